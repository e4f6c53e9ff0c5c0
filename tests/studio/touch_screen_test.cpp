// SPDX-License-Identifier: GPL-3.0-or-later
// Fingers on a touch screen, several at once, and pens, in the view.
#include <QMouseEvent>
#include <QPointingDevice>
#include <QStyleHints>
#include <QTabletEvent>
#include <QTouchEvent>
#include <set>
#include <utility>

#include "core/document/take.h"
#include "tests/studio/window.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

/// Qt knows a device for as long as the program runs.
QPointingDevice* screen() {
    static QPointingDevice* made = QTest::createTouchDevice();
    return made;
}

/// Counts the presses of mouse buttons that reach the view.
struct Presses : QObject {
    int count = 0;
    bool eventFilter(QObject*, QEvent* e) override {
        count += e->type() == QEvent::MouseButtonPress;
        return false;
    }
};

struct Touching : Window {
    EndpointRef head, tail;
    Presses presses;
    Touching() {
        open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/caterpillar.imomushi"));
        window().showStart(false);
        trigger("tool-pose");
        look(Vec3(0, 0, 1));
        head = {now().boneNamed("head-bone")->id, true};
        tail = {now().boneNamed("tail-bone")->id, false};
        view().installEventFilter(&presses);
    }
    ~Touching() { view().removeEventFilter(&presses); }
    QPoint at(const EndpointRef& end) { return view().onScreen(end)->toPoint(); }
    Vec3 place(const EndpointRef& end) { return *document().session().positionOf(end); }
    int steps() { return document().session().position(); }
    /// All fingers that are on the view, as a screen tells of them; `state` is of the last one.
    void tell(std::vector<QPoint> fingers, QEventPoint::State state = QEventPoint::Updated) {
        auto touch = QTest::touchEvent(&view(), screen(), false);
        for (int id = 0; id < int(fingers.size()); ++id) {
            const bool last = id + 1 == int(fingers.size());
            if (last && state == QEventPoint::Pressed)
                touch.press(id, fingers[std::size_t(id)], &view());
            else if (last && state == QEventPoint::Released)
                touch.release(id, fingers[std::size_t(id)], &view());
            else
                touch.move(id, fingers[std::size_t(id)], &view());
        }
        touch.commit();
    }
    void land(const std::vector<QPoint>& fingers) { tell(fingers, QEventPoint::Pressed); }
    /// The last of them is lifted.
    void lift(const std::vector<QPoint>& fingers) { tell(fingers, QEventPoint::Released); }
    void reaches(const EndpointRef& end, QPoint finger) {
        waitFor([&] { return (at(end) - finger).manhattanLength() < 8; });
    }
    /// Two fingers take both ends and lead them.
    void leadBoth(QPoint first, QPoint second) {
        const QPoint a = at(head), b = at(tail);
        land({a});
        land({a, b});
        for (int i = 1; i <= 4; ++i) {
            tell({a + i * (first - a) / 4, b + i * (second - b) / 4});
            settle();
        }
        tell({first, second});
        reaches(head, first);
        reaches(tail, second);
    }
};

}  // namespace

TEST_CASE("touch screen: two fingers lead two ends at once, what they hold stays held, and one step takes both back") {
    Touching w;
    const Vec3 head = w.place(w.head), tail = w.place(w.tail);
    const int before = w.steps();
    const QPoint first = w.at(w.head) + QPoint(-40, -90), second = w.at(w.tail) + QPoint(50, -60);
    w.leadBoth(first, second);
    CHECK(w.view().tools().busy());
    CHECK(w.view().hint().startsWith(QStringLiteral("Each finger")));
    CHECK(w.steps() == before);
    w.lift({first, second});
    w.settle();
    CHECK(w.steps() == before);  // the other one goes on
    CHECK(w.view().tools().busy());
    w.lift({first});
    w.settle();
    CHECK(!w.view().tools().busy());
    CHECK(w.steps() == before + 1);
    CHECK(w.now().goals.contains(w.head));
    CHECK(w.now().goals.contains(w.tail));
    CHECK((w.at(w.head) - first).manhattanLength() < 8);
    CHECK((w.at(w.tail) - second).manhattanLength() < 8);
    CHECK(w.presses.count == 0);
    CHECK(w.document().selection().size() == 2);
    w.trigger("undo");
    w.settle();
    CHECK((w.place(w.head) - head).norm() < 1e-6);
    CHECK((w.place(w.tail) - tail).norm() < 1e-6);
    CHECK(w.steps() == before);
}

TEST_CASE("touch screen: a finger that does not move holds what it is on while another one leads, and one that lands later joins the step") {
    Touching w;
    const int before = w.steps();
    const Vec3 tail = w.place(w.tail);
    const QPoint a = w.at(w.head), b = w.at(w.tail), to = a + QPoint(-30, -90);
    w.run({{"do", "unpin"}, {"endpoint", "tail-bone/start"}});
    w.land({b});
    w.land({b, a});
    w.tell({b, to});
    w.reaches(w.head, to);
    CHECK(w.now().goals.contains(w.tail));
    CHECK((w.place(w.tail) - tail).norm() < 0.02);
    w.lift({b, to});
    w.settle();
    CHECK(w.steps() == before + 1);  // that of unpin
    // Another finger takes the head back.
    const QPoint again = w.at(w.head), farther = again + QPoint(10, 40);
    w.land({b, again});
    w.tell({b, farther});
    w.reaches(w.head, farther);
    w.lift({b, farther});
    w.lift({b});
    w.settle();
    CHECK(w.steps() == before + 2);
}

TEST_CASE("touch screen: a finger on nothing does nothing while others hold, and a touch that is cancelled takes all back") {
    Touching w;
    const Vec3 head = w.place(w.head), tail = w.place(w.tail);
    const int before = w.steps();
    const QPoint first = w.at(w.head) + QPoint(-40, -90), second = w.at(w.tail) + QPoint(50, -60), nothing(60, w.view().height() - 60);
    w.leadBoth(first, second);
    const auto axes = w.view().cameraController().axes();
    const QPointF origin = *w.view().onScreen(Vec3(0, 0, 0));
    w.land({first, second, nothing});
    w.tell({first, second, nothing + QPoint(100, -80)});
    w.tell({first, second, nothing + QPoint(150, -150)});
    w.settle();
    CHECK(w.view().cameraController().axes() == axes);
    CHECK(*w.view().onScreen(Vec3(0, 0, 0)) == origin);
    CHECK((w.at(w.head) - first).manhattanLength() < 8);
    CHECK((w.at(w.tail) - second).manhattanLength() < 8);
    QTouchEvent cancel(QEvent::TouchCancel, screen(), Qt::NoModifier, QList<QEventPoint>());
    QApplication::sendEvent(&w.view(), &cancel);
    w.settle();
    CHECK(!w.view().tools().busy());
    CHECK(w.steps() == before);
    CHECK(!w.now().goals.contains(w.head));
    CHECK((w.place(w.head) - head).norm() < 1e-6);
    CHECK((w.place(w.tail) - tail).norm() < 1e-6);
    // The screen goes on telling of fingers that lead nothing any more.
    w.tell({first, second, nothing});
    w.lift({first, second, nothing});
    w.lift({first, second});
    w.lift({first});
    w.settle();
    CHECK(w.steps() == before);
    CHECK((w.place(w.head) - head).norm() < 1e-6);
    CHECK(w.presses.count == 0);
}

TEST_CASE("touch screen: on nothing a finger orbits, two pan and zoom about their middle, and nothing is posed or selected") {
    Touching w;
    const int before = w.steps();
    const Vec3 head = w.place(w.head);
    const auto axes = w.view().cameraController().axes();
    const QPoint a(200, 120), b(400, 120);
    const auto apart = [&] { return std::hypot(w.view().onScreen(w.head)->x() - w.view().onScreen(w.tail)->x(), w.view().onScreen(w.head)->y() - w.view().onScreen(w.tail)->y()); };
    const double wide = apart();
    w.land({a});
    w.land({a, b});
    for (int i = 1; i <= 10; ++i) w.tell({a - QPoint(2 * i, 0), b + QPoint(8 * i, 0)});
    // They were 200 pixels apart and are 300.
    CHECK(apart() == doctest::Approx(1.5 * wide).epsilon(0.02));
    CHECK(w.view().cameraController().axes() == axes);
    const QPointF tail = *w.view().onScreen(w.tail);
    w.tell({a + QPoint(0, 50), b + QPoint(100, 50)});
    CHECK((*w.view().onScreen(w.tail) - tail - QPointF(20, 50)).manhattanLength() < 3.0);
    CHECK(w.view().cameraController().axes() == axes);
    // The one that is left turns nothing.
    w.lift({a + QPoint(0, 50), b + QPoint(100, 50)});
    w.tell({a + QPoint(0, 150)});
    CHECK(w.view().cameraController().axes() == axes);
    w.lift({a + QPoint(0, 150)});
    w.look(Vec3(0, 0, 1));
    w.document().select({{SelectionItem::Kind::Endpoint, w.head.bone, {}, true}});
    w.land({a});
    w.tell({a + QPoint(30, 0)});
    w.tell({a + QPoint(90, 20)});
    CHECK((w.view().cameraController().axes() - axes).norm() > 0.1);
    w.lift({a + QPoint(90, 20)});
    CHECK(w.document().selection().size() == 1);
    CHECK(w.steps() == before);
    CHECK((w.place(w.head) - head).norm() < 1e-6);
    CHECK(w.presses.count == 0);
    CHECK(!w.view().tools().busy());
}

TEST_CASE("touch screen: a tap selects as a click does and makes no step; the second of two taps lets go") {
    Touching w;
    w.run({{"do", "drag"}, {"endpoint", "head-bone/end"}, {"to", {1.2, 0.6, 0.1}}});
    waitFor([&] { return !w.document().session().moving(); });
    const int before = w.steps();
    const QPoint a = w.at(w.head);
    // However slow the machine is, both taps are one double tap.
    QStyleHints& hints = *QGuiApplication::styleHints();
    const int interval = hints.mouseDoubleClickInterval();
    hints.setMouseDoubleClickInterval(10 * kWaitMs);
    w.land({a});
    w.lift({a});
    CHECK(w.document().selection() == std::vector{SelectionItem{SelectionItem::Kind::Endpoint, w.head.bone, {}, true}});
    CHECK(w.steps() == before);
    CHECK(w.now().goals.contains(w.head));
    w.land({a});
    w.lift({a});
    hints.setMouseDoubleClickInterval(interval);
    CHECK(!w.now().goals.contains(w.head));
    CHECK(w.steps() == before + 1);
    const QPoint nothing(60, w.view().height() - 60);
    w.land({nothing});
    w.lift({nothing});
    CHECK(w.document().selection().empty());
}

TEST_CASE("touch screen: with other tools one finger does what the mouse does, and two lead the camera and place nothing") {
    Touching w;
    w.trigger("tool-select");
    const QPoint a = w.at(w.head);
    w.land({a});
    w.lift({a});
    w.settle();
    CHECK(w.presses.count == 1);
    CHECK(w.document().selection() == std::vector{SelectionItem{SelectionItem::Kind::Endpoint, w.head.bone, {}, true}});
    w.run({{"do", "new"}});
    const QString path = writeMesh(w.folder.filePath(QStringLiteral("bar.obj")), shapes::box(Vec3(-3, -0.5, -0.5), Vec3(3, 0.5, 0.5), 12, 3, 3).mesh);
    w.run({{"do", "import-element"}, {"path", path.toStdString()}, {"name", "bar"}});
    w.window().showStart(false);
    w.look(Vec3(0.2, 0.2, 1));
    w.trigger("tool-face");
    const QPoint flesh = w.onScreen(Vec3(2.5, 0.2, 0.5));
    w.click(flesh);
    const int placed = w.steps();
    const auto faces = [&] { return w.now().elements.begin()->second->faces.size(); };
    const std::size_t byMouse = faces();
    const auto pending = w.view().tools().tool().pending();
    w.view().tools().cancel();
    while (w.steps() > 1) w.run({{"do", "undo"}});
    w.settle();
    // Two fingers on the same place.
    const int presses = w.presses.count;
    const QPoint beside = flesh + QPoint(-60, 10);
    QTest::touchEvent(&w.view(), screen(), false).press(0, flesh, &w.view()).press(1, beside, &w.view()).commit();
    w.tell({flesh + QPoint(30, 0), beside - QPoint(30, 0)});
    w.lift({flesh + QPoint(30, 0), beside - QPoint(30, 0)});
    w.lift({flesh + QPoint(30, 0)});
    w.settle();
    CHECK(w.presses.count == presses);
    CHECK(w.steps() == 1);
    CHECK(!w.view().tools().tool().pending());
    w.look(Vec3(0.2, 0.2, 1));
    w.land({flesh});
    w.lift({flesh});
    w.settle();
    CHECK(w.presses.count == presses + 1);
    CHECK(w.steps() == placed);
    CHECK(faces() == byMouse);
    CHECK(w.view().tools().tool().pending() == pending);
    CHECK((placed > 1 || pending));  // the click did something
}

TEST_CASE("touch screen: what two fingers did is recorded, and performed again from the script to the same bytes") {
    Touching w;
    const QPoint first = w.at(w.head) + QPoint(-40, -90), second = w.at(w.tail) + QPoint(50, -60);
    w.run({{"do", "record"}, {"take", "fingers"}, {"action", "start"}});
    w.leadBoth(first, second);
    w.lift({first, second});
    w.lift({first});
    w.settle();
    w.run({{"do", "record"}, {"take", "fingers"}, {"action", "stop"}});
    const QString path = w.folder.filePath(QStringLiteral("fingers.jsonl"));
    w.run({{"do", "save-script"}, {"path", path.toStdString()}});
    QFile script(path);
    REQUIRE(script.open(QIODevice::ReadOnly));
    CommandRegistry registry;
    addCoreCommands(registry);
    addReportCommands(registry);
    Session again(registry);
    int drags = 0;
    std::set<std::string> led;
    while (!script.atEnd()) {
        const Json line = Json::parse(script.readLine().toStdString());
        drags += line.at("do") == "drag";
        if (const auto inputs = line.find("inputs"); inputs != line.end())
            for (const Json& input : *inputs) led.insert(input.at("endpoint").get<std::string>());
        REQUIRE(again.execute(line).has_value());
    }
    CHECK(drags == 4);  // commands take hold and leave, and the performance is given what is between
    CHECK(led == std::set<std::string>{"head-bone/end", "tail-bone/start"});
    CHECK(again.document().goals.at(w.head).target == w.now().goals.at(w.head).target);
    CHECK(again.document().goals.at(w.tail).target == w.now().goals.at(w.tail).target);
    const Take &is = *again.document().takeNamed("fingers"), &was = *w.now().takeNamed("fingers");
    CHECK(was.times.size() > 10);
    CHECK(is.times == was.times);
    CHECK((is.poses == was.poses));
    CHECK((is.shapes == was.shapes));
}

TEST_CASE("pen: the harder it presses in the touch tool, the deeper the flesh goes, and it comes back when it is lifted") {
    Window w;
    const QString path = writeMesh(w.folder.filePath(QStringLiteral("bar.obj")), shapes::box(Vec3(-3, -0.5, -0.5), Vec3(3, 0.5, 0.5), 12, 3, 3).mesh);
    w.run({{"do", "import-element"}, {"path", path.toStdString()}, {"name", "bar"}});
    w.run({{"do", "add-joint-face"}, {"element", "bar"}, {"name", "tail"}, {"plane", {{"origin", {-3, 0, 0}}, {"normal", {-1, 0, 0}}}}});
    w.run({{"do", "add-joint-face"}, {"element", "bar"}, {"name", "tip"}, {"plane", {{"origin", {3, 0, 0}}, {"normal", {1, 0, 0}}}}});
    w.run({{"do", "set"}, {"target", "bar"}, {"property", "solver-mesh"}, {"value", "draft"}});
    w.run({{"do", "enable"}, {"effect", "touch"}});
    w.run({{"do", "precompute"}});
    w.window().showStart(false);
    w.settle();
    w.look(Vec3(0, 0, 1));
    w.trigger("tool-touch");
    const PartId bar = w.now().elements.begin()->first;
    const Points rest = w.document().session().positionsOf(bar);
    const QPoint at = w.onScreen(Vec3(0.2, 0.1, 0.5));
    // Qt tells of the pen first, and as it is not taken, of a mouse that does the same.
    QPointingDevice pen(QStringLiteral("pen"), 77, QInputDevice::DeviceType::Stylus, QPointingDevice::PointerType::Pen, QInputDevice::Capability::Position | QInputDevice::Capability::Pressure, 1, 1);
    const auto tell = [&](QEvent::Type type, double pressure, Qt::MouseButton button, Qt::MouseButtons buttons) {
        QTabletEvent e(type, &pen, at, w.view().mapToGlobal(at), pressure, 0, 0, 0, 0, 0, Qt::NoModifier, button, buttons);
        QApplication::sendEvent(&w.view(), &e);
        CHECK(!e.isAccepted());
    };
    const auto depth = [&] { return (w.document().session().positionsOf(bar) - rest).rowwise().norm().maxCoeff(); };
    const auto steadyDepth = [&] {
        for (double before = -1.0, now = depth();; before = std::exchange(now, depth())) {
            if (std::abs(now - before) < 1e-3 * now + 1e-6) return now;
            QTest::qWait(5 * kFrameMs);
        }
    };
    const auto pressed = [&](double pressure) {
        tell(QEvent::TabletMove, pressure, Qt::NoButton, Qt::LeftButton);
        w.settle();
        REQUIRE(w.now().touches.size() == 1);
        return steadyDepth();
    };
    QTest::mouseMove(&w.view(), at);
    w.settle();
    tell(QEvent::TabletPress, 0.02, Qt::LeftButton, Qt::LeftButton);
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, at);
    REQUIRE(w.view().tools().busy());
    const double lightly = pressed(0.2), middling = pressed(0.5), hard = pressed(0.9), nothing = pressed(0.0);
    CHECK(nothing < 0.1 * lightly);
    CHECK(lightly > 1e-4);
    CHECK(middling > 1.3 * lightly);
    CHECK(hard > 1.1 * middling);
    tell(QEvent::TabletRelease, 0.0, Qt::LeftButton, Qt::NoButton);
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, at);
    w.settle();
    CHECK(!w.view().tools().busy());
    CHECK(w.now().touches.empty());
    // A mouse presses as a pen does by the half.
    QTest::mousePress(&w.view(), Qt::LeftButton, {}, at);
    w.settle();
    CHECK(steadyDepth() == doctest::Approx(middling).epsilon(0.02));
    QTest::mouseRelease(&w.view(), Qt::LeftButton, {}, at);
}
