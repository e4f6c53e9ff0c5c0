// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <vector>

#include "ui/models/studio_document.h"

class QButtonGroup;
class QCheckBox;
class QComboBox;
class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;
class QVBoxLayout;

namespace imomushi {

class ChoiceCard;
class ExportJob;

/// Asks how the character goes out, writes it in the background with the command "export", and shows what was read back. The studio stays usable meanwhile.
class ExportDialog : public QDialog {
    Q_OBJECT
public:
    /// `folder`: where files go unless another one was chosen before.
    ExportDialog(StudioDocument& document, const QString& folder, QWidget* parent = nullptr);

    [[nodiscard]] Json command() const;  ///< "export" with what was chosen
    [[nodiscard]] ExportJob& job() { return *job_; }
    void setPath(const QString& path);

public slots:
    /// Cancels what is being written, or closes.
    void reject() override;

private:
    void fillTakes();
    void fillFormats();
    void suitFormat();
    void takePreset();
    void takeLayout();
    void checkPath();
    void browse();
    void write();
    void remember() const;
    void showProgress();
    void showAnswer();
    void say(const QString& icon, int role, const QString& text);
    void clearReport();
    void describe();
    [[nodiscard]] QString suffix() const;
    [[nodiscard]] bool splitByItself() const;
    [[nodiscard]] std::string layoutName() const;

    StudioDocument& document_;
    ExportJob* job_;
    QButtonGroup* presets_;
    QButtonGroup* layouts_;
    std::vector<ChoiceCard*> presetCards_;
    QComboBox* take_;  // data: keys of the command, as JSON
    QComboBox* fps_;
    QComboBox* targets_;
    QComboBox* format_;
    QCheckBox* split_;
    QCheckBox* quantise_;
    QCheckBox* normals_;
    QLineEdit* path_;
    QLabel* replaces_;
    QVBoxLayout* report_;
    QLabel* reportTitle_;
    QPushButton* show_;
    QProgressBar* progress_;
    QLabel* stage_;
    QPushButton* close_;
    QPushButton* write_;
    QString written_;
};

}  // namespace imomushi
