// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/display_mapping.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <string>

#include "core/base/finite.h"
#include "core/base/parallel.h"
#include "core/mesh/bounds.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"
#include "core/reduction/surface_gradient.h"

namespace imomushi {
namespace {

using Gradient = Eigen::Matrix3d;  ///< row: component of u, column: direction

/// A vertex follows a triangle that faces its way up to this many times as far as the nearest one: on a thin fin that is the right side
/// of it, on detail that overhangs the solver's surface the other side of the body is out of reach.
constexpr double kReach = 2.0;

/// Vertices per piece of work: some milliseconds.
constexpr std::size_t kGrain = 4096;

}  // namespace

Result<DisplayMapping> DisplayMapping::build(const Input& input, const Progress& progress) {
    const TriangleMesh& display = *input.display;
    const TriangleMesh& solver = *input.solver;
    const auto count = static_cast<std::size_t>(display.vertices.rows());
    if (!input.leaveOut.empty() && input.leaveOut.size() != count)
        return fail("bad-value", "The list of vertices to leave out has " + std::to_string(input.leaveOut.size()) + " entries for " +
                                     std::to_string(count) + " vertices; give one for each.");
    if (!allFinite(display.vertices) || !allFinite(solver.vertices))
        return fail("bad-value", "A mesh has vertices that are not numbers; repair it first.");
    for (const TriangleMesh* mesh : {&display, &solver})
        if (mesh->triangles.size() > 0 && (mesh->triangles.minCoeff() < 0 || mesh->triangles.maxCoeff() >= mesh->vertices.rows()))
            return fail("bad-value", "A triangle names a vertex that does not exist; repair the mesh first.");

    DisplayMapping mapping;
    mapping.solver_ = solver;
    mapping.free_.assign(static_cast<std::size_t>(solver.triangles.rows()), 1);
    for (const std::int32_t t : input.heldTriangles) {
        if (t < 0 || t >= solver.triangles.rows()) return fail("bad-value", "A joint face names a triangle that does not exist; choose it again.");
        mapping.free_[static_cast<std::size_t>(t)] = 0;
    }
    std::vector<std::int32_t> free;
    for (std::int32_t t = 0; t < solver.triangles.rows(); ++t) {
        auto& flag = mapping.free_[static_cast<std::size_t>(t)];
        if (flag && !(triangleFrame(solver, t).area > 0.0)) flag = 0;
        if (flag) free.push_back(t);
    }
    if (free.empty()) return fail("no-free-surface", "The joint faces cover the whole surface that is solved on; make them smaller.");

    mapping.around_ = VertexCorners({solver.triangles.data(), static_cast<std::size_t>(solver.triangles.size())}, static_cast<std::size_t>(solver.vertices.rows()),
                                    mapping.free_);

    for (std::size_t v = 0; v < count; ++v)
        if (input.leaveOut.empty() || !input.leaveOut[v]) mapping.vertices_.push_back(static_cast<std::int32_t>(v));
    if (progress.cancelled()) return fail(kCancelled, "Mapping the display was cancelled.");
    const TriangleTree tree(solver, std::move(free));
    const Points normals = vertexNormals(display);
    if (progress.cancelled()) return fail(kCancelled, "Mapping the display was cancelled.");

    mapping.places_.resize(mapping.vertices_.size());
    std::atomic<std::size_t> done{0};
    parallelFor(input.threads, mapping.vertices_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        if (progress.cancelled()) return;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 x = display.vertices.row(mapping.vertices_[i]);
            TriangleTree::Hit hit = tree.nearest(x);
            const TriangleTree::Hit facing = tree.nearestFacing(x, normals.row(mapping.vertices_[i]).transpose());
            if (facing.triangle >= 0 && facing.squaredDistance <= kReach * kReach * hit.squaredDistance) hit = facing;
            Vec3 p = Vec3::Zero();
            for (int c = 0; c < 3; ++c) p += hit.barycentric[c] * solver.vertices.row(solver.triangles(hit.triangle, c)).transpose();
            mapping.places_[i] = {hit.barycentric, x - p, hit.triangle};
        }
        done += end - begin;
    });
    if (done != mapping.vertices_.size()) return fail(kCancelled, "Mapping the display was cancelled.");

    const double diagonal = diagonalOf(display.vertices);
    double squares = 0.0, largest = 0.0;
    for (const Place& place : mapping.places_) {
        const double squared = place.offset.squaredNorm();
        squares += squared;
        largest = std::max(largest, squared);
    }
    if (diagonal > 0.0 && !mapping.places_.empty()) {
        mapping.distance_.largest = std::sqrt(largest) / diagonal;
        const double rms = std::sqrt(squares / static_cast<double>(mapping.places_.size()));
        mapping.distance_.rms = rms / diagonal;
        double volume = 0.0, area = 0.0;
        const Vec3 origin = solver.vertices.row(0);
        for (std::int32_t t = 0; t < solver.triangles.rows(); ++t) {
            const Vec3 twice = areaVector(solver, t);
            area += 0.5 * twice.norm();
            volume += (solver.vertices.row(solver.triangles(t, 0)).transpose() - origin).dot(twice) / 6.0;
        }
        if (volume > 0.0) mapping.distance_.shape = rms * area / (2.0 * volume);
    }
    progress.report("map", 1.0);
    return mapping;
}

Result<DisplayMapping::Mapped> DisplayMapping::apply(const Eigen::MatrixXd& displacement, double nu, int threads, const Progress& progress) const {
    if (displacement.rows() != 3 * solver_.vertices.rows())
        return fail("bad-value", "There are " + std::to_string(displacement.rows()) + " displacements for a solver mesh of " +
                                     std::to_string(solver_.vertices.rows()) + " vertices; give three for each.");
    if (!(nu >= 0.0 && nu <= 0.5)) return fail("bad-value", "The Poisson ratio is 0 to 0.5.");
    if (!allFinite(displacement)) return fail("bad-value", "Displacements are not numbers; precompute again.");
    const double stretch = nu / (1.0 - nu);
    const Eigen::Index columns = displacement.cols();
    const auto triangles = static_cast<std::size_t>(solver_.triangles.rows()), solverVertices = static_cast<std::size_t>(solver_.vertices.rows());
    Mapped out;
    out.displacement.resize(3 * static_cast<Eigen::Index>(vertices_.size()), columns);
    out.error = out.largestError = Eigen::VectorXd::Zero(columns);

    std::vector<Gradient> ofTriangle(triangles), ofVertex(solverVertices);
    std::vector<double> area(triangles);
    struct Sums {
        double displacement = 0.0, error = 0.0, largest = 0.0;
    };
    std::vector<Sums> sums((vertices_.size() + kGrain - 1) / kGrain);
    for (Eigen::Index column = 0; column < columns; ++column) {
        if (progress.cancelled()) return fail(kCancelled, "Mapping the display was cancelled.");
        progress.report("map", static_cast<double>(column) / static_cast<double>(columns));
        const double* all = displacement.col(column).data();
        const auto u = [&](std::int32_t v) { return Eigen::Map<const Vec3>(all + 3 * static_cast<std::ptrdiff_t>(v)); };
        const auto cornersOf = [&](std::int32_t t) { return std::array<Vec3, 3>{u(solver_.triangles(t, 0)), u(solver_.triangles(t, 1)), u(solver_.triangles(t, 2))}; };
        parallelFor(threads, triangles, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                if (!free_[t]) continue;
                const TriangleFrame frame = triangleFrame(solver_, static_cast<std::int32_t>(t));
                ofTriangle[t] = gradientOf(frame, cornersOf(static_cast<std::int32_t>(t)), stretch);
                area[t] = frame.area;
            }
        });
        parallelFor(threads, solverVertices, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                Gradient sum = Gradient::Zero();
                double weight = 0.0;
                for (const std::int32_t corner : around_.at(static_cast<std::int32_t>(v))) {
                    const auto t = static_cast<std::size_t>(corner / 3);
                    sum += area[t] * ofTriangle[t];
                    weight += area[t];
                }
                if (weight > 0.0) sum /= weight;
                ofVertex[v] = sum;
            }
        });
        double* to = out.displacement.col(column).data();
        parallelFor(threads, vertices_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            Sums sum;
            for (std::size_t i = begin; i < end; ++i) {
                const Place& place = places_[i];
                std::array<Vec3, 3> x;
                Vec3 p = Vec3::Zero(), linear = Vec3::Zero();
                for (int c = 0; c < 3; ++c) {
                    const std::int32_t v = solver_.triangles(place.triangle, c);
                    x[static_cast<std::size_t>(c)] = solver_.vertices.row(v);
                    p += place.barycentric[c] * x[static_cast<std::size_t>(c)];
                    linear += place.barycentric[c] * u(v);
                }
                Vec3 curved = Vec3::Zero();
                Gradient mean = Gradient::Zero();
                for (int c = 0; c < 3; ++c) {
                    const Gradient& G = ofVertex[static_cast<std::size_t>(solver_.triangles(place.triangle, c))];
                    curved += 0.5 * place.barycentric[c] * (G * (p - x[static_cast<std::size_t>(c)]));
                    mean += place.barycentric[c] * G;
                }
                const Vec3 result = linear + curved + mean * place.offset;
                const Vec3 doubt = curved + (mean - ofTriangle[static_cast<std::size_t>(place.triangle)]) * place.offset;
                Eigen::Map<Vec3>(to + 3 * i) = result;
                sum.displacement += result.squaredNorm();
                sum.error += doubt.squaredNorm();
                sum.largest = std::max(sum.largest, doubt.squaredNorm());
            }
            sums[begin / kGrain] = sum;
        });
        Sums total;
        for (const Sums& part : sums) {
            total.displacement += part.displacement;
            total.error += part.error;
            total.largest = std::max(total.largest, part.largest);
        }
        out.error[column] = total.displacement > 0.0 ? std::sqrt(total.error / total.displacement) : 0.0;
        out.largestError[column] = std::sqrt(total.largest);
    }
    return out;
}

std::size_t DisplayMapping::bytes() const {
    return sizeof(Place) * places_.size() + sizeof(std::int32_t) * vertices_.size() + around_.bytes() + free_.size() +
           sizeof(double) * static_cast<std::size_t>(solver_.vertices.size()) + sizeof(std::int32_t) * static_cast<std::size_t>(solver_.triangles.size());
}

}  // namespace imomushi
