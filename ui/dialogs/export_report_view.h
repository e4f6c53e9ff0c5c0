// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QFrame>

#include "core/document/effects.h"
#include "ui/widgets/appearance.h"

class QLabel;
class QPushButton;
class QVBoxLayout;

namespace imomushi {

/// What an export wrote, how near it is to the character, and what became of each effect.
class ExportReportView : public QFrame {
    Q_OBJECT
public:
    explicit ExportReportView(QWidget* parent = nullptr);

    /// Before anything is written: what will be told.
    void showBefore(const Effects& effects);
    void showWriting(const QString& path);
    void showCancelled();
    void showFailure(const Error& error);
    /// The answer of the command "export".
    void showAnswer(const Json& answer);
    /// The file that is being written or was written last; empty after a failure.
    [[nodiscard]] const QString& written() const { return written_; }

private:
    void begin(const QString& title);
    void add(const char* icon, Appearance::Role role, const QString& text);
    void addEffect(const Json& told);

    QLabel* title_;
    QVBoxLayout* lines_;
    QPushButton* show_;
    QString written_;
};

}  // namespace imomushi
