// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of the manual that show the studio: `packaging/pictures.sh` runs these cases and keeps what they shoot. ctest leaves them out.
#include <QCheckBox>
#include <QDockWidget>

#include "tests/studio/window.h"
#include "tests/support/osc_bytes.h"
#include "tests/support/udp_sender.h"
#include "ui/dialogs/export_dialog.h"
#include "ui/panels/live/live_panel.h"
#include "ui/window/status_strip.h"

using namespace imomushi;

namespace {

constexpr int kFineMs = 2500;  ///< until what moved stands still and is drawn, without a graphics card

/// As large as the screen of the pictures, so that nothing is seen around the window.
struct Picture : Window {
    Picture() : Window(QGuiApplication::primaryScreen()->size(), __builtin_FILE()) {
        window().move(0, 0);
        view().setPictureQuality(ViewportWidget::PictureQuality::Fine);
        settle();
    }
    ~Picture() { view().setPictureQuality(ViewportWidget::PictureQuality::Fast); }  // as in all other cases
    void openSample(const char* name) { open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/%1.imomushi").arg(QLatin1String(name))); }
    /// Takes the end of a bone, draws it by so many pixels and lets go; the pointer stays there.
    void pull(const char* bone, QPoint by) {
        EndpointRef end{};
        for (const auto& [id, b] : now().bones)
            if (b->name == bone) end = {id, true};
        const QPoint from = view().onScreen(end)->toPoint();
        QTest::mouseMove(&view(), from);
        settle();
        QTest::mousePress(&view(), Qt::LeftButton, {}, from);
        for (int i = 1; i <= 8; ++i) {
            QTest::mouseMove(&view(), from + by * i / 8);
            settle();
        }
        QTest::mouseRelease(&view(), Qt::LeftButton, {}, from + by);
        QTest::qWait(kFineMs);
    }
    void shoot(const char* name) {
        settle();
        // How fast the machine of the pictures draws without a graphics card says nothing to anybody.
        for (auto* label : window().status().findChildren<QLabel*>())
            if (label->text().endsWith(QStringLiteral(" ms")) || label->text().endsWith(QStringLiteral("fps"))) label->hide();
        Window::shoot(name);
    }
    /// A picture of a widget alone, as it is on the screen.
    void shootOnly(const QWidget& widget, const char* name) {
        settle();
        QTest::qWait(kFineMs);
        const QRect at(widget.mapToGlobal(QPoint()), widget.size());
        const QString to = qEnvironmentVariable("IMOMUSHI_SCREENSHOTS");
        if (!to.isEmpty()) QGuiApplication::primaryScreen()->grabWindow(0, at.x(), at.y(), at.width(), at.height()).save(to + u'/' + QLatin1String(name) + QStringLiteral(".png"));
    }
    QDockWidget* panel(const char* dock) {
        auto* d = window().findChild<QDockWidget*>(QLatin1String(dock));
        REQUIRE(d);
        d->show();
        d->raise();
        settle();
        return d;
    }
};

}  // namespace

TEST_CASE("pictures: a character is posed" * doctest::skip()) {
    Picture w;
    w.openSample("dragon");
    w.look(Vec3(0.55, 0.3, 1.0));
    w.run({{"do", "disable"}, {"effect", "ground"}});  // of which the status would speak
    w.run({{"do", "morph"}, {"character", "dragon"}, {"target", "smile"}, {"weight", 1.0}});
    w.run({{"do", "drag"}, {"endpoint", "arm.R/end"}, {"to", {-0.62, 0.5, 0.5}}});
    w.run({{"do", "drag"}, {"endpoint", "tail.3/end"}, {"to", {0.62, 0.85, -0.85}}});
    w.run({{"do", "drag"}, {"endpoint", "head/end"}, {"to", {-0.12, 1.72, 0.27}}});
    for (const char* eye : {"eye.L", "eye.R"}) w.run({{"do", "turn-part"}, {"character", "dragon"}, {"part", eye}, {"rotation", {0.0, 0.15, 0.0, 0.9887}}});
    w.trigger("tool-pose");
    w.pull("arm.L", {-40, -200});
    w.shoot("studio");
}

TEST_CASE("pictures: a file is imported" * doctest::skip()) {
    Picture w;
    w.window().files().import({QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/dragon/dragon.glb")});
    auto* dialog = w.window().findChild<ImportDialog*>();
    REQUIRE(dialog);
    auto* soft = dialog->findChild<QCheckBox*>(QStringLiteral("makeSoft"));
    REQUIRE(soft);
    soft->setChecked(true);
    waitFor([&] { return dialog->findChild<QPushButton*>(QStringLiteral("importButton"))->isEnabled(); });
    QTest::qWait(8000);  // what it proposes follows
    w.shootOnly(*dialog, "import");
    dialog->reject();
}

TEST_CASE("pictures: bones and cuts are proposed" * doctest::skip()) {
    Picture w;
    w.run({{"do", "import-character"}, {"path", IMOMUSHI_SOURCE_DIR "/assets/samples/dragon/dragon.glb"}, {"name", "dragon"}});
    w.look(Vec3(0.55, 0.3, 1.0));
    w.trigger("propose");
    waitFor([&] { return w.view().tools().kind() == ToolKind::Proposal; });
    w.cameraStands();
    w.shootOnly(w.view(), "proposal");
    QTest::keyClick(&w.view(), Qt::Key_Escape);
    waitFor([&] { return w.view().tools().kind() == ToolKind::Select; });
}

TEST_CASE("pictures: joint faces and bones" * doctest::skip()) {
    Picture w;
    w.openSample("caterpillar");
    w.trigger("tool-face");
    w.look(Vec3(0.6, 0.35, 1.0));
    w.shootOnly(w.view(), "joints");
}

TEST_CASE("pictures: effects and their prices" * doctest::skip()) {
    Picture w;
    w.openSample("octopus");
    w.panel("effectsDock");
    w.trigger("tool-pose");
    w.look(Vec3(0.25, 0.3, 1.0));
    w.pull("arm2-tip-bone", {-60, -260});
    w.shoot("effects");
}

TEST_CASE("pictures: what accuracy costs" * doctest::skip()) {
    Picture w;
    w.openSample("caterpillar");
    // Five minutes of measuring on this machine; the panel finds what is known then.
    w.run({{"do", "accuracy"}, {"path", w.folder.filePath(QStringLiteral("accuracy.json")).toStdString()}, {"seconds", 300}});
    QDockWidget* dock = w.panel("accuracyDock");
    w.window().resizeDocks({dock}, {430}, Qt::Vertical);
    waitFor([&] { return w.window().accuracy().isVisible() && !w.window().accuracy().study().points.empty(); });
    w.shootOnly(*dock, "accuracy");
}

TEST_CASE("pictures: other programs perform" * doctest::skip()) {
    Picture w;
    w.openSample("octopus");
    w.look(Vec3(0.25, 0.3, 1.0));
    w.trigger("live-inputs");
    const auto map = [&](const char* source, const char* channel, int component, const char* target, double inLow, double low, double high, double hertz) {
        w.run({{"do", "map-input"}, {"source", source}, {"channel", channel}, {"component", component}, {"target", target}, {"in", {inLow, 1}}, {"out", {low, high}}, {"hertz", hertz}});
    };
    map("osc", "/xy/1", 0, "bone/arm2-tip-bone/end/x", 0, -0.1, 0.4, 0);
    map("osc", "/xy/1", 1, "bone/arm2-tip-bone/end/y", 0, 0, 0.9, 0);
    map("osc", "/fader/1", 0, "bone/mantle-bone/end/y", 0, 0, 0.25, 2);
    map("vmc", "bone/LeftUpperArm", 7, "bone/arm8-tip-bone/turn-x", -1, -0.8, 0.8, 4);
    map("osc", "/fader/2", 0, "bone/mantle-bone/end/y", 0, 0, 0.2, 0);
    InputDeck& inputs = w.window().inputs();
    inputs.setOn(0, true);
    REQUIRE(inputs.sources()[0].on);
    const UdpSender sender(std::uint16_t(inputs.sources()[0].port));
    w.window().live().view()->choose(2);
    for (int i = 0; i < 150; ++i) {
        sender.send(oscBytes("/xy/1", {0.62F, 0.8F}));
        sender.send(oscBytes("/fader/1", {0.45F}));
        QTest::qWait(20);
    }
    w.shoot("live");
    inputs.closePorts();
}

TEST_CASE("pictures: a take is exported" * doctest::skip()) {
    Picture w;
    w.openSample("dragon");
    w.trigger("export");
    auto* dialog = w.window().findChild<ExportDialog*>();
    REQUIRE(dialog);
    REQUIRE(QTest::qWaitForWindowExposed(dialog));
    dialog->setPath(QStringLiteral("/home/me/dragon.glb"));
    w.shootOnly(*dialog, "export");
    dialog->reject();
}
