// SPDX-License-Identifier: GPL-3.0-or-later
// Inside, lengths are in sizes of the element, positions are about the mean of its faces' origins, and vertices are in the order of elimination:
// those that the system solves for, one of each shell that no face holds, then the held ones.
#include "core/warp/bend_warp.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numeric>

#include "core/base/union_find.h"
#include "core/mesh/triangle_tree.h"
#include "core/warp/sparse_factor.h"
#include "core/warp/triangle_kernels.h"

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Matrix3f;
using Eigen::Vector4f;

namespace {

// A triangle flatter than this (twice its area over its longest side squared) says nothing about rotations; it only follows, this softly.
constexpr double kSliver = 1e-4, kSliverStiffness = 1e-3;
// Stretches beyond these are treated as these.
constexpr double kLeastStretch = 0.1, kMostStretch = 10.0;
// Within this many sizes of a face (at most this part of the way to the next one) triangles follow the face more and more: linear elasticity with a
// rigid rim has a singular crease there, that nobody wants to see of a large bend. It counts by the square of the motion of the face, half at
// this one (radians).
constexpr double kBand = 2.0, kBandShare = 0.5, kFollowWholly = 0.2;
constexpr float kBandMotion = 0.04f;
// Nearer than this many sizes they are stiffer, up to this many times at the rim; softness grows evenly from there. What shapes cannot agree on is
// settled farther away, and slopes that are left at the rim are as small as they change from row to row beside it.
constexpr double kStiffBand = 0.8, kStiffness = 50.0;
// The inflation falls off towards faces over this many times the size of the largest one, and moves nothing by more than this part of the element's
// width.
constexpr double kInflationRange = 0.5, kMostInflation = 0.25;
// Its amount is found in so many steps of Newton's method with the first slope, or until the volume is as near as this.
constexpr int kVolumeSteps = 4;
constexpr double kVolumeError = 1e-4;
// Beside a face, up to this many sizes of it from its middle: vertices closer to its plane than this many sizes, or than at rest, stop before they
// cross it. They begin to be stopped at half of that.
constexpr double kContactInside = 1.0, kContactOutside = 1.5, kContactDepth = 0.25;
// Vertices that are this close to the plane at rest, in sizes of the face, lie beside it, not before it.
constexpr double kLeastDepth = 1e-4;
// Of every vertex; that of a vertex among good triangles is about 4.
constexpr double kLeastStiffness = 1e-7;

/// Vectors of the frame: x y z and nothing.
using Vectors = std::vector<Vector4f, Eigen::aligned_allocator<Vector4f>>;
float* floats(Vectors& vectors) { return reinterpret_cast<float*>(vectors.data()); }

/// Three numbers that compilers keep in registers: half the time of Eigen's.
struct Three {
    float x = 0.0f, y = 0.0f, z = 0.0f;
    Three() = default;
    Three(float x_, float y_, float z_) : x(x_), y(y_), z(z_) {}
    explicit Three(const Eigen::Vector3f& v) : x(v.x()), y(v.y()), z(v.z()) {}
    explicit Three(const Vec3& v) : Three(Eigen::Vector3f(v.cast<float>())) {}
    explicit Three(const Vector4f& v) : x(v[0]), y(v[1]), z(v[2]) {}
    [[nodiscard]] float dot(const Three& o) const { return x * o.x + y * o.y + z * o.z; }
    [[nodiscard]] Three cross(const Three& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
    [[nodiscard]] float squaredNorm() const { return dot(*this); }
    Three& operator+=(const Three& o) { return x += o.x, y += o.y, z += o.z, *this; }
    friend Three operator+(Three a, const Three& b) { return a += b; }
    friend Three operator-(const Three& a, const Three& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Three operator*(float s, const Three& a) { return {s * a.x, s * a.y, s * a.z}; }
    friend Three operator/(const Three& a, float s) { return (1.0f / s) * a; }
    friend Three operator*(const Matrix3f& m, const Three& a) {
        return {m(0, 0) * a.x + m(0, 1) * a.y + m(0, 2) * a.z, m(1, 0) * a.x + m(1, 1) * a.y + m(1, 2) * a.z,
                m(2, 0) * a.x + m(2, 1) * a.y + m(2, 2) * a.z};
    }
};
Three three(const Vector4f& v) { return Three(v); }
Vector4f four(const Three& v) { return {v.x, v.y, v.z, 0.0f}; }

// The rotation vector of a quaternion, 0...360 degrees by its sign.
Vec3 rotationVector(const Eigen::Quaterniond& q) {
    const double s = q.vec().norm();
    if (!(s > 1e-12 * std::abs(q.w()))) return q.w() != 0.0 ? Vec3(2.0 * q.vec() / q.w()) : Vec3(Vec3::Zero());
    return 2.0 * std::atan2(s, q.w()) / s * q.vec();
}

Matrix3d skew(const Vec3& w) {
    Matrix3d m;
    m << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
    return m;
}

Matrix3d logarithm(const Matrix3d& symmetric) {
    Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
    eigen.compute(symmetric);
    const Vec3 l = eigen.eigenvalues().cwiseMax(kLeastStretch).cwiseMin(kMostStretch).array().log();
    return eigen.eigenvectors() * l.asDiagonal() * eigen.eigenvectors().transpose();
}

// s d + w x d for the stretch exp(s) and the rotation w, by the nearest way, that turn d into e. size: of the element.
Vec3 logarithmicMove(const Vec3& d, const Vec3& e, double size) {
    const double from = d.norm(), to = e.norm();
    if (!(from > 1e-9 * size)) return e - d;
    const double stretch = std::clamp(to / from, kLeastStretch, kMostStretch);
    const Vec3 cross = d.cross(e);
    const double sine = cross.norm();
    Vec3 out = std::log(stretch) * d;
    if (sine > 1e-12 * from * to && to > 1e-9 * from) out += std::atan2(sine, d.dot(e)) / sine * cross.cross(d);
    return out;
}

}  // namespace

struct BendWarp::State {
    int solved = 0, vertices = 0;  // of the order above
    int free = 0;                  // solved, and one of each floating shell
    double size = 1.0, nu = 0.45;
    Vec3 middle = Vec3::Zero(), origin = Vec3::Zero();  // of the element's box as given, of its faces (m)
    std::vector<JointFace> faces;
    std::vector<FaceBasis> bases;
    std::vector<int> firstColumn;
    std::vector<Points> restOfFace;  // in its axes, m
    std::vector<std::int32_t> held;  // body vertices
    std::vector<std::int32_t> indexOfHeld;
    std::vector<std::int64_t> slot;            // of free vertices: their x in `local`
    Eigen::MatrixXf response;                  // 3 free x g, in sizes
    std::vector<Eigen::MatrixXf> heldColumns;  // per face, 3 #vertices x g_f, in sizes
    Eigen::VectorXd volumeChange;              // per column, in sizes^3
    double volume = 0.0;
    Vectors rest;
    std::vector<WarpBatch> triangles;              // that count
    std::vector<std::array<std::int32_t, 3>> surface;  // all
    std::vector<float> inflation;                      // per vertex, 0...1
    SparseFactor factor;
    struct Shell {
        std::vector<std::int32_t> vertices;
        std::vector<WarpBatch> batches;
        std::size_t triangles = 0;
    };
    std::vector<Shell> floating;  // shells without held vertices
    struct Contact {
        std::int32_t vertex;
        float depth, weight;
    };
    std::vector<std::vector<Contact>> contacts;  // per face
    std::vector<FollowBatch> follow;  // triangles in the band of a face, ascending; parts of a triangle add up to 1 at most
    Cost cost;

    // of a frame
    Eigen::VectorXd v;
    Eigen::VectorXf weights, moved;
    Vectors base, displacement, at, force;
    std::vector<WishBatch> wishes;
    std::vector<FaceStrain> strains;  // per face

    void evaluate(std::span<const FaceMotion> motions, const Eigen::VectorXd& warping, const Points& heldAt, float* local) {
        const Vec3 carried = findParameters(motions, warping);
        const Matrix3d stretch = baseStretch(motions);
        strainFaces(motions, stretch);
        displace(stretch);
        const Vec3 place = origin + carried;
        for (std::size_t i = 0; i < held.size(); ++i)
            at[indexOfHeld[i]].head<3>() = ((heldAt.row(static_cast<Eigen::Index>(i)).transpose() - place) / size).cast<float>();
        placeFloating();
        solve(true);
        solve(false);
        inflate();
        keepInside(motions, carried);
        const Eigen::Vector3f shown = (place - middle).cast<float>();
        const auto unit = static_cast<float>(size);
        for (int i = 0; i < free; ++i)
            for (int axis = 0; axis < 3; ++axis) local[slot[i] + axis * kBlock] = unit * at[i][axis] + shown[axis];
    }

    // v of the logarithms of the motions; returns what all faces are shifted by, which is left out of v.
    Vec3 findParameters(std::span<const FaceMotion> motions, const Eigen::VectorXd& warping) {
        Vec3 carried = Vec3::Zero();
        Vec3 mean = Vec3::Zero();  // of the faces' rotations: the way that their origins go round
        for (std::size_t f = 0; f < faces.size(); ++f) mean += rotationVector(motions[f].rotation) / static_cast<double>(faces.size());
        const double angle = mean.norm();
        const Matrix3d back = Eigen::AngleAxisd(-angle, angle > 0.0 ? Vec3(mean / angle) : Vec3(Vec3::UnitX())).toRotationMatrix();
        for (std::size_t f = 0; f < faces.size(); ++f)
            carried +=
                (motions[f].linear * faces[f].frame.origin + motions[f].shift - faces[f].frame.origin) / static_cast<double>(faces.size());
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const auto& m = motions[f];
            const auto& frame = faces[f].frame;
            const Vec3 d = frame.origin - origin, e = m.linear * frame.origin + m.shift - origin - carried;
            const Matrix3d r = m.rotation.normalized().toRotationMatrix(), s = r.transpose() * m.linear;
            JointMap map;
            map.linear = Matrix3d::Identity() +
                         frame.axes.transpose() * (skew(rotationVector(m.rotation)) + logarithm(0.5 * (s + s.transpose()))) * frame.axes;
            map.shift = frame.axes.transpose() * (mean.cross(d) + logarithmicMove(d, back * e, size));
            double lost = 0.0;
            bases[f].coefficients(map, restOfFace[f], faces[f].size, v.data() + firstColumn[f], lost);
        }
        v += warping;
        return carried;
    }

    void strainFaces(std::span<const FaceMotion> motions, const Matrix3d& stretch) {
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const Matrix3d s = motions[f].rotation.normalized().toRotationMatrix().transpose() * motions[f].linear;
            const Vec3 n = faces[f].frame.axes.col(2), w = rotationVector(motions[f].rotation);
            const Matrix3d plane = Matrix3d::Identity() - n * n.transpose();
            const Matrix3d e = plane * (logarithm(0.5 * (s + s.transpose())) - stretch) * plane;
            const double squared = w.squaredNorm() + e.squaredNorm();
            auto& out = strains[f];
            Eigen::Map<Eigen::Vector3f>(out.w) = w.cast<float>();
            Eigen::Map<Matrix3f>(out.e) = e.cast<float>();  // symmetric
            Eigen::Map<Eigen::Vector3f>(out.normal) = n.cast<float>();
            out.weight = static_cast<float>(squared / (squared + kBandMotion * kBandMotion));
        }
    }

    // Logarithm of the stretch that two faces give the whole body.
    [[nodiscard]] Matrix3d baseStretch(std::span<const FaceMotion> motions) const {
        if (faces.size() != 2) return Matrix3d::Zero();
        const auto placed = [&](std::size_t f) -> Vec3 { return motions[f].linear * faces[f].frame.origin + motions[f].shift; };
        const Vec3 d = faces[1].frame.origin - faces[0].frame.origin;
        const double from = d.norm(), to = (placed(1) - placed(0)).norm();
        if (!(from > 1e-6 * size)) return Matrix3d::Zero();
        const double s = std::log(std::clamp(to / from, kLeastStretch, kMostStretch));
        const Matrix3d along = d * d.transpose() / (from * from);
        return s * (along - nu * (Matrix3d::Identity() - along));
    }

    // Steps 1 and 2: base, displacement, and where vertices would be by them.
    void displace(const Matrix3d& logStretch) {
        weights = v.cast<float>();
        if (v.size() > 0) moved.noalias() = response * weights;
        Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
        eigen.compute(logStretch);
        const Matrix3f grow =
            (eigen.eigenvectors() * eigen.eigenvalues().array().exp().matrix().asDiagonal() * eigen.eigenvectors().transpose())
                .cast<float>();
        const Matrix3f linear = logStretch.cast<float>();
        for (int i = 0; i < free; ++i) displacement[i].head<3>() = moved.segment<3>(3 * i);
        std::size_t h = 0;
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const auto part = weights.segment(firstColumn[f], heldColumns[f].cols());
            for (Eigen::Index i = 0; 3 * i < heldColumns[f].rows(); ++i, ++h)
                displacement[indexOfHeld[h]].head<3>() = heldColumns[f].middleRows<3>(3 * i).lazyProduct(part);
        }
        for (int i = 0; i < vertices; ++i) {
            const Three x = three(rest[i]);
            const Three u = grow * (three(displacement[i]) - linear * x), b = grow * x;
            base[i] = four(b);
            displacement[i] = four(u);
            at[i] = four(b + u);
        }
    }

    // A shell that no face holds goes where a body with its mean rotation and displacement goes: the displacement turns while it grows.
    void placeFloating() {
        for (const auto& shell : floating) {
            float sum[3] = {};
            addRotations(shell.batches.data(), shell.triangles, floats(base), floats(displacement), sum);
            const Three w = Three(sum[0], sum[1], sum[2]) / static_cast<float>(std::max<std::size_t>(shell.triangles, 1));
            Three u;
            for (const auto i : shell.vertices) u += three(displacement[i]) / static_cast<float>(shell.vertices.size());
            const float squared = w.squaredNorm(), angle = std::sqrt(squared);
            const float a = angle < 1e-2f ? 0.5f : (1.0f - std::cos(angle)) / squared;
            const float b = angle < 1e-2f ? 1.0f / 6.0f : (angle - std::sin(angle)) / (squared * angle);
            const Three wu = w.cross(u), shift = a * wu + b * w.cross(wu);
            for (const auto i : shell.vertices) at[i] += four(shift);
        }
    }

    // Steps 3 and 4.
    void solve(bool first) {
        std::fill(force.begin(), force.end(), Vector4f::Zero());
        if (first)
            pullToResponse(triangles.data(), triangles.size(), follow.data(), follow.size(), strains.data(), floats(base), floats(displacement),
                           floats(at), wishes.data(), floats(force));
        else
            pullToFit(triangles.data(), triangles.size(), floats(at), wishes.data(), floats(force));
        factor.solve(force.data());
        for (int i = solved; i < vertices; ++i) force[i].setZero();
        for (const auto& shell : floating) {
            Vector4f mean = Vector4f::Zero();
            for (const auto i : shell.vertices) mean += force[i] / static_cast<float>(shell.vertices.size());
            for (const auto i : shell.vertices) force[i] -= mean;
        }
        for (int i = 0; i < free; ++i) at[i] += force[i];
    }

    // Step 5: along normals, so that the volume is what the linear response says.
    void inflate() {
        if (!(volume > 0.0) || inflation.empty()) return;
        const double wanted = volume * std::exp(std::clamp(volumeChange.dot(v) / volume, -1.0, 1.0));
        std::fill(force.begin(), force.end(), Vector4f::Zero());
        for (const auto& t : surface) {
            const Three x0 = three(at[t[0]]);
            const Three n = (three(at[t[1]]) - x0).cross(three(at[t[2]]) - x0);
            const Vector4f normal = four(n);
            for (const auto i : t) force[i] += normal;
        }
        double now = 0.0, slope = 0.0;
        for (int i = 0; i < vertices; ++i) {
            const float length = std::sqrt(force[i].squaredNorm());
            now += static_cast<double>(three(force[i]).dot(three(at[i]))) / 18.0;
            slope += static_cast<double>(inflation[i] * length) / 6.0;
            force[i] *= length > 1e-20f ? inflation[i] / length : 0.0f;
        }
        const double most = kMostInflation * std::cbrt(volume);
        if (!(slope * most > 1e-6 * volume)) return;
        double by = 0.0;
        for (int step = 0; step < kVolumeSteps && std::abs(wanted - now) > kVolumeError * volume; ++step) {
            const double next = std::clamp(by + (wanted - now) / slope, -most, most);
            for (int i = 0; i < free; ++i) at[i] += static_cast<float>(next - by) * force[i];
            by = next;
            now = volumeNow();
        }
    }

    [[nodiscard]] double volumeNow() const {
        double sum = 0.0;
        for (const auto& t : surface) sum += static_cast<double>(three(at[t[0]]).dot(three(at[t[1]]).cross(three(at[t[2]])))) / 6.0;
        return sum;
    }

    // Step 6.
    void keepInside(std::span<const FaceMotion> motions, const Vec3& carried) {
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const auto& frame = faces[f].frame;
            const Vec3 turned = motions[f].rotation.normalized() * frame.axes.col(2);
            Vec3 normal = (motions[f].linear * frame.axes.col(0)).cross(motions[f].linear * frame.axes.col(1));
            const double length = normal.norm();
            normal = length > 1e-6 ? Vec3(normal / (normal.dot(turned) < 0.0 ? -length : length)) : turned;
            const Three n(normal);
            const Three place(Vec3((motions[f].linear * frame.origin + motions[f].shift - origin - carried) / size));
            for (const auto& c : contacts[f]) {
                const float depth = n.dot(place - three(at[c.vertex]));
                if (depth < c.depth) at[c.vertex] -= four(c.weight * (c.depth / (2.0f - depth / c.depth) - depth) * n);
            }
        }
    }
};

namespace {

// 1 below 0, 0 above 1.
double fade(double x) {
    const double t = std::clamp(x, 0.0, 1.0);
    return 1.0 - t * t * (3.0 - 2.0 * t);
}

// How much a triangle follows a face at this part of the band: wholly beside it, where the response is singular, then falling fast at first, so that
// the curvature which it takes from there spreads evenly.
double follow(double x) {
    const double from = x * (1.0 - fade(x / kFollowWholly));
    return std::pow(1.0 - std::min(1.0, from), 3);
}

// Of the middle of each triangle, per face, m.
std::vector<std::vector<double>> distanceToFaces(const TriangleMesh& body, const std::vector<JointFace>& faces) {
    std::vector<std::vector<double>> out;
    for (const auto& face : faces) {
        auto& list = out.emplace_back(static_cast<std::size_t>(body.triangles.rows()), 0.0);
        const TriangleTree tree(body, face.triangles);
        for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
            Vec3 middle = Vec3::Zero();
            for (int c = 0; c < 3; ++c) middle += body.vertices.row(body.triangles(t, c)).transpose() / 3.0;
            list[t] = std::sqrt(tree.nearest(middle).squaredDistance);
        }
    }
    return out;
}

// A triangle that counts; see WarpBatch.
struct ElasticTriangle {
    std::array<std::int32_t, 3> v;
    float c11, c12, c22;
};

std::vector<WarpBatch> batchesOf(const std::vector<ElasticTriangle>& triangles) {
    std::vector<WarpBatch> out((triangles.size() + kWarpBatch - 1) / kWarpBatch, WarpBatch{});
    for (std::size_t i = 0; i < out.size() * kWarpBatch; ++i) {
        const ElasticTriangle& t = triangles[std::min(i, triangles.size() - 1)];
        const std::size_t lane = i % kWarpBatch;
        auto& batch = out[i / kWarpBatch];
        for (std::size_t c = 0; c < 3; ++c) batch.corner[c][lane] = 4 * t.v[c];
        if (i < triangles.size()) batch.c11[lane] = t.c11, batch.c12[lane] = t.c12, batch.c22[lane] = t.c22;
    }
    return out;
}

bool fits(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response,
          std::span<const std::int32_t> blocks) {
    const auto vertices = body.vertices.rows();
    if (!body.vertices.allFinite() ||
        (body.triangles.size() > 0 && (body.triangles.minCoeff() < 0 || body.triangles.maxCoeff() >= vertices)))
        return false;
    if (response.bases.size() != faces.size() || response.firstColumn.size() != faces.size() + 1) return false;
    std::vector<char> seen(static_cast<std::size_t>(vertices), 0);
    std::size_t count = response.freeVertices.size();
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (response.firstColumn[f + 1] - response.firstColumn[f] != response.bases[f].columns()) return false;
        for (const auto v : faces[f].vertices)
            if (v < 0 || v >= vertices || seen[v]++) return false;
        count += faces[f].vertices.size();
    }
    std::size_t block = 0;
    for (const auto v : response.freeVertices) {
        if (v < 0 || v >= vertices || seen[v]++) return false;
        while (block < blocks.size() && blocks[block] + BendWarp::kBlock <= v) ++block;
        if (block == blocks.size() || blocks[block] > v) return false;
    }
    return count == static_cast<std::size_t>(vertices) &&
           response.response.rows() == 3 * static_cast<Eigen::Index>(response.freeVertices.size()) &&
           response.response.cols() == response.columns() && response.response.allFinite();
}

}  // namespace

Result<BendWarp> BendWarp::build(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response, double nu,
                                 std::span<const std::int32_t> blocks, const Vec3& middle, const Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    if (!fits(body, faces, response, blocks) || !middle.allFinite() || !(nu >= 0.0 && nu <= 0.5))
        return fail("bad-value", "The response of an element belongs to another mesh or other joint faces; precompute again.");
    progress.report("warp", 0.0);
    auto state = std::make_unique<State>();
    auto& s = *state;
    const auto n = static_cast<std::size_t>(body.vertices.rows());
    s.vertices = static_cast<int>(n);
    s.nu = nu;
    s.middle = middle;
    s.faces = faces;
    s.bases = response.bases;
    s.firstColumn = response.firstColumn;
    if (n > 0) s.size = (body.vertices.colwise().maxCoeff() - body.vertices.colwise().minCoeff()).norm();
    if (!(s.size > 0.0)) s.size = 1.0;
    s.origin = middle;
    if (!faces.empty()) {
        s.origin.setZero();
        for (const auto& face : faces) s.origin += face.frame.origin / static_cast<double>(faces.size());
    }

    // Which vertices are solved for.
    std::vector<char> kind(n, 0);  // 0 solved, 1 one of a floating shell, 2 held
    for (const auto& face : faces)
        for (const auto v : face.vertices) kind[v] = 2;
    UnionFind shells(static_cast<std::size_t>(n));
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t)
        for (int c = 0; c < 2; ++c) shells.unite(body.triangles(t, c), body.triangles(t, c + 1));
    std::vector<char> holds(n, 0);
    for (std::size_t v = 0; v < n; ++v)
        if (kind[v] == 2) holds[shells.find(static_cast<std::int32_t>(v))] = 1;
    for (std::size_t v = 0; v < n; ++v)
        if (shells.find(static_cast<std::int32_t>(v)) == static_cast<std::int32_t>(v) && !holds[v]) kind[v] = 1;

    // The surface's stiffness: of each triangle, the integral of gradient times gradient.
    const Points points = (body.vertices.rowwise() - s.origin.transpose()) / s.size;
    const auto point = [&](std::int32_t v) -> Vec3 { return points.row(v).transpose(); };
    std::vector<std::int32_t> row(n, -1);
    for (std::size_t v = 0; v < n; ++v)
        if (kind[v] == 0) row[v] = s.solved++;
    std::vector<char> counts;
    std::vector<SparseEntry> entries;
    Eigen::VectorXd area = Eigen::VectorXd::Zero(s.solved);
    Points outward = Points::Zero(static_cast<Eigen::Index>(n), 3);
    const auto distances = distanceToFaces(body, faces);
    std::vector<double> bands;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        double nearest = kBand * faces[f].size;
        for (std::size_t o = 0; o < faces.size(); ++o)
            if (o != f) nearest = std::min(nearest, kBandShare * (faces[o].frame.origin - faces[f].frame.origin).norm());
        bands.push_back(std::max(nearest, 1e-6 * s.size));
    }
    std::vector<ElasticTriangle> triangles;
    std::vector<std::vector<float>> parts(faces.size());  // of triangles, that follow each face
    for (Eigen::Index k = 0; k < body.triangles.rows(); ++k) {
        const std::array<std::int32_t, 3> v{body.triangles(k, 0), body.triangles(k, 1), body.triangles(k, 2)};
        const Vec3 e1 = point(v[1]) - point(v[0]), e2 = point(v[2]) - point(v[0]), normal = e1.cross(e2);
        const double longest = std::max({e1.squaredNorm(), e2.squaredNorm(), (e1 - e2).squaredNorm()}), twice = normal.norm();
        const bool sliver = !(twice > kSliver * longest) || !(longest > 1e-16);
        double stiffer = 1.0;
        for (std::size_t f = 0; f < faces.size(); ++f)
            stiffer = std::max(
                stiffer, 1.0 / (1.0 / kStiffness + (1.0 - 1.0 / kStiffness) *
                                                       std::pow(std::min(1.0, distances[f][k] / (kStiffBand / kBand * bands[f])), 1.5)));
        const double over = stiffer * (sliver ? kSliverStiffness / std::max(longest, 1e-30) : 0.5 / twice);
        const double c11 = over * e2.squaredNorm(), c12 = -over * e1.dot(e2), c22 = over * e1.squaredNorm();
        const double c[3][3] = {{c11 + 2.0 * c12 + c22, -c11 - c12, -c12 - c22}, {-c11 - c12, c11, c12}, {-c12 - c22, c12, c22}};
        for (int i = 0; i < 3; ++i) {
            outward.row(v[i]) += normal.transpose() / 6.0;
            if (row[v[i]] < 0) continue;
            area[row[v[i]]] += twice / 6.0;
            for (int j = 0; j < 3; ++j)
                if (row[v[j]] >= 0) entries.push_back({row[v[i]], row[v[j]], c[i][j]});
        }
        s.volume += point(v[0]).dot(point(v[1]).cross(point(v[2]))) / 6.0;
        s.surface.push_back(v);
        if (sliver || (kind[v[0]] == 2 && kind[v[1]] == 2 && kind[v[2]] == 2)) continue;
        double sum = 0.0;
        for (std::size_t f = 0; f < faces.size(); ++f) sum += follow(distances[f][k] / bands[f]);
        for (std::size_t f = 0; f < faces.size(); ++f) parts[f].push_back(static_cast<float>(follow(distances[f][k] / bands[f]) / std::max(1.0, sum)));
        triangles.push_back({v, static_cast<float>(c11), static_cast<float>(c12), static_cast<float>(c22)});
    }
    if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
    progress.report("warp", 0.2);
    // Vertices of slivers alone hang on this, and rounding of the others is far below.
    for (int i = 0; i < s.solved; ++i) entries.push_back({i, i, kLeastStiffness});
    auto factor = SparseFactor::build(s.solved, entries);
    if (!factor)
        return fail("bad-value", "The triangles of an element are too extreme to warp it; mend its mesh or leave the bend warp off.");
    s.factor = std::move(*factor);
    if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
    progress.report("warp", 0.6);

    // The order of elimination, then the others; held ones in the order of their faces.
    std::vector<std::int32_t> index(n, -1);
    for (std::size_t v = 0; v < n; ++v)
        if (row[v] >= 0) index[v] = s.factor.order()[row[v]];
    s.free = s.solved;
    for (std::size_t v = 0; v < n; ++v)
        if (kind[v] == 1) index[v] = s.free++;
    for (const auto& face : faces)
        for (const auto v : face.vertices) {
            s.held.push_back(v);
            s.indexOfHeld.push_back(index[v] = s.free + static_cast<std::int32_t>(s.indexOfHeld.size()));
        }
    for (auto& t : s.surface)
        for (auto& v : t) v = index[v];
    for (auto& t : triangles)
        for (auto& v : t.v) v = index[v];
    s.triangles = batchesOf(triangles);
    for (std::size_t first = 0; first < triangles.size(); first += kWarpBatch)
        for (std::size_t f = 0; f < faces.size(); ++f) {
            FollowBatch batch{static_cast<std::int32_t>(first / kWarpBatch), static_cast<std::int32_t>(f), {}};
            const auto from = parts[f].begin() + static_cast<std::ptrdiff_t>(first);
            std::copy(from, std::min(from + kWarpBatch, parts[f].end()), batch.part);
            if (std::any_of(batch.part, batch.part + kWarpBatch, [](float part) { return part > 0.0f; })) s.follow.push_back(batch);
        }
    s.rest.assign(n, Vector4f::Zero());
    for (std::size_t v = 0; v < n; ++v) s.rest[index[v]].head<3>() = point(static_cast<std::int32_t>(v)).cast<float>();

    // Inflation: (L + area / range^2) x = area.
    double range = 0.0;
    for (const auto& face : faces) range = std::max(range, kInflationRange * face.size / s.size);
    if (s.volume > 1e-9 && range > 1e-6) {
        for (int i = 0; i < s.solved; ++i) entries.push_back({i, i, area[i] / (range * range)});
        const auto x = solveSparse(entries, area);
        if (const double most = x ? x->maxCoeff() : 0.0; most > 0.0) {
            s.inflation.assign(n, 0.0f);
            for (std::size_t v = 0; v < n; ++v)
                if (row[v] >= 0 && holds[shells.find(static_cast<std::int32_t>(v))])
                    s.inflation[index[v]] = static_cast<float>(std::max(0.0, (*x)[row[v]] / most));
        }
    }
    if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
    progress.report("warp", 0.8);

    // Responses.
    const Eigen::Index columns = response.columns();
    s.response.resize(3 * s.free, columns);
    s.slot.assign(s.free, 0);
    s.volumeChange = Eigen::VectorXd::Zero(columns);
    std::size_t block = 0;
    for (std::size_t i = 0; i < response.freeVertices.size(); ++i) {
        const auto v = response.freeVertices[i];
        while (blocks[block] + kBlock <= v) ++block;
        s.slot[index[v]] = static_cast<std::int64_t>(block) * 3 * kBlock + (v - blocks[block]);
        const auto rows = response.response.middleRows<3>(3 * static_cast<Eigen::Index>(i)) / s.size;
        s.response.middleRows<3>(3 * index[v]) = rows.cast<float>();
        s.volumeChange += rows.transpose() * outward.row(v).transpose();
    }
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const auto& frame = faces[f].frame;
        s.restOfFace.push_back(localVertices(body, faces[f]));
        Eigen::MatrixXf table(3 * s.restOfFace[f].rows(), response.bases[f].columns());
        for (Eigen::Index i = 0; i < s.restOfFace[f].rows(); ++i) {
            const Eigen::MatrixXd at = frame.axes * response.bases[f].at(s.restOfFace[f].row(i).transpose(), static_cast<int>(i)) / s.size;
            table.middleRows<3>(3 * i) = at.cast<float>();
            s.volumeChange.segment(response.firstColumn[f], at.cols()) += at.transpose() * outward.row(faces[f].vertices[i]).transpose();
        }
        s.heldColumns.push_back(std::move(table));
    }

    // Shells that nobody holds.
    std::vector<int> shellOf(n, -1);
    for (std::size_t v = 0; v < n; ++v)
        if (const auto root = shells.find(static_cast<std::int32_t>(v)); !holds[root]) {
            if (shellOf[root] < 0) shellOf[root] = static_cast<int>(s.floating.size()), s.floating.emplace_back();
            s.floating[shellOf[root]].vertices.push_back(index[v]);
        }
    std::vector<std::int32_t> bodyVertex(n);
    for (std::size_t v = 0; v < n; ++v) bodyVertex[index[v]] = static_cast<std::int32_t>(v);
    std::vector<std::vector<ElasticTriangle>> ofShell(s.floating.size());
    for (const auto& t : triangles)
        if (const auto shell = shellOf[shells.find(bodyVertex[t.v[0]])]; shell >= 0) ofShell[shell].push_back(t);
    for (std::size_t i = 0; i < ofShell.size(); ++i) {
        s.floating[i].batches = batchesOf(ofShell[i]);
        s.floating[i].triangles = ofShell[i].size();
    }

    for (const auto& face : faces) {
        auto& list = s.contacts.emplace_back();
        for (const auto v : response.freeVertices) {
            const Vec3 p = face.frame.toLocal(body.vertices.row(v).transpose()) / std::max(face.size, 1e-30);
            const double depth = -p.z(), aside = p.head<2>().norm();
            const double weight = fade((aside - kContactInside) / (kContactOutside - kContactInside)) * fade(depth - 1.0);
            if (depth > kLeastDepth && weight > 0.0)
                list.push_back(
                    {index[v], static_cast<float>(0.5 * std::min(depth, kContactDepth) * face.size / s.size), static_cast<float>(weight)});
        }
    }

    s.v = Eigen::VectorXd::Zero(columns);
    s.weights = Eigen::VectorXf::Zero(columns);
    s.moved = Eigen::VectorXf::Zero(3 * s.free);
    s.base = s.displacement = s.at = s.force = s.rest;
    s.wishes.resize(s.triangles.size());
    s.strains.resize(faces.size());
    s.cost.factor = s.factor.entries();
    s.cost.bytes = s.factor.bytes() + static_cast<std::size_t>(s.response.size()) * sizeof(float) + 5 * n * sizeof(Vector4f) +
                   3 * s.free * sizeof(float) + s.triangles.size() * (sizeof(WarpBatch) + sizeof(WishBatch)) +
                   s.surface.size() * sizeof(s.surface[0]) + s.slot.size() * sizeof(s.slot[0]) + s.inflation.size() * sizeof(float) +
                   s.follow.size() * sizeof(FollowBatch);
    for (const auto& table : s.heldColumns) s.cost.bytes += static_cast<std::size_t>(table.size()) * sizeof(float);
    for (const auto& list : s.contacts) s.cost.bytes += list.size() * sizeof(State::Contact);
    s.cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return BendWarp(std::move(state));
}

BendWarp::BendWarp(std::unique_ptr<State> state) : state_(std::move(state)) {}
BendWarp::BendWarp(BendWarp&&) noexcept = default;
BendWarp& BendWarp::operator=(BendWarp&&) noexcept = default;
BendWarp::~BendWarp() = default;

const std::vector<std::int32_t>& BendWarp::heldVertices() const { return state_->held; }

void BendWarp::evaluate(std::span<const FaceMotion> motions, const Eigen::VectorXd& warping, const Points& held, float* local) {
    state_->evaluate(motions, warping, held, local);
}

BendWarp::Cost BendWarp::cost() const { return state_->cost; }

}  // namespace imomushi
