// SPDX-License-Identifier: GPL-3.0-or-later
// Every view of the studio in both languages, dark and light, at 100 and 150 %, in a small window and a large one. Words that are cut off fail the case; the rest is for eyes:
//   IMOMUSHI_SCREENSHOTS=FOLDER xvfb-run -a -s "-screen 0 1600x1000x24" build/tests/test_studio -nv --no-skip -tc="looks: *"
// A window that the display has no room for is left out, so that a small display shows dialogs as a small screen does: xvfb-run -a -s "-screen 0 1280x720x24" ...
// ctest leaves it out: it takes some minutes, and its pictures are of use only when somebody looks at them.
#include <QDockWidget>
#include <QLineEdit>

#include "tests/studio/window.h"
#include "tests/support/capsules.h"
#include "ui/dialogs/export_dialog.h"
#include "ui/dialogs/help_dialogs.h"
#include "ui/dialogs/place_dialog.h"
#include "ui/dialogs/preferences_dialog.h"
#include "ui/panels/live/live_panel.h"
#include "ui/panels/live/mapping_view.h"
#include "ui/panels/takes_panel.h"
#include "ui/window/command_search.h"

using namespace imomushi;

namespace {

/// One look of the studio.
struct Look {
    QString language;
    Appearance::Theme theme;
    double scale;
    QSize size;
    [[nodiscard]] QString name() const {
        return QStringLiteral("%1-%2-%3-%4").arg(language, theme == Appearance::Theme::Dark ? QStringLiteral("dark") : QStringLiteral("light")).arg(int(100 * scale)).arg(size.width());
    }
};

/// What is seen of the window, kept as a picture; words that are cut off are told.
void keep(Window& w, const Look& look, const char* view, const QWidget& words) {
    w.settle();
    CHECK_MESSAGE(QTest::qWaitFor([&] { return cutOff(words) == ""; }, 2000), look.name().toStdString(), " ", view, ": ", cutOff(words));
    const QString to = qEnvironmentVariable("IMOMUSHI_SCREENSHOTS");
    if (to.isEmpty()) return;
    QTest::qWait(300);
    const QRect at = w.window().frameGeometry();
    QGuiApplication::primaryScreen()->grabWindow(0, at.x(), at.y(), at.width(), at.height()).save(QStringLiteral("%1/%2-%3.png").arg(to, QLatin1String(view), look.name()));
}

/// Looks at all views in turn. `mesh`: a file to import.
void tour(Window& w, const Look& look, const QString& mesh) {
    Appearance& appearance = Appearance::instance();
    appearance.setScale(look.scale);
    appearance.setLanguage(look.language);
    appearance.setTheme(look.theme);
    MainWindow& window = w.window();
    window.resize(look.size);
    window.move(0, 0);
    (void)w.document().execute({{"do", "new"}});
    window.showStart(true);
    for (auto* dock : {"accuracyDock", "takesDock"}) window.findChild<QDockWidget*>(QLatin1String(dock))->hide();
    keep(w, look, "start", window);

    w.open(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/samples/dragon.imomushi"));
    w.look(Vec3(0.55, 0.3, 1.0));
    w.document().select({{SelectionItem::Kind::Element, w.now().elements.begin()->first, {}, false}});
    keep(w, look, "selection", window);
    const auto panel = [&](const char* dock, const char* view) {
        auto* d = window.findChild<QDockWidget*>(QLatin1String(dock));
        REQUIRE(d);
        d->show();
        d->raise();
        keep(w, look, view, *d);
    };
    w.run({{"do", "enable"}, {"effect", "bone-dynamics"}});
    panel("effectsDock", "effects");
    panel("accuracyDock", "accuracy");
    panel("takesDock", "takes");
    w.run({{"do", "suggest-mappings"}, {"protocol", "keys"}});
    window.live().view()->choose(0);
    panel("liveDock", "live");

    w.trigger("export");
    auto* exporting = window.findChild<ExportDialog*>();
    REQUIRE(exporting);
    exporting->setPath(QStringLiteral("/home/me/dragon.glb"));
    keep(w, look, "export", *exporting);
    exporting->reject();

    window.files().import({mesh});
    auto* import = window.findChild<ImportDialog*>();
    REQUIRE(import);
    waitFor([&] { return import->findChild<QPushButton*>(QStringLiteral("importButton"))->isEnabled(); });
    keep(w, look, "import", *import);
    import->reject();

    w.trigger("place-bone");
    auto* placing = window.findChild<PlaceDialog*>();
    REQUIRE(placing);
    keep(w, look, "place", *placing);
    placing->reject();

    PreferencesDialog preferences(window.actions(), &window);
    preferences.show();
    keep(w, look, "preferences", preferences);
    preferences.reject();
    ControlsDialog keys(window.actions(), true, &window);
    keys.show();
    keep(w, look, "keys", keys);
    keys.reject();

    w.activate();
    w.trigger("search");
    auto* search = window.findChild<CommandSearch*>();
    REQUIRE(search);
    QTest::keyClicks(search->findChild<QLineEdit*>(), QStringLiteral("e"));
    keep(w, look, "search", *search);
    QTest::keyClick(search->findChild<QLineEdit*>(), Qt::Key_Escape);
    w.settle();
}

}  // namespace

TEST_CASE("looks: every view in both languages, themes, sizes of letters and of the window" * doctest::skip()) {
    Window w;
    const QString mesh = writeMesh(w.folder.filePath(QStringLiteral("star.obj")), capsules::starfish());
    for (const char* language : {"en", "ja"})
        for (const Appearance::Theme theme : {Appearance::Theme::Dark, Appearance::Theme::Light})
            for (const double scale : {1.0, 1.5})
                for (const QSize size : {QSize(1280, 720), QSize(1600, 1000)})
                    if (size == size.boundedTo(QGuiApplication::primaryScreen()->size())) tour(w, {QLatin1String(language), theme, scale, size}, mesh);
}
