// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <memory>

#include "core/document/command.h"
#include "core/io/import.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QListWidget;
class QProgressBar;
class QPushButton;

namespace imomushi {

class ImportJob;
class MeshPreview;

/// Asks how a mesh file is to be read, and shows what it would become. The file is read in the background, again after each choice.
class ImportDialog : public QDialog {
    Q_OBJECT
public:
    explicit ImportDialog(const QString& path, QWidget* parent = nullptr);

    [[nodiscard]] Json command() const;  ///< import-element with what was chosen
    [[nodiscard]] const ImportRequest& request() const;
    [[nodiscard]] std::shared_ptr<const Result<ImportResult>> prepared() const;

private:
    void read();
    void showResult();
    [[nodiscard]] QString progressText() const;
    [[nodiscard]] ImportRequest chosen() const;

    QString path_;
    ImportJob* job_;
    MeshPreview* preview_;
    QComboBox* unit_;
    QComboBox* up_;
    QCheckBox* split_;
    QLabel* facts_;
    QLabel* verdict_;
    QListWidget* issues_;
    QProgressBar* progress_;
    QLabel* stage_;
    QPushButton* import_;
};

/// Endings that can be imported, for file dialogs and dropped files.
QStringList meshSuffixes();

}  // namespace imomushi
