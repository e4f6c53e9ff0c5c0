// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/jobs/file_job.h"

#include <QCoreApplication>
#include <QCursor>
#include <QEvent>
#include <QEventLoop>
#include <QGuiApplication>
#include <algorithm>
#include <utility>

#include "core/document/document_change.h"
#include "core/session/prepared_step.h"
#include "ui/models/failures.h"

namespace imomushi {
namespace {

constexpr int kToldMs = 300;

/// Nothing that a person does reaches any window while this lives.
class HeldInput : public QObject {
public:
    HeldInput() {
        QGuiApplication::setOverrideCursor(Qt::WaitCursor);
        QCoreApplication::instance()->installEventFilter(this);
    }
    ~HeldInput() override { QGuiApplication::restoreOverrideCursor(); }

protected:
    bool eventFilter(QObject*, QEvent* event) override {
        switch (event->type()) {
            case QEvent::MouseButtonPress:
            case QEvent::MouseButtonRelease:
            case QEvent::MouseButtonDblClick:
            case QEvent::MouseMove:
            case QEvent::Wheel:
            case QEvent::KeyPress:
            case QEvent::KeyRelease:
            case QEvent::ShortcutOverride:
            case QEvent::Shortcut:
            case QEvent::ContextMenu:
            case QEvent::TabletPress:
            case QEvent::TabletMove:
            case QEvent::TabletRelease:
            case QEvent::TouchBegin:
            case QEvent::TouchUpdate:
            case QEvent::TouchEnd:
            case QEvent::NativeGesture:
            case QEvent::DragEnter:
            case QEvent::DragMove:
            case QEvent::Drop: return true;
            case QEvent::Close: event->ignore(); return true;
            default: return false;
        }
    }
};

bool areSame(const Project& a, const Project& b) {
    const auto sameKey = [](const auto& x, const auto& y) { return x.first == y.first && x.second.key == y.second.key; };
    return differInPoseAtMost(a.document, b.document) && std::equal(a.responses.begin(), a.responses.end(), b.responses.begin(), b.responses.end(), sameKey);
}

}  // namespace

void FileJob::read(const CommandRegistry& registry, const std::filesystem::path& path, std::optional<std::int64_t> version) {
    path_ = path;
    version_ = version;
    struct Read {
        std::optional<Result<Project>> project;
        std::shared_ptr<const BuiltCharacter> character;
    };
    auto box = std::make_shared<Read>();
    launch(
        [box, path, version, &registry, afterwards = afterwards_](const Progress&) {
            box->project = loadProject(path, version);
            if (!*box->project) return;
            box->character = buildCharacter(registry, **box->project);
            if (afterwards) attempt([&] { afterwards((*box->project)->document); });  // without it the project is as good
        },
        [this, box] {
            read_ = std::move(box->project);
            character_ = std::move(box->character);
        });
    wait();
}

void FileJob::write(const std::filesystem::path& path, Project project, const VersionLimits& limits) {
    path_ = path;
    project_ = std::make_shared<const Project>(std::move(project));
    auto box = std::make_shared<std::optional<Result<SavedProject>>>();
    launch([box, path, limits, written = project_](const Progress&) { *box = storeProject(path, *written, limits); }, [this, box] { written_ = std::move(*box); });
    wait();
}

void FileJob::wait() {
    const HeldInput held;
    QTimer told;
    told.setSingleShot(true);
    connect(&told, &QTimer::timeout, this, &FileJob::takesTime);
    told.start(kToldMs);
    QEventLoop loop;
    while (running()) loop.processEvents(QEventLoop::WaitForMoreEvents);  // whatever becomes of those who hear that it has finished
}

std::optional<Result<Project>> FileJob::takeRead(const std::filesystem::path& path, std::optional<std::int64_t> version) {
    auto taken = std::exchange(read_, std::nullopt);
    if (path != path_ || version != version_) taken.reset();
    return taken;
}

std::optional<Result<SavedProject>> FileJob::takeWritten(const std::filesystem::path& path, const Project& now) {
    auto taken = std::exchange(written_, std::nullopt);
    const auto project = std::exchange(project_, nullptr);
    if (path != path_ || !project || !areSame(*project, now)) taken.reset();
    return taken;
}

}  // namespace imomushi
