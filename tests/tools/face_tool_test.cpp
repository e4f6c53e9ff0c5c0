// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/face_tool.h"

#include "tests/tools/stage.h"

using namespace imomushi;
using Kind = SelectionItem::Kind;

TEST_CASE("face tool: a click on a flat region makes a joint face in one undo step, and selects it") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Right);
    FaceTool tool(stage.document());
    const int before = stage.steps();
    stage.click(tool, Vec3(3, 0.1, 0.2));
    REQUIRE(stage.element("right").faces.size() == 1);
    const JointFace& face = stage.element("right").faces[0];
    CHECK(face.name == "face 1");
    CHECK(face.vertices.size() == 9);
    CHECK((face.frame.axes.col(2) - Vec3::UnitX()).norm() < 1e-12);
    CHECK(stage.selected() == SelectionItem{Kind::Face, stage.element("right").id, "face 1", false});
    CHECK(stage.steps() == before + 1);
    CHECK(stage.now().joints.empty());
    stage.run({{"do", "undo"}});
    CHECK(stage.element("right").faces.empty());
    stage.run({{"do", "redo"}});
    CHECK(stage.element("right").faces.size() == 1);
}

TEST_CASE("face tool: a click on a joint face selects it and changes nothing") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Right);
    FaceTool tool(stage.document());
    stage.click(tool, Vec3(3, 0.1, 0.2));
    stage.document().select({});
    const int before = stage.steps();
    stage.hover(tool, Vec3(3, -0.3, 0.2));
    CHECK(stage.document().hovered() == SelectionItem{Kind::Face, stage.element("right").id, "face 1", false});
    stage.click(tool, Vec3(3, -0.3, 0.2));
    CHECK(stage.selected() == SelectionItem{Kind::Face, stage.element("right").id, "face 1", false});
    CHECK(stage.steps() == before);
}

TEST_CASE("face tool: a region that touches a joint face is refused with the reason") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Right);
    FaceTool tool(stage.document());
    stage.click(tool, Vec3(3, 0.1, 0.2));
    stage.look(ViewAxis::Front);
    const int before = stage.steps();
    stage.click(tool, Vec3(1.1, 0.1, 0.5));
    CHECK(stage.element("right").faces.size() == 1);
    CHECK(stage.steps() == before);
    REQUIRE(stage.refusals.size() == 1);
    CHECK(stage.refusals[0].contains(QStringLiteral("face 1")));
}

TEST_CASE("face tool: after undo the same click makes the face again") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Right);
    FaceTool tool(stage.document());
    stage.click(tool, Vec3(3, 0.1, 0.2));
    stage.run({{"do", "undo"}});
    stage.click(tool, Vec3(3, 0.1, 0.2));
    CHECK(stage.element("right").faces.size() == 1);
}

TEST_CASE("face tool: where two elements touch, one click behind the surface makes both faces and joins them, in one undo step") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Front);
    stage.camera.setDirection(Vec3(-1, -0.4, -0.3), false);
    FaceTool tool(stage.document());
    const int before = stage.steps();
    stage.click(tool, Vec3(0, 0.05, 0.03), Qt::ControlModifier);
    REQUIRE(stage.element("left").faces.size() == 1);
    REQUIRE(stage.element("right").faces.size() == 1);
    REQUIRE(stage.now().joints.size() == 1);
    CHECK(stage.now().joints.begin()->second->faces.size() == 2);
    CHECK(stage.steps() == before + 1);
    CHECK(stage.refusals.empty());
    stage.run({{"do", "undo"}});
    CHECK(stage.element("left").faces.empty());
    CHECK(stage.element("right").faces.empty());
    CHECK(stage.now().joints.empty());
}

TEST_CASE("face tool: a face that meets a free face of a neighbour is joined to it") {
    ToolStage stage;
    addTwoBars(stage);
    stage.run({{"do", "add-joint-face"},
               {"element", "right"},
               {"name", "mouth"},
               {"plane", {{"origin", {0, 0, 0}}, {"normal", {-1, 0, 0}}}}});
    stage.run({{"do", "set"}, {"target", "right"}, {"property", "visible"}, {"value", false}});
    stage.look(ViewAxis::Right);
    FaceTool tool(stage.document());
    const int before = stage.steps();
    stage.click(tool, Vec3(0, 0.1, 0.2));
    REQUIRE(stage.now().joints.size() == 1);
    const Joint& joint = *stage.now().joints.begin()->second;
    CHECK(joint.faces.size() == 2);
    CHECK(std::count(joint.faces.begin(), joint.faces.end(), FaceRef{stage.element("right").id, "mouth"}) == 1);
    CHECK(stage.steps() == before + 1);
}

TEST_CASE("face tool: faces of another size, another place or the same side do not meet") {
    JointFace a;
    a.size = a.area = 1.0;
    JointFace b = a;
    b.frame.axes.col(2) = -a.frame.axes.col(2);
    CHECK(facesMeet(a, b));
    JointFace moved = b, larger = b;
    moved.frame.origin.x() = 0.02;
    larger.size = 1.2;
    CHECK(!facesMeet(a, moved));
    CHECK(!facesMeet(a, larger));
    CHECK(!facesMeet(a, a));
}

TEST_CASE("face tool: Shift places a plane, Enter makes the face, Esc makes nothing") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Right);
    FaceTool tool(stage.document());
    const int before = stage.steps();
    stage.click(tool, Vec3(3, 0.1, 0.2), Qt::ShiftModifier);
    CHECK(tool.pending());
    CHECK(stage.steps() == before);
    render::Scene scene;
    tool.decorate(scene);
    REQUIRE(scene.markers.size() == 2);
    CHECK(scene.markers[0].shape == render::Marker::Shape::FaceOutline);
    CHECK(scene.markers[0].outline.size() == 8);  // two cells to a side
    CHECK(scene.markers[1].shape == render::Marker::Shape::PlaneGizmo);
    CHECK((scene.markers[1].to - scene.markers[1].from).normalized().dot(Vec3::UnitX()) > 0.999);
    tool.cancel();
    CHECK(!tool.pending());
    CHECK(stage.steps() == before);
    stage.click(tool, Vec3(3, 0.1, 0.2), Qt::ShiftModifier);
    CHECK(tool.key(Qt::Key_Enter, {}));
    CHECK(!tool.pending());
    CHECK(stage.steps() == before + 1);
    REQUIRE(stage.element("right").faces.size() == 1);
    CHECK(stage.element("right").faces[0].vertices.size() == 9);
}

TEST_CASE("face tool: a plane off the surface is refused; a larger tolerance reaches it again") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Right);
    FaceTool tool(stage.document());
    stage.click(tool, Vec3(3, 0.1, 0.2), Qt::ShiftModifier);
    CHECK(tool.key(Qt::Key_Right, {}));
    CHECK(tool.key(Qt::Key_Enter, {}));
    CHECK(stage.element("right").faces.empty());
    CHECK(stage.refusals.size() == 1);
    for (int i = 0; i < 7; ++i) CHECK(tool.key(Qt::Key_Up, {}));
    CHECK(tool.key(Qt::Key_Enter, {}));
    CHECK(stage.element("right").faces.size() == 1);
}

TEST_CASE("face tool: on a round body the tolerance decides how much is flat") {
    ToolStage stage;
    stage.add("ball", shapes::sphere(1.0, 3).mesh);
    stage.look(ViewAxis::Front);
    FaceTool tool(stage.document());
    const Vec3 there(0.02, 0.03, 1.0);
    stage.hover(tool, there);
    const QString narrow = tool.hint();
    for (int i = 0; i < 6; ++i) CHECK(tool.key(Qt::Key_Up, {}));
    CHECK(tool.hint() != narrow);
    stage.click(tool, there);
    REQUIRE(stage.element("ball").faces.size() == 1);
    CHECK(stage.element("ball").faces[0].vertices.size() > 3);
}

TEST_CASE("face tool: a preview of an element that is gone is neither drawn nor made") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Right);
    FaceTool tool(stage.document());
    stage.click(tool, Vec3(3, 0.1, 0.2), Qt::ShiftModifier);
    stage.run({{"do", "remove-element"}, {"name", "right"}});
    render::Scene scene;
    tool.decorate(scene);
    const int before = stage.steps();
    tool.key(Qt::Key_Enter, {});
    CHECK(stage.steps() == before);
}

TEST_CASE("face tool: G moves the placed plane without a button and R turns it, typed numbers lead, and Esc brings it back") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Front);
    FaceTool tool(stage.document());
    const auto plane = [&]() -> std::pair<Vec3, Vec3> {
        render::Scene scene;
        tool.decorate(scene);
        for (const render::Marker& m : scene.markers)
            if (m.shape == render::Marker::Shape::PlaneGizmo) return {m.from, (m.to - m.from).normalized()};
        return {Vec3::Constant(1e9), Vec3::Zero()};
    };
    // Across the right bar.
    stage.click(tool, Vec3(1.2, 0.2, 0.5), Qt::ShiftModifier);
    tool.key(Qt::Key_X, Qt::NoModifier);
    const auto [at, normal] = plane();
    REQUIRE(std::abs(normal.x()) > 0.99);
    CHECK(tool.wants(Qt::Key_G));
    CHECK(tool.key(Qt::Key_G, Qt::NoModifier));
    CHECK(tool.modal());
    CHECK(tool.busy());
    stage.hover(tool, Vec3(1.7, 0.2, 0.5));
    CHECK(plane().first.x() == doctest::Approx(at.x() + 0.5).epsilon(0.02));
    const double way = normal.x() > 0.0 ? 1.0 : -1.0;
    for (const char c : {'0', '.', '2', '5'}) tool.key(c == '.' ? Qt::Key_Period : Qt::Key_0, Qt::NoModifier, QString(QChar::fromLatin1(c)));
    CHECK(plane().first.x() == doctest::Approx(at.x() + 0.25 * way));
    CHECK(!tool.banner().isEmpty());
    tool.cancel();
    CHECK(!tool.busy());
    CHECK(tool.pending());  // the plane is still there
    CHECK((plane().first - at).norm() < 1e-12);
    // A click keeps it, and makes nothing yet.
    const int before = stage.steps();
    stage.hover(tool, Vec3(1.2, 0.2, 0.5));
    tool.key(Qt::Key_G, Qt::NoModifier);
    stage.hover(tool, Vec3(1.7, 0.2, 0.5));
    stage.click(tool, Vec3(1.7, 0.2, 0.5));
    CHECK(!tool.modal());
    CHECK(stage.steps() == before);
    CHECK(plane().first.x() == doctest::Approx(at.x() + 0.5).epsilon(0.02));
    tool.key(Qt::Key_R, Qt::NoModifier);
    for (const char c : {'3', '0'}) tool.key(Qt::Key_0, Qt::NoModifier, QString(QChar::fromLatin1(c)));
    CHECK(std::acos(std::abs(plane().second.dot(normal))) == doctest::Approx(30.0 * 3.14159265358979 / 180.0));
    tool.key(Qt::Key_Return, Qt::NoModifier);
    CHECK(!tool.busy());
    // Enter once more cuts there.
    tool.key(Qt::Key_Return, Qt::NoModifier);
    CHECK(stage.steps() == before + 1);
    CHECK(stage.refusals.empty());
}

namespace {

/// A bar whose end at x = 3 is a joint face of 25 vertices, looked at from there.
struct FaceOfABar : ToolStage {
    FaceTool tool{document()};
    explicit FaceOfABar(bool alone = true) {
        add("bar", shapes::box(Vec3(0, -0.5, -0.5), Vec3(3, 0.5, 0.5), 12, 4, 4).mesh);
        if (!alone) add("next", shapes::box(Vec3(3, -0.5, -0.5), Vec3(6, 0.5, 0.5), 12, 4, 4).mesh);
        run({{"do", "add-joint-face"}, {"element", "bar"}, {"name", "end"}, {"plane", {{"origin", {3, 0, 0}}, {"normal", {1, 0, 0}}}}});
        document().select({SelectionItem{Kind::Face, element("bar").id, "end", false}});
        look(ViewAxis::Right);
    }
    std::size_t vertices() { return element("bar").faces.at(0).vertices.size(); }
    const Vec3 left{3, 0.45, 0.45}, right{3, -0.45, 0.45};  // along the upper rim
};

}  // namespace

TEST_CASE("face tool: + and - and Ctrl+wheel make the selected face larger and smaller by a ring, one undo step each, and the arrows keep the tolerance") {
    FaceOfABar stage;
    FaceTool& tool = stage.tool;
    CHECK(!tool.wants(Qt::Key_Plus));  // the pointer is not there yet
    stage.hover(tool, Vec3(3, 0.1, 0.2));
    CHECK(tool.hint().contains(QStringLiteral("end")));
    const int before = stage.steps();
    CHECK(tool.key(Qt::Key_Plus, {}));
    CHECK(stage.vertices() == 41);
    CHECK(stage.steps() == before + 1);
    CHECK(stage.selected()->face == "end");
    PointerEvent e = stage.at(400, 300, Qt::NoButton, Qt::NoButton, Qt::ControlModifier);
    CHECK(tool.wheel(1.0, e));
    CHECK(stage.vertices() == 57);
    CHECK(stage.steps() == before + 2);
    stage.run({{"do", "undo"}});
    CHECK(stage.vertices() == 41);
    for (std::size_t left : {25u, 9u}) {
        CHECK(tool.key(Qt::Key_Minus, {}));
        CHECK(stage.vertices() == left);
    }
    CHECK(tool.key(Qt::Key_Minus, {}));
    CHECK(stage.refusals.size() == 1);
    CHECK(stage.vertices() == 9);
    CHECK(tool.key(Qt::Key_Up, {}));
    CHECK(stage.vertices() == 9);
    // Without Ctrl the wheel zooms.
    e.modifiers = {};
    CHECK(!tool.wheel(1.0, e));
}

TEST_CASE("face tool: a face that was just made grows at once; a joined one has no brush and stays as it is") {
    FaceOfABar stage;
    stage.run({{"do", "remove-joint-face"}, {"face", "bar/end"}});
    stage.click(stage.tool, Vec3(3, 0.1, 0.2));
    REQUIRE(stage.vertices() == 25);
    CHECK(stage.tool.key(Qt::Key_Plus, {}));
    CHECK(stage.vertices() == 41);

    FaceOfABar joined(false);
    REQUIRE(joinNeighbours(joined.document(), {joined.element("bar").id, "end"}) == 1);
    joined.run({{"do", "set"}, {"target", "next"}, {"property", "visible"}, {"value", false}});
    joined.hover(joined.tool, Vec3(3, 0.1, 0.2));
    const int before = joined.steps();
    CHECK(!joined.tool.wants(Qt::Key_C));
    CHECK(!joined.tool.key(Qt::Key_C, {}));
    CHECK(!joined.tool.key(Qt::Key_L, {}));
    joined.tool.key(Qt::Key_Plus, {});
    CHECK(joined.steps() == before);
}

TEST_CASE("face tool: a drag with the brush takes vertices away with Ctrl and adds them without, each drag one undo step, however fast the hand is") {
    FaceOfABar stage;
    FaceTool& tool = stage.tool;
    stage.hover(tool, stage.left);
    CHECK(tool.wants(Qt::Key_C));
    CHECK(tool.key(Qt::Key_C, {}));
    CHECK(tool.pending());
    CHECK(!tool.busy());
    const int before = stage.steps();
    stage.press(tool, stage.left, Qt::ControlModifier);
    CHECK(tool.busy());
    stage.pull(tool, stage.right);
    CHECK(stage.steps() == before);  // a preview alone
    CHECK(stage.vertices() == 25);
    render::Scene scene;
    tool.decorate(scene);
    REQUIRE(!scene.markers.empty());
    CHECK(scene.markers[0].outline.size() == 14);  // four cells by three
    CHECK(!scene.markers[0].refused);
    stage.letGo(tool, stage.right);
    CHECK(!tool.busy());
    CHECK(stage.vertices() == 20);
    CHECK(stage.steps() == before + 1);
    stage.press(tool, stage.right);
    stage.pull(tool, stage.left);
    stage.letGo(tool, stage.left);
    CHECK(stage.vertices() == 25);
    CHECK(stage.steps() == before + 2);
    stage.run({{"do", "undo"}});
    stage.run({{"do", "undo"}});
    CHECK(stage.vertices() == 25);
    CHECK(tool.key(Qt::Key_C, {}));
    CHECK(!tool.pending());
    CHECK(stage.refusals.empty());
}

TEST_CASE("face tool: Esc takes back what is being painted, once more puts the brush away, and the wheel sets its radius") {
    FaceOfABar stage;
    FaceTool& tool = stage.tool;
    stage.hover(tool, Vec3(3, 0, 0));
    tool.key(Qt::Key_C, {});
    const int before = stage.steps();
    stage.press(tool, stage.left, Qt::ControlModifier);
    stage.pull(tool, stage.right);
    tool.cancel();
    CHECK(!tool.busy());
    CHECK(tool.pending());
    stage.letGo(tool, stage.right);
    CHECK(stage.vertices() == 25);
    CHECK(stage.steps() == before);
    const QString narrow = tool.hint();
    for (int i = 0; i < 8; ++i) CHECK(tool.wheel(1.0, stage.at(400, 300, Qt::NoButton, Qt::NoButton)));
    CHECK(tool.hint() != narrow);
    // Four times as wide it takes more at one touch.
    stage.press(tool, stage.left, Qt::ControlModifier);
    stage.letGo(tool, stage.left);
    CHECK(stage.vertices() < 22);
    tool.cancel();
    CHECK(!tool.pending());
}

TEST_CASE("face tool: a drag that would leave two pieces is shown as refused and changes nothing") {
    FaceOfABar stage;
    FaceTool& tool = stage.tool;
    stage.hover(tool, Vec3(3, 0, 0));
    tool.key(Qt::Key_C, {});
    const int before = stage.steps();
    stage.press(tool, Vec3(3, 0.45, 0.02), Qt::ControlModifier);
    stage.pull(tool, Vec3(3, -0.45, 0.02));
    render::Scene scene;
    tool.decorate(scene);
    REQUIRE(!scene.markers.empty());
    CHECK(scene.markers[0].refused);
    stage.letGo(tool, Vec3(3, -0.45, 0.02));
    CHECK(stage.refusals.size() == 1);
    CHECK(stage.vertices() == 25);
    CHECK(stage.steps() == before);
}

TEST_CASE("face tool: L adds the flat region under the pointer, and a face that is not selected any more has no brush") {
    FaceOfABar stage;
    FaceTool& tool = stage.tool;
    stage.hover(tool, stage.left);
    CHECK(tool.key(Qt::Key_Minus, {}));
    REQUIRE(stage.vertices() == 9);
    const int before = stage.steps();
    stage.hover(tool, stage.left);
    CHECK(tool.wants(Qt::Key_L));
    CHECK(tool.key(Qt::Key_L, {}));
    CHECK(stage.vertices() == 25);
    CHECK(stage.steps() == before + 1);
    tool.key(Qt::Key_C, {});
    CHECK(tool.pending());
    stage.document().select({});
    CHECK(!tool.pending());
}

TEST_CASE("face tool: where an element has a result, the hint says that it must be precomputed again") {
    FaceOfABar stage;
    stage.run({{"do", "set"}, {"target", "bar"}, {"property", "solver-mesh"}, {"value", "as-is"}});
    stage.hover(stage.tool, stage.left);
    CHECK(!stage.tool.hint().contains(QStringLiteral("precomputed again")));
    stage.run({{"do", "precompute"}});
    stage.hover(stage.tool, stage.left);
    CHECK(stage.tool.hint().contains(QStringLiteral("precomputed again")));
    stage.tool.key(Qt::Key_C, {});
    CHECK(stage.tool.hint().contains(QStringLiteral("precomputed again")));
}
