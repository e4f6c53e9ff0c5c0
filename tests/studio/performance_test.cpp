// SPDX-License-Identifier: GPL-3.0-or-later
// A performance goes on whatever the window does, and costs nothing at rest.
#include <QElapsedTimer>
#include <QFileDialog>
#include <QLabel>
#include <QMenu>
#include <QMenuBar>
#include <QSignalSpy>
#include <QThread>

#include "core/document/take.h"
#include "tests/studio/window.h"
#include "tests/support/osc_bytes.h"
#include "tests/support/udp_sender.h"
#include "ui/window/status_strip.h"

using namespace imomushi;

namespace {

constexpr int kAwayMs = 2000;

/// The caterpillar, soft and at rest.
struct PerformanceWindow : Window {
    PerformanceWindow() : Window({1280, 800}) {
        open(samples()[0].path);
        untilStill();
    }
    [[nodiscard]] Session::Performed performed() { return *document().session().performed(); }
    std::string lastEnd() { return now().bones.rbegin()->second->name + "/end"; }
    /// Neither steps nor pictures come any more.
    void untilStill() {
        QSignalSpy steps(&document(), &StudioDocument::frameStepped), pictures(&view(), &ViewportWidget::frameMeasured);
        waitFor([&] {
            steps.clear();
            pictures.clear();
            return stays([&] { return steps.isEmpty() && pictures.isEmpty(); }) && !document().session().moving();
        });
    }
    /// Records while something is done: as many steps as its time has, one rate apart.
    void checkRecords(const std::string& take, const std::function<void()>& meanwhile) {
        CAPTURE(take);
        const double rate = now().settings.rate;
        const auto seconds = [](const QElapsedTimer& since) { return 1e-9 * double(since.nsecsElapsed()); };
        QElapsedTimer outer, inner;
        outer.start();
        const double leftOuter = performed().leftOut;
        run({{"do", "record"}, {"take", take}, {"action", "start"}});
        inner.start();
        const double leftInner = performed().leftOut;
        meanwhile();
        const double least = seconds(inner), leftLeast = performed().leftOut - leftInner;
        run({{"do", "record"}, {"take", take}, {"action", "stop"}});
        const double most = seconds(outer), leftMost = performed().leftOut - leftOuter;
        const Take& made = *now().takeNamed(take);
        const int steps = int(made.times.size());
        MESSAGE(take << ": " << steps << " steps in " << least << " to " << most << " s, " << leftMost << " s left out");
        CHECK(least >= 1e-3 * kAwayMs);
        CHECK(steps >= rate * (least - leftMost) - 2.0);
        CHECK(steps <= rate * (most - leftLeast) + 2.0);
        for (std::size_t f = 1; f < made.times.size(); ++f) CHECK(made.times[f] - made.times[f - 1] == doctest::Approx(1.0 / rate).epsilon(1e-9));
    }
};

}  // namespace

TEST_CASE("performance: steps are made in time and the recorded take is whole while the window is blocked or hidden, and while a menu or a file dialog is open") {
    PerformanceWindow w;
    w.checkRecords("blocked", [] { QThread::msleep(kAwayMs); });
    w.checkRecords("hidden", [&] {
        w.window().hide();
        QTest::qWait(kAwayMs);
        CHECK(!w.view().isVisible());
    });
    w.window().show();
    w.activate();
    w.checkRecords("menu", [&] {
        QMenu* menu = w.window().menuBar()->actions().front()->menu();
        REQUIRE(menu);
        menu->popup(w.window().mapToGlobal(QPoint(20, 20)));
        QTest::qWait(kAwayMs);
        CHECK(menu->isVisible());
        menu->close();
    });
    bool asked = false;
    w.checkRecords("dialog", [&] {
        whenModal<QFileDialog>([&](QFileDialog* dialog) {
            QTest::qWait(kAwayMs);
            asked = true;
            dialog->reject();
        });
        w.shared->actions()["save-as"]->trigger();
        waitFor([&] { return asked; });
    });
    // What the window does not look at is what it shows afterwards.
    w.untilStill();
}

TEST_CASE("performance: at rest there are no steps and no pictures in ten seconds, with an open source too; its next packet moves the character") {
    PerformanceWindow w;
    w.run({{"do", "drag"}, {"endpoint", w.lastEnd()}, {"to", {0.3, 0.4, 0.5}}});
    InputDeck& inputs = w.window().inputs();
    inputs.setPort(0, 0);
    inputs.setOn(0, true);
    REQUIRE(inputs.sources()[0].on);
    UdpSender sender(std::uint16_t(inputs.sources()[0].port));
    const EndpointRef end{w.now().bones.rbegin()->first, true};
    const std::string address = "/imomushi/bone/" + w.now().bones.rbegin()->second->name + "/end/position";
    const auto place = [&] { return *w.document().session().positionOf(end); };
    const auto say = [&](const Vec3& to) { sender.send(oscBytes(address, {float(to.x()), float(to.y()), float(to.z())})); };
    // It is taken hold of by the first packet.
    const Vec3 first = place() + Vec3(0.0, 0.05, 0.0);
    say(first);
    waitFor([&] { return inputs.sources()[0].heard.counts.packets == 1 && (place() - first).norm() < 1e-3; });
    w.untilStill();
    QSignalSpy steps(&w.document(), &StudioDocument::frameStepped), pictures(&w.view(), &ViewportWidget::frameMeasured);
    const auto before = w.performed().step;
    QTest::qWait(10'000);
    CHECK(steps.isEmpty());
    CHECK(pictures.isEmpty());
    CHECK(w.performed().step == before);
    const Vec3 was = place();
    say(first + Vec3(0.0, 0.05, 0.0));
    waitFor([&] { return (place() - was).norm() > 1e-3; });
    CHECK(w.performed().step > before);
    waitFor([&] { return !pictures.isEmpty(); });
    w.untilStill();
}

TEST_CASE("performance: of steps that take longer than their time the status bar says how slow they are") {
    PerformanceWindow w;
    const auto* strip = w.window().findChild<StatusStrip*>();
    const auto slowed = [&] {
        for (const QLabel* label : strip->findChildren<QLabel*>())
            if (const qsizetype at = label->text().indexOf(QStringLiteral("slowed to ")); at >= 0 && label->isVisible()) return label->text().mid(at + 10).section(u' ', 0, 0).toInt();
        return -1;
    };
    CHECK(slowed() == -1);
    // Each step takes three times its time at least.
    StudioDocument& document = w.document();
    const double stepMs = 1e3 / w.now().settings.rate;
    const_cast<Session&>(document.session()).perform([&document, stepMs] {
        QThread::usleep(static_cast<unsigned long>(3e3 * stepMs));
        QMetaObject::invokeMethod(&document, [&document] { document.performInputs(nullptr); }, Qt::QueuedConnection);  // which looks at what was stepped
    });
    w.run({{"do", "record"}, {"take", "slow"}, {"action", "start"}});
    waitFor([&] { return slowed() > 0 && slowed() <= 34; });
    MESSAGE("slowed to " << slowed() << " %");
    CHECK(document.pace() <= 0.34);
    w.run({{"do", "record"}, {"take", "slow"}, {"action", "stop"}});
    // The performance is slower, the take is not.
    const Take& take = *w.now().takeNamed("slow");
    REQUIRE(take.times.size() > 3);
    for (std::size_t f = 1; f < take.times.size(); ++f) CHECK(take.times[f] - take.times[f - 1] == doctest::Approx(1e-3 * stepMs).epsilon(1e-9));
    document.perform();
    w.untilStill();
    // In time again: nothing is said.
    w.run({{"do", "record"}, {"take", "fast"}, {"action", "start"}});
    waitFor([&] { return slowed() == -1; });
    w.run({{"do", "record"}, {"take", "fast"}, {"action", "stop"}});
}
