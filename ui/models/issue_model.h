// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractListModel>
#include <optional>
#include <vector>

#include "ui/models/studio_document.h"

namespace imomushi {

/// Everything that asks for attention: what was found on the meshes, and what is missing before the character can move.
class IssueModel : public QAbstractListModel {
    Q_OBJECT
public:
    enum Roles { ElementRole = Qt::UserRole, IconRole, SeverityRole, DetailRole, RepairRole, RoomRole };  ///< RepairRole: what mends it; empty: nothing here does. RoomRole: for its button
    explicit IssueModel(StudioDocument& document, QObject* parent = nullptr);

    [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
    [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
    [[nodiscard]] PartId element(const QModelIndex& index) const;    ///< 0: it is not of an element
    [[nodiscard]] PartId character(const QModelIndex& index) const;  ///< 0: it is not of a whole character
    /// Where it is on the mesh: body triangles, or triangles of the character's render mesh, empty when it has no place.
    [[nodiscard]] std::vector<std::int32_t> triangles(const QModelIndex& index) const;
    /// A place of a character at rest, m; none: triangles say where, if anything does.
    [[nodiscard]] std::optional<Vec3> point(const QModelIndex& index) const;
    /// The command that mends it; none: nothing here does.
    [[nodiscard]] std::optional<Json> repair(const QModelIndex& index) const;
    /// Commands that mend all that can be mended.
    [[nodiscard]] std::vector<Json> repairAll() const;
    [[nodiscard]] int problems() const;  ///< how many are warnings or errors
    void rebuild();
    /// How wide the button of a line is; kept with the line, not with the document.
    void setRoom(const QModelIndex& index, int pixels);

private:
    struct Line {
        PartId element = 0, character = 0;
        Severity severity = Severity::Info;
        bool fixed = false;
        QString title, detail;
        std::string subject;  ///< name of the element or character
        std::vector<std::int32_t> triangles;
        std::optional<Vec3> point;
        QString repairText;
        Json repair;        ///< null: none
        int room = 0;       ///< of its button, pixels
    };
    void addIssues(std::vector<Line>& lines, const Line& subject, const std::vector<MeshIssue>& issues) const;
    void addGaps(std::vector<Line>& lines, const Line& subject, const CharacterSource& character) const;
    void addLinks(std::vector<Line>& lines, const Line& subject, const CharacterSource& character) const;
    StudioDocument& document_;
    std::vector<Line> lines_;
};

}  // namespace imomushi
