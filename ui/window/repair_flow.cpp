// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/repair_flow.h"

#include <QTimer>
#include <utility>

#include "ui/models/body_texts.h"
#include "ui/window/file_flow.h"

namespace imomushi {
namespace {

constexpr int kUntilLetGoMs = 150;  // asks again whether a gesture is over

}  // namespace

RepairFlow::RepairFlow(StudioDocument& document, FileFlow& files, QObject* parent) : QObject(parent), document_(document), files_(files) {
    connect(&job_, &BackgroundJob::finished, this, [this](bool completed) {
        if (completed) return finish();
        waiting_.clear();
        Q_EMIT unchanged(tr("Repair cancelled"));
    });
}

QString RepairFlow::subject() const { return waiting_.empty() ? QString() : QString::fromStdString(waiting_.front().at("element").get<std::string>()); }

void RepairFlow::start(std::vector<Json> commands) {
    if (job_.running()) return;
    waiting_ = std::move(commands);
    next();
}

void RepairFlow::cancel() { job_.cancel(); }

void RepairFlow::next() {
    if (!waiting_.empty()) job_.start(document_.document(), waiting_.front());
}

void RepairFlow::finish() {
    if (document_.inGesture()) return QTimer::singleShot(kUntilLetGoMs, this, &RepairFlow::finish);
    const QString name = subject();
    const auto answer = files_.executeWith(job_.bodies(), waiting_.front());
    if (!answer) {
        waiting_.clear();
        return;
    }
    waiting_.erase(waiting_.begin());
    const int before = int(answer->at("before").size()), after = int(answer->at("after").size());
    if (answer->at("done").empty()) {
        Q_EMIT unchanged(tr("“%1” has nothing that can be repaired.").arg(name));
    } else {
        QString text = tr("“%1”: %2 before, %3 after.").arg(name, tr("%n issue(s)", nullptr, before), after > 0 ? tr("%n", "issues that are left", after) : tr("none"));
        const CharacterSource* character = document_.document().characterNamed(answer->at("character").get<std::string>());
        if (character && !answer->at("stale").empty()) text += u' ' + tr("The body: %1.").arg(bodyKindText(character->body->report.how));
        Q_EMIT repaired(text);
    }
    next();
}

}  // namespace imomushi
