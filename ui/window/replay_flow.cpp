// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/replay_flow.h"

#include <QFile>
#include <QFileInfo>
#include <algorithm>

#include "ui/models/texts.h"
#include "ui/window/file_flow.h"
#include "ui/window/step_flow.h"

namespace imomushi {
namespace {

constexpr int kWholeMs = 25000, kLongestMs = 500, kShortestMs = 80;  // of all pauses between steps; of one

}  // namespace

ReplayFlow::ReplayFlow(StudioDocument& document, FileFlow& files, StepFlow& steps, QObject* parent) : QObject(parent), document_(document), files_(files), steps_(steps) {
    timer_.setSingleShot(true);
    connect(&timer_, &QTimer::timeout, this, &ReplayFlow::next);
    // Another document comes, or the artist cancelled what was being done.
    connect(&files, &FileFlow::leaving, this, &ReplayFlow::stop);
    connect(&steps, &StepFlow::cancelled, this, &ReplayFlow::stop);
}

bool ReplayFlow::start(const QString& title, const QString& script) {
    QFile file(script);
    if (!file.open(QIODevice::ReadOnly)) return false;
    const std::string folder = QFileInfo(script).absolutePath().toStdString() + '/';
    std::vector<Json> commands;
    bool precomputes = false;
    while (!file.atEnd()) {
        Json command = Json::parse(file.readLine().toStdString(), nullptr, false);
        if (!command.is_object()) continue;  // a remark
        const std::string name = command.value("do", "");
        precomputes = precomputes || name == "precompute";
        if (name == "new" || name == "save" || name == "precompute") continue;  // an empty project it is already, and where it is kept the artist says
        if (command.contains("path")) command["path"] = folder + command["path"].get<std::string>();
        commands.push_back(std::move(command));
    }
    if (commands.empty() || !files_.newProject()) return false;
    title_ = title;
    commands_ = std::move(commands);
    precomputes_ = precomputes;
    done_ = 0;
    running_ = true;
    paused_ = waiting_ = false;
    Q_EMIT changed();
    next();
    return true;
}

QString ReplayFlow::last() const {
    const auto& steps = document_.session().steps();
    const auto position = std::size_t(document_.session().position());
    return done_ > 0 && position > 0 && position <= steps.size() ? stepText(steps[position - 1].name, steps[position - 1].subject) : QString();
}

void ReplayFlow::setPaused(bool paused) {
    if (!running_ || paused == paused_) return;
    paused_ = paused;
    timer_.stop();
    if (!paused && !waiting_) next();
    Q_EMIT changed();
}

void ReplayFlow::stop() {
    if (!running_) return;
    running_ = waiting_ = false;
    timer_.stop();
    Q_EMIT changed();
}

void ReplayFlow::next() {
    if (!running_ || paused_ || waiting_) return;
    if (done_ == count()) return finish();
    const Json command = commands_[std::size_t(done_)];
    waiting_ = true;
    const std::size_t before = document_.document().elements.size();
    const auto refused = std::make_shared<QMetaObject::Connection>();
    // What is refused, because the artist changed what it needs, ends it: the document said why.
    *refused = connect(&steps_, &StepFlow::changed, this, [this, refused, at = done_] {
        if (steps_.running()) return;
        disconnect(*refused);
        if (running_ && waiting_ && done_ == at) stop();
    });
    steps_.start({command, tr("Building “%1”").arg(title_), [this, before](const Json&) {
        if (!running_) return;
        waiting_ = false;
        ++done_;
        if (document_.document().elements.size() != before) Q_EMIT built();
        Q_EMIT changed();
        if (!paused_) timer_.start(pace_ >= 0 ? pace_ : std::clamp(kWholeMs / count(), kShortestMs, kLongestMs));
    }});
}

void ReplayFlow::finish() {
    stop();
    if (precomputes_) Q_EMIT precomputeWanted();
    Q_EMIT ended(title_);
}

}  // namespace imomushi
