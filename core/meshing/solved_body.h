// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/elasticity/tetrahedral_mesh.h"
#include "core/joints/joint_face.h"
#include "core/meshing/disc_mesh.h"
#include "core/meshing/solver_mesh.h"
#include "core/meshing/solver_mesh_setting.h"

namespace imomushi {

/// How finely a body is filled with tetrahedra.
struct VolumeDetail {
    int vertices = 0;  ///< of the body, or of one in its place; 0: it is not filled
    /// Edges at the rim of a face over the radius of a disc as large as it. Away from rims tetrahedra are as large as the body's shape lets them be. 0: edges at
    /// rims and elsewhere are as short as those of a body of `vertices`.
    double rim = 0.0;
    bool onItself = false;  ///< never on another surface in its place
    double growth = 0.7;    ///< by how much edges grow per distance from a rim
    /// If `rim` > 0: edge length at re-entrant creases of the free surface, over the mean edge of a surface of `vertices` vertices. The solution is
    /// singular there. Without it two test bodies of intersecting spheres had an error of 2 % for any `rim`, which the error estimate did not show.
    double crease = 0.5;
};

/// The mesh on which an element is solved, and its relation to the body that is displayed.
struct SolvedBody {
    SolverMesh mesh;
    std::vector<JointFace> faces;  ///< of the body, or of the decimated body: with its vertices, the frames are the body's
    bool decimated = false;        ///< responses must be mapped to the body; otherwise the first vertices of `mesh` are the body's
    double volumeError = 0.0;      ///< of a decimated body, relative
    SolverMesh plain;              ///< `mesh` without strips and bubbles; empty where it has none
    /// Of each vertex of `mesh` before its `origin` begins: the body vertex at exactly the same place, -1: none.
    std::vector<std::int32_t> bodyVertex;
    /// Body vertices that no face has but that lie in what is held, see DiscMesh.
    std::vector<DiscMesh::Inside> inside;
    /// What lies inside `mesh`, where finite elements solve it; none: boundary elements do.
    std::shared_ptr<const TetrahedralMesh> filling;
    VolumeDetail detail;     ///< of a filled body: what was asked for
    std::string noFilling;   ///< why boundary elements took the place of finite elements that the setting asks for, one sentence; else empty

    [[nodiscard]] int nodes() const { return static_cast<int>(mesh.mesh.vertices.rows() + static_cast<Eigen::Index>(mesh.bubbles.size())); }
};

/// Makes the solver mesh that `setting` asks for. By finite elements:
///
///   volume:N    the body, or one of N vertices in its place, finer at rims, filled with tetrahedra (VolumeProblem); volume: N = kVolumeVertices
///   draft, default, best
///               with handles volume:600, volume:2500 and volume:5000, with more vertices for more than four handles; without, of as many vertices at most, and small
///               tetrahedra at rims alone (VolumeDetail::rim), as many as the rims need
///
///   as-is, refined:N
///               of more than BoundaryProblem::kUsualNodes vertices: the body, its edges no longer than those of so many vertices
///
/// By boundary elements:
///
///   as-is       the body, linear displacement
///   refined:N   the body bisected to N vertices, linear displacement
///   decimated:N a body of N vertices in its place, then like default
///
/// and, where a body cannot be filled, or without `fill` (as it must be beyond VolumeProblem::kLargestNu; SolvedBody::noFilling says why):
///
///   volume:N, default
///               strips at singular edges (withLayers) and quadratic displacement: on the body where that is cheap, otherwise on a decimated one
///               (as it is, with linear displacement, where walls are less than 1/150 of the triangles on them)
///   draft       a body of kDraftVertices in its place (as few as rims and thin walls allow; the body itself up to twice as many, or where it cannot be decimated), strips, linear displacement; one with
///               handles has a thousand vertices instead of strips
///   best        more strips and quadratic displacement everywhere, on the body refined where it is coarse
///
/// Measured against second-order finite elements (tests/data/reference): as-is is wrong by up to 23 %, default by less than 1 %, draft by less than 5 %.
/// Handles are held by their discs (DiscMesh), but for as-is and refined:N by boundary elements by their triangles: the mesh is as it is.
/// Errors: those of refinedSolverMesh() and decimate(); "cancelled".
Result<SolvedBody> solvedBody(const TriangleMesh& body, std::span<const JointFace> faces, const SolverMeshSetting& setting, const Progress& progress,
                              bool fill = true);

/// About the size of the mesh that solvedBody() makes, without making it where that takes long (a large body, or a filled one).
struct SolvedSize {
    int nodes = 0, triangles = 0;
    int coarser = 0;  ///< nodes of the coarser level
    bool volume = false;  ///< of tetrahedra
};
SolvedSize solvedSize(const TriangleMesh& body, std::span<const JointFace> faces, const SolverMeshSetting& setting, bool fill = true);

/// A coarser discretisation of the same body, to estimate the error of the finer one by the difference of their solutions.
struct CoarserLevel {
    SolvedBody body;
    double share = 0.0;  ///< error of the finer level over the difference, about
};
/// Strips and bubbles remove about nine tenths of the error of the plain mesh (measured on 24 bodies: the error is 0.3 to 2.5 times the
/// estimate), strips alone half of it, and bubbles on some edges a part in between; against a plain mesh the error falls with the size of the triangles,
/// since rims dominate it (Richardson's extrapolation of first order).
/// Errors: those of decimate(): there is no coarser mesh.
Result<CoarserLevel> coarserLevel(const TriangleMesh& body, std::span<const JointFace> faces, const SolvedBody& fine, const Progress& progress);

}  // namespace imomushi
