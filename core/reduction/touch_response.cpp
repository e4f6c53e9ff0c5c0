// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/touch_response.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>

#include "core/base/parallel.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_frame.h"
#include "core/mesh/triangle_tree.h"
#include "core/meshing/mesh_pieces.h"
#include "core/reduction/semidefinite_projection.h"

namespace imomushi {
namespace {

std::vector<std::int32_t> heldTriangles(const SolverMesh& mesh) {
    std::vector<std::int32_t> out;
    for (const SolverMesh::Patch& face : mesh.faces) out.insert(out.end(), face.triangles.begin(), face.triangles.end());
    return out;
}

std::vector<std::int32_t> heldTriangles(std::span<const JointFace> faces) {
    std::vector<std::int32_t> out;
    for (const JointFace& face : faces) out.insert(out.end(), face.triangles.begin(), face.triangles.end());
    return out;
}

std::vector<char> touchableOf(const SolverMesh& mesh) { return touchableTriangles(mesh.mesh, EdgeTable(mesh.mesh.triangles), heldTriangles(mesh)); }

std::vector<char> touchableOf(const TriangleMesh& body, std::span<const JointFace> faces) { return touchableTriangles(body, EdgeTable(body.triangles), heldTriangles(faces)); }

/// visit(triangle, area) for those that can be touched, see touchableTriangles().
template <class Visit>
void eachTouchable(const TriangleMesh& mesh, const std::vector<char>& touchable, const Visit& visit) {
    for (std::int32_t f = 0; f < mesh.triangles.rows(); ++f)
        if (touchable[static_cast<std::size_t>(f)]) visit(f, 0.5 * areaVector(mesh, f).norm());
}

/// The integral of each column, linear on each triangle, over what can be touched.
Eigen::VectorXd integrals(const TriangleMesh& mesh, const std::vector<char>& touchable, const Eigen::MatrixXd& values) {
    Eigen::VectorXd share = Eigen::VectorXd::Zero(mesh.vertices.rows());
    eachTouchable(mesh, touchable, [&](std::int32_t f, double area) {
        for (int c = 0; c < 3; ++c) share[mesh.triangles(f, c)] += area / 3.0;
    });
    return values.transpose() * share;
}

/// Displacement gradient of a triangle: tangential derivatives from the displacements u of its corners, the normal derivative from the traction over the shear
/// modulus by Hooke's law.
Eigen::Matrix3d gradientOf(const TriangleFrame& frame, const std::array<Vec3, 3>& u, const Vec3& traction, double nu) {
    Eigen::Matrix3d along = Eigen::Matrix3d::Zero();
    for (std::size_t c = 0; c < 3; ++c) along += u[c] * frame.slope[c].transpose();
    // t = lambda tr(G) n + mu (G + G^T) n, solved for G n.
    const Vec3& n = frame.normal;
    const double pressed = traction.dot(n);
    const double across = (1.0 - 2.0 * nu) / (2.0 * (1.0 - nu)) * pressed - nu / (1.0 - nu) * along.trace();
    const Vec3 sheared = traction - pressed * n - along.transpose() * n;
    return along + (across * n + sheared) * n.transpose();
}

}  // namespace

std::size_t TouchResponse::bytes() const {
    return sizeof(float) * static_cast<std::size_t>(displacement.size() + gradients.size()) +
           sizeof(double) * static_cast<std::size_t>(forces.size() + compliance.size()) +
           sizeof(std::int32_t) * (probes.size() + patches.centre.size() + patches.first.size() + patches.patch.size()) +
           sizeof(float) * patches.weight.size();
}

Eigen::MatrixXd patchTractions(const TouchPatches& patches, const TriangleMesh& body, std::span<const JointFace> faces, const SolvedBody& solved) {
    const SolverMesh& mesh = solved.mesh;
    const Eigen::Index vertices = mesh.mesh.vertices.rows(), own = static_cast<Eigen::Index>(solved.bodyVertex.size());
    const Eigen::MatrixXd onBody = patches.dense();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(vertices, patches.count());
    const std::vector<char> touchable = touchableOf(mesh);
    if (!solved.decimated) {
        out.topRows(own) = onBody;
    } else {
        const std::vector<char> onBodyTouchable = touchableOf(body, faces);
        std::vector<std::int32_t> which;
        for (std::size_t f = 0; f < onBodyTouchable.size(); ++f)
            if (onBodyTouchable[f]) which.push_back(static_cast<std::int32_t>(f));
        std::vector<char> wanted(static_cast<std::size_t>(vertices));
        for (std::int32_t f = 0; f < mesh.mesh.triangles.rows(); ++f)
            for (int c = 0; c < 3 && touchable[static_cast<std::size_t>(f)]; ++c) wanted[static_cast<std::size_t>(mesh.mesh.triangles(f, c))] = 1;
        const Points normals = vertexNormals(mesh.mesh);
        const TriangleTree tree(body, std::move(which));
        for (Eigen::Index v = 0; v < own; ++v) {
            if (!wanted[static_cast<std::size_t>(v)]) continue;
            const Vec3 x = mesh.mesh.vertices.row(v).transpose();
            TriangleTree::Hit hit = tree.nearestFacing(x, normals.row(v).transpose());
            if (hit.triangle < 0) hit = tree.nearest(x);
            for (int c = 0; c < 3; ++c) out.row(v) += hit.barycentric[c] * onBody.row(body.triangles(hit.triangle, c));
        }
    }
    for (Eigen::Index v = own; v < vertices; ++v) {
        const auto& [of, share] = mesh.origin[static_cast<std::size_t>(v - own)];
        out.row(v) = share[0] * out.row(of[0]) + share[1] * out.row(of[1]) + share[2] * out.row(of[2]);
    }
    const Eigen::VectorXd whole = integrals(mesh.mesh, touchable, out);
    for (Eigen::Index p = 0; p < out.cols(); ++p) out.col(p) *= whole[p] > 0.0 ? 1.0 / whole[p] : 0.0;
    return out;
}

Eigen::MatrixXd patchResultants(const SolverMesh& mesh, const Eigen::MatrixXd& tractions, const Vec3& middle, double size) {
    Eigen::MatrixXd force = Eigen::MatrixXd::Zero(1, tractions.cols()), arm = Eigen::MatrixXd::Zero(3, tractions.cols());
    eachTouchable(mesh.mesh, touchableOf(mesh), [&](std::int32_t f, double area) {
        std::array<Vec3, 3> x;
        Vec3 sum = Vec3::Zero();
        for (int c = 0; c < 3; ++c) sum += x[static_cast<std::size_t>(c)] = mesh.mesh.vertices.row(mesh.mesh.triangles(f, c)).transpose() - middle;
        for (int c = 0; c < 3; ++c) {
            const auto values = tractions.row(mesh.mesh.triangles(f, c));
            force += area / 3.0 * values;
            arm += area / 12.0 * (sum + x[static_cast<std::size_t>(c)]) * values;
        }
    });
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(6, 3 * tractions.cols());
    for (Eigen::Index p = 0; p < tractions.cols(); ++p)
        for (int axis = 0; axis < 3; ++axis) {
            out(axis, 3 * p + axis) = force(0, p);
            out.block<3, 1>(3, 3 * p + axis) = Vec3(arm.col(p)).cross(Vec3::Unit(axis)) / size;
        }
    return out;
}

Eigen::MatrixXd patchCompliance(const SolverMesh& mesh, const Eigen::MatrixXd& tractions, const std::vector<std::int32_t>& freeVertices,
                                const BoundaryProblem::Solution& solution) {
    const Eigen::Index patches = tractions.cols(), columns = 3 * patches;
    // Integrals of tractions times the hat of a vertex, and times the bubble of an edge.
    Eigen::MatrixXd hats = Eigen::MatrixXd::Zero(tractions.rows(), patches),
                    bubbles = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(mesh.bubbles.size()), patches);
    eachTouchable(mesh.mesh, touchableOf(mesh), [&](std::int32_t f, double area) {
        std::array<std::int32_t, 3> v{mesh.mesh.triangles(f, 0), mesh.mesh.triangles(f, 1), mesh.mesh.triangles(f, 2)};
        const Eigen::RowVectorXd sum = tractions.row(v[0]) + tractions.row(v[1]) + tractions.row(v[2]);
        for (std::size_t c = 0; c < 3; ++c) {
            hats.row(v[c]) += area / 12.0 * (sum + tractions.row(v[c]));
            const std::array<std::int32_t, 2> edge{std::min(v[c], v[(c + 1) % 3]), std::max(v[c], v[(c + 1) % 3])};
            const auto at = std::lower_bound(mesh.bubbles.begin(), mesh.bubbles.end(), edge);
            if (at != mesh.bubbles.end() && *at == edge)
                bubbles.row(at - mesh.bubbles.begin()) += area / 15.0 * (2.0 * sum - tractions.row(v[(c + 2) % 3]));
        }
    });
    Eigen::MatrixXd hatsOfFree(static_cast<Eigen::Index>(freeVertices.size()), patches);
    for (std::size_t i = 0; i < freeVertices.size(); ++i) hatsOfFree.row(static_cast<Eigen::Index>(i)) = hats.row(freeVertices[i]);
    Eigen::MatrixXd out(columns, columns);
    for (int axis = 0; axis < 3; ++axis) {
        const auto ofAxis = [&](const Eigen::MatrixXd& u) -> Eigen::MatrixXd {
            return u.rightCols(columns)(Eigen::seq(axis, Eigen::indexing::last, 3), Eigen::indexing::all);
        };
        Eigen::MatrixXd rows = hatsOfFree.transpose() * ofAxis(solution.displacement);
        if (bubbles.rows() > 0) rows += bubbles.transpose() * ofAxis(solution.bubbles);
        out(Eigen::seq(axis, Eigen::indexing::last, 3), Eigen::indexing::all) = rows;
    }
    return out;
}

Result<void> finishTouch(const TriangleMesh& body, std::span<const JointFace> faces, const std::vector<std::int32_t>& free, double nu, int threads,
                         TouchResponse& response, const Progress& progress) {
    Eigen::MatrixXd& C = response.compliance;
    const double symmetricNorm = (C + C.transpose()).norm();
    response.asymmetry = symmetricNorm > 0.0 ? (C - C.transpose()).norm() / symmetricNorm : 0.0;
    C = (0.5 * (C + C.transpose())).eval();
    const auto spectrum = projectToSemidefinite(C, progress);
    if (!spectrum) return tl::make_unexpected(spectrum.error());
    C = (0.5 * (C + C.transpose())).eval();  // to the last bit
    response.negativeEnergy = spectrum->highest > 0.0 ? std::min(spectrum->lowest, 0.0) / spectrum->highest : 0.0;

    // Gradients at the vertices: means of the triangles around, weighted by area, as those of slivers are inaccurate.
    const TouchPatches& patches = response.patches;
    const Eigen::Index count = patches.count(), vertices = body.vertices.rows();
    const std::vector<char> touchable = touchableOf(body, faces);
    const Eigen::MatrixXd weights = patches.dense();
    const Eigen::VectorXd whole = integrals(body, touchable, weights);
    std::vector<Eigen::Index> row(static_cast<std::size_t>(vertices), -1);
    for (std::size_t i = 0; i < free.size(); ++i) row[static_cast<std::size_t>(free[i])] = 3 * static_cast<Eigen::Index>(i);
    std::vector<std::pair<std::int32_t, TriangleFrame>> frames;
    Eigen::VectorXd around = Eigen::VectorXd::Zero(vertices);
    eachTouchable(body, touchable, [&](std::int32_t f, double) {
        const TriangleFrame frame = triangleFrame(body, f);
        if (!(frame.area > 0.0)) return;
        frames.emplace_back(f, frame);
        for (int c = 0; c < 3; ++c) around[body.triangles(f, c)] += frame.area;
    });
    // By forces on patch q along three axes.
    using Gradients = std::array<Eigen::Matrix3d, 3>;
    const auto gradientsBy = [&](Eigen::Index q) {
        std::vector<Gradients> sum(static_cast<std::size_t>(vertices), {Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()});
        for (const auto& [f, frame] : frames) {
            double bump = 0.0;
            for (int c = 0; c < 3; ++c) bump += weights(body.triangles(f, c), q) / 3.0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                std::array<Vec3, 3> u;
                for (int c = 0; c < 3; ++c) {
                    const Eigen::Index at = row[static_cast<std::size_t>(body.triangles(f, c))];
                    u[static_cast<std::size_t>(c)] =
                        at < 0 ? Vec3::Zero() : Vec3(response.displacement.block<3, 1>(at, 3 * q + static_cast<Eigen::Index>(axis)).cast<double>());
                }
                const Vec3 traction = whole[q] > 0.0 ? Vec3(bump / whole[q] * Vec3::Unit(static_cast<Eigen::Index>(axis))) : Vec3::Zero();
                const Eigen::Matrix3d gradient = frame.area * gradientOf(frame, u, traction, nu);
                for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(body.triangles(f, c))][axis] += gradient;
            }
        }
        for (std::size_t v = 0; v < sum.size(); ++v)
            if (const double area = around[static_cast<Eigen::Index>(v)]; area > 0.0)
                for (Eigen::Matrix3d& gradient : sum[v]) gradient /= area;
        return sum;
    };

    // For each patch p, among the vertices where its weight is the largest, the one with the largest gradient (Frobenius) by forces on patch q.
    struct Largest {
        double square = 0.0;
        std::int32_t vertex = -1;
    };
    std::vector<Eigen::Index> patchOf(static_cast<std::size_t>(vertices), -1);
    for (Eigen::Index v = 0; v < vertices; ++v)
        if (around[v] > 0.0 && patches.first[static_cast<std::size_t>(v)] < patches.first[static_cast<std::size_t>(v) + 1])
            weights.row(v).maxCoeff(&patchOf[static_cast<std::size_t>(v)]);
    std::vector<Largest> largest(static_cast<std::size_t>(count * count));
    const auto each = [&](const auto& work) {
        std::atomic<Eigen::Index> done{0};
        parallelFor(threads, static_cast<std::size_t>(count), 1, [&](std::size_t begin, std::size_t end) {
            for (auto q = static_cast<Eigen::Index>(begin); q < static_cast<Eigen::Index>(end) && !progress.cancelled(); ++q, ++done) work(q);
        });
        return done == count;
    };
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    if (!each([&](Eigen::Index q) {
            const std::vector<Gradients> gradients = gradientsBy(q);
            for (std::size_t v = 0; v < gradients.size(); ++v) {
                if (patchOf[v] < 0) continue;
                double square = 0.0;
                for (const Eigen::Matrix3d& gradient : gradients[v]) square += gradient.squaredNorm();
                Largest& known = largest[static_cast<std::size_t>(q * count + patchOf[v])];
                if (square > (1.0 + kTie) * known.square) known = {square, static_cast<std::int32_t>(v)};
            }
        }))
        return cancelled();
    for (Eigen::Index p = 0; p < count; ++p) {
        Largest other;
        for (Eigen::Index q = 0; q < count; ++q)
            if (const Largest& by = largest[static_cast<std::size_t>(q * count + p)]; q != p && by.square > (1.0 + kTie) * other.square) other = by;
        for (const std::int32_t v : {largest[static_cast<std::size_t>(p * count + p)].vertex, other.vertex})
            if (v >= 0) response.probes.push_back(v);
    }
    std::sort(response.probes.begin(), response.probes.end());
    response.probes.erase(std::unique(response.probes.begin(), response.probes.end()), response.probes.end());
    response.gradients.resize(9 * static_cast<Eigen::Index>(response.probes.size()), 3 * count);
    if (!each([&](Eigen::Index q) {
            const std::vector<Gradients> gradients = gradientsBy(q);
            for (std::size_t i = 0; i < response.probes.size(); ++i)
                for (int axis = 0; axis < 3; ++axis)
                    for (int k = 0; k < 3; ++k)
                        response.gradients.block<3, 1>(static_cast<Eigen::Index>(9 * i) + 3 * k, 3 * q + axis) =
                            gradients[static_cast<std::size_t>(response.probes[i])][static_cast<std::size_t>(axis)].row(k).transpose().cast<float>();
        }))
        return cancelled();
    return {};
}

}  // namespace imomushi
