// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <vector>

#include "ui/models/commands.h"
#include "ui/models/studio_document.h"

class QButtonGroup;
class QCheckBox;
class QComboBox;
class QLabel;
class QLayout;
class QLineEdit;
class QProgressBar;
class QPushButton;

namespace imomushi {

class ExportJob;
class ExportReportView;
struct ExportPreset;

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
    /// What of takes and pose goes out.
    struct TakeChoice {
        commands::Export::What what = commands::Export::What::Takes;
        std::string take;
        bool operator==(const TakeChoice&) const = default;
    };
    QLayout* makePresets();
    QLayout* makeLayouts();
    QLayout* makeOptions();
    QLayout* makeFile();
    QLayout* makeFoot();
    /// What was chosen last; a file in `folder` where none was.
    void recall(const QString& folder);
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
    void showOutcome(bool completed);
    [[nodiscard]] const ExportPreset& chosenPreset() const;
    [[nodiscard]] QString suffix() const;
    [[nodiscard]] bool splitByItself() const;
    [[nodiscard]] std::string layoutName() const;

    StudioDocument& document_;
    ExportJob* job_;
    QButtonGroup* presets_;
    QButtonGroup* layouts_;
    QComboBox* take_;
    std::vector<TakeChoice> takeChoices_;  ///< of the rows of take_
    QComboBox* fps_;
    QComboBox* targets_;
    QComboBox* format_;
    QCheckBox* split_;
    QCheckBox* quantise_;
    QCheckBox* compress_;
    QCheckBox* normals_;
    QLineEdit* path_;
    QLabel* replaces_;
    ExportReportView* report_;
    QProgressBar* progress_;
    QLabel* stage_;
    QPushButton* close_;
    QPushButton* write_;
};

}  // namespace imomushi
