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
