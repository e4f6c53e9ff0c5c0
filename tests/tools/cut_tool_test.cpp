// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/stage.h"
#include "ui/models/paths.h"
#include "ui/picking/cut_preview.h"
#include "ui/picking/picking.h"
#include "ui/scene/cut_frame.h"
#include "ui/scene/document_scene.h"
#include "ui/tools/face_tool.h"
#include "ui/tools/select_tool.h"

using namespace imomushi;
using Kind = SelectionItem::Kind;

namespace {

/// A round limb of 6 m along x, of radius 0.5, without flat regions but for its ends.
TriangleMesh limb() {
    TriangleMesh mesh = shapes::cylinder(0.5, 6.0, 32, 40).mesh;
    mesh.vertices = Points(mesh.vertices * (Eigen::Matrix3d() << 0, 0, -1, 0, 1, 0, 1, 0, 0).finished());  // z -> x
    mesh.vertices.col(0).array() -= 3.0;
    return mesh;
}

/// The limb as a whole character "worm" with the element "worm body".
void addWorm(ToolStage& stage) {
    stage.made->services().importCharacter = [](const ImportRequest&, const Progress&) -> Result<CharacterFile> {
        const TriangleMesh mesh = limb();
        CharacterFile file;
        file.format = "obj";
        file.renderModel.mesh.body = mesh;
        file.renderModel.part.assign(std::size_t(mesh.triangles.rows()), 0);
        file.renderModel.parts = {"worm"};
        file.renderModel.mesh.renderMesh.triangles = mesh.triangles;
        for (std::int32_t v = 0; v < mesh.vertices.rows(); ++v) file.renderModel.mesh.renderMesh.bodyVertex.push_back(v);
        return file;
    };
    stage.run({{"do", "import-character"}, {"path", "worm.obj"}, {"name", "worm"}});
}

const CharacterSource& worm(ToolStage& stage) { return *stage.now().characters.begin()->second; }

/// A place on the front of the limb, beside the edges of its triangles.
Vec3 onLimb(double x) { return {x, 0.03, 0.498}; }

SelectionItem cutItem(ToolStage& stage, std::size_t i = 0) { return {Kind::Cut, worm(stage).cuts.at(i).id, {}, false}; }

}  // namespace

TEST_CASE("cuts: the section finder crosses a limb on the shortest way round, with the front away from the middle") {
    const auto mesh = std::make_shared<const TriangleMesh>(limb());
    const SectionFinder finder(mesh, *mesh);
    for (const double x : {-2.0, 1.3, 2.2}) {
        const auto found = finder.across(Vec3(x, 0.0, 0.5), Vec3::UnitZ());
        REQUIRE(found.has_value());
        const CutPlane* plane = &found->plane;
        CHECK(found->outline.length == doctest::Approx(3.14159265).epsilon(0.02));
        CHECK(std::abs(plane->normal.x()) > std::cos(3.0 * 3.14159265 / 180.0));  // refined to two degrees
        CHECK(plane->normal.x() * x > 0.0);
        CHECK((plane->origin - Vec3(x, 0, 0)).norm() < 0.05);
        const auto outline = finder.at(*plane);
        REQUIRE(outline.has_value());
        CHECK(outline->length == doctest::Approx(3.14159265).epsilon(0.02));
        const auto placed = finder.placed(*outline, [&](std::int32_t v) { return Vec3(mesh->vertices.row(v)); });
        REQUIRE(placed.size() == 1);
        for (const Vec3& p : placed[0]) CHECK(std::abs((p - plane->origin).dot(plane->normal)) < 5e-3);  // vertices this near are snapped onto the plane (kSnap)
    }
    CHECK(!finder.at({Vec3(20, 0, 0), Vec3::UnitX()}).has_value());
}

TEST_CASE("cuts: the way round from a triangle finds the same planes as whole sections do") {
    const auto mesh = std::make_shared<const TriangleMesh>(limb());
    const SectionFinder finder(mesh, *mesh);
    int asked = 0;
    for (std::int32_t t = 0; t < mesh->triangles.rows(); t += 17) {
        const Vec3 a = mesh->vertices.row(mesh->triangles(t, 0)), b = mesh->vertices.row(mesh->triangles(t, 1)), c = mesh->vertices.row(mesh->triangles(t, 2));
        const Vec3 point = 0.5 * a + 0.3 * b + 0.2 * c, normal = (b - a).cross(c - a).normalized();
        const auto whole = finder.across(point, normal), round = finder.across(point, normal, t);
        REQUIRE(whole.has_value() == round.has_value());
        if (!whole) continue;
        ++asked;
        // Vertices that a section moves onto its plane change its length by less than their moves: directions that are as short as each other may change places.
        const auto first = finder.at(whole->plane), second = finder.at(round->plane);
        REQUIRE(first.has_value());
        REQUIRE(second.has_value());
        CHECK(second->length == doctest::Approx(first->length).epsilon(0.01));
    }
    CHECK(asked > 20);
}

TEST_CASE("cuts: in the face tool flesh without a flat region shows its section, and a click cuts it in one undo step, joins the pieces and selects the cut") {
    ToolStage stage;
    addWorm(stage);
    stage.look(ViewAxis::Front);
    FaceTool tool(stage.document());
    std::vector<QString> told;
    QObject::connect(&stage.document(), &StudioDocument::madeCut, [&](const QString& text) { told.push_back(text); });
    stage.hover(tool, onLimb(1.3));
    render::Scene scene;
    tool.decorate(scene);
    REQUIRE(scene.markers.size() == 1);
    CHECK(scene.markers[0].shape == render::Marker::Shape::FaceOutline);
    for (const Vec3& p : scene.markers[0].outline) CHECK(std::abs(p.x() - 1.3) < 0.1);
    const int before = stage.steps();
    stage.click(tool, onLimb(1.3));
    CHECK(stage.steps() == before + 1);
    CHECK(stage.refusals.empty());
    REQUIRE(worm(stage).cuts.size() == 1);
    CHECK(stage.now().elements.size() == 2);
    REQUIRE(stage.now().joints.size() == 1);
    CHECK(stage.now().joints.begin()->second->faces.size() == 2);
    CHECK(stage.selected() == cutItem(stage));
    CHECK(told.size() == 1);
    stage.run({{"do", "undo"}});
    CHECK(stage.now().elements.size() == 1);
    CHECK(worm(stage).cuts.empty());
    CHECK(stage.document().selection().empty());
    // Enter does the same as a click.
    stage.hover(tool, onLimb(-1.0));
    CHECK(tool.wants(Qt::Key_Return));
    CHECK(tool.key(Qt::Key_Return, {}));
    CHECK(worm(stage).cuts.size() == 1);
}

TEST_CASE("cuts: the flat end of a limb becomes a joint face as before, and an arrow asks for a patch of round flesh") {
    ToolStage stage;
    addWorm(stage);
    stage.look(ViewAxis::Right);
    FaceTool tool(stage.document());
    stage.click(tool, Vec3(3.0, 0.1, 0.1));
    CHECK(worm(stage).cuts.empty());
    CHECK(stage.element("worm body").faces.size() == 1);
    stage.run({{"do", "undo"}});
    stage.look(ViewAxis::Front);
    stage.hover(tool, onLimb(0.3));
    CHECK(tool.key(Qt::Key_Up, {}));
    stage.click(tool, onLimb(0.3));
    CHECK(worm(stage).cuts.empty());
    CHECK(stage.element("worm body").faces.size() == 1);
}

TEST_CASE("cuts: a plane that is placed on flesh crosses it; keys move and turn it, Enter cuts, Esc does not") {
    ToolStage stage;
    addWorm(stage);
    stage.look(ViewAxis::Front);
    FaceTool tool(stage.document());
    const int before = stage.steps();
    stage.click(tool, onLimb(1.3), Qt::ShiftModifier);
    CHECK(tool.pending());
    tool.cancel();
    CHECK(!tool.pending());
    CHECK(stage.steps() == before);
    stage.click(tool, onLimb(1.3), Qt::ShiftModifier);
    CHECK(tool.key(Qt::Key_X, {}));
    CHECK(tool.key(Qt::Key_Right, {}));
    CHECK(tool.key(Qt::Key_Enter, {}));
    REQUIRE(worm(stage).cuts.size() == 1);
    const CutPlane& plane = worm(stage).cuts[0].plane;
    CHECK(std::abs(plane.normal.x()) == doctest::Approx(1.0));
    CHECK(std::abs(plane.origin.x() - 1.3) == doctest::Approx(0.005 * 6.16).epsilon(0.05));  // half a percent of the diagonal, to the side that X turned the plane to
}

TEST_CASE("cuts: a refused cut changes nothing, says why, and offers the nearest place that works") {
    ToolStage stage;
    addWorm(stage);
    // A slanted cut, which a straight one meets where it is placed.
    stage.run({{"do", "cut"}, {"element", "worm"}, {"plane", {{"origin", {1.3, 0, 0}}, {"normal", {1, 0.6, 0}}}}});
    stage.look(ViewAxis::Front);
    std::vector<Json> offers;
    QObject::connect(&stage.document(), &StudioDocument::offered, [&](const QString& why, const QString&, const Json& command) {
        CHECK(!why.isEmpty());
        offers.push_back(command);
    });
    FaceTool tool(stage.document());
    const int before = stage.steps();
    stage.document().select({});
    stage.click(tool, onLimb(1.2), Qt::ShiftModifier);
    tool.key(Qt::Key_X, {});
    tool.key(Qt::Key_Enter, {});
    CHECK(worm(stage).cuts.size() == 1);
    CHECK(stage.steps() == before);
    CHECK(stage.refusals.empty());
    REQUIRE(offers.size() == 1);
    stage.run(offers[0]);
    CHECK(worm(stage).cuts.size() == 2);
}

TEST_CASE("cuts: the plane of the selected cut slides along its normal with the pointer, and the cut moves on release, in one undo step") {
    ToolStage stage;
    addWorm(stage);
    stage.run({{"do", "cut"}, {"element", "worm"}, {"plane", {{"origin", {1.0, 0, 0}}, {"normal", {1, 0, 0}}}}});
    stage.look(ViewAxis::Front);
    stage.document().select({cutItem(stage)});
    for (const bool inFaceTool : {true, false}) {
        CAPTURE(inFaceTool);
        std::unique_ptr<Tool> tool = makeTool(inFaceTool ? ToolKind::Face : ToolKind::Select, stage.document());
        const int before = stage.steps();
        const double from = worm(stage).cuts[0].plane.origin.x();
        stage.press(*tool, Vec3(from, 0.49, 0.0));
        CHECK(tool->busy());
        stage.pull(*tool, Vec3(from + 0.3, 0.49, 0.0));
        stage.pull(*tool, Vec3(from + 0.5, 0.49, 0.0));
        CHECK(worm(stage).cuts[0].plane.origin.x() == from);
        CHECK(stage.steps() == before);
        stage.letGo(*tool, Vec3(from + 0.5, 0.49, 0.0));
        CHECK(!tool->busy());
        CHECK(stage.steps() == before + 1);
        CHECK(worm(stage).cuts[0].plane.origin.x() == doctest::Approx(from + 0.5).epsilon(1e-3));
        CHECK(stage.selected() == cutItem(stage));
        stage.run({{"do", "undo"}});
        CHECK(worm(stage).cuts[0].plane.origin.x() == from);
        // Given up, nothing happens.
        stage.press(*tool, Vec3(from, 0.49, 0.0));
        stage.pull(*tool, Vec3(from + 0.5, 0.49, 0.0));
        tool->cancel();
        CHECK(!tool->busy());
        CHECK(worm(stage).cuts[0].plane.origin.x() == from);
    }
}

TEST_CASE("cuts: typed numbers slide and turn the plane, also of a cut that G and R take without a button") {
    ToolStage stage;
    addWorm(stage);
    stage.run({{"do", "cut"}, {"element", "worm"}, {"plane", {{"origin", {1.0, 0, 0}}, {"normal", {1, 0, 0}}}}});
    stage.look(ViewAxis::Front);
    stage.document().select({cutItem(stage)});
    const auto type = [](Tool& tool, const QString& signs) {
        for (const QChar sign : signs) CHECK(tool.key(0, {}, QString(sign)));
    };
    const int before = stage.steps();
    {
        SelectTool tool(stage.document());
        stage.press(tool, Vec3(1, 0.49, 0.0));
        type(tool, QStringLiteral("25 cm"));
        CHECK(tool.banner().contains(QStringLiteral("25 cm")));
        stage.letGo(tool, Vec3(1, 0.49, 0.0));
        CHECK(worm(stage).cuts[0].plane.origin.x() == doctest::Approx(1.25).epsilon(1e-6));
        CHECK(stage.steps() == before + 1);
        stage.hover(tool, Vec3(0, 1.2, 0));
        CHECK(tool.wants(Qt::Key_G));
        CHECK(tool.key(Qt::Key_G, {}, QStringLiteral("g")));
        CHECK(tool.modal());
        type(tool, QStringLiteral(".1-"));
        stage.press(tool, Vec3(0, 1.2, 0));
        CHECK(!tool.busy());
        CHECK(worm(stage).cuts[0].plane.origin.x() == doctest::Approx(1.15).epsilon(1e-6));
        CHECK(stage.steps() == before + 2);
    }
    FaceTool tool(stage.document());
    stage.hover(tool, Vec3(0, 1.2, 0));
    CHECK(tool.wants(Qt::Key_R));
    CHECK(tool.key(Qt::Key_R, {}, QStringLiteral("r")));
    type(tool, QStringLiteral("20°"));
    CHECK(tool.key(Qt::Key_Return, {}, {}));
    CHECK(worm(stage).cuts[0].plane.normal.normalized().x() == doctest::Approx(std::cos(20.0 * 3.14159265358979 / 180.0)));
    CHECK(std::abs(worm(stage).cuts[0].plane.normal.normalized().z()) < 1e-9);
    CHECK(stage.steps() == before + 3);
    CHECK(tool.key(Qt::Key_G, {}, QStringLiteral("g")));
    stage.hover(tool, Vec3(0.5, 1.2, 0));
    tool.cancel();
    CHECK(stage.steps() == before + 3);
    CHECK(stage.refusals.empty());
}

TEST_CASE("cuts: the tip of the arrow turns the plane, with Ctrl to an axis") {
    ToolStage stage;
    addWorm(stage);
    stage.run({{"do", "cut"}, {"element", "worm"}, {"plane", {{"origin", {1.0, 0, 0}}, {"normal", {1, 0.3, 0}}}}});
    stage.look(ViewAxis::Front);
    stage.document().select({cutItem(stage)});
    SelectTool tool(stage.document());
    const auto frame = cutFrame(stage.session(), cutItem(stage).part);
    REQUIRE(frame.has_value());
    const Vec3 tip = frame->centre + frame->reach * frame->normal;
    stage.press(tool, tip);
    CHECK(tool.busy());
    stage.pull(tool, tip + Vec3(0.05, -0.1, 0), Qt::ControlModifier);
    stage.letGo(tool, tip + Vec3(0.05, -0.1, 0));
    CHECK((worm(stage).cuts[0].plane.normal.normalized() - Vec3::UnitX()).norm() < 1e-6);
}

TEST_CASE("cuts: Delete takes the selected cut out, and its name goes with it from the selection") {
    ToolStage stage;
    addWorm(stage);
    stage.run({{"do", "cut"}, {"element", "worm"}, {"plane", {{"origin", {1.0, 0, 0}}, {"normal", {1, 0, 0}}}}, {"name", "waist"}});
    const SelectionItem item = cutItem(stage);
    CHECK(pathOf(stage.now(), item) == "waist");
    stage.document().select({item});
    SelectTool tool(stage.document());
    const int before = stage.steps();
    CHECK(tool.key(Qt::Key_Delete, {}));
    CHECK(stage.steps() == before + 1);
    CHECK(worm(stage).cuts.empty());
    CHECK(stage.now().elements.size() == 1);
    CHECK(stage.document().selection().empty());
    // A whole character goes with all that is its.
    stage.document().select({{Kind::Character, worm(stage).id, {}, false}});
    CHECK(tool.key(Qt::Key_Delete, {}));
    CHECK(stage.now().characters.empty());
    CHECK(stage.now().elements.empty());
}

TEST_CASE("picking: a render mesh answers with the element that the triangle follows and a point of its body that is no cap") {
    ToolStage stage;
    addWorm(stage);
    stage.run({{"do", "cut"}, {"element", "worm"}, {"plane", {{"origin", {1.0, 0, 0}}, {"normal", {1, 0, 0}}}}, {"names", {"trunk", "tip"}}});
    stage.look(ViewAxis::Front);
    for (const auto& [x, name] : {std::pair{-1.0, "trunk"}, std::pair{2.0, "tip"}}) {
        const auto s = stage.screen(onLimb(x));
        const PointerEvent e = stage.at(s.x(), s.y(), Qt::LeftButton, Qt::LeftButton);
        const auto hits = rayHits(stage.session(), e.rayOrigin, e.rayDirection);
        REQUIRE(hits.size() == 2);
        const Element& element = stage.element(name);
        CHECK(hits[0].element == element.id);
        CHECK(hits[0].entering);
        CHECK(!hits[1].entering);
        CHECK(element.piece->origin->triangles[std::size_t(hits[0].triangle)] >= 0);
        CHECK((hits[0].rest - onLimb(x)).norm() < 0.01);
        CHECK((hits[0].point - hits[0].rest).norm() < 1e-5);
        CHECK(pickItem(stage.session(), e) == SelectionItem{Kind::Element, element.id, {}, false});
    }
    stage.run({{"do", "set"}, {"target", "tip"}, {"property", "locked"}, {"value", true}});
    const auto s = stage.screen(onLimb(2.0));
    CHECK(!pickItem(stage.session(), stage.at(s.x(), s.y(), Qt::LeftButton, Qt::LeftButton)));
}

TEST_CASE("cuts: the selected cut can be grabbed from every side, before the ends of bones and before flesh") {
    ToolStage stage;
    addWorm(stage);
    stage.run({{"do", "cut"}, {"element", "worm"}, {"plane", {{"origin", {1.0, 0, 0}}, {"normal", {1, 0, 0}}}}});
    // The end of a bone at the very middle of the cut, which its bone follows.
    stage.run({{"do", "add-bone"}, {"name", "tail"}, {"element", ""}, {"from", {-1, 0, 0}}, {"to", {1, 0, 0}}});
    for (const ViewAxis axis : {ViewAxis::Front, ViewAxis::Top, ViewAxis::Right, ViewAxis::Left}) {
        CAPTURE(int(axis));
        stage.look(axis);
        stage.document().select({cutItem(stage)});
        SelectTool tool(stage.document());
        const double from = worm(stage).cuts[0].plane.origin.x();
        // Seen along its normal, the plane comes nearer where the pointer goes down.
        const bool along = axis == ViewAxis::Right || axis == ViewAxis::Left;
        const Vec3 to = along ? Vec3(from, -0.3, 0.0) : Vec3(from + 0.3, 0.0, 0.0);
        stage.press(tool, Vec3(from, 0.0, 0.0));
        CHECK(tool.busy());
        CHECK(stage.selected() == cutItem(stage));
        stage.pull(tool, 0.5 * (Vec3(from, 0.0, 0.0) + to));
        stage.pull(tool, to);
        stage.letGo(tool, to);
        CHECK(worm(stage).cuts[0].plane.origin.x() == doctest::Approx(from + (axis == ViewAxis::Left ? -0.3 : 0.3)).epsilon(1e-3));
        stage.run({{"do", "undo"}});
        CHECK(worm(stage).cuts[0].plane.origin.x() == from);
    }
}

TEST_CASE("cuts: what ends at a cut comes along when it is moved by numbers") {
    ToolStage stage;
    addWorm(stage);
    stage.run({{"do", "cut"}, {"element", "worm"}, {"plane", {{"origin", {1.0, 0, 0}}, {"normal", {1, 0, 0}}}}});
    const auto& element = *stage.now().elements.begin()->second;
    REQUIRE(element.faces.size() == 1);
    stage.run({{"do", "add-bone"}, {"name", "tail"}, {"element", element.name}, {"from", {-1, 0, 0}}, {"to", element.name + "/" + element.faces[0].name}});
    const EndpointRef end{stage.now().boneNamed("tail")->id, true};
    const auto before = endpointRestPosition(stage.now(), end);
    REQUIRE(before.has_value());
    stage.run({{"do", "move-cut"}, {"cut", worm(stage).cuts[0].name}, {"plane", {{"origin", {1.4, 0, 0}}, {"normal", {1, 0, 0}}}}});
    const auto after = endpointRestPosition(stage.now(), end);
    REQUIRE(after.has_value());
    CHECK(after->x() - before->x() == doctest::Approx(0.4).epsilon(0.02));
}
