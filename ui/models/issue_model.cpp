// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/issue_model.h"

#include <algorithm>

#include "ui/models/texts.h"

namespace imomushi {

IssueModel::IssueModel(StudioDocument& document, QObject* parent) : QAbstractListModel(parent), document_(document) {
    connect(&document, &StudioDocument::structureChanged, this, &IssueModel::rebuild);
    connect(&document, &StudioDocument::fileChanged, this, &IssueModel::rebuild);
    rebuild();
}

void IssueModel::rebuild() {
    std::vector<Line> lines;
    for (const auto& [id, element] : document_.document().elements) {
        const QString name = QString::fromStdString(element->name);
        for (const MeshIssue& issue : element->issues) {
            const Severity severity = issue.fixed ? Severity::Info : issue.severity;
            lines.push_back({id, 0, severity, issue.fixed, issueText(issue.code, issue.count, issue.text), issue.fixed ? tr("%1 · mended").arg(name) : name, issue.fixed ? std::vector<std::int32_t>() : issue.triangles, {}});
        }
        if (element->faces.empty()) lines.push_back({id, 0, Severity::Info, false, tr("Has no joint face yet: it cannot deform."), name, {}, {}});
    }
    for (const auto& [id, character] : document_.document().characters) {
        const QString name = QString::fromStdString(character->name);
        for (const MeshIssue& issue : character->issues) {
            const Severity severity = issue.fixed ? Severity::Info : issue.severity;
            lines.push_back({0, id, severity, issue.fixed, issueText(issue.code, issue.count, issue.text), issue.fixed ? tr("%1 · mended").arg(name) : name, issue.triangles, {}});
        }
        const BodyReport& report = character->body->report;
        for (const Vec3& place : report.gaps.places)
            lines.push_back({0, id, Severity::Warning, false, tr("The body closes a gap here: both sides move as one."), name, {}, place});
    }
    std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.severity > b.severity; });
    const auto same = [](const Line& a, const Line& b) { return a.element == b.element && a.character == b.character && a.point == b.point && a.severity == b.severity && a.title == b.title && a.detail == b.detail; };
    if (std::equal(lines.begin(), lines.end(), lines_.begin(), lines_.end(), same)) return;
    beginResetModel();
    lines_ = std::move(lines);
    endResetModel();
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

int IssueModel::worth() const {
    return int(std::count_if(lines_.begin(), lines_.end(), [](const Line& line) { return line.severity != Severity::Info; }));
}

}  // namespace imomushi
