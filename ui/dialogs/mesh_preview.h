// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/body/body.h"
#include "core/proposal/proposal.h"
#include "core/io/character_file.h"
#include "ui/viewport/turntable_view.h"

namespace imomushi {

/// A small shaded picture of bodies that are not in the document yet, standing on the ground; dragging turns it. Those that cannot become elements have the
/// colour of a warning. Or of a whole character, as it looks.
class MeshPreview : public TurntableView {
    Q_OBJECT
public:
    explicit MeshPreview(QWidget* parent = nullptr);
    void show(const Result<ImportResult>& result);
    /// A whole character with the gaps that its body closes; null: it has no body yet. With the cuts and bones that are proposed for it, if any.
    void show(const CharacterFile& file, const Body* body, const Proposal* proposal);

protected:
    void drawPictures() override;
    void paint(QPainter& painter) override;

private:
    /// Puts something of this box into the middle of the view and says by what it is scaled; 0: it cannot be shown.
    double place(const Eigen::AlignedBox3d& box);
    void addProposal(const TriangleMesh& body, const Proposal& proposal, double scale, const Vec3& centre);
    /// Body vertices as they are drawn.
    const float* placed(const Points& vertices, double scale, const Vec3& centre);
    std::vector<std::vector<float>> positions_;  ///< per body, of scene_
    QImage picture_;
};

}  // namespace imomushi
