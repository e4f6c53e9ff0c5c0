// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/clipboard_flow.h"

#include <QClipboard>
#include <QDateTime>
#include <QDir>
#include <QGuiApplication>
#include <QMimeData>
#include <QStandardPaths>
#include <algorithm>

#include "ui/models/commands.h"
#include "ui/models/selection_commands.h"
#include "ui/models/texts.h"
#include "ui/tools/select_tool.h"
#include "ui/window/step_flow.h"

namespace imomushi {
namespace {

constexpr int kFilesKept = 4;                        // of elements that were copied: what is pasted late is still there
constexpr qsizetype kMostBytes = qsizetype{64} << 20;  // of a clipboard that is read

/// Where copied elements go next; old ones go.
QString nextFile() {
    QDir folder(QStandardPaths::writableLocation(QStandardPaths::CacheLocation) + QStringLiteral("/clipboard"));
    folder.mkpath(QStringLiteral("."));
    const QStringList files = folder.entryList({QStringLiteral("copied-*.imomushi")}, QDir::Files, QDir::Name | QDir::Reversed);
    for (qsizetype i = kFilesKept - 1; i < files.size(); ++i) folder.remove(files[i]);
    return folder.filePath(QStringLiteral("copied-%1-%2.imomushi").arg(QDateTime::currentMSecsSinceEpoch()).arg(QCoreApplication::applicationPid()));
}

}  // namespace

ClipboardFlow::ClipboardFlow(StudioDocument& document, StepFlow& steps, QObject* parent) : QObject(parent), document_(document), steps_(steps) {
    connect(QGuiApplication::clipboard(), &QClipboard::dataChanged, this, &ClipboardFlow::look);
    look();
}

// Asked once for each content: other programs may take their time to answer.
void ClipboardFlow::look() {
    const QMimeData* data = QGuiApplication::clipboard()->mimeData();
    canPaste_ = data && data->hasFormat(QLatin1String(kMime));
    Q_EMIT changed();
}

bool ClipboardFlow::copy(const std::vector<std::string>& names) {
    const auto answer = document_.execute(commands::copy(names, nextFile().toStdString()));
    if (!answer) return false;
    auto* data = new QMimeData;
    data->setData(QLatin1String(kMime), QByteArray::fromStdString(Json{{"commands", answer->at("commands")}}.dump(-1, ' ', false, Json::error_handler_t::replace)));
    QGuiApplication::clipboard()->setMimeData(data);
    return true;
}

void ClipboardFlow::copySelected() {
    const std::vector<std::string> names = copiedNames(document_);
    if (copy(names)) Q_EMIT said(names.size() == 1 ? tr("Copied “%1”").arg(QString::fromStdString(names.front())) : tr("Copied %n part(s)", nullptr, int(names.size())));
}

void ClipboardFlow::cutSelected() {
    if (copy(copiedNames(document_))) removeSelection(document_);
}

void ClipboardFlow::paste() {
    const QMimeData* data = QGuiApplication::clipboard()->mimeData();
    if (!data || !data->hasFormat(QLatin1String(kMime))) return Q_EMIT warned(tr("Nothing was copied yet."));
    const QByteArray bytes = data->data(QLatin1String(kMime));
    const Json content = bytes.size() > kMostBytes ? Json() : Json::parse(bytes.begin(), bytes.end(), nullptr, false);
    if (!content.is_object() || !content.contains("commands") || !content["commands"].is_array()) return Q_EMIT warned(tr("What was copied cannot be read: copy it once more."));
    const Json& lines = content["commands"];
    const Json command = commands::paste(lines, pastedOnto(document_));
    // Cuts take their time.
    const bool slow = std::any_of(lines.begin(), lines.end(), [](const Json& line) { return line.is_object() && line.contains("do") && line["do"] == "cut"; });
    if (slow) return steps_.start({command, tr("Pasting"), [this](const Json& answer) { pasted(answer); }});
    if (const auto answer = document_.execute(command)) pasted(*answer);
}

void ClipboardFlow::pasted(const Json& answer) {
    const auto any = [&](const char* list) { return !answer.at(list).empty(); };
    if (any("elements") || any("characters") || any("bones") || any("handles") || any("faces") || any("cuts")) selectCopies(document_, answer);
    const Json& left = answer.at("not_pasted");
    if (left.empty()) return Q_EMIT said(tr("Pasted"));
    const QString why = errorText({left[0].at("code").get<std::string>(), left[0].at("why").get<std::string>()}), name = QString::fromStdString(left[0].at("name").get<std::string>());
    Q_EMIT warned(left.size() == 1 ? tr("Pasted, but for “%1”: %2").arg(name, why) : tr("Pasted, but for %1 parts. “%2”: %3").arg(left.size()).arg(name, why));
}

}  // namespace imomushi
