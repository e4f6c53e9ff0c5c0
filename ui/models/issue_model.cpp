// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/issue_model.h"

#include <algorithm>

#include "core/body/repair.h"
#include "core/reduction/element_response.h"
#include "ui/models/body_texts.h"
#include "ui/models/commands.h"
#include "ui/models/texts.h"

namespace imomushi {

IssueModel::IssueModel(StudioDocument& document, QObject* parent) : QAbstractListModel(parent), document_(document) {
    connect(&document, &StudioDocument::structureChanged, this, [this](const DocumentChange& change) {
        if (change.forResponses() || change.has(&DocumentChange::characters)) rebuild();
    });
    connect(&document, &StudioDocument::fileChanged, this, &IssueModel::rebuild);
    connect(&document, &StudioDocument::responsesChanged, this, &IssueModel::rebuild);
    rebuild();
}

void IssueModel::rebuild() {
    std::vector<Line> lines;
    for (const auto& [id, element] : document_.document().elements) {
        Line line;
        line.element = id;
        line.subject = element->name;
        line.detail = QString::fromStdString(element->name);
        addIssues(lines, line, element->issues);
        const auto response = document_.session().responses().freshOf(id);
        if (response && !response->quality.noFilling.empty()) {
            line.title = tr("Solved by boundary elements, which are less exact: finite elements could not be used.");
            lines.push_back(line);
        }
        if (!element->faces.empty()) continue;
        line.title = tr("Has no joint face yet: it cannot deform.");
        lines.push_back(line);
    }
    for (const auto& [id, character] : document_.document().characters) {
        Line line;
        line.character = id;
        line.subject = character->name;
        line.detail = QString::fromStdString(character->name);
        addIssues(lines, line, character->issues);
        addGaps(lines, line, *character);
        addLinks(lines, line, *character);
    }
    std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.severity > b.severity; });
    const auto same = [](const Line& a, const Line& b) { return a.element == b.element && a.character == b.character && a.point == b.point && a.severity == b.severity && a.title == b.title && a.detail == b.detail && a.repair == b.repair; };
    if (std::equal(lines.begin(), lines.end(), lines_.begin(), lines_.end(), same)) return;
    beginResetModel();
    lines_ = std::move(lines);
    endResetModel();
}

void IssueModel::addIssues(std::vector<Line>& lines, const Line& subject, const std::vector<MeshIssue>& issues) const {
    const auto open = [](const MeshIssue& issue) { return !issue.fixed && repairFor(issue.code).has_value(); };
    const auto mendable = std::count_if(issues.begin(), issues.end(), open);
    for (const MeshIssue& issue : issues) {
        Line line = subject;
        line.severity = issue.fixed ? Severity::Info : issue.severity;
        line.fixed = issue.fixed;
        line.title = issueText(issue);
        if (issue.fixed) line.detail = tr("%1 · mended").arg(subject.detail);
        // What was mended on an element is no longer where it was in its file; characters keep the mesh of theirs.
        if (!issue.fixed || subject.character) line.triangles = issue.triangles;
        if (open(issue)) {
            const RepairAction action = *repairFor(issue.code);
            line.repairText = repairText(action);
            // The last one is mended as is best for it; of an element, that is all there is.
            const bool free = subject.element || mendable == 1;
            line.repair = commands::repair(subject.subject, free ? std::vector<std::string>() : std::vector{std::string(nameOf(action))});
        }
        lines.push_back(std::move(line));
    }
}

void IssueModel::addGaps(std::vector<Line>& lines, const Line& subject, const CharacterSource& character) const {
    const BodyReport& report = character.body->report;
    for (const Vec3& place : report.gaps.places) {
        Line line = subject;
        line.severity = Severity::Warning;
        line.title = tr("The body closes a gap here: both sides move as one.");
        line.point = place;
        if (const double finer = std::max(kFinestDetail, 0.5 * report.detail); finer < report.detail) {
            line.repairText = tr("Wrap finer");
            line.repair = commands::repair(subject.subject, {std::string(nameOf(RepairAction::Wrap))}, finer);
        }
        lines.push_back(std::move(line));
    }
}

void IssueModel::addLinks(std::vector<Line>& lines, const Line& subject, const CharacterSource& character) const {
    for (const FleshLink& link : character.body->report.links) {
        Line line = subject;
        line.severity = Severity::Info;
        line.title = tr("A link of flesh holds two parts together here.");
        line.point = 0.5 * (link.from + link.to);
        lines.push_back(std::move(line));
    }
}

void IssueModel::setRoom(const QModelIndex& index, int pixels) {
    if (index.isValid()) lines_[std::size_t(index.row())].room = pixels;
}

int IssueModel::rowCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : int(lines_.size()); }

QVariant IssueModel::data(const QModelIndex& index, int role) const {
    if (!index.isValid()) return {};
    const Line& line = lines_[std::size_t(index.row())];
    switch (role) {
        case Qt::DisplayRole: return line.title;
        case DetailRole: return line.detail;
        case Qt::AccessibleTextRole: return QStringLiteral("%1 — %2").arg(line.title, line.detail);
        case Qt::ToolTipRole: return QStringLiteral("%1\n%2").arg(line.title, line.detail);
        case RepairRole: return line.repairText;
        case RoomRole: return line.room;
        case SeverityRole: return int(line.severity);
        case IconRole:
            if (line.fixed) return QStringLiteral("check");
            return line.severity == Severity::Error ? QStringLiteral("error") : line.severity == Severity::Warning ? QStringLiteral("warning") : QStringLiteral("info");
        default: return {};
    }
}

PartId IssueModel::element(const QModelIndex& index) const { return index.isValid() ? lines_[std::size_t(index.row())].element : 0; }

PartId IssueModel::character(const QModelIndex& index) const { return index.isValid() ? lines_[std::size_t(index.row())].character : 0; }

std::optional<Vec3> IssueModel::point(const QModelIndex& index) const { return index.isValid() ? lines_[std::size_t(index.row())].point : std::nullopt; }

std::vector<std::int32_t> IssueModel::triangles(const QModelIndex& index) const {
    return index.isValid() ? lines_[std::size_t(index.row())].triangles : std::vector<std::int32_t>();
}

std::optional<Json> IssueModel::repair(const QModelIndex& index) const {
    if (!index.isValid() || lines_[std::size_t(index.row())].repair.is_null()) return std::nullopt;
    return lines_[std::size_t(index.row())].repair;
}

std::vector<Json> IssueModel::repairAll() const {
    std::vector<Json> all;
    for (const Line& line : lines_) {
        if (line.repair.is_null() || line.point) continue;  // finer wraps are a choice
        Json command = commands::repair(line.subject);
        if (std::find(all.begin(), all.end(), command) == all.end()) all.push_back(std::move(command));
    }
    return all;
}

int IssueModel::problems() const {
    return int(std::count_if(lines_.begin(), lines_.end(), [](const Line& line) { return line.severity != Severity::Info; }));
}

}  // namespace imomushi
