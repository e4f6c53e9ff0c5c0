// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <vector>

#include "core/project/project_versions.h"

class QListWidget;

namespace imomushi {

/// What was saved of a project, newest first. Accepted: chosen() is to be opened.
class VersionsDialog : public QDialog {
    Q_OBJECT
public:
    explicit VersionsDialog(const std::vector<ProjectVersion>& versions, const QString& project, QWidget* parent = nullptr);
    [[nodiscard]] std::size_t chosen() const;  ///< in `versions`

private:
    QListWidget* list_ = nullptr;
};

}  // namespace imomushi
