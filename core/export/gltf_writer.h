// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/export/morphs.h"
#include "core/export/render_surface.h"
#include "core/export/skin_fit.h"

namespace imomushi {

/// What a glTF file is made from: morphs for Baked and Rigged, a skin for Skinned.
struct GltfContent {
    const ExportScene& scene;
    const ExportOptions& options;
    const Motion& motion;
    std::vector<RenderSurface> surfaces;  ///< of elements, then of parts of meshes of the scene; those of a part are primitives of one mesh
    std::vector<ElementMorphs> morphs;
    /// Per surface, per target: how normals move per unit of weight, 3 per vertex of the surface; empty: they do not.
    std::vector<std::vector<std::vector<float>>> normalTargets;
    FittedSkin skin;

    /// The elements that move vertices of a surface or of its part, and where the targets of each begin among those of the mesh.
    struct Mover {
        int element = 0;
        Eigen::Index first = 0;
    };
    [[nodiscard]] std::vector<Mover> movers(const RenderSurface& surface) const;
    /// How many targets these are.
    [[nodiscard]] Eigen::Index targets(const std::vector<Mover>& movers) const;
};

/// The bytes of a .glb file. Adds to `report`: keys, targets, warnings. Errors: "too-large", "cancelled".
Result<std::string> writeGltf(const GltfContent& content, ExportReport& report, const Progress& progress);

/// Nodes of elements in the written file have their index here, so that files can be read back whatever elements are called; those of parts theirs among all parts.
inline constexpr const char *kElementExtra = "element", *kPartExtra = "part";

}  // namespace imomushi
