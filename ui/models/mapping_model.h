// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractTableModel>
#include <optional>
#include <vector>

#include "ui/models/input_deck.h"
#include "ui/models/mapping_texts.h"

namespace imomushi {

/// The rows of the document's table of mappings, with what each shows while it is used. Muting and solo are edited here.
class MappingModel : public QAbstractTableModel {
    Q_OBJECT
public:
    enum Column { Control, Meter, Target, Mute, Solo, kColumns };
    /// Of Control: who sends it. Of Target: TroubleRole, one sentence where others drive the same or it is not there. Of Mute and Solo: IconRole, the name of a line icon; OnRole.
    enum Roles { NoteRole = Qt::UserRole, TroubleRole, IconRole, OnRole };
    /// What the meter of a row shows.
    struct Level {
        std::optional<double> raw;  ///< part of the range of the control, 0...1; none: nothing was heard
        QString text;               ///< what becomes of it
        bool drives = false;        ///< it moves something
        bool silent = false;
        bool muted = false;         ///< by itself, or by another row that is solo
    };

    MappingModel(StudioDocument& document, InputDeck& inputs, QObject* parent = nullptr);
    [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
    [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override { return parent.isValid() ? 0 : kColumns; }
    [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
    [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

    [[nodiscard]] const InputMapping* mapping(int row) const;  ///< null: there is no such row
    [[nodiscard]] int rowOf(const InputMapping& line) const;   ///< -1: there is no such line
    [[nodiscard]] Level level(int row) const;
    /// Which other row drives what a row drives, and which of them wins now; empty: no other one does.
    [[nodiscard]] QString conflict(int row) const;
    void toggle(const QModelIndex& index);  ///< Mute or Solo
    /// Says everything again in the present language.
    void refresh();

private:
    void take();

    StudioDocument& document_;
    InputDeck& inputs_;
    std::shared_ptr<const InputMappings> mappings_;
    std::vector<TargetText> targets_;
    bool solo_ = false;  ///< of any row
};

}  // namespace imomushi
