// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/outliner_model.h"

#include "tests/tools/stage.h"

using namespace imomushi;

TEST_CASE("outliner: the eye and the lock of the scene and of a character are those of all their elements, in one step") {
    ToolStage stage;
    addTwoBars(stage);
    stage.run({{"do", "make-character"}, {"element", "right"}});
    stage.run({{"do", "cut"}, {"element", "right"}, {"plane", {{"origin", {1.5, 0, 0}}, {"normal", {1, 0, 0}}}}});
    OutlinerModel model(stage.document());
    const QModelIndex scene = model.index(0, 0), whole = model.index(0, 0, scene);
    REQUIRE(whole.data(OutlinerModel::KindRole).toInt() == int(OutlinerModel::Kind::Whole));
    const auto icon = [](const QModelIndex& row, int column) { return row.siblingAtColumn(column).data(OutlinerModel::IconRole).toString().toStdString(); };
    const auto seen = [&] {
        int count = 0;
        for (const auto& [id, e] : stage.now().elements) count += e->visible;
        return count;
    };
    REQUIRE(stage.now().elements.size() == 3);
    CHECK(icon(scene, OutlinerModel::Visible) == "eye");
    const int before = stage.steps();
    model.toggle(whole.siblingAtColumn(OutlinerModel::Visible));
    CHECK(stage.steps() == before + 1);
    CHECK(seen() == 1);
    CHECK(stage.element("left").visible);
    CHECK(icon(whole, OutlinerModel::Visible) == "eye-off");
    CHECK(icon(scene, OutlinerModel::Visible) == "eye");
    CHECK(scene.siblingAtColumn(OutlinerModel::Visible).data(Qt::ToolTipRole).toString() == QStringLiteral("Some are hidden: click to hide all"));
    model.toggle(scene.siblingAtColumn(OutlinerModel::Visible));
    CHECK(seen() == 0);
    model.toggle(scene.siblingAtColumn(OutlinerModel::Visible));
    CHECK(seen() == 3);
    model.toggle(whole.siblingAtColumn(OutlinerModel::Locked));
    CHECK(!stage.element("left").locked);
    CHECK(icon(whole, OutlinerModel::Locked) == "lock");
    CHECK(icon(scene, OutlinerModel::Locked) == "unlock");
    model.toggle(scene.siblingAtColumn(OutlinerModel::Locked));
    CHECK(stage.element("left").locked);
    model.toggle(whole.siblingAtColumn(OutlinerModel::Locked));
    CHECK(icon(whole, OutlinerModel::Locked) == "unlock");
    stage.run({{"do", "undo"}});
    CHECK(icon(whole, OutlinerModel::Locked) == "lock");
}

TEST_CASE("outliner: bones, joint faces and cuts have an eye and a lock of their own, one step each; a cut that moves and a handle that grows keep theirs") {
    ToolStage stage;
    addTwoBones(stage);
    stage.run({{"do", "make-character"}, {"element", "right"}});
    stage.run({{"do", "cut"}, {"element", "right"}, {"plane", {{"origin", {1.5, 0, 0}}, {"normal", {1, 0, 0}}}}});
    stage.run({{"do", "handle"}, {"element", "left"}, {"name", "hold"}, {"point", {-1.5, 0.5, 0.0}}});
    OutlinerModel model(stage.document());
    const Document& d = stage.now();
    const PartId bone = d.boneNamed("bone 1")->id, left = stage.element("left").id;
    const Cut made = d.characters.begin()->second->cuts.front();
    const std::string cutFace = stage.element("right body").piece->sides.front().face;
    const auto toggle = [&](const SelectionItem& item, int column) {
        const QModelIndex row = model.indexOf(item);
        REQUIRE(row.isValid());
        const int before = stage.steps();
        model.toggle(row.siblingAtColumn(column));
        CHECK(stage.steps() == before + 1);
        return model.indexOf(item).siblingAtColumn(column).data(OutlinerModel::IconRole).toString().toStdString();
    };
    using Kind = SelectionItem::Kind;
    CHECK(toggle({Kind::Bone, bone, {}, false}, OutlinerModel::Visible) == "eye-off");
    CHECK(!d.bones.at(bone)->visible);
    CHECK(toggle({Kind::Face, left, "tail", false}, OutlinerModel::Locked) == "lock");
    CHECK(shownOf(d, {Kind::Face, left, "tail", false}).locked);
    CHECK(!shownOf(d, {Kind::Face, left, "joint", false}).locked);
    CHECK(toggle({Kind::Face, left, "hold", false}, OutlinerModel::Visible) == "eye-off");
    const SelectionItem cut{Kind::Cut, made.id, {}, false}, capped{Kind::Face, stage.element("right body").id, cutFace, false};
    CHECK(toggle(cut, OutlinerModel::Locked) == "lock");
    CHECK(toggle(capped, OutlinerModel::Visible) == "eye-off");
    stage.run({{"do", "move-cut"}, {"cut", made.name}, {"plane", {{"origin", {1.7, 0, 0}}, {"normal", {1, 0, 0}}}}});
    stage.run({{"do", "set"}, {"target", "hold"}, {"property", "radius"}, {"value", 0.3}});
    CHECK(shownOf(d, cut).locked);
    CHECK(!shownOf(d, capped).visible);
    CHECK(!shownOf(d, {Kind::Face, left, "hold", false}).visible);
    // All bones by the row above them.
    const QModelIndex bones = model.indexOf(SelectionItem{Kind::Bone, bone, {}, false}).parent();
    REQUIRE(bones.data(OutlinerModel::KindRole).toInt() == int(OutlinerModel::Kind::Bones));
    CHECK(bones.siblingAtColumn(OutlinerModel::Visible).data(Qt::ToolTipRole).toString() == QStringLiteral("Some are hidden: click to hide all"));
    model.toggle(bones.siblingAtColumn(OutlinerModel::Visible));
    CHECK(!d.boneNamed("bone 2")->visible);
    stage.run({{"do", "undo"}});
    CHECK(d.boneNamed("bone 2")->visible);
    CHECK(!d.boneNamed("bone 1")->visible);
}
