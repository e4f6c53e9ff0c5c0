// SPDX-License-Identifier: GPL-3.0-or-later
// Performing by what other programs send: they are sockets of this test, on loopback.
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QScrollArea>
#include <QScrollBar>
#include <QToolButton>
#include <QWheelEvent>

#include "core/base/rotation_vector.h"
#include "core/document/cycle.h"
#include "core/document/source_calibration.h"
#include "core/input/input_decoder.h"
#include "tests/studio/window.h"
#include "tests/support/osc_bytes.h"
#include "tests/support/udp_sender.h"
#include "tests/support/virtual_pad.h"
#include "ui/models/commands.h"
#include "ui/models/mapping_texts.h"
#include "ui/models/recent_files.h"
#include "ui/models/source_calibrator.h"
#include "ui/panels/live/live_panel.h"
#include "ui/picking/picking.h"
#include "ui/widgets/number_field.h"
#include "ui/widgets/switch.h"

using namespace imomushi;

namespace {

/// The caterpillar with the panel of live inputs, and a sender to a port of its own.
struct LiveWindow : Window {
    std::unique_ptr<UdpSender> sender;

    LiveWindow() : Window({1500, 940}) {
        open(samples()[0].path);
        trigger("live-inputs");
        waitFor([&] { return panel().isVisible(); });
    }
    LivePanel& panel() { return window().live(); }
    InputDeck& inputs() { return window().inputs(); }
    MappingModel& model() { return *panel().model(); }
    template <class Widget>
    Widget& part(const char* name) {
        auto* found = panel().findChild<Widget*>(QLatin1String(name));
        REQUIRE_MESSAGE(found, name);
        return *found;
    }
    QString state(const char* source) { return part<QLabel>(("state-" + std::string(source)).c_str()).text(); }
    QString guide() { return part<QLabel>("guide").text(); }
    using Window::click;
    void click(const char* button) {
        auto& b = part<QAbstractButton>(button);
        REQUIRE(b.isVisible());
        REQUIRE(b.isEnabled());
        QTest::mouseClick(&b, Qt::LeftButton);
        settle();
    }
    void plug() {
        inputs().setPort(0, 0);  // any that is free
        if (!inputs().sources()[0].on) click("source-osc");
        REQUIRE(inputs().sources()[0].on);
        sender = std::make_unique<UdpSender>(std::uint16_t(inputs().sources()[0].port));
    }
    void mapKeys() {
        window().activateWindow();
        waitFor([&] { return window().isActiveWindow(); });
        trigger("suggest-keys");
        waitFor([&] { return rows() >= 4; });
    }
    void say(const std::string& address, float number) { sender->send(oscBytes(address, {number})); }
    Vec3 place(const EndpointRef& end) { return *endpointPosition(document().session(), end); }
    EndpointRef lastEnd() { return {now().bones.rbegin()->first, true}; }
    std::string lastEndName() { return now().bones.rbegin()->second->name + "/end"; }
    std::size_t rows() { return now().mappings ? now().mappings->size() : 0; }
    int position() { return document().session().position(); }
};

}  // namespace

TEST_CASE("live: plug, learn, play: a control that is moved gets a row, its meter moves, and the end of the bone follows; undo takes the row out") {
    LiveWindow w;
    CHECK(!w.inputs().listens());
    CHECK(!w.window().actions()["let-go"]->isEnabled());
    CHECK(w.guide().startsWith(QStringLiteral("Plug")));
    w.plug();
    CHECK(w.guide().contains(QStringLiteral("nothing has come")));
    w.say("/fader", 0.0F);
    waitFor([&] { return w.guide().startsWith(QStringLiteral("Learn")); });
    // What is selected in the view is what is learned for.
    w.document().select({{SelectionItem::Kind::Endpoint, w.lastEnd().bone, {}, true}});
    REQUIRE(w.panel().learnBar()->target() == "bone/" + w.lastEndName() + "/y");
    const int before = w.position();
    w.click("learn");
    CHECK(w.inputs().learning());
    CHECK(w.part<QLabel>("learning").text().startsWith(QStringLiteral("Move the control")));
    w.shoot("live-learning");
    for (int i = 0; i <= 20; ++i) {
        w.say("/fader", 0.05F * float(i));
        QTest::qWait(10);
    }
    waitFor([&] { return w.inputs().candidate().has_value() || w.rows() == 1; });
    waitFor([&] { return w.rows() == 1; });
    CHECK(!w.inputs().learning());
    CHECK(w.position() >= before + 1);
    const InputMapping made = w.now().mappings->front();
    CHECK(made.row.source == "osc");
    CHECK(made.row.channel == "/fader");
    CHECK(made.row.curve.inLow == 0.0);
    CHECK(made.row.curve.inHigh == 1.0);
    CHECK(made.target == "bone/" + w.lastEndName() + "/y");
    CHECK(w.panel().view()->chosen() == 0);

    const double rest = w.place(w.lastEnd()).y();
    w.say("/fader", 1.0F);
    waitFor([&] { return w.model().level(0).raw == 1.0 && w.model().level(0).drives; });
    CHECK(w.guide().startsWith(QStringLiteral("Play")));
    const double reach = made.row.curve.outHigh;
    CHECK(reach > 0.01);
    waitFor([&] { return w.place(w.lastEnd()).y() > rest + 0.5 * reach; });
    CHECK(w.document().session().steps().back().name == "live");
    CHECK(w.model().level(0).text == targetValueText(targetText(w.now(), made.target), reach));
    w.shoot("live-playing");

    // Undo takes back what inputs hold, which then move nothing until they go on, and next the row.
    const int held = w.position();
    w.trigger("undo");
    CHECK(w.position() == held - 1);
    w.say("/fader", 0.8F);
    waitFor([&] { return w.inputs().waits() == InputDeck::Waits::Undone; });
    CHECK(w.rows() == 1);
    w.trigger("undo");
    CHECK(w.rows() == 0);
    CHECK(w.model().rowCount() == 0);
    w.trigger("redo");
    CHECK(w.rows() == 1);
    w.click("goOn");
    w.say("/fader", 0.9F);
    waitFor([&] { return w.model().level(0).drives; });
    w.click("source-osc");
    CHECK(!w.inputs().listens());
    waitFor([&] { return !w.document().session().moving(); });
}

TEST_CASE("live: a port that is open drives the project that is opened next, too") {
    LiveWindow w;
    w.plug();
    for (const Sample& sample : samples()) {
        w.run({{"do", "new"}});
        w.open(sample.path);
        const Vec3 rest = w.place(w.lastEnd());
        waitFor([&] {
            w.sender->send(oscBytes("/imomushi/bone/" + w.lastEndName() + "/position", {float(rest.x()), float(rest.y() + 0.1), float(rest.z())}));
            return (w.place(w.lastEnd()) - rest).norm() > 0.01;
        });
        w.inputs().letGo();
        w.inputs().goOn();
    }
}

TEST_CASE("live: panic lets everything glide to rest, and inputs move nothing until they go on") {
    LiveWindow w;
    w.run({{"do", "map-input"}, {"source", "osc"}, {"channel", "/fader"}, {"target", "bone/" + w.lastEndName() + "/y"}, {"out", {0, 0.2}}});
    w.plug();
    const double rest = w.place(w.lastEnd()).y();
    w.say("/fader", 1.0F);
    waitFor([&] { return w.place(w.lastEnd()).y() > rest + 0.15; });
    QTest::keyClick(&w.view(), Qt::Key_Escape, Qt::ShiftModifier);
    CHECK(w.inputs().waits() == InputDeck::Waits::LetGo);
    CHECK(w.guide().startsWith(QStringLiteral("Inputs are stopped")));
    for (int i = 0; i < 5; ++i) w.say("/fader", 0.9F);
    waitFor([&] { return w.place(w.lastEnd()).y() < rest + 0.02; });
    waitFor([&] { return w.inputs().sources()[0].heard.counts.packets == 6; });
    CHECK(!w.model().level(0).drives);
    w.shoot("live-let-go");
    w.click("goOn");
    w.say("/fader", 1.0F);
    waitFor([&] { return w.place(w.lastEnd()).y() > rest + 0.15; });
}

TEST_CASE("live: a port that is taken, broken packets and silence are said in plain words") {
    LiveWindow w;
    const auto taken = UdpPort::listen(0);
    REQUIRE(taken);
    w.inputs().setPort(0, taken->port());
    w.click("source-osc");
    CHECK(!w.inputs().sources()[0].on);
    CHECK(w.part<QLabel>("state-osc").text().contains(QStringLiteral("another program")));
    CHECK(!w.part<Switch>("source-osc").isChecked());
    w.shoot("live-port-taken");
    w.plug();
    CHECK(w.part<QLabel>("state-osc").text().contains(QString::number(w.inputs().sources()[0].port)));
    w.sender->send("nothing that is OSC");
    w.say("/fader", 0.5F);
    waitFor([&] { return w.part<QLabel>("state-osc").text().contains(QStringLiteral("Broken packets, left out: 1")); });
    CHECK(w.part<QLabel>("state-osc").text().contains(QStringLiteral("from 1 sender")));
    // The port is open to this machine alone, until the artist opens it.
    CHECK(!w.inputs().sources()[0].network);
    w.click("network-osc");
    CHECK(w.inputs().sources()[0].on);
    CHECK(w.inputs().sources()[0].network);
    w.click("network-osc");
    CHECK(!w.inputs().sources()[0].network);
}

TEST_CASE("live: rows are edited, muted, moved and removed by commands; two rows of one target say which one wins") {
    LiveWindow w;
    const std::string target = "bone/" + w.lastEndName() + "/y";
    w.run({{"do", "map-input"}, {"source", "osc"}, {"channel", "/one"}, {"target", target}, {"out", {0, 0.1}}});
    w.run({{"do", "map-input"}, {"source", "osc"}, {"channel", "/two"}, {"target", target}, {"out", {0, 0.2}}});
    CHECK(w.model().rowCount() == 2);
    CHECK(w.model().conflict(0).contains(QStringLiteral("/two")));
    w.panel().view()->choose(1);
    w.settle();
    w.shoot("live-rows");
    auto& high = w.part<NumberField>("outHigh");
    CHECK(high.value() == doctest::Approx(0.2));
    const int before = w.position();
    QTest::mouseClick(&high, Qt::LeftButton);
    QTest::keyClick(&high, Qt::Key_A, Qt::ControlModifier);
    QTest::keyClicks(&high, QStringLiteral("0.3"));
    QTest::keyClick(&high, Qt::Key_Return);
    CHECK((*w.now().mappings)[1].row.curve.outHigh == doctest::Approx(0.3));
    CHECK(w.position() == before + 1);
    w.click("invert");
    CHECK((*w.now().mappings)[1].row.curve.outLow == doctest::Approx(0.3));
    CHECK((*w.now().mappings)[1].row.curve.outHigh == 0.0);
    w.click("invert");
    // The second one wins where the first one was not heard.
    w.plug();
    w.say("/two", 1.0F);
    waitFor([&] { return w.model().level(1).drives; });
    CHECK(w.model().conflict(0).contains(QStringLiteral("“/two”, wins now")));
    CHECK(w.model().conflict(1).contains(QStringLiteral("This row wins now")));
    w.say("/one", 1.0F);
    waitFor([&] { return w.model().level(0).drives && !w.model().level(1).drives; });
    w.click("mappingUp");
    CHECK(w.now().mappings->front().row.channel == "/two");
    CHECK(w.panel().view()->chosen() == 0);
    w.model().toggle(w.model().index(0, MappingModel::Mute));
    CHECK(w.now().mappings->front().row.muted);
    w.trigger("undo");
    CHECK(!w.now().mappings->front().row.muted);
    w.click("mappingRemove");
    CHECK(w.rows() == 1);
    CHECK(w.panel().view()->chosen() == 0);
    w.trigger("undo");
    CHECK(w.rows() == 2);
}

TEST_CASE("live: what the mouse holds is not driven until it lets go") {
    LiveWindow w;
    w.run({{"do", "map-input"}, {"source", "osc"}, {"channel", "/fader"}, {"target", "bone/" + w.lastEndName() + "/y"}, {"out", {0, 0.3}}});
    w.plug();
    const double rest = w.place(w.lastEnd()).y();
    w.trigger("tool-pose");
    w.say("/fader", 0.0F);
    waitFor([&] { return w.model().level(0).drives; });
    w.cameraStands();
    const QPoint from = w.onScreen(w.place(w.lastEnd()));
    QTest::mouseMove(&w.view(), from);
    w.settle();
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, from);
    for (int i = 1; i <= 6; ++i) {
        QTest::mouseMove(&w.view(), from + QPoint(0, -6) * i);
        w.settle();
    }
    const double up = w.place(w.lastEnd()).y();
    CHECK(up > rest + 0.02);
    w.say("/fader", 0.0F);
    CHECK(stays([&] { return w.place(w.lastEnd()).y() > up - 0.01; }));
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, from + QPoint(0, -36));
    w.say("/fader", 0.0F);
    waitFor([&] { return w.place(w.lastEnd()).y() < rest + 0.01; });
}

TEST_CASE("live: a pad is plugged in, a stick is learned for the end of a bone, which follows it; without a row the pad is closed") {
    LiveWindow w;
    auto& pads = w.part<QComboBox>("device-pad");
    CHECK(w.state("pad") == QStringLiteral("None is plugged in."));
    CHECK(pads.count() == 1);
    VirtualPad pad;
    w.inputs().lookForDevices();
    CHECK(pads.count() == 2);
    CHECK(pads.itemText(1) == QLatin1String(VirtualPad::kName));
    CHECK(w.state("pad").startsWith(QStringLiteral("Ready")));
    CHECK(!w.inputs().listens());
    CHECK(w.guide().startsWith(QStringLiteral("Learn")));
    w.document().select({{SelectionItem::Kind::Endpoint, w.lastEnd().bone, {}, true}});
    w.click("learn");
    CHECK(w.inputs().listens());
    waitFor([&] { return w.state("pad").contains(QLatin1String(VirtualPad::kName)); });
    for (int i = -10; i <= 10; ++i) {
        pad.axis(SDL_CONTROLLER_AXIS_RIGHTY, 3276 * i);
        QTest::qWait(15);
    }
    waitFor([&] { return w.inputs().candidate().has_value(); });
    w.shoot("live-pad-learning");
    waitFor([&] { return w.rows() == 1; });
    const InputMapping made = w.now().mappings->front();
    CHECK(made.row.source == "pad");
    CHECK(made.row.channel == "right-y");
    CHECK(made.row.curve.inLow == -1.0);
    CHECK(made.row.curve.outLow == -made.row.curve.outHigh);
    const double rest = w.place(w.lastEnd()).y();
    pad.axis(SDL_CONTROLLER_AXIS_RIGHTY, -32768);
    waitFor([&] { return w.model().level(0).drives && w.model().level(0).raw == 1.0; });
    waitFor([&] { return std::abs(w.place(w.lastEnd()).y() - rest) > 0.02; });
    w.shoot("live-pad");
    CHECK(cutOff(w.panel()) == "");
    // Out and in again: what it held stays.
    pad.unplug();
    waitFor([&] { return w.state("pad") == QStringLiteral("Waits for a game controller to be plugged in."); });
    CHECK(w.model().level(0).silent);
    pad.plug();
    waitFor([&] { return w.state("pad").contains(QLatin1String(VirtualPad::kName)); });
    // A source that is switched off hears nothing; without a row no pad is open.
    w.click("source-pad");
    CHECK(!w.inputs().listens());
    w.click("source-pad");
    CHECK(w.inputs().listens());
    w.click("mappingRemove");
    w.settle();
    CHECK(!w.inputs().listens());
    waitFor([&] { return !w.document().session().moving(); });
}

TEST_CASE("live: a pad that a source wants and that is not here is said, and is another one than the first that is") {
    LiveWindow w;
    VirtualPad pad;
    w.inputs().lookForDevices();
    w.inputs().setDevice(2, "030000005e0400008e02000014010000 045e:028e Stage pad");
    CHECK(w.part<QComboBox>("device-pad").currentText() == QStringLiteral("Stage pad (not here)"));
    w.run({{"do", "map-input"}, {"source", "pad"}, {"channel", "left-x"}, {"target", "bone/" + w.lastEndName() + "/y"}});
    w.settle();
    CHECK(w.inputs().listens());
    CHECK(w.state("pad") == QStringLiteral("Waits for Stage pad to be plugged in."));
    w.shoot("live-pad-waits");
    CHECK(cutOff(w.panel()) == "");
    w.inputs().setDevice(2, "");
    waitFor([&] { return w.state("pad").contains(QLatin1String(VirtualPad::kName)); });
}

TEST_CASE("live: a control drives a setting of an effect, which is one step of undo; the same of buttons that play a take, stop it and let everything go") {
    LiveWindow w;
    w.run({{"do", "enable"}, {"effect", "bone-dynamics"}});
    const std::string knob = "effect/bone-dynamics/swing-hertz";
    const auto swing = [&] {
        w.run({{"do", "list"}});  // the document becomes what is performed
        return w.now().effects.number(EffectKind::BoneDynamics, "swing-hertz");
    };
    w.panel().learnBar()->setTarget(knob);
    CHECK(w.panel().learnBar()->target() == knob);
    w.run({{"do", "map-input"}, {"source", "osc"}, {"channel", "/knob"}, {"target", knob}, {"out", {1, 9}}});
    const double before = swing();
    w.plug();
    w.say("/knob", 1.0F);
    waitFor([&] { return std::abs(swing() - 9.0) < 1e-9; });
    CHECK(w.model().level(0).drives);
    CHECK(w.model().level(0).text.endsWith(QStringLiteral("Hz")));
    const int held = w.position();
    w.say("/knob", 0.5F);
    waitFor([&] { return std::abs(swing() - 5.0) < 1e-9; });
    CHECK(w.position() == held);
    w.trigger("undo");
    CHECK(swing() == before);
    CHECK(w.position() == held - 1);
    w.say("/knob", 0.7F);
    waitFor([&] { return w.inputs().waits() == InputDeck::Waits::Undone; });
    w.click("goOn");

    w.run({{"do", "record"}, {"take", "wave"}, {"action", "start"}});
    w.run({{"do", "step"}, {"frames", 90}});
    w.run({{"do", "record"}, {"take", "wave"}, {"action", "stop"}});
    for (const auto& [channel, target] : {std::pair("/play", "take/wave/play"), std::pair("/stop", "take/wave/stop"), std::pair("/panic", "trigger/let-go")})
        w.run({{"do", "map-input"}, {"source", "osc"}, {"channel", channel}, {"target", target}});
    w.settle();
    CHECK(w.panel().learnBar()->target() == knob);
    auto& deck = w.window().deck();
    CHECK(!deck.shown());
    w.say("/play", 1.0F);
    waitFor([&] { return deck.shown() && deck.playing(); });
    CHECK(w.inputs().waits() == InputDeck::Waits::Take);
    waitFor([&] { return w.model().level(1).drives || w.model().level(1).raw == 1.0; });
    w.panel().view()->choose(1);
    w.settle();
    w.shoot("live-triggers");
    CHECK(cutOff(w.panel()) == "");
    w.say("/stop", 1.0F);
    waitFor([&] { return !deck.shown(); });
    w.say("/play", 1.0F);  // it is still pressed
    CHECK(stays([&] { return !deck.shown(); }));
    w.say("/panic", 1.0F);
    waitFor([&] { return w.inputs().waits() == InputDeck::Waits::LetGo; });
}

TEST_CASE("live: the panel is whole in both languages, at twice the size too") {
    LiveWindow w;
    w.plug();
    w.say("/fader", 0.5F);
    w.run({{"do", "map-input"}, {"source", "osc"}, {"channel", "/fader"}, {"target", "bone/" + w.lastEndName() + "/y"}, {"out", {0, 0.1}}});
    w.run({{"do", "map-input"}, {"source", "vmc"}, {"channel", "bone/LeftUpperArm"}, {"component", 7}, {"target", "bone/" + w.lastEndName() + "/y"}, {"in", {-1, 1}}});
    w.panel().view()->choose(0);
    w.settle();
    CHECK(cutOff(w.panel()) == "");
    CHECK(pale(w.panel()) == "");
    w.shoot("live-en");
    Appearance::instance().setLanguage(QStringLiteral("ja"));
    w.settle();
    CHECK(cutOff(w.panel()) == "");
    w.shoot("live-ja");
    Appearance::instance().setTheme(Appearance::Theme::Light);
    w.settle();
    CHECK(pale(w.panel()) == "");
    w.shoot("live-ja-light");
    Appearance::instance().setScale(1.5);
    w.settle();
    CHECK(cutOff(w.panel()) == "");
    w.shoot("live-large");
}

TEST_CASE("live: a key of the keyboard is learned and moves an end while it is held; it does nothing else then, and does again what it did where nobody maps it") {
    LiveWindow w;
    w.window().activateWindow();
    waitFor([&] { return w.window().isActiveWindow(); });
    w.view().setFocus();
    REQUIRE(w.inputs().canLearn());
    w.document().select({{SelectionItem::Kind::Endpoint, w.lastEnd().bone, {}, true}});
    w.click("learn");
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    CHECK(!w.inputs().learning());
    w.click("learn");
    const ToolKind tool = w.view().tools().kind();
    // D is a shortcut of the view.
    QTest::keyPress(&w.view(), Qt::Key_D);
    QTest::qWait(50);
    QTest::keyRelease(&w.view(), Qt::Key_D);
    waitFor([&] { return w.rows() == 1; });
    const InputMapping made = w.now().mappings->front();
    CHECK(made.row.source == "keys");
    CHECK(made.row.channel == "d");
    CHECK(made.row.curve.inLow == 0.0);
    CHECK(w.view().tools().kind() == tool);
    CHECK(w.state("keys").startsWith(QStringLiteral("Keys of rows")));

    w.view().setFocus();
    const double rest = w.place(w.lastEnd()).y();
    QTest::keyPress(&w.view(), Qt::Key_D);
    waitFor([&] { return w.place(w.lastEnd()).y() > rest + 0.5 * made.row.curve.outHigh; });
    CHECK(w.view().tools().kind() == tool);
    // Nobody else hears that it came up, as the window went to the back.
    QEvent back(QEvent::WindowDeactivate);
    QApplication::sendEvent(&w.window(), &back);
    waitFor([&] { return w.place(w.lastEnd()).y() < rest + 0.1 * made.row.curve.outHigh; });
    QTest::keyRelease(&w.view(), Qt::Key_D);

    // What is typed into a field is no input.
    auto& out = w.part<NumberField>("outHigh");
    w.panel().view()->choose(0);
    w.settle();
    out.setFocus();
    QTest::keyClick(&out, Qt::Key_D);
    QTest::keyClick(&out, Qt::Key_Escape);
    w.settle();
    CHECK(w.place(w.lastEnd()).y() < rest + 0.1 * made.row.curve.outHigh);

    w.run({{"do", "unmap-input"}});
    w.settle();
    w.view().setFocus();
    CHECK(!w.inputs().listens());
    QTest::keyClick(&w.view(), Qt::Key_D);
    CHECK(w.view().tools().kind() == ToolKind::Pose);
}

TEST_CASE("live: the keyboard is mapped to whatever the character has by one click, and undo takes it out") {
    LiveWindow w;
    w.mapKeys();
    const double rest = w.place(w.lastEnd()).y();
    w.view().setFocus();
    waitFor([&] { return w.inputs().listens(); });
    QTest::keyPress(&w.view(), Qt::Key_W);
    waitFor([&] { return w.place(w.lastEnd()).y() > rest + 0.1; });
    w.shoot("live-suggested");
    QTest::keyRelease(&w.view(), Qt::Key_W);
    // First what the keys moved, which is a step of its own.
    CHECK(w.document().session().steps().back().name == "live");
    w.trigger("undo");
    w.trigger("undo");
    CHECK(w.rows() == 0);
}

TEST_CASE("live: where a cycle has stopped, a key holds what it moves alone, and stopping all inputs lets that go as part of the same step") {
    LiveWindow w;
    const std::size_t pins = w.now().goals.size();
    w.mapKeys();
    w.trigger("move-by-itself");
    // It moves at once, as it says.
    waitFor([&] { return w.now().goals.size() > pins + 3; });
    const std::string cycle = cyclesOf(w.now()).front().name;
    CHECK(w.inputs().cycleFaders(cycle).amount == 0.5);
    w.inputs().playCycle(cycle, {0.0, 1.0});
    waitFor([&] { return w.now().goals.size() == pins; });
    const int before = w.position();
    w.view().setFocus();
    const double rest = w.place(w.lastEnd()).y();
    QTest::keyPress(&w.view(), Qt::Key_W);
    waitFor([&] { return w.place(w.lastEnd()).y() > rest + 0.05; });
    CHECK(w.now().goals.size() == pins + 1);
    QTest::keyRelease(&w.view(), Qt::Key_W);
    QTest::keyClick(&w.view(), Qt::Key_Escape, Qt::ShiftModifier);
    waitFor([&] { return w.now().goals.size() == pins; });
    CHECK(w.position() == before + 1);
}

TEST_CASE("live: while a take is shown a mapped key leaves it and moves the character, and so does a cycle that is asked to go on") {
    LiveWindow w;
    w.mapKeys();
    w.trigger("record");
    waitFor([&] { return w.document().session().recording() && w.document().session().recording()->frames > 3; });
    w.trigger("record");
    CHECK(w.window().messages().text().startsWith(QStringLiteral("Recorded “")));
    w.window().deck().show(0.0);
    waitFor([&] { return w.inputs().waits() == InputDeck::Waits::Take; });
    CHECK(w.part<QAbstractButton>("goOn").isVisible());
    w.view().setFocus();
    const double rest = w.place(w.lastEnd()).y();
    QTest::keyPress(&w.view(), Qt::Key_W);
    waitFor([&] { return w.inputs().waits() == InputDeck::Waits::No && w.place(w.lastEnd()).y() > rest + 0.05; });
    QTest::keyRelease(&w.view(), Qt::Key_W);
    w.trigger("move-by-itself");
    w.window().deck().show(0.0);
    waitFor([&] { return w.inputs().waits() == InputDeck::Waits::Take; });
    w.trigger("move-by-itself");
    waitFor([&] { return w.inputs().waits() == InputDeck::Waits::No; });
    CHECK(!w.window().deck().shown());
}

TEST_CASE("live: a click that mutes a row chooses none; Escape and a click beside the rows close its form") {
    LiveWindow w;
    w.run({{"do", "map-input"}, {"source", "osc"}, {"channel", "/fader"}, {"target", "bone/" + w.lastEndName() + "/y"}, {"out", {0, 0.2}}});
    auto& view = w.part<MappingView>("mappings");
    const auto at = [&](int column) { return view.visualRect(w.model().index(0, column)).center(); };
    QTest::mouseClick(view.viewport(), Qt::LeftButton, {}, at(MappingModel::Mute));
    CHECK(w.model().level(0).muted);
    CHECK(view.chosen() == -1);
    QTest::mouseClick(view.viewport(), Qt::LeftButton, {}, at(MappingModel::Target));
    CHECK(view.chosen() == 0);
    w.settle();
    QTest::mouseClick(view.viewport(), Qt::LeftButton, {}, at(MappingModel::Mute));
    CHECK(!w.model().level(0).muted);
    CHECK(view.chosen() == 0);
    QTest::keyClick(&view, Qt::Key_Escape);
    CHECK(view.chosen() == -1);
    QTest::mouseClick(view.viewport(), Qt::LeftButton, {}, at(MappingModel::Target));
    QTest::mouseClick(view.viewport(), Qt::LeftButton, {}, {20, view.viewport()->height() - 4});
    CHECK(view.chosen() == -1);
    // What was chosen in one project is not in the next.
    QTest::mouseClick(view.viewport(), Qt::LeftButton, {}, at(MappingModel::Target));
    const Json rows = {{"do", "map-input"}, {"source", "osc"}, {"channel", "/fader"}, {"target", "bone/" + w.lastEndName() + "/y"}, {"out", {0, 0.2}}};
    w.run({{"do", "new"}});
    w.open(samples()[0].path);
    w.run(rows);
    CHECK(view.chosen() == -1);
}

TEST_CASE("live: the wheel over a list of devices scrolls the sources and chooses nothing, until the list has the focus") {
    LiveWindow w;
    const std::size_t before = w.inputs().sources().size();
    for (int i = 0; i < 3; ++i) w.inputs().add(InputProtocol::Osc);
    w.settle();
    auto& box = w.part<QComboBox>("device-pad");
    box.addItem(QStringLiteral("another"), QStringLiteral("another"));
    QScrollArea* area = nullptr;
    for (QWidget* up = box.parentWidget(); up && !area; up = up->parentWidget()) area = qobject_cast<QScrollArea*>(up);
    REQUIRE(area);
    QScrollBar& bar = *area->verticalScrollBar();
    REQUIRE(bar.maximum() > 0);
    bar.setValue(0);
    const auto roll = [&] {
        const QPoint at = box.rect().center();
        QWheelEvent event(at, box.mapToGlobal(at), {}, {0, -120}, Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase, false);
        QApplication::sendEvent(&box, &event);
        w.settle();
    };
    REQUIRE(box.currentIndex() == 0);
    roll();
    CHECK(box.currentIndex() == 0);
    CHECK(bar.value() > 0);
    box.setFocus();
    const int scrolled = bar.value();
    roll();
    CHECK(bar.value() == scrolled);
    CHECK(box.currentIndex() == 1);
    const auto& sources = w.inputs().sources();
    w.inputs().setDevice(std::size_t(std::ranges::find(sources, "pad", &InputDeck::Source::name) - sources.begin()), {});
    while (sources.size() > before) w.inputs().remove(sources.size() - 1);
}

TEST_CASE("live: what is performed is sent to a program that listens, as long as its switch is on") {
    LiveWindow w;
    auto port = UdpPort::listen(0);
    REQUIRE(port);
    OutputDeck& outputs = w.window().outputs();
    while (!outputs.receivers().empty()) outputs.remove(0);
    outputs.add(OutputProtocol::Osc);
    w.settle();
    auto& number = w.part<QLineEdit>("port-of-receiver-1");
    number.setFocus();
    number.setText(QString::number(port->port()));
    QTest::keyClick(&number, Qt::Key_Return);
    CHECK(outputs.receivers()[0].port == port->port());
    std::array<std::byte, 65536> room{};
    CHECK(!port->take(room));  // nothing unless it is switched on
    w.click("receiver-1");
    CHECK(outputs.receivers()[0].on);
    const auto decoder = makeInputDecoder(InputProtocol::Osc, "osc");
    std::map<std::string, Vec3> places;
    const auto told = [&] {
        while (const auto size = port->take(room))
            decoder->decode(std::span(room).first(*size), 0, [&](const InputValue& value) {
                if (value.count == 3) places[std::string(value.channel.text())] = Vec3(value.numbers[0], value.numbers[1], value.numbers[2]);
            });
        const auto found = places.find("/imomushi/bone/" + w.lastEndName() + "/position");
        return found == places.end() ? Vec3(Vec3::Constant(1e9)) : found->second;
    };
    waitFor([&] { return (told() - w.place(w.lastEnd())).norm() < 1e-4; });
    const Vec3 to = w.place(w.lastEnd()) + Vec3(0.0, 0.2, 0.1);
    w.run({{"do", "drag"}, {"endpoint", w.lastEndName()}, {"to", {to.x(), to.y(), to.z()}}});
    waitFor([&] { return (told() - to).norm() < 0.02; });
    auto& state = w.part<QLabel>("state-of-receiver-1");
    waitFor([&] { return state.isVisible() && state.text().contains(QStringLiteral("frames/s")); });
    // Another name: it is sent under that at once.
    w.run(commands::rename(w.now().bones.rbegin()->second->name, "antenna"));
    waitFor([&] { return (told() - w.place(w.lastEnd())).norm() < 1e-4; });
    CHECK(places.contains("/imomushi/bone/antenna/end/position"));
    // An address that is none is said, and is no trouble any more where it is mended.
    auto& host = w.part<QLineEdit>("host-1");
    host.setFocus();
    host.setText(QStringLiteral("stage"));
    QTest::keyClick(&host, Qt::Key_Return);
    CHECK(!outputs.receivers()[0].on);
    CHECK(state.text().contains(QStringLiteral("no address")));
    host.setText(QStringLiteral("localhost"));
    QTest::keyClick(&host, Qt::Key_Return);
    CHECK(outputs.receivers()[0].on);
    w.click("receiver-1");
    w.settle();
    (void)told();
    places.clear();
    QTest::qWait(1500);
    (void)told();
    CHECK(places.empty());
    outputs.remove(0);
    // By VMC an octopus has no bones, which is said where it is switched on.
    const QList<Sample> all = samples();
    w.run({{"do", "new"}});  // nobody asks about changes
    w.open(std::ranges::find(all, QStringLiteral("octopus"), &Sample::name)->path);
    outputs.add(OutputProtocol::Vmc);
    outputs.setOn(0, true);
    w.settle();
    waitFor([&] { return w.part<QLabel>("state-of-receiver-1").text().startsWith(QStringLiteral("Sent without bones")); });
    outputs.remove(0);
}

TEST_CASE("live: a source is calibrated by a button and a countdown, in rest and in a kept pose, also while inputs wait; what is left is said, and undo takes it back") {
    LiveWindow w;
    const std::string bone = w.now().bones.rbegin()->second->name;
    for (int k = 0; k < 3; ++k) w.run({{"do", "map-input"}, {"source", "vmc"}, {"channel", "bone/Head"}, {"component", 7 + k}, {"target", "bone/" + bone + "/turn-" + "xyz"[k]}, {"in", {-3.2, 3.2}}});
    // The last bone alone turns, as its start is pinned.
    const Vec3 to = w.place(w.lastEnd()) + Vec3(0.0, 0.5 * (w.place(w.lastEnd()) - w.place({w.lastEnd().bone, false})).norm(), 0.0);
    w.run({{"do", "pin"}, {"endpoint", bone + "/start"}});
    w.run({{"do", "drag"}, {"endpoint", w.lastEndName()}, {"to", {to.x(), to.y(), to.z()}}});
    waitFor([&] { return w.place(w.lastEnd()).y() > to.y() - 0.02; });
    w.run({{"do", "keep-pose"}, {"name", "looks up"}});
    w.run({{"do", "unpin"}, {"endpoint", bone + "/start"}});
    w.run({{"do", "rest"}});
    w.inputs().setPort(1, 0);
    const auto button = [&]() -> QPushButton& { return w.part<QPushButton>("calibrate-vmc"); };  // rows are made anew in another language
    CHECK(!button().isVisible());  // nobody is listened to
    w.click("source-vmc");
    REQUIRE(w.inputs().sources()[1].on);
    CHECK(button().isVisible());
    CHECK(!w.part<QPushButton>("calibrate-osc").isVisible());
    CHECK(button().text() == QStringLiteral("Calibrate…"));
    const UdpSender body(std::uint16_t(w.inputs().sources()[1].port));
    Vec3 turn(0.4, 0.0, 0.2);  // radians, of the head of who performs
    QTimer sends;
    QObject::connect(&sends, &QTimer::timeout, [&] {
        const Eigen::Quaterniond q = rotationOf(turn);
        body.send(oscBytes("/VMC/Ext/Bone/Pos", {std::string("Head"), 0.0F, 0.0F, 0.0F, float(q.x()), float(-q.y()), float(-q.z()), float(q.w())}));
    });
    sends.start(20);
    waitFor([&] { return w.model().level(0).drives; });

    auto* calibrator = w.panel().findChild<SourceCalibrator*>();
    REQUIRE(calibrator);
    CHECK(!w.part<QWidget>("calibration").isVisible());
    w.click("calibrate-vmc");
    CHECK(w.part<QWidget>("calibration").isVisible());
    CHECK(!w.part<QWidget>("learn").isVisible());
    CHECK(cutOff(w.panel()) == "");
    w.shoot("live-calibration");
    const auto measure = [&] {
        w.click("measurePose");
        waitFor([&] { return calibrator->state() == SourceCalibrator::State::Idle; });
        w.settle();
    };
    const auto& trouble = w.part<QLabel>("calibrationTrouble");
    // It can be given up.
    w.click("measurePose");
    CHECK(calibrator->state() == SourceCalibrator::State::Counting);
    CHECK(w.part<QLabel>("countdown").isVisible());
    CHECK(w.part<QLabel>("countdown").text() == QStringLiteral("3"));
    CHECK(w.part<QLabel>("countdownSays").text().contains(QStringLiteral("Rest")));
    CHECK(cutOff(w.panel()) == "");
    w.shoot("live-calibration-counts");
    w.click("cancelCalibration");
    CHECK(calibrator->state() == SourceCalibrator::State::Idle);
    w.click("measurePose");
    CHECK(calibrator->state() == SourceCalibrator::State::Counting);
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    CHECK(calibrator->state() == SourceCalibrator::State::Idle);
    CHECK(!w.part<QLabel>("countdown").isVisible());
    CHECK(!calibrationOf(w.now(), "vmc"));

    calibrator->setCountdown(300);
    const int before = w.position();
    measure();
    CHECK(trouble.text() == QString());
    REQUIRE(calibrationOf(w.now(), "vmc"));
    CHECK(w.position() == before + 1);
    CHECK(w.document().session().steps().back().name == "calibrate-source");
    CHECK(w.part<QLabel>("calibrated-1").text() == QStringLiteral("Rest: off by 0.0°"));
    CHECK(button().text() == QStringLiteral("Calibrated, off by 0.0°…"));
    const std::vector<double> at = calibrationOf(w.now(), "vmc")->poses.front().said.at("bone/Head");
    CHECK((Vec3(at[7], at[8], at[9]) - turn).norm() < 1e-5);
    // From then on that is rest.
    waitFor([&] { return w.inputs().meters().size() == 3 && w.inputs().meters()[0].known && std::abs(w.inputs().meters()[0].value) < 1e-5 && std::abs(w.inputs().meters()[2].value) < 1e-5; });
    CHECK(w.inputs().meters()[0].raw == doctest::Approx(0.4).epsilon(1e-5));

    // The same again in another pose tells nothing.
    auto& pose = w.part<QComboBox>("calibrationPose");
    REQUIRE(pose.count() == 2);
    pose.setCurrentIndex(1);
    measure();
    CHECK(trouble.isVisible());
    CHECK(trouble.text().contains(QStringLiteral("says the same as in the pose rest")));
    w.shoot("live-calibration-alike");
    CHECK(calibrationOf(w.now(), "vmc")->poses.size() == 1);
    // While inputs wait it is measured, too.
    w.inputs().letGo();
    CHECK(w.inputs().waits() == InputDeck::Waits::LetGo);
    turn = Vec3(-0.3, 0.1, 0.1);
    QTest::qWait(200);
    measure();
    CHECK(!trouble.isVisible());
    REQUIRE(calibrationOf(w.now(), "vmc")->poses.size() == 2);
    CHECK(w.part<QLabel>("calibrated-2").text().startsWith(QStringLiteral("looks up: off by ")));
    w.shoot("live-calibrated");
    w.trigger("undo");
    CHECK(calibrationOf(w.now(), "vmc")->poses.size() == 1);
    w.settle();
    CHECK(!w.part<QLabel>("calibrated-2").isVisible());
    w.trigger("redo");
    w.settle();
    CHECK(w.part<QLabel>("calibrated-2").isVisible());

    for (const char* language : {"ja", "en"}) {
        Appearance::instance().setLanguage(QLatin1String(language));
        w.settle();
        CHECK(cutOff(w.panel()) == "");
        CHECK(pale(w.panel()) == "");
        w.shoot(("live-calibrated-" + std::string(language)).c_str());
    }
    w.click("clear-calibrated-1");
    REQUIRE(calibrationOf(w.now(), "vmc"));
    CHECK(calibrationOf(w.now(), "vmc")->poses.front().name == "looks up");
    // Who is silent is not measured.
    sends.stop();
    pose.setCurrentIndex(0);
    measure();
    CHECK(trouble.text().startsWith(QStringLiteral("Nothing was heard")));
    CHECK(calibrationOf(w.now(), "vmc")->poses.size() == 1);
    w.click("closeCalibration");
    CHECK(!w.part<QWidget>("calibration").isVisible());
    CHECK(w.part<QWidget>("learn").isVisible());
    w.click("calibrate-vmc");
    w.click("source-vmc");  // off: what was measured stays
    CHECK(!button().isVisible());
    CHECK(calibrationOf(w.now(), "vmc"));
}
