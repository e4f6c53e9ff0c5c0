// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <vector>

#include "core/mesh/rig.h"

class QListWidget;
class QPushButton;

namespace imomushi {

/// Which clips of a character's file become takes: one, some or all.
class ClipsDialog : public QDialog {
    Q_OBJECT
public:
    /// `character`: its name.
    ClipsDialog(const QString& character, const std::vector<RigClip>& clips, QWidget* parent = nullptr);
    /// Into the clips, ascending.
    [[nodiscard]] std::vector<std::size_t> chosen() const;

private:
    void follow();
    QListWidget* list_;
    QPushButton* make_;
};

}  // namespace imomushi
