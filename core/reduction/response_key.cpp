// SPDX-License-Identifier: GPL-3.0-or-later
// The content key of a precomputed response: a hash of everything that its bytes depend on.
#include "core/reduction/element_response.h"

namespace imomushi {

namespace {

/// Raise when the same input gives other bytes: cached responses of an older solver are then computed again.
constexpr int kSolverVersion = 9;
/// The same for BasisKind::Modes alone.
constexpr int kModesVersion = 2;
/// The same for touch alone.
constexpr int kTouchVersion = 1;
/// The same for discs alone.
constexpr int kDiscVersion = 3;

}  // namespace

ContentKey responseKey(const ResponseInput& input) {
    ContentHasher hasher;
    hasher.number(kSolverVersion);
    hasher.number(input.nu);
    hasher.number(static_cast<int>(input.basis.kind));
    if (input.basis.kind == BasisKind::Modes) {
        hasher.number(input.basis.modes);
        hasher.number(kModesVersion);
    }
    hasher.number(static_cast<int>(input.solverMesh.kind));
    hasher.number(input.solverMesh.count);
    const TriangleMesh& body = input.mesh->body;
    hasher.array(std::span<const double>(body.vertices.data(), static_cast<std::size_t>(body.vertices.size())));
    hasher.array(std::span<const std::int32_t>(body.triangles.data(), static_cast<std::size_t>(body.triangles.size())));
    hasher.number(input.faces.size());
    for (const JointFace& face : input.faces) {
        hasher.array(std::span<const std::int32_t>(face.vertices));
        hasher.array(std::span<const std::int32_t>(face.triangles));
        hasher.array(std::span<const double>(face.frame.origin.data(), 3));
        hasher.array(std::span<const double>(face.frame.axes.data(), 9));
        hasher.number(static_cast<int>(face.flat()));
        if (face.disc) {
            hasher.number(kDiscVersion);
            hasher.array(std::span<const double>(face.disc->point.data(), 3));
            hasher.number(face.disc->radius);
        }
    }
    if (input.loads == BodyLoads::Always) hasher.text("loads");
    if (input.loads == BodyLoads::WhereCheap) hasher.text("cheap loads");
    if (input.touch > 0) {
        hasher.text("touch");
        hasher.number(kTouchVersion);
        hasher.number(input.touch);
    }
    return hasher.key();
}

}  // namespace imomushi
