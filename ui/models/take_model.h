// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractListModel>
#include <vector>

#include "ui/models/studio_document.h"

namespace imomushi {

/// The takes of the document in order of recording; names can be edited.
class TakeModel : public QAbstractListModel {
    Q_OBJECT
public:
    enum Roles { IconRole = Qt::UserRole, NoteRole };  ///< name of a line icon; how long it is

    explicit TakeModel(StudioDocument& document, QObject* parent = nullptr);
    [[nodiscard]] PartId take(const QModelIndex& index) const;
    [[nodiscard]] QModelIndex indexOf(PartId take) const;

    [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
    [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
    bool setData(const QModelIndex& index, const QVariant& value, int role) override;
    [[nodiscard]] Qt::ItemFlags flags(const QModelIndex& index) const override;
    /// Takes the document as it is, and says everything again in the present language.
    void refresh();

private:
    StudioDocument& document_;
    std::vector<std::shared_ptr<const Take>> takes_;
};

}  // namespace imomushi
