// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>

#include "ui/jobs/autosave.h"

class QListWidget;

namespace imomushi {

/// Work that was kept when a studio ended badly: take one of it up, or throw it away. Accepted: chosen() is to be opened; else it is kept for later.
class RecoveryDialog : public QDialog {
    Q_OBJECT
public:
    explicit RecoveryDialog(const QList<Autosave::Found>& found, QWidget* parent = nullptr);
    [[nodiscard]] int chosen() const;  ///< in `found`
    static constexpr int kOutdated = Qt::UserRole + 1;  ///< of items of the list: Found::outdated

private:
    QListWidget* list_ = nullptr;
};

}  // namespace imomushi
