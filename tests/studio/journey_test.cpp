// SPDX-License-Identifier: GPL-3.0-or-later
#include <QFileInfo>
#include <QMimeData>
#include <QTreeView>

#include "tests/studio/window.h"
#include "ui/models/effect_texts.h"
#include "ui/panels/history_panel.h"
#include "ui/panels/outliner_panel.h"
#include "ui/window/status_strip.h"

using namespace imomushi;

TEST_CASE("studio: a mesh becomes a character by clicking, moves by dragging, and everything can be undone and saved") {
    Window w;
    w.shoot("start");
    CHECK(w.window().startShown());
    const QString file = w.folder.filePath(QStringLiteral("my caterpillar.imomushi"));
    w.run({{"do", "new"}, {"path", file.toStdString()}});

    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    REQUIRE(w.now().elements.size() == 1);
    CHECK(!w.window().startShown());
    const PartId element = w.now().elements.begin()->first;
    const auto faces = [&] { return w.now().elements.at(element)->faces.size(); };
    w.shoot("imported");

    // Two joint faces: a click on each cap of the cylinder, which lies along z from -2 to 2.
    w.trigger("tool-face");
    w.look(Vec3(1.2, 0.7, 1.5));
    w.click(w.onScreen(Vec3(0, 0, 2)));
    CHECK(faces() == 1);
    w.shoot("face");
    w.look(Vec3(1.2, 0.7, -1.5));
    w.click(w.onScreen(Vec3(0, 0, -2)));
    REQUIRE(faces() == 2);

    // A bone from face to face.
    w.trigger("tool-bone");
    w.look(Vec3(1, 0.25, 0.2));
    w.click(w.onScreen(Vec3(0, 0, -2)));
    w.click(w.onScreen(Vec3(0, 0, 2)));
    REQUIRE(w.now().bones.size() == 1);
    const PartId bone = w.now().bones.begin()->first;
    CHECK(w.now().bones.at(bone)->element == element);
    w.shoot("bone");
    QTest::keyClick(&w.view(), Qt::Key_Escape);

    // The precompute runs in the background; the window stays alive meanwhile.
    CHECK(w.document().session().responseState(element) == Session::ResponseState::None);
    w.window().actions()["precompute"]->trigger();  // without settling: so small an element takes less time than that
    CHECK(w.window().precompute().job().running());
    waitFor([&] { return !w.window().precompute().job().running(); }, 120000);
    REQUIRE(w.document().session().responseState(element) == Session::ResponseState::Fresh);
    w.shoot("precomputed");

    // Dragging the end of the bone with the mouse bends the element in one undo step.
    w.trigger("tool-pose");
    w.look(Vec3(1, 0.25, 0.2));
    const int before = w.document().session().position();
    const bool atEnd = (*w.view().onScreen(EndpointRef{bone, true}) - QPointF(w.onScreen(Vec3(0, 0, 2)))).manhattanLength() < 3.0;
    const EndpointRef end{bone, atEnd};
    const QPoint from = w.view().onScreen(end)->toPoint();
    QTest::mouseMove(&w.view(), from);
    w.settle();
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
    for (int i = 1; i <= 12; ++i) {
        QTest::mouseMove(&w.view(), from + QPoint(-4 * i, -10 * i));
        w.settle();
    }
    w.shoot("dragging");
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, from + QPoint(-48, -120));
    w.settle();
    CHECK(w.document().session().position() == before + 1);
    REQUIRE(w.now().goals.contains(end));
    // It follows the pointer: where the bone's end is drawn is where the mouse let go.
    CHECK((*w.view().onScreen(end) - QPointF(from + QPoint(-48, -120))).manhattanLength() < 12.0);
    w.shoot("dragged");

    // Undo to the start, step by step, with the keyboard; then redo everything by a click in the history.
    const int steps = w.document().session().position();
    for (int i = 0; i < steps; ++i) w.trigger("undo");
    CHECK(w.document().session().position() == 0);
    CHECK(w.now().elements.empty());
    CHECK(w.now().bones.empty());
    CHECK(!w.window().actions()["undo"]->isEnabled());
    w.window().history().model()->refresh();
    w.window().history().model()->goTo(steps);
    w.settle();
    CHECK(w.now().elements.size() == 1);
    CHECK(w.now().bones.size() == 1);
    // Undo and redo only switch the key of the result: nothing is computed again.
    CHECK(w.document().session().responseState(element) == Session::ResponseState::Fresh);

    CHECK(w.window().isWindowModified());
    w.trigger("save");
    CHECK(QFileInfo::exists(file));
    CHECK(!w.document().session().modified());
    CHECK(!w.window().isWindowModified());

    // What was saved opens again as it was.
    w.run({{"do", "new"}});
    w.window().files().open(file);
    w.settle();
    CHECK(w.now().elements.size() == 1);
    CHECK(w.now().bones.size() == 1);
    CHECK(w.document().session().responseState(w.now().elements.begin()->first) == Session::ResponseState::Fresh);
    w.shoot("opened");
    CHECK(w.window().files().recent().paths().contains(file));
    w.window().files().recent().remove(file);
}

TEST_CASE("studio: a precompute that is cancelled answers at once and changes nothing") {
    Window w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_fine.obj"));
    const auto& element = *w.now().elements.begin()->second;
    w.run({{"do", "add-joint-face"}, {"element", element.name}, {"name", "a"}, {"plane", {{"origin", {0, 0, 2}}, {"normal", {0, 0, 1}}}}});
    w.run({{"do", "add-joint-face"}, {"element", element.name}, {"name", "b"}, {"plane", {{"origin", {0, 0, -2}}, {"normal", {0, 0, -1}}}}});
    // Seconds of work: it cannot be done before it is cancelled.
    w.run({{"do", "set"}, {"target", element.name}, {"property", "solver-mesh"}, {"value", "best"}});
    w.settle();
    w.trigger("precompute");
    PrecomputeJob& job = w.window().precompute().job();
    waitFor([&] { return !job.stage().isEmpty(); });
    REQUIRE(job.running());
    bool ended = false;
    const auto watch = QObject::connect(&job, &BackgroundJob::finished, [&](bool completed) { ended = !completed; });
    job.cancel();
    QObject::disconnect(watch);
    CHECK(ended);
    CHECK(!job.running());
    CHECK(w.document().session().responseState(w.now().elements.begin()->first) == Session::ResponseState::None);
}

TEST_CASE("studio: in the outliner a bone is hung on another and joint faces are joined by dragging, each as one step") {
    Window w;
    for (int i = 0; i < 2; ++i) w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    const std::string a = w.now().elements.begin()->second->name, b = w.now().elements.rbegin()->second->name;
    for (const std::string& name : {a, b}) w.run({{"do", "add-joint-face"}, {"element", name}, {"name", "end"}, {"plane", {{"origin", {0, 0, 2}}, {"normal", {0, 0, 1}}}}});
    w.run({{"do", "add-bone"}, {"name", "spine"}, {"element", ""}, {"from", {0, 0, -2}}, {"to", {0, 0, 2}}});
    w.run({{"do", "add-bone"}, {"name", "tail"}, {"element", ""}, {"from", {0, 1, 2}}, {"to", {0, 1, 4}}});
    w.run({{"do", "add-bone"}, {"name", "fin"}, {"element", ""}, {"from", "spine/end"}, {"to", {0, 3, 2}}});
    w.settle();
    QAbstractItemModel* model = w.window().outliner().tree()->model();
    const auto row = [&](const QString& name, const char* under = "") {
        for (const QModelIndex& found : model->match(model->index(0, 0), Qt::DisplayRole, name, -1, Qt::MatchExactly | Qt::MatchRecursive))
            if (*under == 0 || found.parent().data().toString() == QLatin1String(under)) return found;
        return QModelIndex();
    };
    const auto drag = [&](const QModelIndexList& rows, const QModelIndex& onto) {
        const std::unique_ptr<QMimeData> data(model->mimeData(rows));
        return model->canDropMimeData(data.get(), Qt::LinkAction, -1, -1, onto) && model->dropMimeData(data.get(), Qt::LinkAction, -1, -1, onto);
    };
    const int steps = w.document().session().position();
    // They do not touch: it starts at the other's end then.
    REQUIRE(drag({row("tail")}, row("spine")));
    const auto bone = [&](const char* name) { return w.now().boneNamed(name); };
    CHECK(bone("tail")->parent == bone("spine")->id);
    CHECK(std::get<EndpointRef>(bone("tail")->start) == EndpointRef{bone("spine")->id, true});
    CHECK(row("tail").parent() == row("spine"));
    CHECK(w.document().session().position() == steps + 1);
    // They touch: nothing moves.
    const auto before = bone("fin")->start;
    REQUIRE(drag({row("fin")}, row("tail")));
    CHECK(bone("fin")->parent == bone("tail")->id);
    CHECK(bone("fin")->start == before);
    // All or nothing: the second would close a ring.
    const int now = w.document().session().position();
    CHECK_FALSE(drag({row("spine")}, row("tail")));
    CHECK(w.document().session().position() == now);
    CHECK_FALSE(drag({row("tail")}, row("tail")));
    CHECK_FALSE(drag({row("tail")}, row("spine")));  // it hangs there already
    CHECK_FALSE(drag({row("tail")}, row("end", a.c_str())));
    REQUIRE(drag({row("end", a.c_str())}, row("end", b.c_str())));
    CHECK(w.now().joints.size() == 1);
    w.trigger("undo");
    CHECK(w.now().joints.empty());
    w.shoot("outliner-drag");
}

TEST_CASE("studio: elements that are done when a precompute is cancelled are kept") {
    Window w;
    for (const char* file : {"a_cylinder_coarse", "a_cylinder_fine"}) {
        w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/%1.obj").arg(QLatin1String(file)));
        const std::string name = w.now().elements.rbegin()->second->name;
        for (const double end : {2.0, -2.0})
            w.run({{"do", "add-joint-face"}, {"element", name}, {"name", end > 0.0 ? "a" : "b"}, {"plane", {{"origin", {0, 0, end}}, {"normal", {0, 0, end}}}}});
    }
    const auto [quick, slow] = std::pair(w.now().elements.begin()->first, w.now().elements.rbegin()->first);
    w.run({{"do", "set"}, {"target", w.now().elements.at(quick)->name}, {"property", "solver-mesh"}, {"value", "as-is"}});
    w.run({{"do", "set"}, {"target", w.now().elements.at(slow)->name}, {"property", "solver-mesh"}, {"value", "best"}});
    w.settle();
    const int steps = w.document().session().position();
    w.trigger("precompute");
    PrecomputeJob& job = w.window().precompute().job();
    waitFor([&] { return job.element() == QString::fromStdString(w.now().elements.at(slow)->name); });
    job.cancel();
    CHECK(job.kept() == 1);
    CHECK(w.document().session().responseState(quick) == Session::ResponseState::Fresh);
    CHECK(w.document().session().responseState(slow) == Session::ResponseState::None);
    CHECK(w.document().session().position() == steps);  // results are no steps
    w.settle();
    w.shoot("kept");
}

TEST_CASE("studio: selection in the outliner is the selection of the document, and names are edited there") {
    Window w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    const PartId id = w.now().elements.begin()->first;
    REQUIRE(w.document().selection().size() == 1);
    QTreeView* tree = w.window().outliner().tree();
    CHECK(tree->selectionModel()->selectedRows().size() == 1);
    w.document().select({});
    CHECK(tree->selectionModel()->selectedRows().isEmpty());
    const QModelIndex row = tree->model()->index(0, 0, tree->model()->index(0, 0));
    QTest::mouseClick(tree->viewport(), Qt::LeftButton, {}, tree->visualRect(row).center());
    CHECK(w.document().isSelected({SelectionItem::Kind::Element, id, {}, false}));
    CHECK(tree->model()->setData(row, QStringLiteral("芋虫"), Qt::EditRole));
    CHECK(w.now().elements.at(id)->name == "芋虫");
    // The eye in its column hides the element, in one step that can be undone.
    const QModelIndex eye = row.siblingAtColumn(OutlinerModel::Visible);
    QTest::mouseClick(tree->viewport(), Qt::LeftButton, {}, tree->visualRect(eye).center());
    CHECK(!w.now().elements.at(id)->visible);
    w.trigger("undo");
    CHECK(w.now().elements.at(id)->visible);
}

TEST_CASE("studio: in the outliner eyes and locks of joint faces and bones are clicked, joints select their faces, and an effect is turned off") {
    Window w;
    for (int i = 0; i < 2; ++i) {
        w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
        w.run({{"do", "add-joint-face"}, {"element", w.now().elements.rbegin()->second->name}, {"name", "end"}, {"plane", {{"origin", {0, 0, 2}}, {"normal", {0, 0, 1}}}}});
    }
    const std::string a = w.now().elements.begin()->second->name, b = w.now().elements.rbegin()->second->name;
    const PartId id = w.now().elements.begin()->first;
    w.run({{"do", "join"}, {"a", a + "/end"}, {"b", b + "/end"}});
    w.run({{"do", "add-bone"}, {"name", "spine"}, {"element", ""}, {"from", {0, 0, -2}}, {"to", {0, 0, 2}}});
    w.run({{"do", "enable"}, {"effect", "bend-warp"}});
    w.settle();
    QTreeView* tree = w.window().outliner().tree();
    const auto row = [&](const QString& name) {
        const QModelIndexList found = tree->model()->match(tree->model()->index(0, 0), Qt::DisplayRole, name, 1, Qt::MatchExactly | Qt::MatchRecursive);
        REQUIRE(!found.isEmpty());
        return found.first();
    };
    const auto click = [&](const QModelIndex& name, int column) {
        const QModelIndex cell = name.siblingAtColumn(column);
        tree->scrollTo(cell);
        const QPoint at = tree->visualRect(cell).center();
        CHECK(tree->indexAt(at) == cell);
        QTest::mouseClick(tree->viewport(), Qt::LeftButton, {}, at);
    };
    click(row(QStringLiteral("end")), OutlinerModel::Visible);
    CHECK(!w.now().elements.at(id)->faces.front().visible);
    click(row(QStringLiteral("spine")), OutlinerModel::Locked);
    CHECK(w.now().boneNamed("spine")->locked);
    click(row(QString::fromStdString(a + "/end ↔ " + b + "/end")), OutlinerModel::Name);
    CHECK(w.document().selection().size() == 2);
    click(row(effectTitle(EffectKind::BendWarp)), OutlinerModel::Visible);
    CHECK(!w.now().effects.has(EffectKind::BendWarp));
    CHECK(tree->model()->match(tree->model()->index(0, 0), Qt::DisplayRole, effectTitle(EffectKind::BendWarp), 1, Qt::MatchExactly | Qt::MatchRecursive).isEmpty());
    w.trigger("undo");
    CHECK(w.now().effects.has(EffectKind::BendWarp));
    w.shoot("outliner");
}

TEST_CASE("studio: what is selected is shown alone, locked and let go of again by keys, each as one step; all of a kind are selected") {
    Window w;
    for (int i = 0; i < 3; ++i) w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    w.run({{"do", "add-bone"}, {"name", "spine"}, {"element", ""}, {"from", {0, 0, -2}}, {"to", {0, 0, 2}}});
    w.run({{"do", "add-bone"}, {"name", "tail"}, {"element", ""}, {"from", "spine/end"}, {"to", {0, 0, 4}}});
    const PartId first = w.now().elements.begin()->first;
    w.document().select({{SelectionItem::Kind::Element, first, {}, false}});
    const int steps = w.document().session().position();
    w.trigger("isolate");
    CHECK(w.document().session().position() == steps + 1);
    for (const auto& [id, element] : w.now().elements) CHECK(element->visible == (id == first));
    for (const auto& [id, bone] : w.now().bones) CHECK(!bone->visible);
    w.trigger("show-all");
    for (const auto& [id, element] : w.now().elements) CHECK(element->visible);
    w.document().select({{SelectionItem::Kind::Bone, w.now().boneNamed("tail")->id, {}, false}});
    w.trigger("isolate");
    CHECK(w.now().elements.at(first)->visible);
    CHECK(!w.now().boneNamed("spine")->visible);
    w.trigger("undo");
    w.trigger("lock");
    CHECK(w.now().boneNamed("tail")->locked);
    w.trigger("select-all");  // of bones; what is locked is not taken
    REQUIRE(w.document().selection().size() == 1);
    CHECK(w.document().selection().front().part == w.now().boneNamed("spine")->id);
    w.document().select({{SelectionItem::Kind::Bone, w.now().boneNamed("tail")->id, {}, false}});
    w.trigger("lock");
    CHECK(!w.now().boneNamed("tail")->locked);
}

TEST_CASE("studio: a refused command is told in the window and changes nothing") {
    Window w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    const int before = w.document().session().position();
    CHECK(!w.document().execute({{"do", "rename"}, {"target", w.now().elements.begin()->second->name}, {"name", "a/b"}}));
    w.settle();
    CHECK(w.window().messages().isVisible());
    CHECK(!w.window().messages().text().isEmpty());
    CHECK(w.document().session().position() == before);
    w.shoot("refused");
}
