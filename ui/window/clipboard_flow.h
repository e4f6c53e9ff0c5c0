// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QString>
#include <string>
#include <vector>

#include "ui/models/studio_document.h"

namespace imomushi {

class StepFlow;

/// Copies parts to the clipboard, as commands that make them again, and pastes them: within a project, into another one, and from one studio into another. Elements are in a file that the
/// commands name.
class ClipboardFlow : public QObject {
    Q_OBJECT
public:
    /// What the clipboard holds: {"commands": [...]}, JSON.
    static constexpr const char* kMime = "application/x-imomushi-commands+json";

    ClipboardFlow(StudioDocument& document, StepFlow& steps, QObject* parent);

    /// Names of parts and effects. False: refused, as the document says.
    bool copy(const std::vector<std::string>& names);
    /// What is selected.
    void copySelected();
    void cutSelected();
    void paste();
    /// The clipboard has something that paste() reads.
    [[nodiscard]] bool canPaste() const { return canPaste_; }

signals:
    void changed();  ///< canPaste() may be another
    void said(const QString& message);
    void warned(const QString& message);  ///< not everything could be pasted

private:
    void look();
    void pasted(const Json& answer);

    StudioDocument& document_;
    StepFlow& steps_;
    bool canPaste_ = false;
};

}  // namespace imomushi
