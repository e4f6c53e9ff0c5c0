// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/proposal/mirror_plane.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/decompositions.h"
#include "core/mesh/bounds.h"
#include "core/mesh/triangle_tree.h"

namespace imomushi {
namespace {

constexpr Eigen::Index kMirrorSamples = 600;
constexpr int kRefinements = 8, kPolishings = 10;
/// Of the diagonal: distances as small as this are rounding of a file in single precision.
constexpr double kRounding = 1e-7;
/// A polished plane may be worse on average by this factor: what differs on both sides no longer draws it aside.
constexpr double kMostPolished = 1.1;
/// A normal this near to an axis is that axis: a third of a degree. Modelled symmetry is exact, and its plane goes through the middle or the origin.
constexpr double kOnAxis = 6e-3;
/// Planes this near to each other, in diagonals, are one.
constexpr double kSamePlace = 5e-3;
/// One that is better by this is preferred whatever its direction, in diagonals.
constexpr double kClearlyBetter = 2e-3;

struct MirrorCandidate {
    CutPlane plane;
    double error = 0.0;
};

class MirrorFinder {
public:
    explicit MirrorFinder(const TriangleMesh& mesh) : mesh_(mesh), tree_(mesh), box_(boundsOf(mesh.vertices)) {
        // Vertices weigh what their triangles do, so that dense parts do not decide alone.
        weight_.assign(static_cast<std::size_t>(mesh.vertices.rows()), 0.0);
        for (Eigen::Index f = 0; f < mesh.triangles.rows(); ++f) {
            const Vec3 a = at(mesh.triangles(f, 0)), b = at(mesh.triangles(f, 1)), c = at(mesh.triangles(f, 2));
            const double area = 0.5 * (b - a).cross(c - a).norm();
            for (int k = 0; k < 3; ++k) weight_[static_cast<std::size_t>(mesh.triangles(f, k))] += area / 3.0;
        }
        const Eigen::Index step = std::max<Eigen::Index>(1, mesh.vertices.rows() / kMirrorSamples);
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); v += step) samples_.push_back(v);
    }

    std::optional<CutPlane> find() {
        Vec3 middle = Vec3::Zero();
        double whole = 0.0;
        for (Eigen::Index v = 0; v < mesh_.vertices.rows(); ++v) middle += weight_[static_cast<std::size_t>(v)] * at(v), whole += weight_[static_cast<std::size_t>(v)];
        if (!(whole > 0.0)) return std::nullopt;
        middle /= whole;
        Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
        for (Eigen::Index v = 0; v < mesh_.vertices.rows(); ++v) spread += weight_[static_cast<std::size_t>(v)] / whole * (at(v) - middle) * (at(v) - middle).transpose();
        const auto axes = eigenpairsOf(spread);

        std::vector<MirrorCandidate> found;
        const auto consider = [&](const Vec3& origin, const Vec3& normal) {
            MirrorCandidate made = refined({origin, normal.normalized()});
            if (made.error <= kMirrorTolerance) found.push_back(made);
        };
        const Vec3 centre = box_.low + 0.5 * box_.size();
        for (const int axis : {0, 2, 1}) consider(centre, Vec3::Unit(axis));
        for (const int axis : {0, 1, 2}) consider(middle, axes.vectors.col(axis));
        if (found.empty()) return std::nullopt;
        const auto rank = [](const MirrorCandidate& c) {
            const Vec3 n = c.plane.normal.cwiseAbs();
            return n.y() > 0.7 ? 2 : n.z() > n.x() ? 1 : 0;
        };
        const MirrorCandidate* best = &found.front();
        for (const MirrorCandidate& c : found)
            if (c.error < best->error - kClearlyBetter || (c.error < best->error + kClearlyBetter && rank(c) < rank(*best))) best = &c;
        return best->plane;
    }

private:
    [[nodiscard]] Vec3 at(Eigen::Index v) const { return mesh_.vertices.row(v).transpose(); }

    /// Root mean square distance of the mirrored samples from the surface, in diagonals.
    [[nodiscard]] double errorOf(const CutPlane& plane) const {
        double sum = 0.0, whole = 0.0;
        for (const Eigen::Index v : samples_) {
            const double w = weight_[static_cast<std::size_t>(v)];
            sum += w * tree_.nearest(mirroredPoint(plane, at(v))).squaredDistance;
            whole += w;
        }
        return whole > 0.0 ? std::sqrt(sum / whole) / box_.diagonal() : HUGE_VAL;
    }

    /// Fits the plane to pairs of a sample and the place of the surface nearest to its mirror image: they lie opposite each other.
    [[nodiscard]] MirrorCandidate refined(CutPlane plane) const {
        MirrorCandidate best{plane, errorOf(plane)};
        CutPlane now = plane;
        for (int k = 0; k < kRefinements && best.error > 1e-6; ++k) {
            Vec3 middle = Vec3::Zero();
            double whole = 0.0;
            std::vector<std::pair<Vec3, Vec3>> pairs;
            for (const Eigen::Index v : samples_) {
                const Vec3 p = at(v);
                const auto hit = tree_.nearest(mirroredPoint(now, p));
                if (hit.triangle < 0) continue;
                Vec3 q = Vec3::Zero();
                for (int c = 0; c < 3; ++c) q += hit.barycentric[c] * at(mesh_.triangles(hit.triangle, c));
                const double w = weight_[static_cast<std::size_t>(v)];
                middle += w * 0.5 * (p + q);
                whole += w;
                pairs.emplace_back(p, q);
            }
            if (!(whole > 0.0)) break;
            middle /= whole;
            // The normal minimises the sum of (p - middle).n (q - middle).n, as both lie on different sides.
            Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                const Vec3 p = pairs[i].first - middle, q = pairs[i].second - middle;
                products += weight_[static_cast<std::size_t>(samples_[i])] * (p * q.transpose() + q * p.transpose());
            }
            const auto solver = eigenpairsOf(products);
            Vec3 normal = solver.vectors.col(0);
            if (normal.dot(plane.normal) < 0.0) normal = -normal;
            if (normal.dot(plane.normal) < 0.8) break;  // another plane
            now = {middle, normal};
            const double error = errorOf(now);
            if (!(error < best.error)) break;
            best = {now, error};
        }
        return snapped(polished(best));
    }

    /// A plane of which most of the surface is the exact mirror image is found to rounding, however the rest differs (a mended spot, a bag on one shoulder): least squares
    /// of distances to the tangent planes, in which far pairs weigh little. So a turned or scaled character has the same plane.
    [[nodiscard]] MirrorCandidate polished(const MirrorCandidate& rough) const {
        CutPlane now = rough.plane;
        for (int k = 0; k < kPolishings; ++k) {
            struct Pair {
                Eigen::Vector3d slope;  // of the distance: by two turns of the normal, by a shift along it
                double distance = 0.0, weight = 0.0;
            };
            const Vec3 first = now.normal.unitOrthogonal(), second = now.normal.cross(first);
            std::vector<Pair> pairs;
            std::vector<double> distances;
            for (const Eigen::Index v : samples_) {
                const Vec3 p = at(v), mirrored = mirroredPoint(now, p);
                const auto hit = tree_.nearest(mirrored);
                if (hit.triangle < 0) continue;
                const auto t = mesh_.triangles.row(hit.triangle);
                const Vec3 area = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
                if (!(area.norm() > 0.0)) continue;
                const Vec3 m = area.normalized();
                const double height = now.normal.dot(p - now.origin), lean = m.dot(now.normal);
                const auto turn = [&](const Vec3& by) { return -2.0 * (by.dot(p - now.origin) * lean + height * by.dot(m)); };
                pairs.push_back({{turn(first), turn(second), 2.0 * lean}, m.dot(mirrored - at(t[0])), weight_[static_cast<std::size_t>(v)]});
                distances.push_back(std::abs(pairs.back().distance));
            }
            if (pairs.size() < 8) return rough;
            const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
            std::nth_element(distances.begin(), middle, distances.end());
            const double near = std::max(*middle, kRounding * box_.diagonal());
            Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
            Eigen::Vector3d right = Eigen::Vector3d::Zero();
            for (const Pair& pair : pairs) {
                const double far = pair.distance / near, weight = pair.weight / ((1.0 + far * far) * (1.0 + far * far));
                matrix += weight * pair.slope * pair.slope.transpose();
                right -= weight * pair.distance * pair.slope;
            }
            const auto solver = eigenpairsOf(matrix);
            if (!(solver.values[0] > 1e-9 * solver.values[2])) return rough;  // a body of revolution: any plane will do
            const Eigen::Vector3d step = solver.vectors * solver.values.cwiseInverse().asDiagonal() * solver.vectors.transpose() * right;
            now.origin += step[2] * now.normal;
            now.normal = (now.normal + step[0] * first + step[1] * second).normalized();
        }
        return errorOf(now) <= kMostPolished * rough.error + kRounding ? MirrorCandidate{now, rough.error} : rough;
    }

    [[nodiscard]] MirrorCandidate snapped(MirrorCandidate c) const {
        int axis = 0;
        for (int k = 1; k < 3; ++k)
            if (std::abs(c.plane.normal[k]) > std::abs(c.plane.normal[axis])) axis = k;
        if (c.plane.normal[axis] < 0.0) c.plane.normal = -c.plane.normal;
        if ((c.plane.normal - Vec3::Unit(axis)).norm() > kOnAxis) return c;
        const Vec3 centre = box_.low + 0.5 * box_.size();
        CutPlane straight{Vec3(centre), Vec3::Unit(axis)};
        const double place = centre[axis] - c.plane.normal.dot(centre - c.plane.origin);
        straight.origin[axis] = place;
        for (const double wish : {0.0, centre[axis]})
            if (std::abs(wish - place) <= kSamePlace * box_.diagonal()) {
                straight.origin[axis] = wish;
                break;
            }
        const double error = errorOf(straight);
        return error <= c.error + 1e-3 ? MirrorCandidate{straight, error} : c;
    }

    const TriangleMesh& mesh_;
    TriangleTree tree_;
    Bounds box_;
    std::vector<double> weight_;
    std::vector<Eigen::Index> samples_;
};

}  // namespace

std::optional<CutPlane> findMirrorPlane(const TriangleMesh& mesh) {
    if (mesh.triangles.rows() == 0) return std::nullopt;
    return MirrorFinder(mesh).find();
}

}  // namespace imomushi
