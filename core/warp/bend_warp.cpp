// SPDX-License-Identifier: GPL-3.0-or-later
// The bend warp of a frame, by the tables of its element (bend_warp_tables.h, which says the units and the order of vertices).
#include "core/warp/bend_warp.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/warp/bend_warp_tables.h"

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Matrix3f;
using Eigen::Vector4f;

namespace {

// Stretches beyond these are treated as these.
constexpr double kMinStretch = 0.1, kMaxStretch = 10.0;
// Triangles near a face follow it (BendWarpTables::follow) by the square of the motion of the face: half at this one, radians.
constexpr float kBandMotion = 0.04f;
// Vertices of triangles that the response strains by more than the first (TargetBatch::strain; surfaces of nearly twice their length) are smoothed, fully from the second on.
constexpr float kLargeStrain = 0.6f, kTornStrain = 1.2f;
// Each pass moves them by this part of the way to the mean of their neighbours. Fewer passes left folds in the ankles of a penguin that is pulled by half its height.
constexpr int kSmoothings = 12;
constexpr float kSmoothing = 0.6f;
// The inflation moves no vertex by more than this part of the cube root of the volume.
constexpr double kMaxInflation = 0.25;
// Its amount is found in so many steps of Newton's method with the first slope, or until the volume is as near as this.
constexpr int kVolumeSteps = 4;
constexpr double kVolumeError = 1e-4;
// Step 6 changes the volume: where it does by more than this, step 5 is done again.
constexpr double kPressedOut = 2e-3;

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
    const Vec3 l = eigen.eigenvalues().cwiseMax(kMinStretch).cwiseMin(kMaxStretch).array().log();
    return eigen.eigenvectors() * l.asDiagonal() * eigen.eigenvectors().transpose();
}

// s d + w x d for the stretch exp(s) and the rotation w, by the nearest way, that turn d into e. size: of the element.
Vec3 logarithmicMove(const Vec3& d, const Vec3& e, double size) {
    const double from = d.norm(), to = e.norm();
    if (!(from > 1e-9 * size)) return e - d;
    const double stretch = std::clamp(to / from, kMinStretch, kMaxStretch);
    const Vec3 cross = d.cross(e);
    const double sine = cross.norm();
    Vec3 out = std::log(stretch) * d;
    if (sine > 1e-12 * from * to && to > 1e-9 * from) out += std::atan2(sine, d.dot(e)) / sine * cross.cross(d);
    return out;
}

}  // namespace

struct BendWarp::State {
    explicit State(std::shared_ptr<const BendWarpTables> given) : tables(std::move(given)), t(*tables) {
        v = Eigen::VectorXd::Zero(t.response.cols());
        weights = Eigen::VectorXf::Zero(t.response.cols());
        moved = Eigen::VectorXf::Zero(3 * t.free);
        base = displacement = at = force = t.rest;
        targets.resize(t.triangles.size());
        strains.resize(t.faces.size());
        strained.reserve(static_cast<std::size_t>(t.free));
        planes.resize(t.faces.size());
        if (!t.carrier) return;
        coarse.assign(3 * t.indexOf.size(), 0.0f);
        gradients = t.carrier->mapping.gradients();
        linearOfFace.assign(t.faces.size(), Matrix3d::Identity());
    }

    void solveShape(std::span<const FaceMotion> motions, const Eigen::VectorXd& warping, const Points& heldAt) {
        const Vec3 carried = findParameters(motions, warping);
        const Matrix3d stretch = baseStretch(motions);
        strainFaces(motions, stretch);
        displace(stretch);
        const Vec3 place = t.origin + carried;
        for (std::size_t i = 0; i < t.held.size(); ++i) {
            const auto row = t.carrier ? static_cast<Eigen::Index>(t.carrier->rowOfHeld[i]) : static_cast<Eigen::Index>(i);
            at[t.indexOfHeld[i]].head<3>() = ((heldAt.row(row).transpose() - place) / t.size).cast<float>();
        }
        placeFloating();
        solve(true);
        solve(false);
        if (largestStrain > kLargeStrain) smoothStrained();
        inflate();
        findPlanes(motions);
        if (!t.carrier) {
            // What was pressed in at a face comes out elsewhere.
            if (keepInside(carried) && t.volume > 0.0 && !t.inflation.empty() && grow(kPressedOut)) keepInside(carried);
        }
        shown = (place - t.middle).cast<float>();
        if (t.carrier) findCoarse(motions);
    }

    /// Of the body itself.
    void write(float* local) const {
        const auto unit = static_cast<float>(t.size);
        for (int i = 0; i < t.free; ++i)
            for (int axis = 0; axis < 3; ++axis) local[t.slot[i] + axis * kBlock] = unit * at[i][axis] + shown[axis];
    }

    // Where the vertices of the coarse body are, and how they turn what is around them.
    void findCoarse(std::span<const FaceMotion> motions) {
        const auto unit = static_cast<float>(t.size);
        for (std::size_t i = 0; i < t.indexOf.size(); ++i)
            Eigen::Map<Eigen::Vector3f>(coarse.data() + 3 * i) = unit * at[t.indexOf[i]].head<3>() + shown;
        for (std::size_t f = 0; f < t.faces.size(); ++f) linearOfFace[f] = motions[f].linear;
        const auto& mapping = t.carrier->mapping;
        mapping.findTriangles(EmbeddedMapping::Values::Positions, coarse.data(), 0, mapping.triangles(), gradients);
        mapping.findVertices(0, mapping.vertices(), gradients);
    }

    /// Points begin...end - 1 of the carrier.
    void carry(std::size_t begin, std::size_t end, float* local) const {
        const auto& carrier = *t.carrier;
        const auto before = [](const auto& part, std::size_t point) { return static_cast<std::size_t>(part.point) < point; };
        const auto& parts = carrier.mapping.jointParts();
        auto part = std::lower_bound(parts.begin(), parts.end(), begin, before);
        auto contact = std::lower_bound(carrier.contacts.begin(), carrier.contacts.end(), begin, before);
        for (std::size_t i = begin; i < end; ++i) {
            Vec3 x = carrier.mapping.at(i, coarse.data(), gradients);
            for (; part != parts.end() && static_cast<std::size_t>(part->point) == i; ++part) x += linearOfFace[static_cast<std::size_t>(part->face)] * part->offset;
            for (; contact != carrier.contacts.end() && static_cast<std::size_t>(contact->point) == i; ++contact) {
                const auto& plane = planes[static_cast<std::size_t>(contact->face)];
                const double most = contact->depth, depth = plane.normal.dot(plane.place - t.middle - x);
                if (depth < most) x -= contact->weight * (most / (2.0 - depth / most) - depth) * plane.normal;
            }
            for (int axis = 0; axis < 3; ++axis) local[carrier.slot[i] + axis * kBlock] = static_cast<float>(x[axis]);
        }
    }

    // v of the logarithms of the motions; returns what all faces are shifted by, which is left out of v.
    Vec3 findParameters(std::span<const FaceMotion> motions, const Eigen::VectorXd& warping) {
        Vec3 carried = Vec3::Zero();
        Vec3 mean = Vec3::Zero();  // of the faces' rotations: the way that their origins go round
        for (std::size_t f = 0; f < t.faces.size(); ++f) mean += rotationVector(motions[f].rotation) / static_cast<double>(t.faces.size());
        const double angle = mean.norm();
        const Matrix3d back = Eigen::AngleAxisd(-angle, angle > 0.0 ? Vec3(mean / angle) : Vec3(Vec3::UnitX())).toRotationMatrix();
        for (std::size_t f = 0; f < t.faces.size(); ++f)
            carried +=
                (motions[f].linear * t.faces[f].frame.origin + motions[f].shift - t.faces[f].frame.origin) / static_cast<double>(t.faces.size());
        for (std::size_t f = 0; f < t.faces.size(); ++f) {
            const auto& m = motions[f];
            const auto& frame = t.faces[f].frame;
            const Vec3 d = frame.origin - t.origin, e = m.linear * frame.origin + m.shift - t.origin - carried;
            const Matrix3d r = m.rotation.normalized().toRotationMatrix(), s = r.transpose() * m.linear;
            JointMap map;
            map.linear = Matrix3d::Identity() +
                         frame.axes.transpose() * (skew(rotationVector(m.rotation)) + logarithm(0.5 * (s + s.transpose()))) * frame.axes;
            map.shift = frame.axes.transpose() * (mean.cross(d) + logarithmicMove(d, back * e, t.size));
            double lost = 0.0;
            t.bases[f].coefficients(map, t.restOfFace[f], t.faces[f].size, v.data() + t.firstColumn[f], lost);
        }
        v += warping;
        return carried;
    }

    void strainFaces(std::span<const FaceMotion> motions, const Matrix3d& stretch) {
        for (std::size_t f = 0; f < t.faces.size(); ++f) {
            const Matrix3d s = motions[f].rotation.normalized().toRotationMatrix().transpose() * motions[f].linear;
            const Vec3 n = t.faces[f].frame.axes.col(2), w = rotationVector(motions[f].rotation);
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
        if (t.faces.size() != 2) return Matrix3d::Zero();
        const auto placed = [&](std::size_t f) -> Vec3 { return motions[f].linear * t.faces[f].frame.origin + motions[f].shift; };
        const Vec3 d = t.faces[1].frame.origin - t.faces[0].frame.origin;
        const double from = d.norm(), to = (placed(1) - placed(0)).norm();
        if (!(from > 1e-6 * t.size)) return Matrix3d::Zero();
        const double s = std::log(std::clamp(to / from, kMinStretch, kMaxStretch));
        const Matrix3d along = d * d.transpose() / (from * from);
        return s * (along - t.nu * (Matrix3d::Identity() - along));
    }

    // Steps 1 and 2: base, displacement, and where vertices would be by them.
    void displace(const Matrix3d& logStretch) {
        weights = v.cast<float>();
        if (v.size() > 0) moved.noalias() = t.response * weights;
        for (int i = 0; i < t.free; ++i) displacement[i].head<3>() = moved.segment<3>(3 * i);
        std::size_t h = 0;
        for (std::size_t f = 0; f < t.faces.size(); ++f) {
            const auto part = weights.segment(t.firstColumn[f], t.heldColumns[f].cols());
            for (Eigen::Index i = 0; 3 * i < t.heldColumns[f].rows(); ++i, ++h)
                displacement[t.indexOfHeld[h]].head<3>() = t.heldColumns[f].middleRows<3>(3 * i).lazyProduct(part);
        }
        if (logStretch.isZero(0.0)) {
            std::copy(t.rest.begin(), t.rest.end(), base.begin());
            for (int i = 0; i < t.vertices; ++i) at[i] = t.rest[i] + displacement[i];
            return;
        }
        Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
        eigen.compute(logStretch);
        const Matrix3f stretch =
            (eigen.eigenvectors() * eigen.eigenvalues().array().exp().matrix().asDiagonal() * eigen.eigenvectors().transpose())
                .cast<float>();
        const Matrix3f linear = logStretch.cast<float>();
        for (int i = 0; i < t.vertices; ++i) {
            const Three x = three(t.rest[i]);
            const Three u = stretch * (three(displacement[i]) - linear * x), b = stretch * x;
            base[i] = four(b);
            displacement[i] = four(u);
            at[i] = four(b + u);
        }
    }

    // A shell that no face holds goes where a body with its mean rotation and displacement goes: the displacement turns while it grows.
    void placeFloating() {
        for (const auto& shell : t.floating) {
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
            largestStrain = pullToResponse(t.triangles.data(), t.triangles.size(), t.follow.data(), t.follow.size(), strains.data(), floats(base),
                                           floats(displacement), floats(at), targets.data(), floats(force));
        else
            pullToFit(t.triangles.data(), t.triangles.size(), floats(at), targets.data(), floats(force));
        t.factor.solve(force.data());
        for (int i = t.solved; i < t.vertices; ++i) force[i].setZero();
        for (const auto& shell : t.floating) {
            Vector4f mean = Vector4f::Zero();
            for (const auto i : shell.vertices) mean += force[i] / static_cast<float>(shell.vertices.size());
            for (const auto i : shell.vertices) force[i] -= mean;
        }
        for (int i = 0; i < t.free; ++i) at[i] += force[i];
    }

    // The end of step 4. `force` and `displacement` are free by then: fourth numbers of the one hold how much a vertex is smoothed, 0 to 1, and the other holds where it goes.
    void smoothStrained() {
        std::fill(force.begin(), force.end(), Vector4f::Zero());
        for (std::size_t k = 0; k < t.triangles.size(); ++k)
            for (int lane = 0; lane < kWarpBatch; ++lane) {
                const float strain = std::clamp((targets[k].strain[lane] - kLargeStrain) / (kTornStrain - kLargeStrain), 0.0f, 1.0f);
                for (const auto& corner : t.triangles[k].corner) force[corner[lane] / 4][3] = std::max(force[corner[lane] / 4][3], strain);
            }
        strained.clear();
        for (int i = 0; i < t.free; ++i)
            if (force[i][3] > 0.0f) strained.push_back(i);
        for (int pass = 0; pass < kSmoothings; ++pass) {
            for (const auto i : strained) displacement[i] = at[i] + kSmoothing * force[i][3] * (sumAround(at, i) / countAround(i) - at[i]);
            for (const auto i : strained) at[i] = displacement[i];
        }
    }

    // Over the neighbours of a vertex.
    [[nodiscard]] float countAround(int i) const { return static_cast<float>(t.firstNeighbor[i + 1] - t.firstNeighbor[i]); }
    [[nodiscard]] Vector4f sumAround(const Vectors& values, int i) const {
        Vector4f sum = Vector4f::Zero();
        for (auto n = t.firstNeighbor[i]; n < t.firstNeighbor[i + 1]; ++n) sum += values[t.neighbors[n]];
        return sum;
    }

    // What the linear response says.
    [[nodiscard]] double wantedVolume() const { return t.volume * std::exp(std::clamp(t.volumeChange.dot(v) / t.volume, -1.0, 1.0)); }

    // Step 5: along normals that are smoothed once, less where triangles do not agree on one: creases would get sharper. (The fourth number of a normal sums areas.)
    void inflate() {
        if (!(t.volume > 0.0) || t.inflation.empty()) return;
        std::fill(force.begin(), force.end(), Vector4f::Zero());
        addNormals(t.surface.data(), t.surface.size(), floats(at), floats(force));
        // The way of each vertex, in the displacement, which is done with: by the triangles around those around it, two of which meet each neighbour.
        for (int i = 0; i < t.vertices; ++i) {
            displacement[i].setZero();
            if (!(t.inflation[i] > 0.0f)) continue;
            const Vector4f sums = countAround(i) * force[i] + 2.0f * sumAround(force, i);
            const Three around = three(sums);
            const float length = std::sqrt(around.squaredNorm()), whole = sums[3];
            const float smooth = whole > 1e-20f ? length / whole : 0.0f, weight = t.inflation[i] * smooth * smooth;
            displacement[i] = four((length > 1e-20f ? weight / length : 0.0f) * around);
        }
        grow(kVolumeError);
    }

    // To the volume that the linear response says, if it is off by more than this part. The ways of vertices are in the displacement.
    bool grow(double error) {
        const double wanted = wantedVolume(), most = kMaxInflation * std::cbrt(t.volume);
        const VolumeCurve curve = volumeCurve(t.surface.data(), t.surface.size(), floats(at), floats(displacement));
        if (!(curve.slope * most > 1e-6 * t.volume) || !(std::abs(wanted - curve.volume) > error * t.volume)) return false;
        double by = 0.0;
        for (int step = 0; step < kVolumeSteps && std::abs(wanted - curve(by)) > kVolumeError * t.volume; ++step) by = std::clamp(by + (wanted - curve(by)) / curve.slope, -most, most);
        for (int i = 0; i < t.free; ++i) at[i] += static_cast<float>(by) * displacement[i];
        return true;
    }

    // Step 6.
    bool keepInside(const Vec3& carried) {
        bool pressed = false;
        for (std::size_t f = 0; f < t.faces.size(); ++f) {
            const Three n(planes[f].normal);
            const Three place(Vec3((planes[f].place - t.origin - carried) / t.size));
            for (const auto& c : t.contacts[f]) {
                const float depth = n.dot(place - three(at[c.vertex]));
                if (depth >= c.depth) continue;
                at[c.vertex] -= four(c.weight * (c.depth / (2.0f - depth / c.depth) - depth) * n);
                pressed = true;
            }
        }
        return pressed;
    }

    void findPlanes(std::span<const FaceMotion> motions) {
        for (std::size_t f = 0; f < t.faces.size(); ++f) {
            const auto& frame = t.faces[f].frame;
            const Vec3 turned = motions[f].rotation.normalized() * frame.axes.col(2);
            Vec3 normal = (motions[f].linear * frame.axes.col(0)).cross(motions[f].linear * frame.axes.col(1));
            const double length = normal.norm();
            planes[f].normal = length > 1e-6 ? Vec3(normal / (normal.dot(turned) < 0.0 ? -length : length)) : turned;
            planes[f].place = motions[f].linear * frame.origin + motions[f].shift;
        }
    }

    const std::shared_ptr<const BendWarpTables> tables;
    const BendWarpTables& t;
    Eigen::VectorXd v;
    Eigen::VectorXf weights, moved;
    Vectors base, displacement, at, force;
    std::vector<TargetBatch> targets;
    float largestStrain = 0.0f;  // of the response, on a triangle
    std::vector<std::int32_t> strained;  // vertices
    std::vector<FaceStrain> strains;  // per face
    struct Plane {
        Vec3 normal = Vec3::UnitZ(), place = Vec3::Zero();  // m
    };
    std::vector<Plane> planes;  // per face
    Eigen::Vector3f shown = Eigen::Vector3f::Zero();  // of `at` to positions about the middle, m
    // Of a carrier: positions of the coarse body, as shown; what it does around each of its vertices; motions of faces.
    std::vector<float> coarse;
    EmbeddedMapping::Gradients gradients;
    std::vector<Matrix3d> linearOfFace;
};

Result<BendWarp> BendWarp::build(const TriangleMesh& body, const std::vector<JointFace>& faces, const ElementResponse& response, double nu,
                                 std::span<const std::int32_t> blocks, const Vec3& middle, const Progress& progress) {
    auto tables = BendWarpTables::build(body, faces, response, nu, blocks, middle, progress);
    if (!tables) return tl::unexpected(tables.error());
    return BendWarp(std::move(*tables));
}

BendWarp::BendWarp(std::shared_ptr<const BendWarpTables> tables) : state_(std::make_unique<State>(std::move(tables))) {}
BendWarp::BendWarp(BendWarp&&) noexcept = default;
BendWarp& BendWarp::operator=(BendWarp&&) noexcept = default;
BendWarp::~BendWarp() = default;

const std::vector<std::int32_t>& BendWarp::heldVertices() const { return state_->t.carrier ? state_->t.carrier->held : state_->t.held; }

void BendWarp::evaluate(std::span<const FaceMotion> motions, const Eigen::VectorXd& warping, const Points& held, float* local) {
    solve(motions, warping, held, local);
    carry(0, carried(), local);
}

std::size_t BendWarp::carried() const { return state_->t.carrier ? state_->t.carrier->mapping.size() : 0; }

void BendWarp::solve(std::span<const FaceMotion> motions, const Eigen::VectorXd& warping, const Points& held, float* local) {
    state_->solveShape(motions, warping, held);
    if (!state_->t.carrier) state_->write(local);
}

void BendWarp::carry(std::size_t begin, std::size_t end, float* local) const {
    if (begin < end) state_->carry(begin, end, local);
}

BendWarp::Cost BendWarp::cost() const {
    const auto& t = state_->t;
    const auto n = static_cast<std::size_t>(t.vertices);
    Cost cost{t.seconds, 0, t.factor.entries()};
    cost.bytes = t.factor.bytes() + static_cast<std::size_t>(t.response.size()) * sizeof(float) + 5 * n * sizeof(Vector4f) +
                 3 * static_cast<std::size_t>(t.free) * sizeof(float) + t.triangles.size() * (sizeof(WarpBatch) + sizeof(TargetBatch)) +
                 t.surface.size() * sizeof(t.surface[0]) + (t.neighbors.size() + t.firstNeighbor.size()) * sizeof(t.neighbors[0]) + t.slot.size() * sizeof(t.slot[0]) + t.inflation.size() * sizeof(float) +
                 t.follow.size() * sizeof(FollowBatch);
    for (const auto& table : t.heldColumns) cost.bytes += static_cast<std::size_t>(table.size()) * sizeof(float);
    for (const auto& list : t.contacts) cost.bytes += list.size() * sizeof(BendWarpTables::Contact);
    if (t.carrier) cost.bytes += t.carrier->bytes() + 3 * t.carrier->mapping.size() * sizeof(float);
    return cost;
}

}  // namespace imomushi
