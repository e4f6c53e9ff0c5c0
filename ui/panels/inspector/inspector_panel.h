// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QScrollArea>
#include <QTimer>
#include <vector>

#include "ui/models/studio_document.h"

namespace imomushi {

class InspectorForm;

/// Shows and changes the properties of what is selected; of the character when nothing is.
class InspectorPanel : public QScrollArea {
    Q_OBJECT
public:
    explicit InspectorPanel(StudioDocument& document, QWidget* parent = nullptr);

signals:
    void precomputeWanted();
    /// A place of a character (m, at rest) is to be shown.
    void placeWanted(imomushi::PartId character, const imomushi::Vec3& point);
    /// See InspectorForm.
    void partWanted(imomushi::PartId character, const std::vector<std::int32_t>& triangles);

protected:
    void changeEvent(QEvent* event) override;

private:
    void updateSoon();  ///< several changes of one event are shown once
    void update();      ///< a new form when something else is selected, the present values otherwise
    void rebuild();
    [[nodiscard]] InspectorForm* makeForm();

    StudioDocument& document_;
    std::vector<SelectionItem> shown_;
    QWidget* host_;  ///< of the form
    InspectorForm* form_ = nullptr;
    bool built_ = false;      ///< the form is up to date in its rows, language and look
    bool scheduled_ = false;
    bool partShown_ = false;  ///< a part of a character is pointed out
    QTimer live_;             ///< runs while frames move what is shown
};

}  // namespace imomushi
