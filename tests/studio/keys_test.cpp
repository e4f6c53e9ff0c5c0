// SPDX-License-Identifier: GPL-3.0-or-later
// Keys and the pointer: what they reach, and what they must not end.
#include <QDockWidget>
#include <QLineEdit>
#include <QListWidget>
#include <QMenu>
#include <QMenuBar>
#include <QShortcutEvent>
#include <QSpinBox>
#include <QTextBrowser>
#include <functional>
#include <map>
#include <set>

#include "tests/studio/window.h"
#include "ui/dialogs/help_dialogs.h"
#include "ui/dialogs/picture_dialog.h"
#include "ui/dialogs/preferences_dialog.h"
#include "ui/models/gesture.h"
#include "ui/panels/effects_panel.h"
#include "ui/picking/picking.h"
#include "ui/viewport/picture_job.h"
#include "ui/viewport/viewport_widget.h"
#include "ui/widgets/number_field.h"
#include "ui/window/command_search.h"

using namespace imomushi;

namespace {

/// Hears which actions the keys of the window reach, and keeps them from being done.
class Shortcuts : public QObject {
public:
    Shortcuts() { qApp->installEventFilter(this); }
    std::map<QKeySequence, std::set<QObject*>> reached;
    std::set<QKeySequence> ambiguous;
    bool eventFilter(QObject* to, QEvent* event) override {
        if (event->type() != QEvent::Shortcut) return false;
        const auto* shortcut = static_cast<QShortcutEvent*>(event);
        reached[shortcut->key()].insert(to);
        if (shortcut->isAmbiguous()) ambiguous.insert(shortcut->key());
        return true;
    }
};

/// A bone through a body, seen along it: one end is behind the other.
struct Overlapping : Window {
    EndpointRef front, back;
    explicit Overlapping(const char* tool) {
        run({{"do", "import-element"}, {"path", IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"}, {"name", "chest"}});
        run({{"do", "add-joint-face"}, {"element", "chest"}, {"name", "a"}, {"plane", {{"origin", {0, 0, -2}}, {"normal", {0, 0, -1}}}}});
        run({{"do", "add-joint-face"}, {"element", "chest"}, {"name", "b"}, {"plane", {{"origin", {0, 0, 2}}, {"normal", {0, 0, 1}}}}});
        run({{"do", "add-bone"}, {"name", "spine"}, {"from", "chest/a"}, {"to", "chest/b"}});
        window().showStart(false);
        trigger(tool);
        front = {now().boneNamed("spine")->id, true};
        back = {front.bone, false};
        look(Vec3(0, 0, 1));
        window().viewport().setOrthographic(true);
        settle();
    }
    QPoint at() { return view().onScreen(front)->toPoint(); }
    std::string hoveredName() {
        const auto& item = document().hovered();
        return item ? (now().bones.contains(item->part) ? now().bones.at(item->part)->name + (item->atEnd ? "/end" : "/start") : "?") : "";
    }
};

}  // namespace

TEST_CASE("keys: each reaches one action and no other, in both languages") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    for (const char* language : {"en", "ja"}) {
        CAPTURE(language);
        Appearance::instance().setLanguage(QString::fromLatin1(language));
        w.settle();
        std::map<QAction*, bool> enabled;
        for (QAction* action : w.window().actions().all()) {
            enabled[action] = action->isEnabled();
            action->setEnabled(true);
        }
        w.view().setFocus();
        Shortcuts heard;
        for (QAction* action : w.window().actions().all())
            for (const QKeySequence& keys : action->shortcuts()) {
                const QKeyCombination key = keys[0];
                QTest::keyClick(&w.view(), key.key(), key.keyboardModifiers());
                const std::string what = keys.toString().toStdString() + " of " + action->objectName().toStdString();
                // Some are the view's own, which does the same.
                if (action->objectName().startsWith(QStringLiteral("frame-"))) continue;
                CHECK_MESSAGE(heard.reached[keys] == std::set<QObject*>{action}, what);
                CHECK_MESSAGE(!heard.ambiguous.contains(keys), what);
            }
        for (const auto& [action, on] : enabled) action->setEnabled(on);
    }
}

TEST_CASE("keys: of the words of a menu no two have the same letter, in both languages") {
    Window w;
    for (const char* language : {"en", "ja"}) {
        CAPTURE(language);
        Appearance::instance().setLanguage(QString::fromLatin1(language));
        w.settle();
        int letters = 0;
        const std::function<void(const QList<QAction*>&, const QString&)> look = [&](const QList<QAction*>& actions, const QString& of) {
            std::map<QKeySequence, QString> known;
            for (const QAction* action : actions) {
                if (action->menu()) look(action->menu()->actions(), action->text());
                const QKeySequence letter = QKeySequence::mnemonic(action->text());
                if (letter.isEmpty()) continue;
                ++letters;
                const auto [before, first] = known.try_emplace(letter, action->text());
                CHECK_MESSAGE(first, QStringLiteral("%1: %2 / %3").arg(of, before->second, action->text()).toStdString());
            }
        };
        look(w.window().menuBar()->actions(), QStringLiteral("menu bar"));
        CHECK(letters > 80);
    }
}

TEST_CASE("keys: Enter leaves a number field, and the next key is the view's") {
    Window w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    w.document().select({{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    waitFor([&] { return inspectorRow<NumberField>(w, "Poisson ratio") != nullptr; });
    auto* field = inspectorRow<NumberField>(w, "Poisson ratio");
    field->setFocus();
    field->selectAll();
    QTest::keyClicks(field, QStringLiteral("0.3"));
    QTest::keyClick(field, Qt::Key_Return);
    w.settle();
    CHECK(field->value() == doctest::Approx(0.3));
    CHECK(w.view().hasFocus());
    QTest::keyClick(QApplication::focusWidget(), Qt::Key_D);
    CHECK(w.view().tools().kind() == ToolKind::Pose);
}

TEST_CASE("keys: they reach the view when the pointer is over it, unless words are being typed") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    const auto enter = [&] {
        const QPointF at = w.view().rect().center();
        QEnterEvent event(at, w.view().mapTo(&w.window(), at), w.view().mapToGlobal(at));
        QApplication::sendEvent(&w.view(), &event);
    };
    waitFor([&] { return !w.window().inspector().findChildren<NumberField*>().isEmpty(); });
    NumberField* number = nullptr;
    for (auto* field : w.window().inspector().findChildren<NumberField*>())
        if (field->isVisible()) number = field;
    REQUIRE(number);
    number->setFocus();
    enter();
    CHECK(w.view().hasFocus());
    w.trigger("search");
    auto* line = w.window().findChild<CommandSearch*>()->findChild<QLineEdit*>();
    enter();
    CHECK(line->hasFocus());
    QTest::keyClick(line, Qt::Key_Escape);
    w.settle();
}

TEST_CASE("keys: what cannot be done now says why, by its key, in its tip and where it is searched") {
    Window w;
    w.window().showStart(false);
    w.settle();
    w.view().setFocus();
    QTest::keyClick(&w.view(), Qt::Key_M, Qt::ShiftModifier);
    CHECK(w.window().messages().isVisible());
    CHECK(w.window().messages().text() == QStringLiteral("There is nothing to make soft: import a mesh, or select one of several characters and elements."));
    CHECK(w.window().actions()["make-soft"]->toolTip().contains(QStringLiteral("There is nothing to make soft")));
    for (const QAction* action : w.window().actions().all())
        if (!action->isEnabled()) CHECK_MESSAGE(!whyDisabled(*action).isEmpty(), action->objectName().toStdString());
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    for (const QAction* action : w.window().actions().all())
        if (!action->isEnabled()) CHECK_MESSAGE(!whyDisabled(*action).isEmpty(), action->objectName().toStdString());
}

TEST_CASE("search: effects, panels, settings, samples, parts, takes and clips are found, and that nothing is") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/dragon.imomushi"));
    REQUIRE(!w.now().takes.empty());
    const auto search = [&](const QString& typed) {
        w.trigger("search");
        auto* found = w.window().findChild<CommandSearch*>();
        found->findChild<QLineEdit*>()->setText(typed);
        w.settle();
        return found;
    };
    const auto first = [&](const QString& typed) {
        auto* found = search(typed);
        const auto* list = found->findChild<QListWidget*>();
        const QString name = list->count() ? list->item(0)->text() : QString();
        found->close();
        w.settle();
        return name.toStdString();
    };
    for (const QString& name : {QStringLiteral("Effects"), QStringLiteral("Contact"), QStringLiteral("Size of the interface"), QStringLiteral("Octopus"), QStringLiteral("Accuracy and cost")}) CHECK(first(name) == name.toStdString());
    for (const auto& [id, element] : w.now().elements) CHECK(first(QString::fromStdString(element->name)) == element->name);
    for (const auto& [id, take] : w.now().takes) CHECK(first(QString::fromStdString(take->name)) == take->name);
    for (const auto& [id, character] : w.now().characters) CHECK(first(QString::fromStdString(character->name)) == character->name);

    auto* none = search(QStringLiteral("zzqqxx"));
    CHECK(none->findChild<QListWidget*>()->count() == 0);
    auto* label = none->findChild<QLabel*>(QStringLiteral("nothingFound"));
    CHECK(label->isVisible());
    CHECK(label->text().contains(QStringLiteral("zzqqxx")));
    w.shoot("search-nothing");
    none->close();
    w.settle();

    // Enter goes there.
    auto* effects = search(QStringLiteral("Contact"));
    w.shoot("search-effects");
    QTest::keyClick(effects->findChild<QLineEdit*>(), Qt::Key_Return);
    w.settle();
    CHECK(!w.window().findChild<QDockWidget*>(QStringLiteral("effectsDock"))->visibleRegion().isEmpty());
    const auto& [id, element] = *w.now().elements.rbegin();
    auto* parts = search(QString::fromStdString(element->name));
    QTest::keyClick(parts->findChild<QLineEdit*>(), Qt::Key_Return);
    w.settle();
    CHECK(w.document().selection() == std::vector{SelectionItem{SelectionItem::Kind::Element, id, {}, false}});
}

TEST_CASE("search: it knows every setting of the preferences by its name") {
    Window w;
    PreferencesDialog dialog(w.window().actions(), &w.window());
    for (const auto* box : dialog.findChildren<QComboBox*>()) CHECK_MESSAGE(PreferencesDialog::settings().contains(box->accessibleName()), box->accessibleName().toStdString());
    CHECK(PreferencesDialog::settings().size() == dialog.findChildren<QComboBox*>().size() + 1);
}

TEST_CASE("gestures: a number that is dragged is one step, whatever keys are pressed meanwhile") {
    Window w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    w.document().select({{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    waitFor([&] { return inspectorRow<NumberField>(w, "Poisson ratio") != nullptr; });
    auto* field = inspectorRow<NumberField>(w, "Poisson ratio");
    const int before = w.document().session().position();
    QTest::mousePress(field, Qt::LeftButton, {}, QPoint(40, 10));
    for (int i = 1; i <= 4; ++i) QTest::mouseMove(field, QPoint(40 - 3 * i, 10));
    REQUIRE(w.document().inGesture());
    QTest::keyClick(field, Qt::Key_Z, Qt::ControlModifier);
    QTest::keyClick(field, Qt::Key_D, Qt::ControlModifier);
    for (const char* action : {"undo", "delete", "duplicate", "redo"}) w.window().actions()[action]->trigger();
    for (int i = 5; i <= 8; ++i) QTest::mouseMove(field, QPoint(40 - 3 * i, 10));
    CHECK(w.document().inGesture());
    QTest::mouseRelease(field, Qt::LeftButton, {}, QPoint(16, 10));
    CHECK(!w.document().inGesture());
    CHECK(w.document().session().position() == before + 1);
    CHECK(w.now().elements.size() == 1);

    // One that begins while another goes on is a part of it.
    {
        Gesture outer(w.document());
        w.run({{"do", "rename"}, {"target", w.now().elements.begin()->second->name}, {"name", "one"}});
        {
            Gesture inner(w.document());
            w.run({{"do", "rename"}, {"target", "one"}, {"name", "two"}});
            inner.commit();
        }
        CHECK(w.document().inGesture());
        outer.commit();
    }
    CHECK(w.document().session().position() == before + 2);
}

TEST_CASE("gestures: a job that ends while a number is dragged waits until it is let go") {
    Window w;
    w.import(QStringLiteral(IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"));
    const std::string name = w.now().elements.begin()->second->name;
    const int before = w.document().session().position();
    {
        Gesture drag(w.document());
        w.run({{"do", "rename"}, {"target", name}, {"name", "dragged"}});
        bool done = false;
        w.window().steps().start({{{"do", "import-element"}, {"path", IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"}, {"name", "late"}}, QStringLiteral("late"), [&](const Json&) { done = true; }});
        QTest::qWait(20 * kFrameMs);
        CHECK(w.window().steps().running());
        CHECK(!done);
        drag.commit();
        waitFor([&] { return !w.window().steps().running(); });
        CHECK(done);
    }
    CHECK(w.document().session().position() == before + 2);
}

TEST_CASE("overlapping ends: the one in front is taken, Tab takes the one behind, and the view says which") {
    Overlapping w("tool-pose");
    QTest::mouseMove(&w.view(), w.at() + QPoint(40, 40));
    w.settle();
    QTest::mouseMove(&w.view(), w.at());
    w.settle();
    CHECK(w.hoveredName() == "spine/end");  // nearer to the viewer
    CHECK(w.view().hint().contains(QStringLiteral("Tab")));
    CHECK(w.view().hint().contains(QStringLiteral("spine/end")));
    QTest::keyClick(&w.view(), Qt::Key_Tab);
    w.settle();
    CHECK(w.view().hasFocus());
    CHECK(w.hoveredName() == "spine/start");
    CHECK(w.view().hint().contains(QStringLiteral("spine/start")));
    w.shoot("overlapping");
    // P pins what the view says, not what is in front.
    QTest::keyClick(&w.view(), Qt::Key_P);
    w.settle();
    CHECK(w.now().goals.contains(w.back));
    CHECK(w.now().goals.size() == 1);
    QTest::keyClick(&w.view(), Qt::Key_Tab);
    w.settle();
    CHECK(w.hoveredName() == "spine/end");  // round
}

TEST_CASE("overlapping ends: a second click at the same place takes the one behind") {
    Overlapping w("tool-select");
    w.click(w.at());
    REQUIRE(w.document().selection().size() == 1);
    const SelectionItem first = w.document().selection().front();
    CHECK(first.kind == SelectionItem::Kind::Endpoint);
    QTest::qWait(QApplication::doubleClickInterval() + kFrameMs);
    w.click(w.at());
    REQUIRE(w.document().selection().size() == 1);
    const SelectionItem second = w.document().selection().front();
    CHECK(second.kind == SelectionItem::Kind::Endpoint);
    CHECK(second != first);
    // Elsewhere and back it is the one in front again.
    QTest::mouseMove(&w.view(), w.at() + QPoint(60, 60));
    w.settle();
    w.document().select({});
    w.click(w.at());
    CHECK(w.document().selection().front() == first);
}

TEST_CASE("joint face: keys and a brush change the selected one in the view, and with Shift the same letters reach their commands") {
    Window w;
    w.run({{"do", "import-element"}, {"path", IMOMUSHI_TEST_DATA "/reference/a_cylinder_coarse.obj"}, {"name", "chest"}});
    w.run({{"do", "add-joint-face"}, {"element", "chest"}, {"name", "b"}, {"plane", {{"origin", {0, 0, 2}}, {"normal", {0, 0, 1}}}}});
    w.window().showStart(false);
    w.trigger("tool-face");
    const PartId chest = w.now().elementNamed("chest")->id;
    w.document().select({{SelectionItem::Kind::Face, chest, "b", false}});
    w.look(Vec3(0, 0, 1));
    w.settle();
    const auto vertices = [&] { return w.now().elements.at(chest)->faces.at(0).vertices.size(); };
    const std::size_t made = vertices();
    const int before = w.document().session().position();
    const QPoint at = w.view().rect().center();
    QTest::mouseMove(&w.view(), at + QPoint(40, 0));
    QTest::mouseMove(&w.view(), at);
    w.settle();
    w.view().setFocus();
    QTest::keyClick(&w.view(), Qt::Key_Minus);
    REQUIRE(vertices() < made);
    const std::size_t small = vertices();
    CHECK(w.document().session().position() == before + 1);
    QTest::keyClick(&w.view(), Qt::Key_C);
    CHECK(w.view().tools().tool().pending());
    CHECK(w.view().hint().contains(QStringLiteral("Ctrl+drag")));
    // From the middle to beyond the rim.
    const QPoint rim = at + QPoint(w.view().height() * 2 / 5, 0);
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, at);
    QTest::mouseMove(&w.view(), at + QPoint(10, 0));
    QTest::mouseMove(&w.view(), rim);
    w.settle();
    CHECK(w.view().tools().busy());
    w.shoot("face-brush");
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, rim);
    CHECK(vertices() > small);
    CHECK(w.document().session().position() == before + 2);
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    CHECK(!w.view().tools().tool().pending());
    QTest::mouseMove(&w.view(), at + QPoint(3, 0));
    w.settle();
    REQUIRE(w.view().tools().tool().wants(Qt::Key_L));
    w.shoot("face-keys");
    Shortcuts heard;
    QTest::keyClick(&w.view(), Qt::Key_L, Qt::ShiftModifier);
    CHECK(heard.reached[QKeySequence(Qt::SHIFT | Qt::Key_L)] == std::set<QObject*>{w.window().actions()["live-inputs"]});
    CHECK(w.document().session().position() == before + 2);
}

TEST_CASE("picture of the view: any size, with alpha, and without what is selected") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    CHECK(w.window().actions()["picture"]->shortcut() == QKeySequence(Qt::Key_F12));
    const QString file = w.folder.filePath(QStringLiteral("view.png"));
    PictureJob job;
    const auto write = [&](const QString& to, const ViewportWidget::Picture& picture) {
        std::optional<Result<void>> done;
        job.start(w.view().pictureScene(picture), picture.size, to, [&](const Result<void>& result) { done = result; });
        waitFor([&] { return done.has_value(); });
        return done.value_or(fail("never", "It never ended."));
    };
    REQUIRE(write(file, {QSize(333, 517), true, false, false}).has_value());
    const QImage clear(file);
    CHECK(clear.size() == QSize(333, 517));
    CHECK(clear.hasAlphaChannel());
    CHECK(qAlpha(clear.pixel(2, 2)) == 0);
    int solid = 0, none = 0;
    for (int y = 0; y < clear.height(); ++y)
        for (int x = 0; x < clear.width(); ++x) {
            solid += qAlpha(clear.pixel(x, y)) == 255;
            none += qAlpha(clear.pixel(x, y)) == 0;
        }
    CHECK(solid > clear.width() * clear.height() / 50);
    CHECK(none > clear.width() * clear.height() / 4);
    w.document().select({{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    REQUIRE(write(file, {QSize(333, 517), true, false, false}).has_value());
    CHECK(QImage(file) == clear);
    REQUIRE(write(file, {QSize(400, 300), false, true, true}).has_value());
    CHECK(qAlpha(QImage(file).pixel(2, 2)) == 255);
    CHECK(write(file, {QSize(9000, 9000), false, false, true}).error().code == "bad-size");
    CHECK(write(w.folder.filePath(QStringLiteral("no/such/folder.png")), {QSize(40, 30), false, false, true}).error().code == "not-writable");

    PictureDialog dialog(QSize(640, 480), &w.window());
    dialog.findChild<QSpinBox*>(QStringLiteral("pictureWidth"))->setValue(1920);
    CHECK(dialog.picture().size == QSize(1920, 480));
}

TEST_CASE("help: the list of keys has every key as it is set, in both languages") {
    Window w;
    for (const char* language : {"en", "ja"}) {
        Appearance::instance().setLanguage(QString::fromLatin1(language));
        w.settle();
        ControlsDialog dialog(w.window().actions(), true, &w.window());
        const QString text = dialog.findChild<QTextBrowser*>(QStringLiteral("controls"))->toPlainText();
        for (const QAction* action : w.window().actions().all())
            for (const QKeySequence& keys : action->shortcuts()) {
                CHECK_MESSAGE(text.contains(keys.toString(QKeySequence::NativeText)), action->objectName().toStdString());
                CHECK_MESSAGE(text.contains(commandName(*action)), action->objectName().toStdString());
            }
    }
}

namespace {

/// The end of a bone of the caterpillar, held by the mouse.
struct DraggedEnd : Window {
    EndpointRef end;
    DraggedEnd() {
        open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
        trigger("tool-pose");
        end = {now().boneNamed("head-bone")->id, true};
        settle();
        const QPoint at = view().onScreen(end)->toPoint();
        QTest::mouseMove(&view(), at);
        QTest::mousePress(&view(), Qt::LeftButton, {}, at);
        REQUIRE(view().tools().busy());
        view().setFocus();
    }
    /// A key of a Linux keyboard as its layout tells it: the place, and what is printed there.
    void press(int driver, int key, const QString& text, Qt::KeyboardModifiers modifiers = {}) {
        QKeyEvent override(QEvent::ShortcutOverride, key, modifiers, quint32(driver + 8), 0, 0, text);
        QApplication::sendEvent(&view(), &override);
        CHECK(override.isAccepted());
        QKeyEvent event(QEvent::KeyPress, key, modifiers, quint32(driver + 8), 0, 0, text);
        QApplication::sendEvent(&view(), &event);
    }
    Vec3 target() { return now().goals.at(end).target; }
};

}  // namespace

TEST_CASE("numbers while dragging: the keys of US, French, German and Japanese layouts type them, the keypad does not turn the view, and one drag is one step") {
    DraggedEnd w;
    const int before = w.document().session().position();
    const auto from = w.document().session().positionOf(w.end);
    REQUIRE(from.has_value());
    const Vec3 eye = w.view().cameraController().camera().eye;
    const auto says = [&](const char* text) { return w.view().tools().tool().banner().contains(QString::fromUtf8(text)); };
    // French: X, then the unshifted "&", "é" and the minus right of "0".
    w.press(45, Qt::Key_X, QStringLiteral("x"));
    w.press(51, Qt::Key_Comma, QStringLiteral(","));
    w.press(2, Qt::Key_Ampersand, QStringLiteral("&"));
    w.press(3, Qt::Key_Eacute, QStringLiteral("é"));
    w.press(12, Qt::Key_ParenRight, QStringLiteral(")"));
    CHECK(w.now().goals.contains(w.end));
    CHECK(says("-.12▏ = -12 cm"));
    for (int i = 0; i < 5; ++i) w.press(14, Qt::Key_Backspace, QStringLiteral("\b"));
    CHECK(!says("▏"));
    // The keypad, with and without its lock.
    w.press(82, Qt::Key_Insert, {}, Qt::KeypadModifier);
    w.press(83, Qt::Key_Comma, QStringLiteral(","), Qt::KeypadModifier);
    w.press(79, Qt::Key_1, QStringLiteral("1"), Qt::KeypadModifier);
    w.press(81, Qt::Key_PageDown, {}, Qt::KeypadModifier);
    CHECK(says("0.13▏ = 13 cm"));
    CHECK(w.view().cameraController().camera().eye == eye);
    // German: "/" is Shift and the digit 7. Then Tab, which stays in the view, and digits of the US and of Japan.
    w.press(8, Qt::Key_Slash, QStringLiteral("/"), Qt::ShiftModifier);
    w.press(3, Qt::Key_2, QStringLiteral("2"));
    CHECK(says("0.13/2▏ = 6.5 cm"));
    w.press(45, Qt::Key_X, QStringLiteral("x"));  // free again
    w.press(15, Qt::Key_Tab, QStringLiteral("\t"));
    CHECK(w.view().hasFocus());
    w.press(2, Qt::Key_1, QStringLiteral("1"));
    w.press(46, Qt::Key_C, QStringLiteral("c"));
    w.press(50, Qt::Key_M, QStringLiteral("m"));
    CHECK(says("1cm▏ = 1 cm"));
    CHECK(w.view().tools().kind() == ToolKind::Pose);
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, w.view().onScreen(w.end)->toPoint());
    CHECK(!w.view().tools().busy());
    CHECK(w.document().session().position() == before + 1);
    CHECK((w.target() - *from - Vec3(0.065, 0.01, 0)).norm() < 1e-9);
}

TEST_CASE("bones at rest: G moves what is selected without a button, a click keeps it and Esc takes it back") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    w.trigger("tool-bone");
    const PartId bone = w.now().boneNamed("head-bone")->id;
    w.document().select({{SelectionItem::Kind::Bone, bone, {}, false}});
    const QPoint at = w.view().rect().center();
    QTest::mouseMove(&w.view(), at);
    w.settle();
    const int before = w.document().session().position();
    const auto place = [&] { return *w.document().session().positionOf({bone, true}); };
    const Vec3 from = place();
    QTest::keyClick(&w.view(), Qt::Key_G);
    REQUIRE(w.view().tools().busy());
    QTest::mouseMove(&w.view(), at + QPoint(0, -30));
    w.settle();
    CHECK(w.view().tools().busy());  // no button is down, and it goes on
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    CHECK(!w.view().tools().busy());
    CHECK(w.document().session().position() == before);
    QTest::keyClick(&w.view(), Qt::Key_G);
    QTest::keyClick(&w.view(), Qt::Key_Y);
    QTest::keyClicks(&w.view(), QStringLiteral("5 cm"));
    w.shoot("bone-moved");
    QTest::mouseClick(&w.view(), Qt::LeftButton, {}, at);
    CHECK(!w.view().tools().busy());
    CHECK(w.document().session().position() == before + 1);
    CHECK((place() - from - Vec3(0, 0.05, 0)).norm() < 1e-9);
    w.settle();
    w.trigger("undo");
    CHECK((place() - from).norm() < 1e-9);
}

TEST_CASE("select: the others, what is next, and the chain that hangs on a bone") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    const auto names = [&] {
        std::set<std::string> all;
        for (const SelectionItem& item : w.document().selection()) all.insert(item.kind == SelectionItem::Kind::Bone ? w.now().bones.at(item.part)->name : item.kind == SelectionItem::Kind::Element ? w.now().elements.at(item.part)->name : "?");
        return all;
    };
    const auto bone = [&](const char* name) { return SelectionItem{SelectionItem::Kind::Bone, w.now().boneNamed(name)->id, {}, false}; };
    const auto key = [&](Qt::Key k) {
        w.settle();
        QTest::keyClick(&w.view(), k, Qt::ShiftModifier);
        w.settle();
    };
    w.view().setFocus();
    w.document().select({bone("middle-bone")});
    key(Qt::Key_G);
    CHECK(names() == std::set<std::string>{"rear-bone", "middle-bone", "front-bone"});
    key(Qt::Key_I);
    CHECK(names() == std::set<std::string>{"tail-bone", "head-bone"});
    w.document().select({bone("middle-bone")});
    key(Qt::Key_C);
    CHECK(names() == std::set<std::string>{"middle-bone", "front-bone", "head-bone"});
    w.document().select({{SelectionItem::Kind::Element, w.now().elementNamed("head")->id, {}, false}});
    key(Qt::Key_G);
    CHECK(names() == std::set<std::string>{"head", "front"});
    key(Qt::Key_I);
    CHECK(names().size() == w.now().elements.size() - 2);
    CHECK(!names().contains("head"));
}

TEST_CASE("keys: with Blender's mouse R turns what is selected and Ctrl+R records; with the industry's W, E and R choose what the gizmo has") {
    Window w;
    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
    w.trigger("tool-select");
    w.document().select({{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    QTest::mouseMove(&w.view(), w.view().rect().center());
    w.view().setFocus();
    w.settle();
    QTest::keyClick(&w.view(), Qt::Key_R);
    CHECK(w.view().tools().busy());
    CHECK(!w.window().deck().recording());
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    CHECK(!w.view().tools().busy());
    CHECK(w.window().actions()["gizmo-scale"]->shortcuts().isEmpty());
    CHECK(w.window().actions()["record"]->shortcut() == QKeySequence(Qt::CTRL | Qt::Key_R));

    const auto prefer = [&](int preset) {
        whenModal<PreferencesDialog>([preset](PreferencesDialog* dialog) {
            Q_EMIT dialog->navigationChanged(preset);
            dialog->reject();
        });
        w.window().actions()["preferences"]->trigger();
        w.activate();
        w.view().setFocus();
    };
    prefer(1);
    for (const auto& [key, action] : {std::pair{Qt::Key_W, "gizmo-move"}, {Qt::Key_E, "gizmo-turn"}, {Qt::Key_R, "gizmo-scale"}}) {
        CAPTURE(action);
        QTest::keyClick(&w.view(), key);
        w.settle();
        CHECK(w.window().actions()[action]->isChecked());
        CHECK(!w.view().tools().busy());
    }
    w.shoot("gizmo-scale");
    prefer(0);
    CHECK(w.window().actions()["gizmo-scale"]->shortcuts().isEmpty());
    w.trigger("gizmo-all");
}
