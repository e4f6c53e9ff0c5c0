// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "core/io/import.h"
#include "ui/viewport/turntable_view.h"

namespace imomushi {

/// A small shaded picture of bodies that are not in the document yet, standing on the ground; dragging turns it. Those that cannot become elements have the
/// colour of a warning.
class MeshPreview : public TurntableView {
    Q_OBJECT
public:
    explicit MeshPreview(QWidget* parent = nullptr);
    void show(const Result<ImportResult>& result);

protected:
    void drawPictures() override;
    void paint(QPainter& painter) override;

private:
    std::vector<std::vector<float>> positions_;  ///< per body, of scene_
    QImage picture_;
};

}  // namespace imomushi
