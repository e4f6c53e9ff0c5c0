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
