// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <doctest/doctest.h>

#include <QApplication>
#include <QCursor>
#include <QDialog>
#include <QFile>
#include <QImage>
#include <QLabel>
#include <QPushButton>
#include <QScreen>
#include <QTemporaryDir>
#include <QTest>
#include <QTextStream>
#include <QTimer>
#include <QToolButton>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "core/commands/core_commands.h"
#include "core/reports/report_commands.h"
#include "ui/dialogs/import_dialog.h"
#include "ui/models/input_deck.h"
#include "ui/panels/accuracy/accuracy_panel.h"
#include "ui/panels/inspector/inspector_panel.h"
#include "ui/viewport/viewport_widget.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/elided_label.h"
#include "ui/window/file_flow.h"
#include "ui/window/main_window.h"
#include "ui/window/message_bar.h"
#include "ui/window/step_flow.h"
#include "ui/window/studio_actions.h"

namespace imomushi {

constexpr int kWaitMs = 120000;  ///< for what must happen: many times what it takes on a busy machine
constexpr int kFrameMs = 40;    ///< two frames of the view, so that one at least was stepped

/// Waits until `condition` holds; the case ends where it never does.
template <class Condition>
void waitFor(Condition condition, int ms = kWaitMs) {
    REQUIRE(QTest::qWaitFor(condition, ms));
}
/// Nothing of what would break `condition` happens in the time of many frames.
template <class Condition>
bool stays(Condition condition) {
    return !QTest::qWaitFor([&] { return !condition(); }, 10 * kFrameMs);
}

/// Acts on the modal dialog that is opened next: by a timer, as the call that opens it returns when it closes.
template <class Dialog>
void whenModal(std::function<void(Dialog*)> act) {
    auto* timer = new QTimer(qApp);
    QObject::connect(timer, &QTimer::timeout, timer, [timer, act] {
        auto* dialog = qobject_cast<Dialog*>(QApplication::activeModalWidget());
        if (!dialog || !dialog->isVisible()) return;
        timer->deleteLater();
        timer->stop();
        act(dialog);
    });
    timer->start(kFrameMs);
}

/// Labels and buttons in `root` that are smaller than their text; empty: none.
inline std::string cutOff(const QWidget& root) {
    QString found;
    for (const QWidget* widget : root.findChildren<QWidget*>()) {
        if (!widget->isVisible()) continue;
        QString text;
        QSize needed;
        if (qobject_cast<const ElidedLabel*>(widget)) continue;  // it says by an ellipsis that there is more
        if (const auto* label = qobject_cast<const QLabel*>(widget)) {
            text = label->text();
            needed = label->wordWrap() ? QSize(0, label->heightForWidth(label->width())) : label->sizeHint();
        } else if (const auto* button = qobject_cast<const QAbstractButton*>(widget)) {
            text = button->text();
            needed = button->minimumSizeHint();
            if (button->hasHeightForWidth()) needed.setHeight(button->heightForWidth(button->width()));
            const auto* tool = qobject_cast<const QToolButton*>(button);
            if (tool && tool->toolButtonStyle() == Qt::ToolButtonIconOnly) text.clear();
        }
        if (!text.isEmpty() && (widget->width() < needed.width() || widget->height() < needed.height()))
            found += QStringLiteral("\"%1\" needs %2 x %3 and has %4 x %5; ").arg(text).arg(needed.width()).arg(needed.height()).arg(widget->width()).arg(widget->height());
    }
    return found.toStdString();
}
/// Labels in `root` whose picture has less contrast between its lightest and darkest pixel than WCAG 2.1 asks of large print and controls (3 to 1); empty: none.
inline std::string pale(QWidget& root) {
    QString found;
    const QImage picture = root.grab().toImage();
    const auto luminance = [](const QColor& c) {
        const auto linear = [](double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); };
        return 0.2126 * linear(c.redF()) + 0.7152 * linear(c.greenF()) + 0.0722 * linear(c.blueF());
    };
    for (const QLabel* label : root.findChildren<QLabel*>()) {
        if (!label->isVisible() || !label->isEnabled() || label->text().isEmpty()) continue;
        if (label->visibleRegion() != QRegion(label->rect())) continue;  // scrolled away, or partly
        const QRect seen = label->rect().translated(label->mapTo(&root, QPoint())).intersected(picture.rect());
        double darkest = 1.0, lightest = 0.0;
        for (int y = seen.top(); y <= seen.bottom(); ++y)
            for (int x = seen.left(); x <= seen.right(); ++x) {
                const double l = luminance(picture.pixelColor(x, y));
                darkest = std::min(darkest, l);
                lightest = std::max(lightest, l);
            }
        const double contrast = (lightest + 0.05) / (darkest + 0.05);
        if (contrast < 3.0) found += QStringLiteral("\"%1\" %2; ").arg(label->text()).arg(contrast);
    }
    return found.toStdString();
}

/// The one window that the cases of a file share: made for its first case, and gone when another file begins. After each case it is put back as it was at first.
class SharedStudio {
public:
    static SharedStudio& instance() {
        static SharedStudio studio;
        return studio;
    }
    MainWindow& open(const std::string& file, QSize size) {
        if (file != file_) close();
        file_ = file;
        if (!made_) {
            made_ = std::make_unique<MainWindow>(registry_);
            made_->resize(size);
            made_->move(10, 10);
            // The pointer of the display would move over the view whenever a dialog closes, with no button down.
            QCursor::setPos(1599, 999);
            made_->show();
            REQUIRE(QTest::qWaitForWindowExposed(made_.get()));
            docks_ = made_->saveState();
        }
        made_->resize(size);
        made_->show();
        return *made_;
    }
    void putBack() {
        if (!made_) return;
        MainWindow& w = *made_;
        w.viewport().tools().cancel();
        for (auto* dialog : w.findChildren<QDialog*>()) dialog->reject();
        w.precompute().job().cancel();
        w.steps().cancel();
        w.accuracy().job().cancel();
        w.deck().stopRecording();
        w.deck().setPlaying(false);
        w.deck().leave();
        w.inputs().closePorts();
        (void)w.document().execute({{"do", "new"}});
        for (const char* off : {"stage", "loop", "count-in", "orthographic", "bodies", "xray", "soft-at-once", "passing-handles", "snap"})
            if (w.actions()[off]->isChecked()) w.actions()[off]->trigger();
        for (const char* on : {"bones", "grid"})
            if (!w.actions()[on]->isChecked()) w.actions()[on]->trigger();
        w.viewport().tools().setTool(ToolKind::Select);
        w.viewport().cameraController() = CameraController();
        w.viewport().cameraController().setViewport(w.viewport().width(), w.viewport().height());
        w.messages().hide();
        Appearance& appearance = Appearance::instance();
        appearance.setTheme(Appearance::Theme::Dark);
        appearance.setLanguage(QStringLiteral("en"));
        appearance.setScale(1.0);
        QCoreApplication::processEvents();  // docks follow the scale
        w.restoreState(docks_);
        w.showStart(true);
        QCoreApplication::processEvents();
    }
    void close() { made_.reset(); }

private:
    SharedStudio() { addCoreCommands(registry_); addReportCommands(registry_); }
    CommandRegistry registry_;
    std::string file_;
    std::unique_ptr<MainWindow> made_;
    QByteArray docks_;
};

/// One case with the studio's window on the display of the test, empty at first, and a folder to write into.
struct Window {
    QTemporaryDir folder;
    MainWindow* shared;

    explicit Window(QSize size = {1560, 960}, const char* file = __builtin_FILE()) : shared(&SharedStudio::instance().open(file, size)) { activate(); }
    ~Window() { SharedStudio::instance().putBack(); }
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Ends the studio in mid-case, as quitting it does; the next Window is a new one.
    void end() {
        SharedStudio::instance().close();
        shared = nullptr;
    }
    /// No window manager gives the focus back when a dialog or a list closes.
    void activate() {
        shared->activateWindow();
        REQUIRE(QTest::qWaitForWindowActive(shared));
        settle();
    }

    MainWindow& window() { return *shared; }
    StudioDocument& document() { return shared->document(); }
    const Document& now() { return shared->document().document(); }
    ViewportWidget& view() { return shared->viewport(); }
    /// Lets the display, the queue and one frame of the view have their turn.
    void settle() {
        QCursor::pos();  // asks the display: what it had to tell before has arrived then
        QTest::qWait(kFrameMs);
        for (int round = 0; round < 4; ++round) QCoreApplication::processEvents();
    }
    /// Until the camera stands where it is going.
    void cameraStands() {
        settle();
        waitFor([&] { return !view().cameraController().moving(); });
        settle();
    }

    void run(const Json& command) {
        const auto answer = document().execute(command);
        REQUIRE_MESSAGE(answer.has_value(), (answer ? "" : answer.error().message));
    }
    void trigger(const char* action) {
        QAction* a = shared->actions()[action];
        REQUIRE_MESSAGE(a->isEnabled(), action);
        a->trigger();
        settle();
    }
    /// Imports a mesh through the dialog, as a person does.
    void import(const QString& path) {
        shared->files().import({path});
        auto* dialog = shared->findChild<ImportDialog*>();
        REQUIRE(dialog);
        auto* button = dialog->findChild<QPushButton*>(QStringLiteral("importButton"));
        waitFor([&] { return button->isEnabled(); });
        shoot("import");
        QTest::mouseClick(button, Qt::LeftButton);
        waitFor([&] { return !shared->steps().running(); });  // making it soft
        cameraStands();  // it frames what came
        activate();
    }
    /// Opens a project, as the start page does.
    void open(const QString& path) {
        shared->files().open(path);
        waitFor([&] { return !shared->startShown() && view().isVisible(); });
        cameraStands();
    }
    QPoint onScreen(const Vec3& p) {
        const auto at = view().onScreen(p);
        REQUIRE(at.has_value());
        const QPoint pixel = at->toPoint();
        REQUIRE(view().rect().contains(pixel));
        return pixel;
    }
    void click(QPoint at, Qt::KeyboardModifiers keys = {}) {
        QTest::mouseMove(&view(), at);
        settle();
        QTest::mouseClick(&view(), Qt::LeftButton, keys, at);
        settle();
    }
    void look(const Vec3& from) {
        view().cameraController().setDirection(-from, false);
        view().frameAll(false);
        settle();
    }
    /// Keeps a picture of the screen where IMOMUSHI_SCREENSHOTS names a folder.
    void shoot(const char* name) {
        const QString to = qEnvironmentVariable("IMOMUSHI_SCREENSHOTS");
        if (to.isEmpty()) return;
        QTest::qWait(300);  // without a graphics card edges are smooth a little later
        QGuiApplication::primaryScreen()->grabWindow(0).save(to + u'/' + QLatin1String(name) + QStringLiteral(".png"));
    }
};

/// Writes positions and triangles as an OBJ file; its path.
inline QString writeMesh(const QString& path, const TriangleMesh& mesh) {
    QFile file(path);
    REQUIRE(file.open(QIODevice::WriteOnly));
    QTextStream out(&file);
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) out << "v " << mesh.vertices(v, 0) << ' ' << mesh.vertices(v, 1) << ' ' << mesh.vertices(v, 2) << '\n';
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) out << "f " << mesh.triangles(t, 0) + 1 << ' ' << mesh.triangles(t, 1) + 1 << ' ' << mesh.triangles(t, 2) + 1 << '\n';
    return path;
}

/// The field of a row of the inspector that is seen, null: there is no such row. Facts have their value in their names.
template <class Field>
Field* inspectorRow(Window& w, const char* label) {
    for (QWidget* panel : w.window().findChildren<InspectorPanel*>())
        for (auto* field : panel->findChildren<Field*>())
            if (const QString name = field->accessibleName(); field->isVisible() && (name == QLatin1String(label) || name.startsWith(QLatin1String(label) + QStringLiteral(": ")))) return field;
    return nullptr;
}

}  // namespace imomushi
