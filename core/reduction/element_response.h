// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/hash.h"
#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/elasticity/boundary_problem.h"
#include "core/joints/face_basis.h"
#include "core/joints/joint_face.h"
#include "core/mesh/mesh.h"
#include "core/meshing/solver_mesh_setting.h"
#include "core/reduction/touch_response.h"

namespace imomushi {

/// Accuracy and cost of the precompute of one element.
struct ResponseQuality {
    SolveQuality solve;
    double asymmetry = 0.0;       ///< |K - K^T| / |K + K^T| (Frobenius) of the raw joint stiffness
    double negativeEnergy = 0.0;  ///< most negative eigenvalue of K over the largest, before the projection
    double seconds = 0.0;         ///< wall time of the whole precompute
    int solverVertices = 0, solverNodes = 0;  ///< of the solver mesh; nodes: three unknowns each
    /// Estimated errors of the response, relative to the motion of the body (root mean squares over its vertices). Negative: not known.
    /// `error`: of the discretisation, by the difference from a coarser level; the largest over the joint modes, or with handles, which move rigidly, the root mean square over moves and turns.
    /// `mappingError`: what mapping from a decimated body adds; root mean square over the modes.
    double error = -1.0, mappingError = 0.0;
    std::int64_t tetrahedra = 0;  ///< of finite elements; 0: solved by boundary elements, or read from a file of an older program, which does not tell
    std::string noFilling;        ///< see SolvedBody::noFilling
    bool decimated = false;       ///< solved on a decimated body
    double shapeError = 0.0;      ///< of the decimated body: see DisplayMapping::Distance::shape
};

/// The precomputed response of one element: displacement of its free vertices X = A' v for the joint parameters v of all its faces
/// (Watanabe et al. 2006, section 3; v = 0 at rest), and the energy 1/2 v^T K v.
/// An element without a joint face has no columns: it follows its bone rigidly.
struct ElementResponse {
    std::vector<std::int32_t> freeVertices;  ///< ascending body vertices that no face holds
    std::vector<FaceBasis> bases;            ///< one per joint face, in the order of the element's faces
    std::vector<int> firstColumn;            ///< of each face; one more entry: the number of columns g
    Eigen::MatrixXd response;                ///< A': 3 * #free x g, rows xyz per free vertex, displacement (m) per unit of v, element rest axes
    /// K: g x g, symmetric, positive semi-definite, zero on rigid motions; for shear modulus 1. K v are the forces on the joint parameters that hold v.
    Eigen::MatrixXd stiffness;
    /// Of a full basis (else empty), g x g, for shear modulus 1: the tractions at the vertices of the faces (3 i + axis of each face, element rest axes)
    /// per unit of v, linear on the body's triangles. They balance exactly, but are as unsymmetrical as collocation leaves them. Below `response`
    /// they make the n x m matrix of the previous model: X = (displacement of free vertices, tractions of held ones).
    Eigen::MatrixXd tractions;
    /// Body loads with all faces at rest, where they were asked for (else empty). Columns 0 1 2: a uniform force per volume along x, y, z of the
    /// element rest axes, over the shear modulus (1/m); 3: a pressure over the shear modulus that pushes the free surface outwards.
    static constexpr int kLoads = 4;
    Eigen::MatrixXd loads;       ///< 3 * #free x kLoads: displacement (m) per unit of load
    Eigen::MatrixXd loadForces;  ///< g x kLoads, for shear modulus 1: with loads l and joint parameters v the faces are held by K v + loadForces l
    TouchResponse touch;         ///< contact forces, where they were asked for
    ResponseQuality quality;

    [[nodiscard]] int columns() const { return firstColumn.empty() ? 0 : firstColumn.back(); }
    [[nodiscard]] std::size_t bytes() const;
};

/// Whether a response has body loads too.
enum class BodyLoads {
    None,
    WhereCheap,  ///< where they are columns of a solution that is needed anyway, so that gravity and pressure need no precompute: not on bodies with appendages
    Always,
};

/// Everything the precompute of one element depends on.
struct ResponseInput {
    std::shared_ptr<const ElementMesh> mesh;
    std::vector<JointFace> faces;
    double nu = 0.45;
    BasisChoice basis;
    SolverMeshSetting solverMesh;
    BodyLoads loads = BodyLoads::None;
    /// Number of touch patches, about; 0: none. They are about sqrt(free surface / touch) wide: 24 are for large soft dents, 96 for small ones. A
    /// patch costs three columns. On small meshes there are fewer, see touchPatches().
    int touch = 0;
    static constexpr int kMaxTouch = 1024;
    int threads = 1;  ///< not part of the key: it changes no byte of the response
};

/// The content key of the response: mesh, faces, nu, basis, solver mesh, loads, touch, and the version of the solver.
ContentKey responseKey(const ResponseInput& input);

/// Solved on the body without its appendages, which follow (see TrimmedBody); only body loads and touch patches are solved on the whole body, as appendages
/// bend under them.
/// Errors: those of BoundaryProblem::build and solve, and of solvedBody().
Result<ElementResponse> buildResponse(const ResponseInput& input, const Progress& progress);

/// Those of several elements, each with the bytes that buildResponse() gives it: up to `threads` of them at once, the largest bodies first, each on one thread; one alone on
/// all of them. `done` has the place of each input and its response as soon as that is there, in any order and on any of the threads, one at a time; when cancelled, not of all.
/// `progress` is told from any of the threads too.
void buildResponses(std::span<const ResponseInput> inputs, int threads, const std::function<void(std::size_t, Result<ElementResponse>)>& done, const Progress& progress);

/// Whether several such inputs are better solved at once than one after the other: true for finite elements, whose factorisation has one thread, of at most the size of "default" (about
/// 100 MB each).
bool solvedBesideOthers(const ResponseInput& input);

/// Seconds and bytes of buildResponse() on this machine, and the milliseconds per frame of its product.
struct ResponseEstimate {
    double seconds = 0.0;
    std::size_t bytes = 0;
    double frameMilliseconds = 0.0;
    int columns = 0;
};
ResponseEstimate estimateResponse(const ResponseInput& input);

/// Statics of one element alone for given displacements of its joint-face vertices (no reduction): displacement of every body vertex,
/// #V x 3. `faceDisplacement`: per face #vertices x 3 in world axes.
Result<Points> solveFull(const ResponseInput& input, const std::vector<Points>& faceDisplacement, const Progress& progress);

}  // namespace imomushi
