// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"
#include "core/reduction/element_response.h"
#include "core/reduction/embedded_mapping.h"

// Of core/warp's own files alone.
namespace imomushi {

/// A body of fewer vertices that the bend warp of a large one is worked on, and how it carries the large one. Its vertices lie on the large body, so that their response is
/// that of the large body; those of faces are vertices of the large body's.
struct CoarseBody {
    /// Bodies of more vertices are carried. A carried vertex costs a tenth of one that is solved for.
    static constexpr Eigen::Index kCarriedFrom = 12000;
    /// Vertices of the coarse body, about. From the warp of the whole body it is .6 per mille of the size in bends to 150 degrees, 1.1 in twists of 180, 2.6 in stretches to
    /// twice the length between rigid faces (tests/bench/bend_warp.cpp, 292,000 vertices).
    static constexpr int kVertices = 6000;

    /// What vertices of the large body read while they are carried; lengths in m.
    struct Carrier {
        EmbeddedMapping mapping;                // of free vertices, which follow the coarse body
        std::vector<std::int64_t> slot;         // of each point of the mapping: its x in `local`
        std::vector<std::int32_t> held;         // vertices of the large body that faces hold
        std::vector<std::int32_t> rowOfHeld;    // in `held`, of those of the coarse body
        struct Contact {
            std::int32_t point;
            int face;
            float depth, weight;
        };
        std::vector<Contact> contacts;  // ascending by point
        [[nodiscard]] std::size_t bytes() const;
    };

    TriangleMesh mesh;
    std::vector<JointFace> faces;
    ElementResponse response;
    std::shared_ptr<Carrier> carrier;  // slot and contacts are left to the caller

    /// Null: the body cannot be made coarse (it is not closed, it meets itself, its faces have too many vertices, a basis of vertices); or cancelled.
    static std::unique_ptr<CoarseBody> build(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response, double nu, const Progress& progress);
};

}  // namespace imomushi
