// SPDX-License-Identifier: GPL-3.0-or-later
#include <QComboBox>
#include <QFile>
#include <QListView>
#include <QTextStream>
#include <QTreeView>

#include "tests/body/messes.h"
#include "tests/studio/window.h"
#include "tests/support/shapes.h"
#include "ui/models/issue_model.h"
#include "ui/models/outliner_model.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/panels/issues_panel.h"
#include "ui/panels/outliner_panel.h"
#include "ui/window/repair_flow.h"
#include "ui/window/studio_docks.h"

using namespace imomushi;
using namespace imomushi::messes;

namespace {

void writeObj(const QString& path, const TriangleMesh& mesh) {
    QFile file(path);
    REQUIRE(file.open(QIODevice::WriteOnly));
    QTextStream out(&file);
    out.setRealNumberPrecision(17);
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) out << "v " << mesh.vertices(v, 0) << ' ' << mesh.vertices(v, 1) << ' ' << mesh.vertices(v, 2) << '\n';
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) out << "f " << mesh.triangles(t, 0) + 1 << ' ' << mesh.triangles(t, 1) + 1 << ' ' << mesh.triangles(t, 2) + 1 << '\n';
}

/// The list of issues, with its buttons.
struct Issues {
    IssuesPanel& panel;
    QListView& list;
    explicit Issues(Window& w) : panel(w.window().issues()), list(*panel.findChild<QListView*>()) { StudioDocks::raise(panel); }
    const IssueModel& model() const { return *qobject_cast<const IssueModel*>(list.model()); }
    QModelIndex row(const QString& beginning) const {
        for (int r = 0; r < model().rowCount(); ++r)
            if (model().index(r).data().toString().startsWith(beginning)) return model().index(r);
        return {};
    }
    QPushButton* button(const QModelIndex& index) const {
        QWidget* place = list.indexWidget(index);
        return place ? place->findChild<QPushButton*>() : nullptr;
    }
    QPushButton* all() const { return panel.findChild<QPushButton*>(QStringLiteral("repairAll")); }
};

void waitForRepair(Window& w) {
    waitFor([&] { return !w.window().repairs().job().running(); });
    w.settle();
}

}  // namespace

TEST_CASE("studio: a mesh comes in unmended, each of its issues shows its place and is mended by a button, and undo brings it back") {
    Window w;
    const TriangleMesh ball = shapes::sphere(0.5, 3).mesh;
    const QString path = w.folder.filePath(QStringLiteral("torn.obj"));
    writeObj(path, broken(without(ball, {0, 1, 2, 3, 7, 100}), 3, 0.0, 0.03, 0.0, 0.0));
    w.window().files().import({path});
    auto* dialog = w.window().findChild<ImportDialog*>();
    REQUIRE(dialog);
    auto* import = dialog->findChild<QPushButton*>(QStringLiteral("importButton"));
    waitFor([&] { return import->isEnabled(); });
    auto* body = dialog->findChild<QComboBox*>(QStringLiteral("body"));
    body->setCurrentIndex(4);
    Q_EMIT body->activated(4);
    waitFor([&] { return import->isEnabled(); });
    CHECK(dialog->command().at("body") == "unmended");
    w.settle();
    CHECK(cutOff(*dialog) == "");
    w.shoot("repair-import");
    QTest::mouseClick(import, Qt::LeftButton);
    w.cameraStands();
    w.activate();
    const auto character = [&]() -> const CharacterSource& { return *w.now().characters.begin()->second; };
    REQUIRE(w.now().characters.size() == 1);
    CHECK(character().body->report.how == BodyKind::Wrapped);

    Issues issues(w);
    w.settle();
    w.shoot("repair-before");
    const QString open = QStringLiteral("The surface has open edges."), turned = QStringLiteral("Neighbouring triangles face different ways.");
    REQUIRE(issues.row(open).isValid());
    REQUIRE(issues.row(turned).isValid());
    const int problems = issues.model().problems();
    CHECK(problems == 2);
    CHECK(issues.all()->isVisible());

    // A click shows the place, wherever on the row.
    QTest::mouseClick(issues.list.viewport(), Qt::LeftButton, {}, issues.list.visualRect(issues.row(open)).center() - QPoint(40, 0));
    w.settle();
    CHECK(w.document().selection() == std::vector{SelectionItem{SelectionItem::Kind::Character, character().id, {}, false}});
    CHECK(!issues.model().triangles(issues.row(open)).empty());
    w.shoot("repair-place");

    // One, and the wrap stays.
    QPushButton* orient = issues.button(issues.row(turned));
    REQUIRE(orient != nullptr);
    CHECK(orient->text() == QStringLiteral("Orient"));
    const int position = w.document().session().position();
    QTest::mouseClick(orient, Qt::LeftButton);
    waitForRepair(w);
    CHECK(w.document().session().position() == position + 1);
    CHECK(issues.model().problems() == 1);
    CHECK(!issues.row(turned).isValid());
    CHECK(issues.button(issues.row(QStringLiteral("Triangles that faced against"))) == nullptr);
    CHECK(character().body->report.how == BodyKind::Wrapped);
    CHECK(w.window().messages().text().contains(QStringLiteral("2 issue")));
    w.shoot("repair-one");

    // The rest.
    QTest::mouseClick(issues.all(), Qt::LeftButton);
    waitForRepair(w);
    CHECK(character().body->report.how == BodyKind::Mended);
    CHECK(issues.model().problems() == 0);
    CHECK(!issues.all()->isVisible());
    CHECK(issues.list.hasFocus());
    CHECK(w.document().session().position() == position + 2);
    const auto labels = w.window().inspector().findChildren<QLabel*>();
    CHECK(std::any_of(labels.begin(), labels.end(), [](const QLabel* label) { return label->isVisible() && label->text() == QStringLiteral("mended"); }));
    w.shoot("repair-after");
    CHECK(w.window().messages().isVisible());
    auto* undo = w.window().messages().findChild<QPushButton*>();
    REQUIRE(undo != nullptr);
    CHECK(undo->text() == QStringLiteral("Undo"));
    QTest::mouseClick(undo, Qt::LeftButton);
    w.settle();
    CHECK(character().body->report.how == BodyKind::Wrapped);
    CHECK(issues.model().problems() == 1);
    w.trigger("undo");
    CHECK(issues.model().problems() == 2);
}

TEST_CASE("studio: parts of an element that overlap are united by the button of that issue") {
    Window w;
    const TriangleMesh ball = shapes::sphere(0.5, 2).mesh;
    const QString path = w.folder.filePath(QStringLiteral("two.obj"));
    writeObj(path, both(ball, moved(ball, 1.0, {0.6, 0.05, 0.02})));
    w.run({{"do", "import-element"}, {"path", path.toStdString()}});
    w.window().showStart(false);
    Issues issues(w);
    w.settle();
    const QModelIndex crossing = issues.row(QStringLiteral("The surface passes through itself."));
    REQUIRE(crossing.isValid());
    REQUIRE(issues.button(crossing) != nullptr);
    QTest::mouseClick(issues.button(crossing), Qt::LeftButton);
    waitForRepair(w);
    REQUIRE(w.now().characters.size() == 1);
    CHECK(w.now().characters.begin()->second->body->report.how == BodyKind::Mended);
    CHECK(!issues.row(QStringLiteral("The surface passes through itself.")).isValid());
    CHECK(w.now().elementNamed("two") != nullptr);
    w.shoot("repair-united");
}

TEST_CASE("studio: a repair that is cancelled leaves everything as it was") {
    Window w;
    const TriangleMesh ball = shapes::sphere(0.5, 3).mesh;
    const QString path = w.folder.filePath(QStringLiteral("ball.obj"));
    writeObj(path, ball);
    w.run({{"do", "import-character"}, {"path", path.toStdString()}});
    w.window().showStart(false);
    const int position = w.document().session().position();
    w.window().repairs().start({{{"do", "repair"}, {"element", "ball"}, {"actions", {"wrap"}}}});
    CHECK(w.window().repairs().job().running());
    w.window().repairs().cancel();
    w.settle();
    CHECK(!w.window().repairs().job().running());
    CHECK(w.document().session().position() == position);
    CHECK(w.window().messages().isVisible());
    // What cannot be mended is said.
    w.window().repairs().start({{{"do", "repair"}, {"element", "ball"}}});
    waitForRepair(w);
    CHECK(w.window().messages().text().contains(QStringLiteral("ball")));
}

TEST_CASE("studio: an element that finite elements cannot solve is among the issues, until they can") {
    Window w;
    const QString path = w.folder.filePath(QStringLiteral("bar.obj"));
    writeObj(path, shapes::bar(2).mesh);
    w.run({{"do", "import-element"}, {"path", QFile::encodeName(path).toStdString()}, {"name", "bar"}});
    w.run({{"do", "add-joint-face"}, {"element", "bar"}, {"name", "in"}, {"plane", {{"origin", {0, 0, 0}}, {"normal", {0, 0, -1}}}}});
    w.run({{"do", "set"}, {"target", "bar"}, {"property", "nu"}, {"value", 0.495}});
    Issues issues(w);
    const auto said = [&] { return issues.row(QStringLiteral("Solved by boundary elements")).isValid(); };
    CHECK_FALSE(said());
    w.run({{"do", "precompute"}});
    CHECK(said());
    // Another effect asks for another response: what is there is out of date, here and in the outliner.
    const auto state = [&] {
        const auto* outliner = w.window().outliner().tree()->model();
        const QModelIndexList bar = outliner->match(outliner->index(0, 0), Qt::DisplayRole, QStringLiteral("bar"), 1, Qt::MatchExactly | Qt::MatchRecursive);
        REQUIRE(!bar.isEmpty());
        return bar.first().siblingAtColumn(OutlinerModel::State).data(OutlinerModel::IconRole).toString();
    };
    CHECK(state() == QString());
    w.run({{"do", "enable"}, {"effect", "touch"}});
    CHECK_FALSE(said());
    CHECK(state() == QStringLiteral("stale"));
    w.run({{"do", "undo"}});
    CHECK(said());
    w.run({{"do", "set"}, {"target", "bar"}, {"property", "nu"}, {"value", 0.49}});
    CHECK_FALSE(said());
    w.run({{"do", "precompute"}});
    CHECK_FALSE(said());
}
