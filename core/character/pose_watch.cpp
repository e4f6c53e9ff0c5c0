// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/pose_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/rotation_vector.h"

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Joint faces are tried out turning about so many axes in their plane.
constexpr int kAxes = 8;
// Radians, or sizes of a face: motions are small, as responses are linear.
constexpr double kSmall = 1e-3;
// Of the triangles that fold first in one motion, so many are watched.
constexpr std::size_t kOfMotion = 3;
// Vertices nearer to the plane of a face than this part of its size at rest say nothing: the surface may lie in that plane.
constexpr double kNearPlane = 0.08;
// Sizes of motions that are tried out until one calls for the warp.
constexpr double kFirstSize = 0.01, kLastSize = 0.5, kSizeStep = 1.25;
// A triangle with a sine below this is a sliver; its normal says nothing.
constexpr double kSliver = 0.02;

Matrix3d crossMatrix(const Vec3& w) {
    Matrix3d m;
    m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    return m;
}

/// How far x has gone from `from` to `to`: 0 ... 1, smooth.
double ramp(double x, double from, double to) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/// rad, 0 ... 2 pi.
double largestTurn(std::span<const FaceMotion> motions) {
    double largest = 0.0;
    for (const auto& motion : motions) largest = std::max(largest, 2.0 * std::atan2(motion.rotation.vec().norm(), motion.rotation.w()));
    return largest;
}

// Where the bend warp begins, and where it is whole. The volume goes with the square of a bend.
constexpr double kAreaFrom = 0.75, kAreaTo = 0.4;
constexpr double kDepthFrom = 0.7, kDepthTo = 0.35;
constexpr double kVolumeFrom = 0.003, kVolumeTo = 0.016;
constexpr double kBendFrom = 0.45, kBendTo = 0.9;  // rad

}  // namespace

/// A small motion of joint faces that is tried out.
struct TriedMotion {
    std::vector<Vec3> turns, shifts;  // per face, rad and m, in the axes of the element
    VectorXd v;
};

class PoseWatchBuilder {
public:
    PoseWatchBuilder(const TriangleMesh& body, std::span<const JointFace> faces, const ElementResponse& response)
        : body_(body), faces_(faces), response_(response), faceOf_(static_cast<std::size_t>(body.vertices.rows()), -1) {
        for (std::size_t f = 0; f < faces.size(); ++f)
            for (const auto v : faces[f].vertices) faceOf_[static_cast<std::size_t>(v)] = static_cast<int>(f);
        indexOf_.assign(faceOf_.size(), -1);
    }

    std::shared_ptr<const PoseWatch> build() {
        for (const auto& face : faces_) {
            out_->frames_.push_back(face.frame);
            out_->sizes_.push_back(face.size);
            out_->restOfFace_.push_back(localVertices(body_, face));
        }
        out_->bases_ = response_.bases;
        out_->firstColumn_ = response_.firstColumn;
        findMoves();
        const auto tried = motions();
        for (const auto& motion : tried) choose(motion);
        takeSamples();
        if (moves_.cols() <= PoseWatch::kMostColumns) findVolume();
        findCalm(tried);
        return out_;
    }

private:
    // Displacements of all body vertices per column, 3 #V x g.
    void findMoves() {
        moves_ = MatrixXd::Zero(3 * body_.vertices.rows(), response_.columns());
        for (std::size_t i = 0; i < response_.freeVertices.size(); ++i)
            moves_.middleRows<3>(3 * response_.freeVertices[i]) = response_.response.middleRows<3>(3 * static_cast<Eigen::Index>(i));
        for (std::size_t f = 0; f < faces_.size(); ++f)
            for (std::size_t i = 0; i < faces_[f].vertices.size(); ++i) {
                const Eigen::Index vertex = faces_[f].vertices[i];
                const Vec3 local = faces_[f].frame.toLocal(body_.vertices.row(vertex).transpose());
                const MatrixXd block = faces_[f].frame.axes * response_.bases[f].at(local, static_cast<int>(i));
                moves_.block(3 * vertex, response_.firstColumn[f], 3, block.cols()) = block;
            }
    }

    void add(TriedMotion& motion, std::size_t f, const Vec3& turn, const Vec3& shift) const {
        const auto& face = faces_[f];
        JointMap map;
        map.linear += face.frame.axes.transpose() * crossMatrix(turn) * face.frame.axes;
        map.shift = face.frame.axes.transpose() * shift;
        double lost = 0.0;
        response_.bases[f].coefficients(map, out_->restOfFace_[f], face.size, motion.v.data() + response_.firstColumn[f], lost);
        motion.turns[f] = turn;
        motion.shifts[f] = shift;
    }

    [[nodiscard]] std::vector<TriedMotion> motions() const {
        const TriedMotion none{std::vector<Vec3>(faces_.size(), Vec3::Zero()), std::vector<Vec3>(faces_.size(), Vec3::Zero()), VectorXd::Zero(response_.columns())};
        std::vector<TriedMotion> all;
        const auto axisOf = [&](std::size_t f, int k) -> Vec3 {
            const double angle = 2.0 * std::numbers::pi * k / kAxes;
            return kSmall * faces_[f].frame.axes * Vec3(std::cos(angle), std::sin(angle), 0.0);
        };
        for (std::size_t f = 0; f < faces_.size(); ++f) {
            const Vec3 outward = kSmall * faces_[f].frame.axes.col(2);
            for (int k = 0; k < kAxes; ++k) add(all.emplace_back(none), f, axisOf(f, k), Vec3::Zero());
            for (const double sign : {1.0, -1.0}) add(all.emplace_back(none), f, sign * outward, Vec3::Zero());
            add(all.emplace_back(none), f, Vec3::Zero(), -faces_[f].size * outward);
        }
        // A bow and an S.
        for (int k = 0; faces_.size() == 2 && k < kAxes; ++k)
            for (const double sign : {1.0, -1.0}) {
                add(all.emplace_back(none), 0, axisOf(0, k), Vec3::Zero());
                add(all.back(), 1, sign * axisOf(0, k), Vec3::Zero());
            }
        return all;
    }

    [[nodiscard]] Vec3 rest(Eigen::Index vertex) const { return body_.vertices.row(vertex).transpose(); }
    [[nodiscard]] Vec3 normalOf(Eigen::Index t) const {
        return (rest(body_.triangles(t, 1)) - rest(body_.triangles(t, 0))).cross(rest(body_.triangles(t, 2)) - rest(body_.triangles(t, 0)));
    }
    /// The face nearest to a triangle.
    [[nodiscard]] int nearestFace(Eigen::Index t) const {
        int best = 0;
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t f = 0; f < faces_.size(); ++f)
            if (const double d = (rest(body_.triangles(t, 0)) - faces_[f].frame.origin).squaredNorm(); d < nearest) nearest = d, best = static_cast<int>(f);
        return best;
    }

    void choose(const TriedMotion& motion) {
        const VectorXd moved = moves_ * motion.v;
        const auto move = [&](Eigen::Index v) -> Vec3 { return moved.segment<3>(3 * v); };
        std::vector<std::pair<double, Eigen::Index>> folding;
        std::pair<double, Eigen::Index> tilting{0.0, -1};
        int rim = -1;
        for (Eigen::Index t = 0; t < body_.triangles.rows(); ++t) {
            const Eigen::Index a = body_.triangles(t, 0), b = body_.triangles(t, 1), c = body_.triangles(t, 2);
            int held = 0, face = -1;
            for (const Eigen::Index v : {a, b, c})
                if (const int f = faceOf_[static_cast<std::size_t>(v)]; f >= 0) ++held, face = f;
            if (held == 3) continue;
            const Vec3 p = rest(b) - rest(a), q = rest(c) - rest(a), n = p.cross(q);
            const double area = n.norm();
            if (!(area > kSliver * p.norm() * q.norm())) continue;
            const Vec3 dn = (move(b) - move(a)).cross(q) + p.cross(move(c) - move(a));
            folding.emplace_back(dn.dot(n) / (area * area), t);
            if (held != 2) continue;
            const Vec3 tilt = dn - n * (dn.dot(n) / (area * area)) - motion.turns[static_cast<std::size_t>(face)].cross(n);
            if (const double angle = tilt.norm() / area; angle > tilting.first) tilting = {angle, t}, rim = face;
        }
        const std::size_t count = std::min(kOfMotion, folding.size());
        std::partial_sort(folding.begin(), folding.begin() + static_cast<std::ptrdiff_t>(count), folding.end());
        for (std::size_t i = 0; i < count; ++i)
            if (folding[i].first < 0.0) addTriangle(out_->triangles_, folding[i].second, nearestFace(folding[i].second));
        if (tilting.second >= 0) addTriangle(out_->rims_, tilting.second, rim);
        for (std::size_t f = 0; f < faces_.size(); ++f) chooseDepth(motion, f, move);
    }

    template <class Move>
    void chooseDepth(const TriedMotion& motion, std::size_t f, const Move& move) {
        const auto& frame = faces_[f].frame;
        const Vec3 normal = frame.axes.col(2);
        double fastest = 0.0, depthOf = 0.0;
        Eigen::Index found = -1;
        for (const auto v : response_.freeVertices) {
            const Vec3 from = rest(v) - frame.origin;
            const double depth = -normal.dot(from);
            if (depth < kNearPlane * faces_[f].size) continue;
            // How fast it comes nearer to the plane, which turns.
            const double rate = (normal.dot(move(v)) + motion.turns[f].cross(normal).dot(from)) / depth;
            if (rate > fastest) fastest = rate, found = v, depthOf = depth;
        }
        if (found < 0) return;
        const int sample = sampleOf(static_cast<std::int32_t>(found));
        const auto same = [&](const PoseWatch::Depth& d) { return d.sample == sample && d.face == static_cast<int>(f); };
        if (std::none_of(out_->depths_.begin(), out_->depths_.end(), same)) out_->depths_.push_back({sample, static_cast<int>(f), depthOf});
    }

    int sampleOf(std::int32_t vertex) {
        int& index = indexOf_[static_cast<std::size_t>(vertex)];
        if (index < 0) {
            index = static_cast<int>(out_->samples_.size());
            out_->samples_.push_back(vertex);
        }
        return index;
    }

    void addTriangle(std::vector<PoseWatch::Triangle>& to, Eigen::Index t, int face) {
        const Vec3 n = normalOf(t);
        PoseWatch::Triangle made{{sampleOf(body_.triangles(t, 0)), sampleOf(body_.triangles(t, 1)), sampleOf(body_.triangles(t, 2))}, face, n.normalized(), n.norm()};
        if (std::none_of(to.begin(), to.end(), [&](const auto& known) { return known.corner == made.corner; })) to.push_back(made);
    }

    void takeSamples() {
        const auto count = static_cast<Eigen::Index>(out_->samples_.size());
        out_->rows_.resize(3 * count, moves_.cols());
        out_->rest_.resize(count, 3);
        for (Eigen::Index i = 0; i < count; ++i) {
            out_->rows_.middleRows<3>(3 * i) = moves_.middleRows<3>(3 * out_->samples_[static_cast<std::size_t>(i)]);
            out_->rest_.row(i) = body_.vertices.row(out_->samples_[static_cast<std::size_t>(i)]);
        }
    }

    // Motions grow until one calls for something; several at once may do so at half of that.
    void findCalm(const std::vector<TriedMotion>& tried) {
        auto room = out_->room();
        std::vector<FaceMotion> motions(faces_.size());
        VectorXd v(response_.columns());
        for (double size = kFirstSize; size < kLastSize; size *= kSizeStep) {
            for (const auto& motion : tried) {
                for (std::size_t f = 0; f < faces_.size(); ++f) {
                    const auto& face = faces_[f];
                    auto& m = motions[f];
                    m.rotation = rotationOf(size / kSmall * motion.turns[f]);
                    m.linear = m.rotation.toRotationMatrix();
                    m.shift = face.frame.origin - m.linear * face.frame.origin + size / kSmall * motion.shifts[f];
                    JointMap map;
                    map.linear = face.frame.axes.transpose() * m.linear * face.frame.axes;
                    map.shift = face.frame.axes.transpose() * (size / kSmall * motion.shifts[f]);
                    double lost = 0.0;
                    response_.bases[f].coefficients(map, out_->restOfFace_[f], face.size, v.data() + response_.firstColumn[f], lost);
                }
                if (PoseWatch::callForWarp(out_->measure(v, motions, room)) > 0.0) return;
            }
            out_->calm_ = 0.5 * size;
        }
    }

    // 6 V = sum over triangles of det(x_a, x_b, x_c), and its derivatives by v at rest.
    void findVolume() {
        const Points x = body_.vertices.rowwise() - body_.vertices.colwise().mean();
        VectorXd slope = VectorXd::Zero(3 * x.rows());
        MatrixXd turned = MatrixXd::Zero(moves_.rows(), moves_.cols());
        double volume = 0.0;
        for (Eigen::Index t = 0; t < body_.triangles.rows(); ++t)
            for (int k = 0; k < 3; ++k) {
                const Eigen::Index a = body_.triangles(t, k), b = body_.triangles(t, (k + 1) % 3), c = body_.triangles(t, (k + 2) % 3);
                const Vec3 xa = x.row(a).transpose(), xb = x.row(b).transpose(), xc = x.row(c).transpose();
                slope.segment<3>(3 * a) += xb.cross(xc) / 6.0;
                if (k == 0) volume += xa.dot(xb.cross(xc)) / 6.0;
                // Of a: u_b x x_c + x_b x u_c.
                turned.middleRows<3>(3 * a).noalias() += crossMatrix(xb) / 6.0 * moves_.middleRows<3>(3 * c) - crossMatrix(xc) / 6.0 * moves_.middleRows<3>(3 * b);
            }
        if (!(volume > 0.0)) return;
        out_->volumeSlope_ = moves_.transpose() * slope / volume;
        out_->volumeCurve_ = moves_.transpose() * turned / volume;
    }

    const TriangleMesh& body_;
    std::span<const JointFace> faces_;
    const ElementResponse& response_;
    std::vector<int> faceOf_, indexOf_;  // per body vertex, -1: none
    MatrixXd moves_;
    std::shared_ptr<PoseWatch> out_{new PoseWatch};
};

std::shared_ptr<const PoseWatch> PoseWatch::build(const TriangleMesh& body, std::span<const JointFace> faces, const ElementResponse& response) {
    return PoseWatchBuilder(body, faces, response).build();
}

std::shared_ptr<const PoseWatch> LazyPoseWatch::get(const TriangleMesh& body, std::span<const JointFace> faces, const ElementResponse& response) const {
    std::call_once(once_, [&] { watch_ = PoseWatch::build(body, faces, response); });
    ready_ = true;
    return watch_;
}

PoseWatch::Room PoseWatch::room() const { return {VectorXd::Zero(rows_.rows()), VectorXd::Zero(rows_.cols()), VectorXd::Zero(rows_.cols())}; }

PoseMeasures PoseWatch::measure(const VectorXd& v, std::span<const FaceMotion> motions, Room& room) const {
    PoseMeasures out;
    room.moves.noalias() = rows_ * v;
    const auto at = [&](int sample) -> Vec3 { return rest_.row(sample).transpose() + room.moves.segment<3>(3 * sample); };
    const auto normalAt = [&](const Triangle& t) -> Vec3 { return (at(t.corner[1]) - at(t.corner[0])).cross(at(t.corner[2]) - at(t.corner[0])); };
    out.bend = largestTurn(motions);
    for (const auto& t : triangles_) {
        const Eigen::Quaterniond& turn = motions[static_cast<std::size_t>(t.face)].rotation;
        const Vec3 n = normalAt(t) / t.area;
        const Vec3 whole = turn * t.normal, half = t.normal + whole;
        const double length = half.norm();
        double seen = std::max(n.dot(t.normal), n.dot(whole));
        if (length > 1e-6) seen = std::max(seen, n.dot(half) / length);
        out.area = std::min(out.area, seen);
    }
    for (const auto& d : depths_) {
        const auto face = static_cast<std::size_t>(d.face);
        const auto& motion = motions[face];
        const Vec3 origin = motion.linear * frames_[face].origin + motion.shift;
        out.depth = std::min(out.depth, (motion.rotation * frames_[face].axes.col(2)).dot(origin - at(d.sample)) / d.rest);
    }
    for (const auto& t : rims_) {
        const Vec3 n = normalAt(t), turned = motions[static_cast<std::size_t>(t.face)].rotation * t.normal;
        out.crease = std::max(out.crease, std::atan2(n.cross(turned).norm(), n.dot(turned)));
    }
    if (volumeSlope_.size() > 0) {
        // What stretches alone make of the volume: v of the logarithms of these motions.
        for (std::size_t f = 0; f < motions.size(); ++f) {
            const auto& axes = frames_[f].axes;
            const auto& m = motions[f];
            const Matrix3d stretch = m.rotation.toRotationMatrix().transpose() * m.linear;
            JointMap gentle;
            gentle.linear = axes.transpose() * (stretch + crossMatrix(rotationVector(m.rotation))) * axes;
            gentle.shift = axes.transpose() * (m.linear * frames_[f].origin + m.shift - frames_[f].origin);
            double lost = 0.0;
            bases_[f].coefficients(gentle, restOfFace_[f], sizes_[f], room.gentle.data() + firstColumn_[f], lost);
        }
        room.product.noalias() = volumeCurve_ * v;
        const double shown = 1.0 + volumeSlope_.dot(v) + 0.5 * v.dot(room.product);
        out.volume = shown / std::exp(std::clamp(volumeSlope_.dot(room.gentle), -2.0, 2.0)) - 1.0;
    }
    return out;
}

double PoseWatch::sizeOf(const FaceMotion& m, std::size_t face) const {
    const double turn = 2.0 * std::atan2(m.rotation.vec().norm(), m.rotation.w());
    const double shift = (m.linear * frames_[face].origin + m.shift - frames_[face].origin).norm();
    return turn + (sizes_[face] > 0.0 ? shift / sizes_[face] : 0.0) + (m.linear - m.rotation.toRotationMatrix()).norm();
}

bool PoseWatch::isCalm(std::span<const FaceMotion> motions) const {
    for (std::size_t f = 0; f < motions.size(); ++f)
        if (!(sizeOf(motions[f], f) <= calm_)) return false;
    return true;
}

bool PoseWatch::isBent(std::span<const FaceMotion> motions) { return largestTurn(motions) >= kBendTo; }

double PoseWatch::callForWarp(const PoseMeasures& m) {
    return std::max({ramp(m.area, kAreaFrom, kAreaTo), ramp(m.depth, kDepthFrom, kDepthTo), ramp(std::sqrt(std::abs(m.volume)), std::sqrt(kVolumeFrom), std::sqrt(kVolumeTo)), ramp(m.bend, kBendFrom, kBendTo)});
}

}  // namespace imomushi
