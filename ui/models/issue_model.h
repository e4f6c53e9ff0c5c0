// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractListModel>
#include <vector>

#include "ui/models/studio_document.h"

namespace imomushi {

/// Everything that asks for attention: what was found on the meshes, and what is missing before the character can move.
class IssueModel : public QAbstractListModel {
    Q_OBJECT
public:
    enum Roles { ElementRole = Qt::UserRole, IconRole, SeverityRole, DetailRole };
    explicit IssueModel(StudioDocument& document, QObject* parent = nullptr);

    [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
    [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
    [[nodiscard]] PartId element(const QModelIndex& index) const;
    /// Where it is on the mesh: body triangles, empty when it has no place.
    [[nodiscard]] std::vector<std::int32_t> triangles(const QModelIndex& index) const;
    [[nodiscard]] int worth() const;  ///< how many are warnings or errors
    void rebuild();

private:
    struct Line {
        PartId element = 0;
        Severity severity = Severity::Info;
        bool fixed = false;
        QString title, detail;
        std::vector<std::int32_t> triangles;
    };
    StudioDocument& document_;
    std::vector<Line> lines_;
};

}  // namespace imomushi
