// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/select_tool.h"

#include <QLineF>
#include <QPolygonF>
#include <map>
#include <random>
#include <set>

#include "tests/tools/stage.h"
#include "ui/picking/picking.h"

using namespace imomushi;
using Kind = SelectionItem::Kind;

TEST_CASE("picking: a ray crosses a box twice, in and out, and knows the rest point") {
    ToolStage stage;
    addTwoBars(stage);
    const auto hits = rayHits(stage.session(), Vec3(1.1, 0.2, 9), -Vec3::UnitZ());
    REQUIRE(hits.size() == 2);
    CHECK(hits[0].entering);
    CHECK(!hits[1].entering);
    CHECK(hits[0].distance == doctest::Approx(8.5));
    CHECK((hits[0].rest - Vec3(1.1, 0.2, 0.5)).norm() < 1e-6);
    CHECK((hits[1].rest - Vec3(1.1, 0.2, -0.5)).norm() < 1e-6);
    CHECK(hits[0].element == stage.element("right").id);
}

TEST_CASE("picking: hidden and locked elements are looked through") {
    ToolStage stage;
    addTwoBars(stage);
    stage.run({{"do", "set"}, {"target", "right"}, {"property", "locked"}, {"value", true}});
    CHECK(rayHits(stage.session(), Vec3(1.1, 0.2, 9), -Vec3::UnitZ()).empty());
    stage.run({{"do", "set"}, {"target", "left"}, {"property", "visible"}, {"value", false}});
    CHECK(rayHits(stage.session(), Vec3(-1.1, 0.2, 9), -Vec3::UnitZ()).empty());
}

TEST_CASE("select: a click takes what is under it, Shift adds and takes away, nothing clears") {
    ToolStage stage;
    addTwoBars(stage);
    stage.look(ViewAxis::Front);
    SelectTool tool(stage.document());
    const SelectionItem left{Kind::Element, stage.element("left").id, {}, false}, right{Kind::Element, stage.element("right").id, {}, false};
    stage.click(tool, Vec3(1.1, 0.1, 0));
    CHECK(stage.selected() == right);
    stage.click(tool, Vec3(-1.1, 0.1, 0), Qt::ShiftModifier);
    CHECK(stage.document().selection().size() == 2);
    stage.click(tool, Vec3(1.1, 0.1, 0), Qt::ShiftModifier);
    CHECK(stage.selected() == left);
    stage.click(tool, Vec3(0, 1.2, 0));
    CHECK(stage.document().selection().empty());
}

TEST_CASE("select: bones and their ends lie over bodies, joint faces are parts of their own") {
    ToolStage stage;
    addTwoBones(stage);
    stage.look(ViewAxis::Front);
    SelectTool tool(stage.document());
    const PartId bone2 = stage.now().boneNamed("bone 2")->id;
    stage.hover(tool, Vec3(1.7, 0.0, 0));
    CHECK(stage.document().hovered() == SelectionItem{Kind::Bone, bone2, {}, false});
    stage.click(tool, Vec3(3.0, 0.0, 0));
    CHECK(stage.selected() == SelectionItem{Kind::Endpoint, bone2, {}, true});
    stage.look(ViewAxis::Right);
    stage.click(tool, Vec3(3.0, 0.3, 0.3));
    CHECK(stage.selected() == SelectionItem{Kind::Face, stage.element("right").id, "tip", false});
    CHECK(stage.steps() == 2 + 4 + 1 + 2);  // looking changes nothing
}

TEST_CASE("select: the end of a bone can be dragged, and the drag be taken back") {
    ToolStage stage;
    addTwoBones(stage);
    stage.look(ViewAxis::Front);
    SelectTool tool(stage.document());
    const int before = stage.steps();
    const EndpointRef tip{stage.now().boneNamed("bone 2")->id, true};
    stage.press(tool, Vec3(3, 0, 0));
    stage.pull(tool, Vec3(2.8, 0.8, 0));
    CHECK(tool.busy());
    CHECK(stage.now().goals.contains(tip));
    tool.cancel();
    CHECK(!tool.busy());
    CHECK(stage.steps() == before);
    stage.press(tool, Vec3(3, 0, 0));
    stage.pull(tool, Vec3(2.8, 0.8, 0));
    stage.letGo(tool, Vec3(2.8, 0.8, 0));
    CHECK(stage.steps() == before + 1);
    // A drag that begins on the body only selects.
    stage.press(tool, Vec3(-1.6, 0.35, 0));
    stage.pull(tool, Vec3(-1.6, 0.9, 0));
    CHECK(!tool.busy());
    CHECK(stage.steps() == before + 1);
}

TEST_CASE("select: a box that is dragged from nothing selects what it touches, Shift adds, and Esc takes it back") {
    ToolStage stage;
    addTwoBones(stage);
    for (const bool orthographic : {true, false}) {
        CAPTURE(orthographic);
        stage.camera.setOrthographic(orthographic);
        stage.look(ViewAxis::Front);
        stage.document().select({});
        SelectTool tool(stage.document());
        const SelectionItem left{Kind::Element, stage.element("left").id, {}, false}, right{Kind::Element, stage.element("right").id, {}, false};
        const SelectionItem bone1{Kind::Bone, stage.now().boneNamed("bone 1")->id, {}, false};
        const auto selection = [&] { return stage.document().selection(); };
        // Between two rows of vertices: edges count too.
        stage.press(tool, Vec3(0.6, 1.2, 0));
        CHECK(!tool.box());
        stage.pull(tool, Vec3(0.9, 0.25, 0));
        REQUIRE(tool.box());
        CHECK(tool.busy());
        CHECK(selection() == std::vector{right});
        stage.pull(tool, Vec3(0.9, 1.1, 0));
        CHECK(selection().empty());
        stage.pull(tool, Vec3(-2.0, -0.2, 0));
        CHECK(selection().size() == 4);  // both elements and their bones
        CHECK(selection().back().kind == Kind::Element);
        stage.letGo(tool, Vec3(-2.0, -0.2, 0));
        CHECK(!tool.busy());
        CHECK(!tool.box());
        CHECK(selection().size() == 4);
        // Shift keeps what was selected; Esc takes the box back.
        stage.document().select({right});
        stage.press(tool, Vec3(-4.0, 1.2, 0), Qt::ShiftModifier);
        stage.pull(tool, Vec3(-2.0, -0.1, 0), Qt::ShiftModifier);
        CHECK(selection() == std::vector{right, bone1, left});
        tool.cancel();
        CHECK(selection() == std::vector{right});
        CHECK(!tool.busy());
        stage.press(tool, Vec3(-4.0, 1.2, 0));
        CHECK(selection().empty());
        tool.cancel();
        CHECK(selection() == std::vector{right});
    }
    // What cannot be clicked cannot be boxed.
    SelectTool tool(stage.document());
    stage.run({{"do", "set"}, {"target", "right"}, {"property", "locked"}, {"value", true}});
    stage.run({{"do", "set"}, {"target", "left"}, {"property", "visible"}, {"value", false}});
    stage.press(tool, Vec3(-4.0, 1.2, 0));
    stage.pull(tool, Vec3(4.0, -1.2, 0));
    for (const SelectionItem& item : stage.document().selection()) CHECK(item.kind == Kind::Bone);
    stage.letGo(tool, Vec3(4.0, -1.2, 0));
}

TEST_CASE("select: Delete removes everything selected in one undo step") {
    ToolStage stage;
    addTwoBones(stage);
    stage.look(ViewAxis::Front);
    SelectTool tool(stage.document());
    const int before = stage.steps();
    CHECK(!tool.key(Qt::Key_Delete, {}));
    const Element& right = stage.element("right");
    stage.document().select({{Kind::Element, right.id, {}, false},
                             {Kind::Face, right.id, "tip", false},
                             {Kind::Bone, stage.now().boneNamed("bone 2")->id, {}, false}});
    CHECK(tool.key(Qt::Key_Delete, {}));
    CHECK(stage.now().elements.size() == 1);
    CHECK(stage.now().bones.size() == 1);
    CHECK(stage.document().selection().empty());
    CHECK(stage.steps() == before + 1);
    stage.run({{"do", "undo"}});
    CHECK(stage.now().elements.size() == 2);
    CHECK(stage.now().bones.size() == 2);
    CHECK(stage.element("right").faces.size() == 2);
}

TEST_CASE("select: Ctrl and a drag draw a loop, which takes what it touches when it is let go, with Shift beside what was selected") {
    ToolStage stage;
    addTwoBars(stage);
    stage.run({{"do", "add-bone"}, {"name", "far"}, {"from", {-2, 2, 0}}, {"to", {-1, 2, 0}}});
    stage.look(ViewAxis::Front);
    SelectTool tool(stage.document());
    const auto draw = [&](const std::vector<Vec3>& way, Qt::KeyboardModifiers modifiers) {
        stage.press(tool, way.front(), modifiers);
        for (const Vec3& p : way) stage.pull(tool, p, modifiers);
    };
    // Around the end of the right bar; a box of the same corners would take the bone and the left bar, too.
    const std::vector<Vec3> hook = {{-2.5, 2.4, 0}, {3.5, 2.4, 0}, {3.5, -0.8, 0}, {2.5, -0.8, 0}, {2.5, 2.2, 0}, {-2.5, 2.3, 0}};
    draw(hook, Qt::ControlModifier);
    CHECK(tool.busy());
    CHECK(tool.lasso().size() == qsizetype(hook.size()));
    CHECK(!tool.box());
    CHECK(stage.document().selection().empty());
    stage.letGo(tool, hook.back());
    const SelectionItem right{Kind::Element, stage.element("right").id, {}, false};
    CHECK(stage.selected() == right);
    CHECK(tool.lasso().isEmpty());
    // The bone beside it.
    draw({{-1.6, 2.3, 0}, {-1.4, 2.3, 0}, {-1.4, 1.8, 0}, {-1.6, 1.8, 0}}, Qt::ControlModifier | Qt::ShiftModifier);
    stage.letGo(tool, {-1.6, 1.8, 0});
    CHECK(stage.document().selection().size() == 2);
    CHECK(stage.document().isSelected({Kind::Bone, stage.now().boneNamed("far")->id, {}, false}));
    // Esc leaves what was selected.
    draw(hook, Qt::ControlModifier);
    tool.cancel();
    CHECK(stage.document().selection().size() == 2);
}

TEST_CASE("select: boxes and loops take what has an edge that touches them, whatever shape they have, of flesh near and far") {
    ToolStage stage;
    // Each of more triangles than are asked together.
    stage.add("round", shapes::sphere(0.7, 3).mesh);
    stage.add("far", shapes::moved(shapes::sphere(0.4, 3), Eigen::Matrix3d::Identity(), Vec3(1.4, 0.0, -2.0)).mesh);
    bool orthographic = true;
    SUBCASE("without perspective") {}
    SUBCASE("with perspective") { orthographic = false; }
    stage.camera.setOrthographic(orthographic);
    stage.look(ViewAxis::Front);
    const PointerEvent view = stage.at(0, 0, Qt::NoButton, Qt::NoButton);
    std::mt19937 random(20261130);
    const auto number = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
    const auto touches = [](const QPointF& a, const QPointF& b, const auto& contains, const QPolygonF& outline) {
        if (contains(a) || contains(b)) return true;
        for (qsizetype i = 0; i < outline.size(); ++i)
            if (QLineF(a, b).intersects(QLineF(outline[i], outline[(i + 1) % outline.size()])) == QLineF::BoundedIntersection) return true;
        return false;
    };
    const auto expected = [&](const auto& contains, const QPolygonF& outline) {
        std::set<PartId> found;
        for (const auto& [id, element] : stage.now().elements) {
            const TriangleMesh& mesh = element->mesh->body;
            const auto at = [&](Eigen::Index t, int c) {
                const auto p = view.onScreen(mesh.vertices.row(mesh.triangles(t, c % 3)).transpose());
                REQUIRE(p);
                return QPointF(p->x(), p->y());
            };
            for (Eigen::Index t = 0; t < mesh.triangles.rows() && !found.contains(id); ++t)
                for (int c = 0; c < 3; ++c)
                    if (touches(at(t, c), at(t, c + 1), contains, outline)) found.insert(id);
        }
        return found;
    };
    const auto ids = [](const std::vector<SelectionItem>& items) {
        std::set<PartId> found;
        for (const SelectionItem& item : items) found.insert(item.part);
        return found;
    };
    const Eigen::Vector2d low = stage.screen(Vec3(-1.0, 1.0, 0.0)), high = stage.screen(Vec3(2.2, -1.0, 0.0));
    const auto somewhere = [&] { return QPointF(number(low.x(), high.x()), number(low.y(), high.y())); };
    std::map<std::size_t, int> taken;  // how many were taken, how often
    for (int i = 0; i < 150; ++i) {
        CAPTURE(i);
        const QPointF from = somewhere();
        const QRectF box(from, QSizeF(number(0.5, 160.0), number(0.5, 160.0)));
        const auto inBox = expected([&](const QPointF& p) { return box.contains(p); }, QPolygonF({box.topLeft(), box.topRight(), box.bottomRight(), box.bottomLeft()}));
        CHECK(ids(itemsWithin(stage.session(), view, box)) == inBox);
        QPolygonF loop;  // it may cross itself, or be as thin as a line
        for (int k = 0; k < 3 + i % 9; ++k) loop << (i % 3 == 0 ? from + (somewhere() - from) * 0.2 : somewhere());
        const auto inLoop = expected([&](const QPointF& p) { return loop.containsPoint(p, Qt::WindingFill); }, loop);
        CHECK(ids(itemsWithin(stage.session(), view, loop)) == inLoop);
        ++taken[inBox.size()], ++taken[inLoop.size()];
    }
    for (std::size_t n = 0; n <= 2; ++n) CHECK(taken[n] > 10);
}

TEST_CASE("picking: hidden and locked bones and joint faces are looked through, and what is locked is not grabbed by G") {
    ToolStage stage;
    addTwoBones(stage);
    const auto under = [&](const Vec3& p) {
        const auto s = stage.screen(p);
        return pickItem(stage.session(), stage.at(s.x(), s.y(), Qt::NoButton, Qt::NoButton));
    };
    const auto set = [&](const char* target, const char* property, bool value) { stage.run({{"do", "set"}, {"target", target}, {"property", property}, {"value", value}}); };
    stage.look(ViewAxis::Front);
    const PartId bone1 = stage.now().boneNamed("bone 1")->id, bone2 = stage.now().boneNamed("bone 2")->id;
    const SelectionItem right{Kind::Element, stage.element("right").id, {}, false}, tip{Kind::Endpoint, bone2, {}, true};
    REQUIRE(under(Vec3(1.7, 0, 0)) == SelectionItem{Kind::Bone, bone2, {}, false});
    for (const auto& [property, off] : {std::pair{"locked", true}, std::pair{"visible", false}}) {
        CAPTURE(property);
        set("bone 2", property, off);
        CHECK(under(Vec3(1.7, 0, 0)) == right);
        CHECK(under(Vec3(2.95, 0, 0)) == right);
        CHECK(under(Vec3(0, 0, 0)) == SelectionItem{Kind::Endpoint, bone1, {}, true});  // the other bone's end is there, too
        SelectTool tool(stage.document());
        stage.document().select({tip});
        stage.hover(tool, Vec3(3.0, 0.2, 0));
        CHECK(!tool.wants(Qt::Key_G));
        CHECK(!tool.key(Qt::Key_G, {}));
        set("bone 2", property, !off);
        CHECK(tool.wants(Qt::Key_G));
    }
    stage.look(ViewAxis::Right);
    const SelectionItem face{Kind::Face, stage.element("right").id, "tip", false};
    REQUIRE(under(Vec3(3, 0.3, 0.3)) == face);
    set("right/tip", "locked", true);
    CHECK(under(Vec3(3, 0.3, 0.3)) == right);
    set("right/tip", "locked", false);
    set("right/tip", "visible", false);
    CHECK(under(Vec3(3, 0.3, 0.3)) == right);
}
