// SPDX-License-Identifier: GPL-3.0-or-later
#include <QAbstractButton>
#include <QCheckBox>
#include <QComboBox>
#include <QElapsedTimer>
#include <QFile>
#include <QSettings>
#include <QTextStream>

#include "tests/studio/window.h"
#include "core/proposal/proposal.h"
#include "tests/support/capsules.h"
#include "tests/support/shapes.h"
#include "ui/jobs/precompute_job.h"
#include "ui/models/issue_model.h"
#include "ui/models/paths.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/panels/outliner_panel.h"
#include "ui/models/texts.h"
#include "ui/scene/cut_frame.h"
#include "ui/window/next_steps.h"
#include "ui/window/status_strip.h"

using namespace imomushi;

namespace {

/// A tube of 6 m along x, of radius 0.5, open at both ends: no element can be made of it.
QString writeTube(const QString& path) {
    const TriangleMesh mesh = shapes::cylinder(0.5, 6.0, 24, 30).mesh;
    const double low = mesh.vertices.col(2).minCoeff(), high = mesh.vertices.col(2).maxCoeff();
    QFile file(path);
    REQUIRE(file.open(QIODevice::WriteOnly));
    QTextStream out(&file);
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) out << "v " << mesh.vertices(v, 2) - 3.0 << ' ' << mesh.vertices(v, 1) << ' ' << -mesh.vertices(v, 0) << '\n';
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        const auto all = [&](double z) {
            for (int k = 0; k < 3; ++k)
                if (mesh.vertices(mesh.triangles(t, k), 2) != z) return false;
            return true;
        };
        if (!all(low) && !all(high)) out << "f " << mesh.triangles(t, 0) + 1 << ' ' << mesh.triangles(t, 1) + 1 << ' ' << mesh.triangles(t, 2) + 1 << '\n';
    }
    return path;
}

}  // namespace

TEST_CASE("studio: an open mesh comes in as a whole character, is cut by a click, and bends when it is dragged") {
    Window w;
    w.import(writeTube(w.folder.filePath(QStringLiteral("tube.obj"))));
    REQUIRE(w.now().characters.size() == 1);
    REQUIRE(w.now().elements.size() == 1);
    const auto character = [&]() -> const CharacterSource& { return *w.now().characters.begin()->second; };
    CHECK(character().body->report.how == BodyKind::Mended);
    CHECK(w.document().selection() == std::vector{SelectionItem{SelectionItem::Kind::Character, character().id, {}, false}});
    w.shoot("character-imported");

    // A click of the face tool cuts the tube across; both pieces are joined.
    w.trigger("tool-face");
    w.look(Vec3(0.3, 0.4, 1.0));
    const int before = w.document().session().position();
    w.click(w.onScreen(Vec3(0.8, 0.2, 0.458)));
    REQUIRE(character().cuts.size() == 1);
    CHECK(w.document().session().position() == before + 1);
    CHECK(w.now().elements.size() == 2);
    CHECK(w.now().joints.size() == 1);
    CHECK(w.window().messages().isVisible());
    w.shoot("character-cut");
    w.trigger("undo");
    CHECK(character().cuts.empty());
    w.trigger("redo");
    REQUIRE(character().cuts.size() == 1);
    const SelectionItem cut{SelectionItem::Kind::Cut, character().cuts[0].id, {}, false};
    w.document().select({cut});
    w.settle();
    w.shoot("character-cut-selected");

    // Its plane is dragged with the mouse.
    const auto frame = cutFrame(w.document().session(), cut.part);
    REQUIRE(frame.has_value());
    const double was = character().cuts[0].plane.origin.x();
    const Vec3 grip = frame->centre + 0.6 * frame->reach * Vec3::UnitY();
    const QPoint from = w.onScreen(grip), to = w.onScreen(grip + 0.5 * Vec3::UnitX());
    QTest::mouseMove(&w.view(), from);
    w.settle();
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
    for (int i = 1; i <= 5; ++i) {
        QTest::mouseMove(&w.view(), from + (to - from) * i / 5);
        w.settle();
    }
    w.shoot("character-cut-dragging");
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, to);
    w.settle();
    CHECK(w.document().session().position() == before + 2);
    CHECK(std::abs(character().cuts[0].plane.origin.x() - was - 0.5) < 0.1);

    // Bones from end to end through the cut, precompute, drag.
    std::array<std::string, 2> names;
    for (const auto& [id, element] : w.now().elements) names[element->piece->sides[0].front ? 1 : 0] = element->name;
    const std::string face = names[0] + "/" + w.now().elementNamed(names[0])->faces[0].name;
    w.run({{"do", "add-bone"}, {"name", "trunk"}, {"element", names[0]}, {"from", {-2.9, 0, 0}}, {"to", face}});
    w.run({{"do", "add-bone"}, {"name", "tip"}, {"element", names[1]}, {"from", "trunk/end"}, {"to", {2.9, 0, 0}}});
    w.run({{"do", "pin"}, {"endpoint", "trunk/start"}});
    w.window().actions()["precompute"]->trigger();
    waitFor([&] { return !w.window().precompute().job().running(); });
    for (const auto& [id, element] : w.now().elements) CHECK(w.document().session().responseState(id) == Session::ResponseState::Fresh);
    w.trigger("tool-pose");
    w.look(Vec3(0.3, 0.4, 1.0));
    const EndpointRef tip{w.now().boneNamed("tip")->id, true};
    const QPoint start = w.view().onScreen(tip)->toPoint();
    QTest::mouseMove(&w.view(), start);
    w.settle();
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, start);
    for (int i = 1; i <= 10; ++i) {
        QTest::mouseMove(&w.view(), start + QPoint(-8 * i, -16 * i));
        w.settle();
    }
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, start + QPoint(-80, -160));
    w.settle();
    w.shoot("character-dragged");
    const Points now = w.document().session().renderPositionsOf(character().id);
    const Points& rest = character().model->mesh.body.vertices;
    CHECK(now.allFinite());
    CHECK((now - rest).rowwise().norm().maxCoeff() > 0.5);
    CHECK(now.rows() == rest.rows());

    // The outliner has the cut under its character; Delete takes it out, and what hung on it.
    w.document().select({cut});
    w.settle();
    w.trigger("delete");
    CHECK(character().cuts.empty());
    CHECK(w.now().elements.size() == 1);
}

TEST_CASE("studio: what is proposed for a character is seen in the view, changed with the mouse, and accepted with one key") {
    Window w;
    w.import(writeTube(w.folder.filePath(QStringLiteral("tube.obj"))));
    REQUIRE(w.now().characters.size() == 1);
    const auto character = [&]() -> const CharacterSource& { return *w.now().characters.begin()->second; };
    const int before = w.document().session().position();
    w.trigger("propose");
    waitFor([&] { return w.view().tools().kind() == ToolKind::Proposal; });
    w.look(Vec3(0.3, 0.4, 1.0));
    const auto* tool = w.view().tools().proposal();
    REQUIRE(tool != nullptr);
    REQUIRE(!tool->cuts.empty());
    const std::size_t cuts = tool->cuts.size();
    CHECK(!w.window().findChild<NextSteps*>()->isVisible());  // the banner is there
    w.shoot("proposal");
    // A plane is taken by its rim and dragged.
    const ProposedCut cut = tool->cuts.front();
    const double side = cut.plane.normal.x() > 0.0 ? 1.0 : -1.0;
    const Vec3 rim(cut.plane.origin.x(), 0.3, 0.4);
    const QPoint from = w.onScreen(rim), to = w.onScreen(rim + 0.25 * side * Vec3::UnitX());
    const auto drag = [&] {
        QTest::mouseMove(&w.view(), from);
        w.settle();
        QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
        for (int i = 1; i <= 4; ++i) {
            QTest::mouseMove(&w.view(), from + (to - from) * i / 4);
            w.settle();
        }
        QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, to);
        w.settle();
    };
    drag();
    const auto moved = [&] { return side * (w.view().tools().proposal()->cuts.front().plane.origin.x() - cut.plane.origin.x()); };
    CHECK(std::abs(moved() - 0.25) < 0.05);
    QTest::keyClick(&w.view(), Qt::Key_Z, Qt::ControlModifier);
    CHECK(moved() == 0.0);
    QTest::keyClick(&w.view(), Qt::Key_Y, Qt::ControlModifier);
    CHECK(std::abs(moved() - 0.25) < 0.05);
    CHECK(w.document().session().position() == before);
    w.shoot("proposal-moved");
    // Esc leaves all as it was; asked again, Enter does it.
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    waitFor([&] { return w.view().tools().kind() == ToolKind::Select; });
    CHECK(w.document().session().position() == before);
    w.trigger("propose");
    waitFor([&] { return w.view().tools().kind() == ToolKind::Proposal; });
    CHECK(w.view().tools().proposal()->cuts.front().plane.origin == cut.plane.origin);
    // Another tool leaves it as it is.
    w.look(Vec3(0.3, 0.4, 1.0));
    drag();
    CHECK(std::abs(moved() - 0.25) < 0.05);
    w.trigger("tool-select");
    CHECK(w.window().messages().isVisible());
    CHECK(!w.view().tools().proposal());
    w.trigger("propose");
    REQUIRE(w.view().tools().proposal());
    CHECK(std::abs(moved() - 0.25) < 0.05);
    QTest::keyClick(&w.view(), Qt::Key_Z, Qt::ControlModifier);
    CHECK(moved() == 0.0);
    // It is done beside the window, which hears of it later; cancelled, the artist goes on where it was.
    QTest::keyClick(&w.view(), Qt::Key_Return);
    CHECK(w.window().steps().running());
    CHECK(w.document().session().position() == before);
    w.window().steps().cancel();
    CHECK(w.view().tools().kind() == ToolKind::Proposal);
    int turns = 0;  // of the window's events
    QTimer heart;
    QObject::connect(&heart, &QTimer::timeout, [&] { turns += w.window().steps().running(); });
    heart.start(1);
    QTest::keyClick(&w.view(), Qt::Key_Return);
    CHECK(turns == 0);
    CHECK(w.document().session().position() == before);
    waitFor([&] { return w.view().tools().kind() == ToolKind::Pose; });
    heart.stop();
    CHECK(turns > 0);
    CHECK(w.document().session().position() == before + 1);
    CHECK(character().cuts.size() == cuts);
    CHECK(!w.window().actions()["propose"]->isEnabled());
    w.shoot("proposal-accepted");
    // Taken back, it can be changed again.
    w.trigger("undo");
    w.trigger("propose");
    REQUIRE(w.view().tools().proposal());
    CHECK(moved() == 0.0);
}

TEST_CASE("studio: the import dialog offers what fits the file first, and the artist may choose otherwise") {
    Window w;
    const QString clean = QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj");
    const QString open = writeTube(w.folder.filePath(QStringLiteral("tube.obj")));
    for (const auto& [path, whole] : {std::pair{clean, false}, std::pair{open, true}}) {
        ImportDialog dialog(path, &w.window());
        dialog.open();
        auto* button = dialog.findChild<QPushButton*>(QStringLiteral("importButton"));
        waitFor([&] { return button->isEnabled(); });
        auto* card = dialog.findChild<QAbstractButton*>(QStringLiteral("wholeCharacter"));
        CHECK(card->isChecked() == whole);
        CHECK(dialog.command().at("do") == (whole ? "import-character" : "import-element"));
        w.settle();
        CHECK(cutOff(dialog) == "");
        if (whole) continue;
        // A clean mesh as a whole character, with a body that is wrapped on purpose.
        card->click();
        waitFor([&] { return button->isEnabled(); });
        auto* body = dialog.findChild<QComboBox*>(QStringLiteral("body"));
        body->setCurrentIndex(3);
        Q_EMIT body->activated(3);
        CHECK(!button->isEnabled());
        waitFor([&] { return button->isEnabled(); });
        CHECK(dialog.command().at("do") == "import-character");
        CHECK(dialog.command().at("body") == "wrapped");
        w.settle();
        CHECK(cutOff(dialog) == "");
        dialog.reject();
    }
}

TEST_CASE("studio: the outliner lists cuts under their character, the inspector has forms of both, and a gap that is closed can be looked at") {
    Window w;
    w.import(writeTube(w.folder.filePath(QStringLiteral("tube.obj"))));
    const PartId id = w.now().characters.begin()->first;
    w.run({{"do", "cut"}, {"element", w.now().characters.begin()->second->name}, {"plane", {{"origin", {0.8, 0, 0}}, {"normal", {1, 0, 0}}}}, {"name", "waist"}});
    const SelectionItem whole{SelectionItem::Kind::Character, id, {}, false}, cut{SelectionItem::Kind::Cut, w.now().characters.begin()->second->cuts[0].id, {}, false};
    const auto shows = [&](const char* text) {
        for (const QLabel* label : w.window().inspector().findChildren<QLabel*>())
            if (label->isVisible() && label->text() == QLatin1String(text)) return true;
        return false;
    };
    w.document().select({cut});
    w.settle();
    CHECK(shows("waist"));
    CHECK(shows("Origin at rest"));
    CHECK(cutOff(w.window().inspector()) == "");
    w.shoot("cut-inspector");
    w.document().select({whole});
    w.settle();
    CHECK(shows("mended"));
    CHECK(cutOff(w.window().inspector()) == "");
    w.shoot("character-inspector");

    OutlinerModel model(w.document());
    const QModelIndex at = model.indexOf(cut);
    REQUIRE(at.isValid());
    CHECK(model.item(at.parent()) == whole);
    CHECK(at.data().toString() == QStringLiteral("waist"));
    CHECK(model.setData(at, QStringLiteral("belt"), Qt::EditRole));
    CHECK(w.now().characters.begin()->second->cuts[0].name == "belt");

    w.view().setMarked(MarkedPlace{id, {0}, Vec3(0, 0.5, 0)});
    w.view().frameMarked();
    w.cameraStands();
    CHECK(w.view().onScreen(Vec3(0, 0.5, 0)).has_value());
    w.trigger("bodies");
    CHECK(w.view().bodiesVisible());
    w.shoot("bodies");
}

TEST_CASE("studio: the view says what comes next, a mesh that is there is made soft in the background as one step, and cancelling changes nothing") {
    Window w;
    auto* next = w.window().findChild<NextSteps*>();
    REQUIRE(next);
    const auto offered = [&](const char* name) {
        for (auto* button : next->findChildren<QPushButton*>(QLatin1String(name)))
            if (button->isVisible()) return button;
        return static_cast<QPushButton*>(nullptr);
    };
    CHECK(!offered("nextImport"));  // the start page says it
    w.window().showStart(false);
    w.settle();
    REQUIRE(offered("nextImport"));
    CHECK(offered("nextSample"));
    CHECK(cutOff(*next) == "");
    w.shoot("next-empty");
    const QString path = writeMesh(w.folder.filePath(QStringLiteral("star.obj")), capsules::starfish());
    w.run({{"do", "import-character"}, {"path", path.toStdString()}, {"name", "star"}});
    w.view().frameAll(false);
    w.settle();
    REQUIRE(offered("nextSoft"));
    CHECK(offered("nextHandle"));
    CHECK(!offered("nextImport"));
    CHECK(cutOff(*next) == "");
    w.shoot("next-soften");
    Appearance::instance().setLanguage(QStringLiteral("ja"));
    w.settle();
    CHECK(offered("nextSoft")->text().startsWith(QStringLiteral("柔らかくする")));
    w.shoot("next-soften-japanese");
    Appearance::instance().setLanguage(QStringLiteral("en"));
    w.settle();
    CHECK(!w.shared->actions()["make-soft-bones"]->isEnabled());  // it has no skeleton

    const int before = w.document().session().position();
    QTest::mouseClick(offered("nextSoft"), Qt::LeftButton);
    REQUIRE(w.window().steps().running());
    CHECK(w.now().bones.empty());
    w.window().steps().cancel();
    CHECK(!w.window().steps().running());
    w.settle();
    CHECK(w.document().session().position() == before);
    CHECK(w.now().elements.size() == 1);

    // From the menu; the document changes meanwhile, so that it is done anew, on what is there now. The window goes on all the time.
    REQUIRE(w.shared->actions()["make-soft"]->isEnabled());
    double longest = 0.0;
    QElapsedTimer beat;
    QTimer heart;
    heart.setInterval(1);
    QObject::connect(&heart, &QTimer::timeout, [&] { longest = std::max(longest, 1e-3 * double(beat.restart())); });
    w.window().actions()["make-soft"]->trigger();
    REQUIRE(w.window().steps().running());
    w.run({{"do", "set"}, {"target", w.now().elements.begin()->second->name}, {"property", "nu"}, {"value", 0.4}});
    beat.start();
    heart.start();
    waitFor([&] { return !w.window().steps().running(); });
    heart.stop();
    MESSAGE("made soft; the window answered after ", longest, " s at most");
    const auto& steps = w.document().session().steps();
    REQUIRE(w.document().session().position() == before + 2);
    CHECK(stepText(steps.back().name, steps.back().subject) == QStringLiteral("Make soft: star"));
    CHECK(w.now().elements.size() >= 6);
    CHECK(w.now().bones.size() >= 5);
    for (const auto& [id, element] : w.now().elements) CHECK(element->nu == 0.4);
    CHECK(w.view().tools().kind() == ToolKind::Pose);
    w.settle();
    CHECK(!offered("nextSoft"));
    CHECK(!w.shared->actions()["make-soft"]->isEnabled());
    w.shoot("next-softened");
    w.trigger("undo");
    CHECK(w.now().bones.empty());
    CHECK(offered("nextSoft"));
    // Closed, it stays away.
    for (auto* button : next->findChildren<QToolButton*>())
        if (button->isVisible()) button->click();
    w.settle();
    CHECK(!next->isVisible());
}

TEST_CASE("studio: an element that came in by itself is made soft later, as one step; what is moved by something already says why not") {
    Window w;
    const QString path = writeMesh(w.folder.filePath(QStringLiteral("star.obj")), capsules::starfish());
    w.run({{"do", "import-element"}, {"path", path.toStdString()}, {"name", "star"}});
    w.window().showStart(false);
    w.view().frameAll(false);
    w.document().select({});
    w.settle();
    const int before = w.document().session().position();
    QAction* soft = w.window().actions()["make-soft"];
    CHECK(commandName(*soft) == QStringLiteral("Make it soft"));  // by this name it is found
    REQUIRE(soft->isEnabled());                                  // the only one there is
    auto* next = w.window().findChild<NextSteps*>();
    QPushButton* offered = nullptr;
    for (auto* button : next->findChildren<QPushButton*>(QStringLiteral("nextSoft")))
        if (button->isVisible()) offered = button;
    REQUIRE(offered);
    CHECK(cutOff(*next) == "");
    w.shoot("element-soften");
    QTest::mouseClick(offered, Qt::LeftButton);
    REQUIRE(w.window().steps().running());
    waitFor([&] { return !w.window().steps().running(); });
    REQUIRE(w.document().session().position() == before + 1);
    CHECK(stepText(w.document().session().steps().back().name, w.document().session().steps().back().subject) == QStringLiteral("Make soft: star"));
    REQUIRE(w.now().characters.size() == 1);
    CHECK(w.now().bones.size() >= 5);
    w.settle();
    w.shoot("element-softened");
    CHECK(!soft->isEnabled());
    w.trigger("undo");
    CHECK(w.now().characters.empty());
    CHECK(w.now().elements.begin()->second->name == "star");
    CHECK(soft->isEnabled());

    // A proposal is looked at first: that takes a character, too.
    w.document().select({{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    w.settle();
    w.trigger("propose");
    waitFor([&] { return w.view().tools().proposal(); });
    CHECK(w.now().characters.size() == 1);
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    w.settle();
    w.trigger("undo");
    CHECK(w.now().characters.empty());

    const Points& v = w.now().elements.begin()->second->mesh->body.vertices;
    w.run({{"do", "handle"}, {"element", "star"}, {"name", "tip"}, {"point", {v(0, 0), v(0, 1), v(0, 2)}}, {"radius", 0.1}});
    w.settle();
    CHECK(!soft->isEnabled());
    CHECK(whyDisabled(*soft) == QStringLiteral("It has joint faces, bones or handles: precompute makes it soft."));
}

TEST_CASE("studio: undo of a character that was made soft, in the middle of its precompute, leaves nothing of it behind") {
    Window w;
    const QString path = writeMesh(w.folder.filePath(QStringLiteral("star.obj")), capsules::starfish());
    w.run({{"do", "import-character"}, {"path", path.toStdString()}, {"name", "star"}});
    w.window().showStart(false);
    w.view().frameAll(false);
    const auto said = [&](const QString& text) {
        for (const auto* label : w.window().status().findChildren<QLabel*>())
            if (label->text() == text) return true;
        return false;
    };
    const QString vertices = QLocale().toString(qlonglong(w.now().characters.begin()->second->model->mesh.body.vertices.rows())) + QStringLiteral(" vertices");
    w.settle();
    CHECK(said(vertices));
    w.trigger("make-soft");
    waitFor([&] { return !w.window().steps().running(); });
    w.settle();
    w.trigger("precompute");
    REQUIRE(w.window().precompute().job().running());
    CHECK(said(vertices));
    w.trigger("undo");
    CHECK(w.now().elements.size() == 1);
    waitFor([&] { return !w.window().precompute().job().running(); });
    w.settle();
    CHECK(said(vertices));
    CHECK(!w.window().actions()["precompute"]->isEnabled());
    CHECK(w.window().actions()["make-soft"]->isEnabled());
    for (const SelectionItem& item : w.document().selection()) CHECK(!pathOf(w.now(), item).empty());
    w.shoot("undone-in-mid-precompute");
}

TEST_CASE("studio: a size that cannot be meant is asked about once for each file") {
    Window w;
    TriangleMesh large = capsules::starfish();
    large.vertices *= 100.0;
    const QString first = writeMesh(w.folder.filePath(QStringLiteral("first.obj")), large), second = writeMesh(w.folder.filePath(QStringLiteral("second.obj")), large);
    const auto ask = [&](const QString& path, const char* answer, const char* picture) {
        ImportDialog dialog(path, &w.window());
        dialog.leadToSoft(false);
        dialog.open();
        auto* import = dialog.findChild<QPushButton*>(QStringLiteral("importButton"));
        waitFor([&] { return import->isEnabled(); });
        w.settle();
        auto* button = dialog.findChild<QPushButton*>(QLatin1String(*answer ? answer : "takeUnit"));
        CHECK(button->isVisible() == (*answer != 0));
        CHECK(cutOff(dialog) == "");
        if (picture) w.shoot(picture);
        if (*answer) {
            QTest::mouseClick(button, Qt::LeftButton);
            waitFor([&] { return import->isEnabled(); });
            CHECK(!button->isVisible());
        }
        const Json command = dialog.command();
        CHECK(command.at("do") == "make-soft");
        dialog.reject();
        return command.value("unit", std::string());
    };
    CHECK(ask(first, "takeUnit", "size-question") == "cm");
    CHECK(ask(first, "", nullptr) == "cm");
    CHECK(ask(second, "keepSize", nullptr) == "");
    CHECK(ask(second, "", nullptr) == "");
    CHECK(QSettings().value(QStringLiteral("import/obj/unit"), 0).toInt() == 0);  // other files of this type are what they are
    QSettings().remove(QStringLiteral("import/sizes"));
}

TEST_CASE("import dialog: to make it soft is offered for whatever is read, and asked again for the next file") {
    Window w;
    QSettings().setValue(QStringLiteral("import/soft-at-first"), true);
    const QString element = QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj");
    {
        ImportDialog dialog(element, &w.window());
        dialog.show();
        auto* soft = dialog.findChild<QCheckBox*>(QStringLiteral("makeSoft"));
        auto* import = dialog.findChild<QPushButton*>(QStringLiteral("importButton"));
        waitFor([&] { return import->isEnabled(); });
        // A clean closed surface with flat ends: an element, unless somebody wants it soft at once.
        REQUIRE(dialog.findChild<QAbstractButton*>(QStringLiteral("elements"))->isChecked());
        CHECK(soft->isVisible());
        CHECK(!soft->isChecked());
        soft->click();
        CHECK(dialog.findChild<QAbstractButton*>(QStringLiteral("wholeCharacter"))->isChecked());
        CHECK(soft->isChecked());
        soft->click();
        CHECK(!soft->isChecked());
        waitFor([&] { return import->isEnabled(); });
        dialog.accept();
    }
    ImportDialog next(writeTube(w.folder.filePath(QStringLiteral("tube.obj"))), &w.window());
    next.show();
    waitFor([&] { return next.findChild<QPushButton*>(QStringLiteral("importButton"))->isEnabled(); });
    CHECK(next.findChild<QCheckBox*>(QStringLiteral("makeSoft"))->isChecked());
    QSettings().setValue(QStringLiteral("import/soft-at-first"), false);
}
