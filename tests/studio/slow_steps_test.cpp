// SPDX-License-Identifier: GPL-3.0-or-later
#include <QFile>
#include <QTextStream>

#include "tests/studio/window.h"
#include "tests/support/shapes.h"
#include "ui/models/history_model.h"
#include "ui/models/paths.h"
#include "ui/models/recent_files.h"
#include "ui/models/selection_commands.h"
#include "ui/scene/cut_frame.h"
#include "ui/widgets/number_field.h"
#include "ui/widgets/switch.h"
#include "ui/window/file_flow.h"

using namespace imomushi;

namespace {

/// A worm of 6 m along x with 12,000 vertices: more than the studio handles while the window waits.
QString writeWorm(const QString& path) {
    const TriangleMesh mesh = shapes::cylinder(0.5, 6.0, 60, 200).mesh;
    QFile file(path);
    REQUIRE(file.open(QIODevice::WriteOnly));
    QTextStream out(&file);
    out.setRealNumberPrecision(17);
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) out << "v " << mesh.vertices(v, 2) - 3.0 << ' ' << mesh.vertices(v, 1) << ' ' << -mesh.vertices(v, 0) << '\n';
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) out << "f " << mesh.triangles(t, 0) + 1 << ' ' << mesh.triangles(t, 1) + 1 << ' ' << mesh.triangles(t, 2) + 1 << '\n';
    return path;
}

struct Worm : Window {
    Worm() : Window({1560, 960}, __FILE__) {
        run({{"do", "import-character"}, {"path", writeWorm(folder.filePath(QStringLiteral("worm.obj"))).toStdString()}, {"name", "worm"}});
        window().showStart(false);
        cameraStands();
        look(Vec3(0.3, 0.4, 1.0));
    }
    const CharacterSource& character() { return *now().characters.begin()->second; }
    int position() { return document().session().position(); }
    void wait() {
        REQUIRE(window().steps().running());
        waitOn();
    }
    /// The same where events have passed, in which it may have ended.
    void waitOn() {
        waitFor([&] { return !window().steps().running(); });
        settle();
    }
    static Json cutAt(double x, const char* element = "worm body") { return {{"do", "cut"}, {"element", element}, {"plane", {{"origin", {x, 0, 0}}, {"normal", {1, 0, 0}}}}}; }
};

}  // namespace

TEST_CASE("slow steps: a large character is cut beside the window, once however often Enter is pressed, and undo gives a cut up that is not made yet") {
    Worm w;
    w.trigger("tool-face");
    const QPoint at = w.onScreen(Vec3(0.8, 0.2, 0.458));
    QTest::mouseMove(&w.view(), at);
    w.settle();
    const int before = w.position();
    QTest::keyClick(&w.view(), Qt::Key_Return);
    QTest::keyClick(&w.view(), Qt::Key_Return);
    CHECK(w.position() == before);  // the window did not wait for it
    w.wait();
    REQUIRE(w.character().cuts.size() == 1);
    CHECK(w.position() == before + 1);
    CHECK(w.document().selection() == std::vector{SelectionItem{SelectionItem::Kind::Cut, w.character().cuts[0].id, {}, false}});
    CHECK(w.window().messages().isVisible());

    const Json second = Worm::cutAt(-1.5);
    w.document().executeSlow({second});
    REQUIRE(w.window().steps().running());
    w.trigger("undo");
    CHECK(!w.window().steps().running());
    CHECK(w.character().cuts.size() == 1);  // the one before stays
    w.trigger("undo");
    CHECK(w.character().cuts.empty());
}

TEST_CASE("slow steps: a plane that cuts nothing is refused beside the window, which offers the nearest place") {
    Worm w;
    w.run(Worm::cutAt(0.0));
    w.document().select({{SelectionItem::Kind::Cut, w.character().cuts[0].id, {}, false}});
    w.settle();
    const auto frame = cutFrame(w.document().session(), w.character().cuts[0].id);
    REQUIRE(frame);
    const int before = w.position();
    // Far beyond the end of the worm.
    const Vec3 grip = frame->centre + 0.6 * frame->reach * Vec3::UnitY();
    QTest::mouseMove(&w.view(), w.onScreen(grip));
    w.settle();
    QTest::keyClick(&w.view(), Qt::Key_G);
    QTest::keyClicks(&w.view(), QStringLiteral("5"));
    QTest::keyClick(&w.view(), Qt::Key_Return);
    CHECK(!w.view().tools().busy());
    w.wait();
    CHECK(w.position() == before);
    CHECK(w.window().messages().isVisible());
    auto* offer = w.window().messages().findChild<QAbstractButton*>(QStringLiteral("offer"));
    REQUIRE(offer);
    REQUIRE(offer->isVisible());
    offer->click();
    w.wait();
    CHECK(w.position() == before + 1);
    CHECK(w.character().cuts[0].plane.origin.x() > 1.0);
}

TEST_CASE("slow steps: a large character that is moved stays where the hand put it until the document has it there") {
    Worm w;
    w.trigger("tool-select");
    w.document().select({{SelectionItem::Kind::Character, w.character().id, {}, false}});
    w.settle();
    const auto picture = [&] { return w.view().grabFramebuffer(); };
    const QImage still = picture();
    QTest::mouseMove(&w.view(), w.onScreen(Vec3(0, 0, 0.5)));
    w.settle();
    QTest::keyClick(&w.view(), Qt::Key_G);
    QTest::keyClick(&w.view(), Qt::Key_Y);
    QTest::keyClicks(&w.view(), QStringLiteral("1"));
    w.settle();
    const int before = w.position();
    QTest::keyClick(&w.view(), Qt::Key_Return);
    REQUIRE(w.window().steps().running());
    CHECK(w.position() == before);
    CHECK(!w.view().tools().busy());
    w.view().redraw();
    const QImage waiting = picture();
    // It cannot be taken again before it is there.
    QTest::keyClick(&w.view(), Qt::Key_G);
    CHECK(!w.view().tools().busy());
    w.wait();
    CHECK(w.position() == before + 1);
    CHECK(w.now().elements.begin()->second->mesh->body.vertices.col(1).minCoeff() > 0.4);
    w.document().select({});
    w.settle();
    // A point of the worm that is above where all of it was before.
    const QPoint above = w.onScreen(Vec3(0.0, 1.3, 0.3));
    const double ratio = waiting.devicePixelRatio();
    const auto apart = [&](const QImage& a, const QImage& b) {
        const QColor one = a.pixelColor((QPointF(above) * ratio).toPoint()), other = b.pixelColor((QPointF(above) * ratio).toPoint());
        return std::abs(one.red() - other.red()) + std::abs(one.green() - other.green()) + std::abs(one.blue() - other.blue());
    };
    // The same flesh, but for how a selection is tinted; before it was moved, the background.
    CHECK(apart(waiting, picture()) < 60);
    CHECK(apart(waiting, still) > 120);
}

TEST_CASE("slow steps: copies, mirror images and what is removed of a large character come beside the window, as one step each") {
    Worm w;
    w.document().select({{SelectionItem::Kind::Character, w.character().id, {}, false}});
    const int before = w.position();
    duplicateSelected(w.document());
    CHECK(w.now().characters.size() == 1);
    w.wait();
    CHECK(w.now().characters.size() == 2);
    CHECK(w.position() == before + 1);
    REQUIRE(w.document().selection().size() == 1);  // the copy
    CHECK(w.document().selection()[0].part != w.now().characters.begin()->first);
    w.window().actions()["delete"]->trigger();
    CHECK(w.now().characters.size() == 2);
    w.wait();
    CHECK(w.now().characters.size() == 1);
    CHECK(w.position() == before + 2);
}

TEST_CASE("slow steps: the switch of an effect shows at once what was asked for, and who goes back in the history gives up what is not made yet") {
    Worm w;
    auto* button = w.window().findChild<Switch*>(QStringLiteral("smooth-joints"));
    REQUIRE(button);
    const auto on = [&] { return w.now().effects.has(EffectKind::SmoothJoints); };
    const int before = w.position();
    button->click();
    CHECK(!on());
    CHECK(button->isChecked());
    QCoreApplication::processEvents();  // what the document says changes nothing of that
    CHECK(button->isChecked());
    w.waitOn();
    CHECK(on());
    CHECK(button->isChecked());
    CHECK(w.position() == before + 1);
    // Twice: as before.
    button->click();
    button->click();
    CHECK(button->isChecked());
    w.wait();
    CHECK(on());
    CHECK(button->isChecked());
    CHECK(w.position() == before + 3);
    button->click();
    CHECK(!button->isChecked());
    HistoryModel(w.document()).goTo(before);
    waitFor([&] { return !w.window().steps().running() && w.position() == before; });
    w.settle();
    CHECK(!on());
    CHECK(!button->isChecked());
    CHECK(w.position() == before);
}

TEST_CASE("slow steps: a copy is not selected where something else was selected meanwhile") {
    Worm w;
    w.document().select({{SelectionItem::Kind::Character, w.character().id, {}, false}});
    duplicateSelected(w.document());
    const SelectionItem body{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false};
    w.document().select({body});
    w.wait();
    CHECK(w.now().characters.size() == 2);
    CHECK(w.document().selection() == std::vector{body});
}

TEST_CASE("slow steps: several parts of a large character are removed beside the window, as one step") {
    Worm w;
    w.run(Worm::cutAt(-1.0));
    w.run(Worm::cutAt(1.0, "worm body 2"));
    const auto& cuts = w.character().cuts;
    REQUIRE(cuts.size() == 2);
    w.document().select({{SelectionItem::Kind::Cut, cuts[0].id, {}, false}, {SelectionItem::Kind::Cut, cuts[1].id, {}, false}});
    w.settle();
    const int before = w.position();
    w.window().actions()["delete"]->trigger();
    CHECK(w.position() == before);
    w.wait();
    CHECK(w.character().cuts.empty());
    CHECK(w.now().elements.size() == 1);
    CHECK(w.position() == before + 1);
    w.trigger("undo");
    CHECK(w.character().cuts.size() == 2);
    // What goes with a cut is known only when that is removed.
    const PartId piece = w.now().elements.begin()->first;
    w.document().select({{SelectionItem::Kind::Cut, w.character().cuts[0].id, {}, false}, {SelectionItem::Kind::Cut, w.character().cuts[1].id, {}, false}, {SelectionItem::Kind::Element, piece, {}, false}});
    w.settle();
    w.trigger("delete");
    waitFor([&] { return !w.window().steps().running(); });
    CHECK(w.now().characters.empty());
    CHECK(w.position() == before + 1);
}

TEST_CASE("slow steps: a number typed for a cut of a large character shows at once, and the cut follows beside the window; a place that cuts nothing shows where the cut is") {
    Worm w;
    w.run(Worm::cutAt(0.0));
    w.document().select({{SelectionItem::Kind::Cut, w.character().cuts[0].id, {}, false}});
    w.settle();
    auto* x = w.window().inspector().findChild<NumberField*>();  // of its origin
    REQUIRE(x);
    REQUIRE(x->value() == 0.0);
    const int before = w.position();
    x->setProperty("value", 0.75);
    CHECK(w.position() == before);
    REQUIRE(w.window().steps().running());
    QCoreApplication::processEvents();
    CHECK(x->value() == 0.75);
    w.waitOn();
    CHECK(w.position() == before + 1);
    CHECK(w.character().cuts[0].plane.origin.x() == 0.75);
    x = w.window().inspector().findChild<NumberField*>();
    REQUIRE(x);
    CHECK(x->value() == 0.75);
    x->setProperty("value", 50.0);  // beyond its end
    w.waitOn();
    CHECK(w.position() == before + 1);
    CHECK(w.window().messages().isVisible());
    x = w.window().inspector().findChild<NumberField*>();
    REQUIRE(x);
    CHECK(x->value() == 0.75);
}

TEST_CASE("start page: a project that is saved or opened gets a small picture of what the view shows, drawn beside the window") {
    Worm w;
    const QString file = w.folder.filePath(QStringLiteral("worm.imomushi"));
    RecentFiles& recent = w.window().files().recent();
    QFile::remove(recent.thumbnailFile(file));
    w.run({{"do", "save"}, {"path", file.toStdString()}});
    REQUIRE(w.window().files().save());
    waitFor([&] { return !recent.thumbnail(file).isNull(); });
    const QImage small = recent.thumbnail(file);
    CHECK(small.size() == RecentFiles::kThumbnail);
    // The worm in the middle, the ground beside it.
    const auto at = [&](double right, double down) { return small.pixelColor(int(right * small.width()), int(down * small.height())); };
    CHECK(std::abs(at(0.5, 0.5).lightness() - at(0.02, 0.02).lightness()) > 20);
    recent.remove(file);
    CHECK(recent.thumbnail(file).isNull());
}
