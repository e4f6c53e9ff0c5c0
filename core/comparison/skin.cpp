// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/character/aligned_buffer.h"
#include "core/comparison/skin_kernels.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;

constexpr int kNodes = Skin::kSegments + 1;
/// Bezier handles of this part of a bone's length make a quarter of a circle of two bones that meet at right angles.
constexpr double kHandle = 0.390464;
constexpr int kCurveSamples = 64;
/// A bone this near to its rest length is not stretched: rounding.
constexpr double kStretched = 1e-7;

struct Affine {
    Matrix3d linear = Matrix3d::Identity();
    Vec3 shift = Vec3::Zero();
};

void store(const Affine& a, float* column) {  // 4 columns of 4
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) column[4 * c + r] = static_cast<float>(a.linear(r, c));
    for (int r = 0; r < 3; ++r) column[12 + r] = static_cast<float>(a.shift[r]);
    column[15] = 1.0f;
}

Matrix3d stretched(const Vec3& direction, double stretch, double across) {
    const Matrix3d along = direction * direction.transpose();
    return stretch * along + across * (Matrix3d::Identity() - along);
}
/// The same with the volume kept.
Matrix3d stretched(const Vec3& direction, double stretch) { return stretched(direction, stretch, 1.0 / std::sqrt(stretch)); }

/// A bone as a curve: places and directions of the ends of its segments.
struct Curve {
    std::array<Vec3, kNodes> place, tangent;
    double length = 0.0;
};

/// Cubic Bezier curve with segments of equal length.
void trace(const Vec3& from, const Vec3& to, const Vec3& tangentFrom, const Vec3& tangentTo, Curve& out) {
    const double handle = kHandle * (to - from).norm();
    const Vec3 p1 = from + handle * tangentFrom, p2 = to - handle * tangentTo;
    const auto at = [&](double t) -> Vec3 {
        const double s = 1.0 - t;
        return s * s * s * from + 3.0 * s * s * t * p1 + 3.0 * s * t * t * p2 + t * t * t * to;
    };
    std::array<double, kCurveSamples + 1> lengths{};
    Vec3 last = from;
    for (int i = 1; i <= kCurveSamples; ++i) {
        const Vec3 next = at(static_cast<double>(i) / kCurveSamples);
        lengths[i] = lengths[i - 1] + (next - last).norm();
        last = next;
    }
    out.length = lengths[kCurveSamples];
    int sample = 0;
    for (int k = 0; k < kNodes; ++k) {
        const double wanted = out.length * k / (kNodes - 1);
        while (sample + 1 < kCurveSamples && lengths[sample + 1] < wanted) ++sample;
        const double step = lengths[sample + 1] - lengths[sample];
        const double t = std::clamp((sample + (step > 0.0 ? (wanted - lengths[sample]) / step : 0.0)) / kCurveSamples, 0.0, 1.0), s = 1.0 - t;
        out.place[k] = at(t);
        const Vec3 d = s * s * (p1 - from) + 2.0 * s * t * (p2 - p1) + t * t * (to - p2);
        const double n = d.norm();
        out.tangent[k] = n > 0.0 ? Vec3(d / n) : tangentFrom;
    }
}

}  // namespace

struct Skin::State {
    SkinKind kind = SkinKind::LinearBlend;
    Skeleton skeleton;
    BoneTree tree;
    std::vector<std::array<char, 2>> freeEnd;          // per bone: start, end
    std::vector<std::array<int, 2>> neighbour;         // per bone: the one that its curve leans to at start and end, -1: none
    std::size_t count = 0;
    AlignedBuffer<float> positions, rest, matrices;    // rest: x y z 1
    // Per vertex what it follows, most first: offset into matrices (bones, or ends of segments), weight.
    std::vector<std::uint32_t> firstPart;
    std::vector<std::pair<std::uint32_t, float>> parts;
    // The same where no vertex follows more than four bones.
    bool four = false;
    AlignedBuffer<float> weights;
    AlignedBuffer<std::uint16_t> offsets;
    std::vector<std::array<float, 8>> dual;            // per bone: rotation w x y z, then the dual part
    std::vector<Curve> restCurves;
    Curve curve;

    [[nodiscard]] double length(const Pose& pose, int b) const { return (pose.points[skeleton.bones[b].end] - pose.points[skeleton.bones[b].start]).norm(); }
    [[nodiscard]] double stretch(const Pose& pose, int b) const { return std::max(length(pose, b) / skeleton.bones[b].length, 1e-3); }
    [[nodiscard]] double roll(const Pose& pose, int b) const {
        const auto& bone = skeleton.bones[b];
        const bool start = freeEnd[b][0] != 0, end = freeEnd[b][1] != 0;
        if (start == end) return boneRoll(skeleton, tree, pose, b);
        return tree.rollSign[b] * pose.roll[start ? bone.start : bone.end];
    }
    [[nodiscard]] Quaterniond rotation(const Pose& pose, int b) const {
        const Quaterniond& q = pose.frames[b];
        const double r = roll(pose, b);
        return r == 0.0 ? q : Quaterniond(Eigen::AngleAxisd(r, q * tree.restDirection[b])) * q;
    }
    [[nodiscard]] Vec3 direction(const Pose& pose, int b) const {
        const Vec3 d = pose.points[skeleton.bones[b].end] - pose.points[skeleton.bones[b].start];
        const double n = d.norm();
        return n > 0.0 ? Vec3(d / n) : Vec3(pose.frames[b] * tree.restDirection[b]);
    }
    /// Where the curve of a bone points at an end, along the bone.
    [[nodiscard]] Vec3 lean(const Pose& pose, int b, bool atEnd) const {
        const Vec3 own = direction(pose, b);
        const int other = neighbour[b][atEnd ? 1 : 0];
        if (other < 0) return own;
        const int point = atEnd ? skeleton.bones[b].end : skeleton.bones[b].start;
        Vec3 along = direction(pose, other);
        if ((skeleton.bones[other].start == point) != atEnd) along = -along;
        const Vec3 sum = own + along;
        const double n = sum.norm();
        return n > 1e-6 ? Vec3(sum / n) : own;
    }
    void traceBone(const Pose& pose, int b, Curve& out) const {
        trace(pose.points[skeleton.bones[b].start], pose.points[skeleton.bones[b].end], lean(pose, b, false), lean(pose, b, true), out);
    }

    void applyMatrices();
    void blendLinear(const Pose& pose);
    void blendDual(const Pose& pose);
    void blendSpline(const Pose& pose);
};

void Skin::State::applyMatrices() {
    if (four) return skinByMatrix({matrices.data(), rest.data(), weights.data(), offsets.data()}, 0, count, positions.data());
    for (std::size_t v = 0; v < count; ++v) {
        const float* p = rest.data() + 4 * v;
        float sum[4] = {0.0f, 0.0f, 0.0f, 0.0f};
        for (auto n = firstPart[v]; n < firstPart[v + 1]; ++n) {
            const float* m = matrices.data() + parts[n].first;
            const float w = parts[n].second;
            for (int r = 0; r < 4; ++r) sum[r] += w * (m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
        }
        std::copy_n(sum, 3, positions.data() + 3 * v);
    }
}

void Skin::State::blendLinear(const Pose& pose) {
    for (int b = 0; b < static_cast<int>(skeleton.bones.size()); ++b) {
        const auto& bone = skeleton.bones[b];
        Affine a;
        a.linear = rotation(pose, b).toRotationMatrix() * stretched(tree.restDirection[b], stretch(pose, b));
        a.shift = pose.points[bone.start] - a.linear * skeleton.points[bone.start];
        store(a, matrices.data() + 16 * static_cast<std::size_t>(b));
    }
    applyMatrices();
}

void Skin::State::blendDual(const Pose& pose) {
    bool anyStretch = false;
    for (int b = 0; b < static_cast<int>(skeleton.bones.size()); ++b) {
        const auto& bone = skeleton.bones[b];
        const double s = stretch(pose, b);
        anyStretch = anyStretch || std::abs(s - 1.0) > kStretched;
        Affine scale;
        scale.linear = stretched(tree.restDirection[b], s);
        scale.shift = skeleton.points[bone.start] - scale.linear * skeleton.points[bone.start];
        store(scale, matrices.data() + 16 * static_cast<std::size_t>(b));
        const Quaterniond q = rotation(pose, b).normalized();
        const Vec3 t = pose.points[bone.start] - q * skeleton.points[bone.start];
        const Quaterniond e = Quaterniond(0.0, 0.5 * t.x(), 0.5 * t.y(), 0.5 * t.z()) * q;
        const Quaterniond both[2] = {q, e};
        for (std::size_t i = 0; i < 2; ++i) {
            float* to = dual[static_cast<std::size_t>(b)].data() + 4 * i;
            to[0] = static_cast<float>(both[i].w()), to[1] = static_cast<float>(both[i].x()), to[2] = static_cast<float>(both[i].y()), to[3] = static_cast<float>(both[i].z());
        }
    }
    if (anyStretch) applyMatrices();
    for (std::size_t v = 0; v < count; ++v) {
        const auto begin = firstPart[v], end = firstPart[v + 1];
        const auto& first = dual[parts[begin].first / 16u];
        std::array<float, 8> sum;
        for (std::size_t i = 0; i < 8; ++i) sum[i] = parts[begin].second * first[i];
        for (auto n = begin + 1; n < end; ++n) {
            const auto& d = dual[parts[n].first / 16u];
            const float same = first[0] * d[0] + first[1] * d[1] + first[2] * d[2] + first[3] * d[3];
            const float part = same < 0.0f ? -parts[n].second : parts[n].second;
            for (std::size_t i = 0; i < 8; ++i) sum[i] += part * d[i];
        }
        const float square = sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2] + sum[3] * sum[3];
        const float scale = 1.0f / std::sqrt(std::max(square, 1e-30f));
        for (float& x : sum) x *= scale;
        const float a = sum[0], x = sum[1], y = sum[2], z = sum[3], e = sum[4], ex = sum[5], ey = sum[6], ez = sum[7];
        float* out = positions.data() + 3 * v;
        const float* p = anyStretch ? out : rest.data() + 4 * v;
        // p + 2 r x (r x p + a p) + 2 (a e_r - e r + r x e_r)
        const float px = p[0], py = p[1], pz = p[2];
        const float cx = y * pz - z * py + a * px, cy = z * px - x * pz + a * py, cz = x * py - y * px + a * pz;
        out[0] = px + 2.0f * (y * cz - z * cy) + 2.0f * (a * ex - e * x + y * ez - z * ey);
        out[1] = py + 2.0f * (z * cx - x * cz) + 2.0f * (a * ey - e * y + z * ex - x * ez);
        out[2] = pz + 2.0f * (x * cy - y * cx) + 2.0f * (a * ez - e * z + x * ey - y * ex);
    }
}

void Skin::State::blendSpline(const Pose& pose) {
    for (int b = 0; b < static_cast<int>(skeleton.bones.size()); ++b) {
        const auto& bone = skeleton.bones[b];
        traceBone(pose, b, curve);
        const auto& was = restCurves[static_cast<std::size_t>(b)];
        // Curves are longer than bones: bending alone does not thin them.
        const double s = std::max(curve.length / was.length, 1e-3), across = 1.0 / std::sqrt(stretch(pose, b));
        const Vec3 along = direction(pose, b);
        const double sign = tree.rollSign[b], from = sign * pose.roll[bone.start], to = sign * pose.roll[bone.end];
        for (int k = 0; k < kNodes; ++k) {
            const auto i = static_cast<std::size_t>(k);
            const Quaterniond turned = minimalRotation(along, curve.tangent[i]) * pose.frames[b];
            const Quaterniond rolled = Quaterniond(Eigen::AngleAxisd(from + (to - from) * k / (kNodes - 1), curve.tangent[i])) * turned;
            const Quaterniond atRest = minimalRotation(tree.restDirection[b], was.tangent[i]);
            Affine a;
            a.linear = (rolled * atRest.conjugate()).toRotationMatrix() * stretched(was.tangent[i], s, across);
            a.shift = curve.place[i] - a.linear * was.place[i];
            store(a, matrices.data() + 16 * (static_cast<std::size_t>(b) * kNodes + i));
        }
    }
    applyMatrices();
}

Skin::Skin(std::unique_ptr<State> state) : state_(std::move(state)) {}
Skin::Skin(Skin&&) noexcept = default;
Skin& Skin::operator=(Skin&&) noexcept = default;
Skin::~Skin() = default;

Result<Skin> Skin::build(const WeldedSurface& body, const Skeleton& skeleton, const SkinWeights& weights, SkinKind kind) {
    const std::size_t bones = skeleton.bones.size();
    if (bones == 0) return fail("no-bone", "There is no bone for the skin to follow: add bones first.");
    if (bones > 4096) return fail("bad-value", "There are more than 4096 bones: a skin cannot tell so many apart.");
    if (weights.vertices.size() != static_cast<std::size_t>(body.vertices.rows())) return fail("bad-value", "The weights belong to another body: compute them again.");
    for (const auto& v : weights.vertices)
        for (std::size_t k = 0; k < SkinWeights::kMax; ++k)
            if (v.bone[k] < 0 || v.bone[k] >= static_cast<std::int32_t>(bones) || !(v.weight[k] >= 0.0f) || !(v.weight[0] > 0.0f))
                return fail("bad-value", "The weights belong to other bones: compute them again.");
    auto state = std::make_unique<State>();
    State& s = *state;
    s.kind = kind;
    s.skeleton = skeleton;
    s.tree = boneTree(skeleton);
    s.count = weights.vertices.size();
    s.positions = AlignedBuffer<float>(3 * s.count + 1);
    s.rest = AlignedBuffer<float>(4 * s.count);
    s.matrices = AlignedBuffer<float>(16 * bones * (kind == SkinKind::Spline ? kNodes : 1));
    s.dual.resize(kind == SkinKind::DualQuaternion ? bones : 0);
    for (std::size_t v = 0; v < s.count; ++v)
        for (std::size_t k = 0; k < 4; ++k)
            s.rest[4 * v + k] = k < 3 ? static_cast<float>(body.vertices(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(k))) : 1.0f;
    std::vector<int> uses(skeleton.points.size(), 0);
    for (const auto& b : skeleton.bones) ++uses[b.start], ++uses[b.end];
    for (std::size_t b = 0; b < bones; ++b) {
        const auto& bone = skeleton.bones[b];
        s.freeEnd.push_back({static_cast<char>(uses[bone.start] == 1), static_cast<char>(uses[bone.end] == 1)});
        std::array<int, 2> lean = {-1, -1};
        for (const int side : {0, 1}) {
            const int point = side ? bone.end : bone.start;
            for (std::size_t c = 0; c < bones; ++c) {
                if (c == b || (skeleton.bones[c].start != point && skeleton.bones[c].end != point)) continue;
                // At a branch a bone leans to its parent only.
                if (uses[point] == 2 || s.tree.parent[b] == static_cast<int>(c)) lean[static_cast<std::size_t>(side)] = static_cast<int>(c);
            }
        }
        s.neighbour.push_back(lean);
    }
    const Pose pose = restPose(skeleton);
    if (kind == SkinKind::Spline) {
        s.restCurves.resize(bones);
        for (std::size_t b = 0; b < bones; ++b) s.traceBone(pose, static_cast<int>(b), s.restCurves[b]);
    }
    s.four = kind != SkinKind::Spline;
    s.firstPart = {0};
    for (std::size_t v = 0; v < s.count; ++v) {
        const Vec3 p = body.vertices.row(static_cast<Eigen::Index>(v)).transpose();
        for (std::size_t k = 0; k < SkinWeights::kMax; ++k) {
            const float w = weights.vertices[v].weight[k];
            if (!(w > 0.0f)) continue;
            const auto b = static_cast<std::size_t>(weights.vertices[v].bone[k]);
            if (kind != SkinKind::Spline) {
                s.parts.emplace_back(16 * b, w);
                continue;
            }
            // Where along the bone, as B-bones have it: by the straight bone.
            const auto& bone = skeleton.bones[b];
            const double t = std::clamp((p - skeleton.points[bone.start]).dot(s.tree.restDirection[b]) / bone.length, 0.0, 1.0) * kSegments;
            const int low = std::min(static_cast<int>(t), kSegments - 1);
            const auto offset = static_cast<std::uint32_t>(16 * (b * kNodes + static_cast<std::size_t>(low)));
            const auto part = static_cast<float>(t - low);
            s.parts.emplace_back(offset, w * (1.0f - part));
            s.parts.emplace_back(offset + 16, w * part);
        }
        s.firstPart.push_back(static_cast<std::uint32_t>(s.parts.size()));
        s.four = s.four && s.firstPart[v + 1] - s.firstPart[v] <= 4;
    }
    if (s.four) {
        s.weights = AlignedBuffer<float>(4 * s.count);
        s.offsets = AlignedBuffer<std::uint16_t>(4 * s.count);
        for (std::size_t v = 0; v < s.count; ++v)
            for (auto n = s.firstPart[v]; n < s.firstPart[v + 1]; ++n) {
                s.weights[4 * v + n - s.firstPart[v]] = s.parts[n].second;
                s.offsets[4 * v + n - s.firstPart[v]] = static_cast<std::uint16_t>(s.parts[n].first);
            }
    }
    Skin out(std::move(state));
    out.update(pose);
    return out;
}

void Skin::update(const Pose& pose) {
    State& s = *state_;
    if (!fits(s.skeleton, pose)) return;
    switch (s.kind) {
        case SkinKind::LinearBlend: return s.blendLinear(pose);
        case SkinKind::DualQuaternion: return s.blendDual(pose);
        case SkinKind::Spline: return s.blendSpline(pose);
    }
}

const float* Skin::positions() const { return state_->positions.data(); }
int Skin::vertices() const { return static_cast<int>(state_->count); }

std::size_t Skin::bytes() const {
    const State& s = *state_;
    const std::size_t all = s.rest.bytes() + s.positions.bytes() + s.matrices.bytes() + s.dual.size() * sizeof(s.dual[0]);
    if (s.kind == SkinKind::LinearBlend && s.four) return all + s.weights.bytes() + s.offsets.bytes();
    return all + s.parts.size() * sizeof(s.parts[0]) + s.firstPart.size() * sizeof(s.firstPart[0]);
}

}  // namespace imomushi
