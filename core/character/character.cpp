// SPDX-License-Identifier: GPL-3.0-or-later
// One frame: pose -> rotation, place and in-plane stretch of every joint (JointState) -> v of every element in its own moving frame -> vertices. With
// smooth joints: rotation and place -> v of rigid joints -> shapes of all joints in equilibrium, and v with them.
// Vertices of joint faces are placed by their joint alone, welded ones from the rest position of their first face: seams are closed by
// construction, whatever the basis can say.
#include "core/character/character.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/parallel.h"
#include "core/character/aligned_buffer.h"
#include "core/character/explicit_joints.h"
#include "core/character/felt_acceleration.h"
#include "core/character/frame_crew.h"
#include "core/character/joint_equilibrium.h"
#include "core/character/joint_jiggle.h"
#include "core/character/normal_stencils.h"
#include "core/character/response_blocks.h"
#include "core/character/shrink.h"
#include "core/character/vertex_kernels.h"
#include "core/skeleton/bone_tree.h"
#include "core/touch/touch_blocks.h"
#include "core/touch/touch_contact.h"
#include "core/warp/bend_warp.h"

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Quaterniond;

namespace {

// Twist in radians or shift in face sizes that the basis cannot say and an artist would see.
constexpr double kVisibleLoss = 1e-3;
constexpr double kTurn = 2.0 * std::numbers::pi;
// A change of v that moves no vertex by more than this part of the element is below single precision: the product is not computed again.
constexpr double kSameShape = 1e-8;
// Body loads deform no element by more than this part of its size, approached smoothly: they are linear, and more would fold it.
constexpr double kMostLoaded = 0.25;
// Radians between an element and its joint at which the shapes of smooth joints have gone, where elements are warped.
constexpr double kFadedAngle = 0.6;
// In-plane stretches stay within these, approached smoothly.
constexpr double kLeastStretch = 0.3, kMostStretch = 3.0;
// A vertex at the rim of a joined face that has no partner takes the normal of the nearest place on the other rim within this many face sizes.
constexpr double kNearRim = 0.1;
// Threads share a frame in pieces of about this many bytes, and only frames with this many: less is done before a helper wakes up.
constexpr std::size_t kBytesPerPiece = 1 << 17, kBytesWorthThreads = 1 << 20;

/// Weighted mean of rotations given as quaternions. Within one tree signs say which way a bend went round (Pose::frames); across trees they mean
/// nothing and are aligned with the first.
class MeanRotation {
public:
    void add(const Quaterniond& q, double weight, int tree) {
        double sign = 1.0;
        if (first_ == kNone)
            first_ = tree;
        else if (tree != first_ && sum_.dot(q.coeffs()) < 0.0)
            sign = -1.0;
        if (!last_) reference_ = q;
        last_ = true;
        sum_ += sign * weight * q.coeffs();
    }
    [[nodiscard]] bool empty() const { return !last_; }
    [[nodiscard]] Quaterniond get() const {
        const double n = sum_.norm();
        return n > 1e-6 ? Quaterniond(Eigen::Vector4d(sum_ / n)) : reference_;
    }

private:
    static constexpr int kNone = std::numeric_limits<int>::min();
    Eigen::Vector4d sum_ = Eigen::Vector4d::Zero();
    Quaterniond reference_ = Quaterniond::Identity();
    int first_ = kNone;
    bool last_ = false;
};

double milliseconds(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

// 1 + x near 0, between the limits everywhere, twice differentiable.
double boundedStretch(double x) {
    const double room = x < 0.0 ? 1.0 - kLeastStretch : kMostStretch - 1.0;
    return 1.0 + room * std::tanh(x / room);
}

// The same to first order, as a free bar of Poisson ratio nu contracts when it is stretched by far: (length)^-nu.
double freeStretch(double x, double nu) {
    if (nu < 1e-3) return boundedStretch(x);
    return std::clamp(std::pow(std::max(1.0 - x / nu, 1e-3), -nu), kLeastStretch, kMostStretch);
}

/// x -> linear * x + shift, rest to world.
struct AffineMap {
    Matrix3d linear = Matrix3d::Identity();
    Vec3 shift = Vec3::Zero();
    [[nodiscard]] Vec3 operator()(const Vec3& p) const { return linear * p + shift; }
    bool operator==(const AffineMap& o) const { return linear == o.linear && shift == o.shift; }
};

Result<void> check(const CharacterInput& input) {
    const int points = static_cast<int>(input.skeleton.points.size());
    const int bones = static_cast<int>(input.skeleton.bones.size());
    const auto bad = [](const std::string& what) { return fail("bad-value", "The character contradicts itself: " + what + "."); };
    const auto in = [](int i, int n) { return i >= 0 && i < n; };
    for (int b = 0; b < bones; ++b) {
        const auto& bone = input.skeleton.bones[b];
        if (!in(bone.start, points) || !in(bone.end, points) || bone.start == bone.end) return bad("a bone has an end that is not there");
        if (bone.parent >= b) return bad("a bone comes before its parent");
        if (!(bone.length > 0.0) || !std::isfinite(bone.length)) return bad("a bone has no length");
        if (!(bone.minStretch >= 0.0) || !(bone.maxStretch >= bone.minStretch)) return bad("a bone's stretch limits are in the wrong order");
    }
    for (const auto& p : input.skeleton.points)
        if (!allFinite(p)) return bad("a joint point is not a number");
    for (const auto& element : input.elements) {
        if (!element.mesh) return bad("an element has no mesh");
        const auto vertices = element.mesh->body.vertices.rows();
        if (!allFinite(element.mesh->body.vertices)) return bad("a vertex is not a number");
        const auto& triangles = element.mesh->body.triangles;
        if (triangles.size() > 0 && (triangles.minCoeff() < 0 || triangles.maxCoeff() >= vertices)) return bad("a triangle has a corner that is not there");
        std::vector<char> onFace(vertices, 0);
        for (const auto& face : element.faces) {
            for (const auto v : face.vertices) {
                if (v < 0 || v >= vertices) return bad("a joint face names a vertex that is not there");
                if (onFace[v]++) return bad("two joint faces share a vertex");
            }
            for (const auto t : face.triangles)
                if (t < 0 || t >= triangles.rows()) return bad("a joint face names a triangle that is not there");
        }
        for (const int b : element.bones)
            if (!in(b, bones)) return bad("an element names a bone that is not there");
        if (!(element.density > 0.0) || !std::isfinite(element.density)) return bad("an element has no density");
        if (!element.response) continue;
        const auto& r = *element.response;
        bool fits = r.bases.size() == element.faces.size() && r.firstColumn.size() == element.faces.size() + 1;
        for (std::size_t f = 0; fits && f < r.bases.size(); ++f) fits = r.firstColumn[f + 1] - r.firstColumn[f] == r.bases[f].columns();
        fits = fits && r.response.rows() == 3 * static_cast<Eigen::Index>(r.freeVertices.size()) && r.response.cols() == r.columns() &&
               r.stiffness.rows() == r.columns() && r.stiffness.cols() == r.columns() && allFinite(r.response) && allFinite(r.stiffness);
        fits = fits && (r.loads.size() == 0 || (r.loads.rows() == r.response.rows() && r.loads.cols() == 4 && allFinite(r.loads) &&
                                           r.loadForces.rows() == r.columns() && r.loadForces.cols() == 4 && allFinite(r.loadForces)));
        std::size_t held = 0;
        for (const auto& face : element.faces) held += face.vertices.size();
        fits = fits && r.freeVertices.size() + held == static_cast<std::size_t>(vertices);
        for (const auto v : r.freeVertices) fits = fits && v >= 0 && v < vertices && !onFace[v];
        if (!fits) return bad("a response belongs to another mesh or other joint faces; precompute again");
    }
    std::vector<std::vector<int>> used(input.elements.size());
    for (std::size_t e = 0; e < used.size(); ++e) used[e].assign(input.elements[e].faces.size(), 0);
    for (const auto& joint : input.joints) {
        if (joint.point < -1 || joint.point >= points || joint.faces.empty()) return bad("a joint has no face or no joint point");
        for (const auto& f : joint.faces) {
            if (!in(f.element, static_cast<int>(input.elements.size())) || !in(f.face, static_cast<int>(used[f.element].size())))
                return bad("a joint names a face that is not there");
            if (f.bone < -1 || f.bone >= bones) return bad("a joint names a bone that is not there");
            ++used[f.element][f.face];
        }
        if (!joint.welded.empty() && joint.faces.size() < 2) return bad("a joint welds a face to nothing");
        for (const auto& [a, b] : joint.welded)
            if (!in(a, static_cast<int>(input.elements[joint.faces[0].element].mesh->body.vertices.rows())) ||
                !in(b, static_cast<int>(input.elements[joint.faces[1].element].mesh->body.vertices.rows())))
                return bad("a joint welds a vertex that is not there");
    }
    for (const auto& faces : used)
        for (const int n : faces)
            if (n != 1) return bad("a joint face belongs to no joint or to several");
    return {};
}

}  // namespace

struct Character::State {
    struct JointState {
        Vec3 restPlace = Vec3::Zero();
        Vec3 restNormal = Vec3::UnitZ();
        Vec3 restTangent = Vec3::Zero();  // that roll turns about; zero: no bones meet here
        double shrink = 0.0;
        bool led = false;
        AffineMap map;
        Quaterniond turn = Quaterniond::Identity();  // of the map; its sign says which way a bend went round
        std::optional<JointJiggle> jiggle;
        bool warped = false;  // an element keeps its volume here
        double nu = 0.45;     // of that element
        // With smooth joints only.
        Matrix3d rotation = Matrix3d::Identity();
        Eigen::Matrix3Xd warping;  // world, per scalar shape
        double part = 1.0;         // of its shape that is shown: less where it turns far and elements are warped
    };
    // A vertex that its joint places, and the rest position that it is placed from.
    struct HeldVertex {
        std::int32_t vertex = 0;
        int joint = 0;
        Vec3 rest = Vec3::Zero();
        int node = 0;  // of explicit joints, where there are any
    };
    // Vertices whose triangles are all inside the joint have no normal of their own.
    struct HiddenVertex {
        std::int32_t vertex = 0;
        int joint = 0;
        Vec3 normal = Vec3::UnitZ();
    };
    // A vertex of a seam, and its normal from this element alone.
    struct RimNormal {
        std::int32_t vertex = 0;
        Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
    };
    enum class Work { None, Place, Evaluate, EvaluateAndKeep };
    // What body loads do to an element: columns after those of the joints.
    struct BodyLoads {
        bool gravity = false, inflated = false;
        FeltAcceleration felt;
        Eigen::VectorXd all;     // v, then loads
        Eigen::VectorXd forces;  // that they put on the joints, see ElementResponse::loadForces
        [[nodiscard]] Eigen::Index first() const { return all.size() - (gravity ? 3 : 0) - (inflated ? 1 : 0); }
    };
    // Large motions of an element.
    struct Warped {
        BendWarp warp;
        std::vector<FaceMotion> motions;  // per face
        Eigen::VectorXd warping;          // what smooth joints add to motions, see BendWarp::evaluate()
        Points held;                      // of warp.heldVertices()
        std::vector<std::size_t> heldOf;  // where they are in ElementState::held
        AlignedBuffer<float> loaded;      // with body loads: local positions under these alone
    };
    // Fingers on an element.
    struct Touched {
        struct Finger {
            Vec3 rest, target;  // m, rest and world
            double radius = 0.0;
        };
        TouchContact contact;
        TouchBlocks blocks;
        std::array<Finger, TouchContact::kFingers> fingers;
        AlignedBuffer<float> dented;
        bool wasDented = false;
        [[nodiscard]] bool active() const {
            bool down = !contact.idle() || wasDented;
            for (int i = 0; i < TouchContact::kFingers; ++i) down = down || contact.down(i);
            return down;
        }
    };
    struct ElementState {
        std::size_t vertices = 0;
        Vec3 middle = Vec3::Zero();
        double size = 0.0;
        double boneLength = 0.0;
        int anchorJoint = -1;  // hangs on this joint; else the middle of its bones
        Vec3 restAnchor = Vec3::Zero();
        std::vector<int> jointOf;        // per face
        std::vector<Points> restOfFace;  // per face, its vertices in its axes

        Quaterniond rotation = Quaterniond::Identity();
        AffineMap frame, shownFrame;
        Eigen::VectorXd v, shownV, columnSize;
        std::optional<BodyLoads> loads;
        [[nodiscard]] const Eigen::VectorXd& weights() const { return loads ? loads->all : v; }
        std::optional<Warped> warped;
        std::vector<char> sameTree;  // per face, where it is warped: signs of rotations agree
        std::optional<Touched> touched;
        std::vector<AffineMap> shownJoints;  // per face
        std::vector<Eigen::Matrix3Xd> shownWarping;  // per face, with smooth joints
        Eigen::MatrixXd heldShapes;          // #shapes x #held, with smooth joints: warping shapes of the joint, m
        bool shown = false, moved = false;
        [[nodiscard]] double scale() const { return size > 0.0 ? 1.0 / size : 1.0; }

        std::vector<HeldVertex> held;
        std::vector<HiddenVertex> hidden;
        std::vector<std::int32_t> free, triangles;  // body vertices; triangles: only visible ones
        std::vector<NormalStencil> stencils;
        std::vector<RimNormal> rim;
        ResponseBlocks blocks;
        AlignedBuffer<float> local, positions, normals;
        bool localShown = false;  // local belongs to shownV
        Work work = Work::None;
        AffineFloat placement{};
        std::uint64_t revision = 0;
    };
    // The normal of a vertex on a seam is shared with a place on an edge of the other rim.
    struct SeamNormal {
        int element = 0, other = 0;
        std::int32_t vertex = 0, from = 0, to = 0;  // those of rims: indices into ElementState::rim
        std::int32_t own = 0;
        float part = 0.0f;  // of the way from `from` to `to`
    };
    // A piece of an element for one thread: blocks, or vertices of normals.
    struct Piece {
        int element = 0;
        std::size_t begin = 0, end = 0;
    };

    explicit State(CharacterInput given)
        : input(std::move(given)), tree(boneTree(input.skeleton)), kinematics(input.skeleton), pose(restPose(input.skeleton)) {
        const auto shrinks = leastEnergyShrink(input);
        boneLength = 0.0;
        for (const auto& bone : input.skeleton.bones) boneLength = std::max(boneLength, bone.length);
        for (std::size_t j = 0; j < input.joints.size(); ++j) joints.push_back(buildJoint(input.joints[j], shrinks[j]));
        elements.resize(input.elements.size());
        for (std::size_t e = 0; e < elements.size(); ++e) buildElement(static_cast<int>(e));
        // The previous model shapes joints itself.
        if (input.smoothJoints && !effects.previousModel) buildEquilibrium();
        for (std::size_t e = 0; e < elements.size() && !failure; ++e) buildWarpAndTouch(e);
        for (std::size_t j = 0; effects.jointDynamics && j < joints.size() && !failure; ++j) {
            auto jiggle = JointJiggle::build(input, input.joints[j], *effects.jointDynamics);
            if (jiggle)
                joints[j].jiggle = std::move(*jiggle);
            else
                failure = jiggle.error();
        }
        if (effects.previousModel && input.basis == BasisKind::Full && !failure) buildExplicitJoints();
        if (failure) return;
        for (std::size_t j = 0; j < input.joints.size(); ++j) buildSeam(input.joints[j]);
        const int threads = input.threads > 0 ? input.threads : hardwareThreads();
        std::size_t bytes = 0;
        for (const auto& e : elements) bytes += e.blocks.count() * e.blocks.bytesPerBlock();
        if (threads > 1 && bytes >= kBytesWorthThreads) crew = std::make_unique<FrameCrew>(threads);
        update(pose, 0.0);
    }

    // Until all elements are precomputed for it the character does without.
    void buildExplicitJoints() {
        for (const auto& e : input.elements)
            if (!e.faces.empty() && (!e.response || e.response->tractions.size() == 0)) return;
        auto made = ExplicitJoints::build(input, *effects.previousModel);
        if (!made) {
            failure = made.error();
            return;
        }
        explicitJoints.emplace(std::move(*made));
        for (std::size_t e = 0; e < elements.size(); ++e)
            for (std::size_t f = 0; f < input.elements[e].faces.size(); ++f)
                for (std::size_t i = 0; i < input.elements[e].faces[f].vertices.size(); ++i)
                    for (auto& h : elements[e].held)
                        if (h.vertex == input.elements[e].faces[f].vertices[i]) h.node = explicitJoints->nodeOf(static_cast<int>(e), static_cast<int>(f), i);
    }

    // What joint faces do by themselves in the previous model, on top of where the bones have them.
    void stepExplicitJoints() {
        const auto start = std::chrono::steady_clock::now();
        for (std::size_t j = 0; j < joints.size(); ++j) explicitJoints->setJoint(static_cast<int>(j), joints[j].turn.toRotationMatrix());
        for (std::size_t e = 0; e < elements.size(); ++e) explicitJoints->setElement(static_cast<int>(e), elements[e].frame.linear, elements[e].v);
        if (stopped) explicitJoints->reset();
        if (frameSeconds > 0.0 && !explicitJoints->step(frameSeconds))
            updateWarnings |= static_cast<unsigned>(FrameWarning::Diverged);
        for (std::size_t e = 0; e < elements.size(); ++e) explicitJoints->addTo(static_cast<int>(e), elements[e].v);
        stats.previousModelMs = milliseconds(start, std::chrono::steady_clock::now());
    }

    void buildWarpAndTouch(std::size_t e) {
        const auto& given = input.elements[e];
        auto& out = elements[e];
        if (!given.response || given.faces.empty()) return;
        if (given.warped) {
            out.sameTree.resize(given.faces.size());
            for (std::size_t f = 0; f < given.faces.size(); ++f) {
                auto& joint = joints[static_cast<std::size_t>(out.jointOf[f])];
                joint.warped = true;
                joint.nu = given.nu;
                const int bone = input.joints[static_cast<std::size_t>(out.jointOf[f])].faces[0].bone;
                out.sameTree[f] = !given.bones.empty() && bone >= 0 && tree.tree[bone] == tree.tree[given.bones[0]];
            }
            auto warp = BendWarp::build(given.mesh->body, given.faces, *given.response, given.nu, {out.blocks.first(), out.blocks.count()}, out.middle, {});
            if (!warp) {
                failure = warp.error();
                return;
            }
            const auto& held = warp->heldVertices();
            Warped made{std::move(*warp), std::vector<FaceMotion>(given.faces.size()), Eigen::VectorXd::Zero(given.response->columns()),
                        Points(static_cast<Eigen::Index>(held.size()), 3), {}, AlignedBuffer<float>(out.loads ? out.local.size() : 0)};
            for (const auto v : made.warp.heldVertices())
                made.heldOf.push_back(static_cast<std::size_t>(
                    std::find_if(out.held.begin(), out.held.end(), [v](const HeldVertex& h) { return h.vertex == v; }) - out.held.begin()));
            out.warped = std::move(made);
        }
        if (given.touched && effects.touch && given.response->touch.columns() > 0) {
            auto contact = TouchContact::build(given.mesh->body, given.faces, given.response, *effects.touch);
            if (!contact) {
                failure = contact.error();
                return;
            }
            out.touched = Touched{std::move(*contact), TouchBlocks(*given.response, {out.blocks.first(), out.blocks.count()}), {}, AlignedBuffer<float>(out.local.size()), false};
        }
    }

    void buildEquilibrium() {
        equilibrium = std::make_unique<JointEquilibrium>(input);
        const int shapes = equilibrium->warpingShapes();
        for (auto& j : joints) j.warping = Eigen::Matrix3Xd::Zero(3, shapes);
        for (auto& e : elements) {
            e.shownWarping.assign(e.jointOf.size(), Eigen::Matrix3Xd::Zero(3, shapes));
            e.heldShapes.resize(shapes, static_cast<Eigen::Index>(e.held.size()));
            for (std::size_t i = 0; i < e.held.size(); ++i)
                equilibrium->shapes(e.held[i].joint, e.held[i].rest, e.heldShapes.col(static_cast<Eigen::Index>(i)).data());
        }
    }

    JointState buildJoint(const CharacterInput::Joint& joint, double shrink) const {
        JointState out;
        const auto& first = input.elements[joint.faces[0].element].faces[joint.faces[0].face].frame;
        out.restPlace = joint.point >= 0 ? input.skeleton.points[joint.point] : first.origin;
        out.restNormal = first.axes.col(2);
        out.shrink = shrink;
        for (const auto& f : joint.faces) {
            out.led = out.led || input.elements[f.element].leadsJointPlanes;
            if (f.bone >= 0) out.restTangent += tree.rollSign[f.bone] * tree.restDirection[f.bone];
        }
        const double n = out.restTangent.norm();
        out.restTangent = n > 1e-6 ? Vec3(out.restTangent / n) : Vec3(Vec3::Zero());
        return out;
    }

    void buildElement(int e) {
        const auto& given = input.elements[e];
        const auto& body = given.mesh->body;
        auto& out = elements[e];
        out.vertices = static_cast<std::size_t>(body.vertices.rows());
        if (out.vertices > 0) {
            const Vec3 low = body.vertices.colwise().minCoeff().transpose(), high = body.vertices.colwise().maxCoeff().transpose();
            out.middle = 0.5 * (low + high);
            out.size = (high - low).norm();
        }
        for (const int b : given.bones) {
            const auto& bone = input.skeleton.bones[b];
            out.boneLength += bone.length;
            out.restAnchor += 0.5 * bone.length * (input.skeleton.points[bone.start] + input.skeleton.points[bone.end]);
        }
        if (out.boneLength > 0.0) out.restAnchor /= out.boneLength;

        std::vector<char> onFace(out.vertices, 0), covered(body.triangles.rows(), 0);
        out.jointOf.assign(given.faces.size(), -1);
        out.shownJoints.resize(given.faces.size());
        for (std::size_t j = 0; j < input.joints.size(); ++j) {
            const auto& joint = input.joints[j];
            for (const auto& f : joint.faces) {
                if (f.element != e) continue;
                out.jointOf[f.face] = static_cast<int>(j);
                if (hangsOnItsJoint(given, joint)) {
                    out.anchorJoint = static_cast<int>(j);
                    out.restAnchor = joints[j].restPlace;
                }
                for (const auto v : given.faces[f.face].vertices) {
                    onFace[v] = 1;
                    Vec3 rest = body.vertices.row(v).transpose();
                    if (&f == joint.faces.data() + 1)
                        for (const auto& [a, b] : joint.welded)
                            if (b == v) rest = input.elements[joint.faces[0].element].mesh->body.vertices.row(a).transpose();
                    out.held.push_back({v, static_cast<int>(j), rest});
                }
                if (joint.faces.size() >= 2)
                    for (const auto t : given.faces[f.face].triangles) covered[t] = 1;
            }
        }

        const int columns = given.response ? given.response->columns() : 0;
        out.v = Eigen::VectorXd::Zero(columns);
        out.columnSize = Eigen::VectorXd::Constant(columns, out.size);
        for (std::size_t f = 0; columns > 0 && f < given.faces.size(); ++f) {
            const int first = given.response->firstColumn[f];
            const FaceBasis& basis = given.response->bases[f];
            out.restOfFace.push_back(localVertices(body, given.faces[f]));
            // Shifts are in metres already.
            if (basis.kind == BasisKind::Full) {
                out.columnSize.segment(first, basis.columns()).setOnes();
                continue;
            }
            out.columnSize[first + 5] = 1.0;
            if (basis.kind != BasisKind::Paper) out.columnSize[first + 6] = out.columnSize[first + 7] = 1.0;
        }

        std::vector<char> visible(out.vertices, 0);
        for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
            if (covered[t]) continue;
            for (int c = 0; c < 3; ++c) {
                out.triangles.push_back(body.triangles(t, c));
                visible[body.triangles(t, c)] = 1;
            }
        }
        for (std::size_t f = 0; f < given.faces.size(); ++f)
            for (const auto v : given.faces[f].vertices)
                if (!visible[v]) out.hidden.push_back({v, out.jointOf[f], given.faces[f].frame.axes.col(2)});

        if (given.response)
            out.free = given.response->freeVertices;
        else
            for (std::size_t v = 0; v < out.vertices; ++v)
                if (!onFace[v]) out.free.push_back(static_cast<std::int32_t>(v));
        Eigen::MatrixXd response = given.response ? given.response->response : Eigen::MatrixXd(3 * out.free.size(), 0);
        addLoads(given, out, response);
        out.shownV = out.weights();
        out.blocks = ResponseBlocks(body.vertices, out.free, out.middle, response, input.format);
        out.local = AlignedBuffer<float>(out.blocks.rest().size());
        const std::size_t padded = (out.vertices + kVertexBlock - 1) / kVertexBlock * kVertexBlock + kVertexBlock;
        out.positions = AlignedBuffer<float>(3 * padded);
        out.normals = AlignedBuffer<float>(3 * padded);
        out.stencils = normalStencils(body.vertices, out.triangles, out.scale());

        const auto split = [e](std::vector<Piece>& pieces, std::size_t count, std::size_t bytesEach, std::size_t grain) {
            std::size_t each = std::max<std::size_t>(kBytesPerPiece / std::max<std::size_t>(bytesEach, 1), 1);
            each = (each + grain - 1) / grain * grain;
            for (std::size_t i = 0; i < count; i += each) pieces.push_back({e, i, std::min(i + each, count)});
        };
        split(productPieces, out.blocks.count(), out.blocks.bytesPerBlock(), 1);
        split(normalPieces, out.vertices, sizeof(NormalStencil) + 6 * sizeof(float), kVertexBlock);
    }

    void addLoads(const CharacterInput::Element& given, ElementState& out, Eigen::MatrixXd& response) const {
        if (!given.response || given.response->loads.size() == 0) return;
        BodyLoads loads;
        loads.gravity = effects.gravity && given.heavy;
        loads.inflated = effects.inflate && given.inflated;
        if (!loads.gravity && !loads.inflated) return;
        std::vector<Eigen::Index> columns;
        if (loads.gravity) columns = {0, 1, 2};
        if (loads.inflated) columns.push_back(3);
        const Eigen::Index first = response.cols(), count = static_cast<Eigen::Index>(columns.size());
        response.conservativeResize(Eigen::NoChange, first + count);
        out.columnSize.conservativeResize(first + count);
        for (Eigen::Index i = 0; i < count; ++i) {
            const auto column = given.response->loads.col(columns[static_cast<std::size_t>(i)]);
            response.col(first + i) = column;
            double largest = 0.0;
            for (Eigen::Index p = 0; p < column.size(); p += 3) largest = std::max(largest, column.segment<3>(p).norm());
            out.columnSize[first + i] = largest;
        }
        loads.all = Eigen::VectorXd::Zero(first + count);
        loads.forces = Eigen::VectorXd::Zero(first);
        loads.felt.reset(out.middle);
        out.loads = std::move(loads);
    }

    // Which vertices of two joined rims share normals.
    void buildSeam(const CharacterInput::Joint& joint) {
        if (joint.faces.size() < 2) return;
        const auto rim = [&](std::size_t i) {
            std::vector<std::int32_t> out;
            const auto& f = joint.faces[i];
            std::vector<char> hidden(elements[f.element].vertices, 0);
            for (const auto& h : elements[f.element].hidden) hidden[h.vertex] = 1;
            for (const auto v : input.elements[f.element].faces[f.face].vertices)
                if (!hidden[v]) out.push_back(v);
            return out;
        };
        const auto point = [&](std::size_t i, std::int32_t v) -> Vec3 {
            return input.elements[joint.faces[i].element].mesh->body.vertices.row(v).transpose();
        };
        const auto rims = {rim(0), rim(1)};
        for (std::size_t side = 0; side < 2; ++side) {
            const std::size_t across = 1 - side;
            const auto& other = joint.faces[across];
            const auto& otherTriangles = input.elements[other.element].mesh->body.triangles;
            const auto& otherFace = input.elements[other.element].faces[other.face];
            const auto& otherRim = *(rims.begin() + across);
            for (const auto v : *(rims.begin() + side)) {
                SeamNormal seam{joint.faces[side].element, other.element, v, -1, -1, -1, 0.0f};
                for (const auto& [a, b] : joint.welded)
                    if ((side == 0 ? a : b) == v) seam.from = seam.to = side == 0 ? b : a;
                double best = seam.from >= 0 ? -1.0 : kNearRim * otherFace.size;
                const Vec3 p = point(side, v);
                for (const auto t : otherFace.triangles)
                    for (int c = 0; c < 3 && best >= 0.0; ++c) {
                        const std::int32_t from = otherTriangles(t, c), to = otherTriangles(t, (c + 1) % 3);
                        if (!std::binary_search(otherRim.begin(), otherRim.end(), from) || !std::binary_search(otherRim.begin(), otherRim.end(), to))
                            continue;
                        const Vec3 a = point(across, from), along = point(across, to) - a;
                        const double part = std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
                        const double distance = (a + part * along - p).norm();
                        if (distance >= best) continue;
                        best = distance;
                        seam.from = from, seam.to = to, seam.part = static_cast<float>(part);
                    }
                if (seam.from < 0) continue;
                seam.own = rimIndex(seam.element, v);
                seam.from = rimIndex(seam.other, seam.from);
                seam.to = rimIndex(seam.other, seam.to);
                seams.push_back(seam);
            }
        }
    }

    std::int32_t rimIndex(int element, std::int32_t v) {
        auto& all = elements[element].rim;
        const auto found = std::find_if(all.begin(), all.end(), [v](const RimNormal& r) { return r.vertex == v; });
        if (found != all.end()) return static_cast<std::int32_t>(found - all.begin());
        all.push_back({v});
        return static_cast<std::int32_t>(all.size() - 1);
    }

    [[nodiscard]] Quaterniond rolled(int bone) const {
        const double roll = boneRoll(input.skeleton, tree, pose, bone);
        const Quaterniond& q = pose.frames[bone];
        if (roll == 0.0) return q;
        return Quaterniond(Eigen::AngleAxisd(roll, q * tree.restDirection[bone])) * q;
    }

    void placeElement(std::size_t e) {
        const auto& given = input.elements[e];
        auto& out = elements[e];
        if (given.bones.empty()) return;
        MeanRotation mean;
        Vec3 anchor = Vec3::Zero();
        for (const int b : given.bones) {
            const auto& bone = input.skeleton.bones[b];
            mean.add(rolled(b), bone.length, tree.tree[b]);
            anchor += 0.5 * bone.length * (pose.points[bone.start] + pose.points[bone.end]);
        }
        anchor /= out.boneLength;
        if (out.anchorJoint >= 0) anchor = pose.points[input.joints[out.anchorJoint].point];
        out.rotation = mean.get().normalized();
        out.frame.linear = out.rotation.toRotationMatrix();
        out.frame.shift = anchor - out.frame.linear * out.restAnchor;
    }

    void placeJoint(std::size_t j) {
        const auto& given = input.joints[j];
        auto& out = joints[j];
        MeanRotation mean;
        Vec3 carried = Vec3::Zero();
        double outward = 0.0;
        int shifted = 0;
        for (const auto& f : given.faces) {
            const auto& element = elements[f.element];
            carried += element.frame(out.restPlace) / static_cast<double>(given.faces.size());
            // A tree of its own for elements that no bone of the joint moves.
            const int alone = -1 - f.element;
            if (out.led) {
                if (input.elements[f.element].leadsJointPlanes) mean.add(element.rotation, 1.0, f.bone >= 0 ? tree.tree[f.bone] : alone);
            } else if (f.bone >= 0 && given.point >= 0) {
                mean.add(pose.frames[f.bone], 1.0, tree.tree[f.bone]);
            } else {
                mean.add(element.rotation, 1.0, alone);
            }
        }
        Vec3 at = given.point >= 0 ? pose.points[given.point] : carried;
        for (const auto& f : given.faces) {
            if (f.bone < 0) continue;
            const auto& element = elements[f.element];
            const Vec3 normal = input.elements[f.element].faces[f.face].frame.axes.col(2);
            outward += (element.frame.linear * normal).dot(at - element.frame(out.restPlace));
            ++shifted;
        }
        Quaterniond rotation = mean.get();
        if (!out.led && given.point >= 0 && pose.roll[given.point] != 0.0 && out.restTangent != Vec3::Zero())
            rotation = Quaterniond(Eigen::AngleAxisd(pose.roll[given.point], rotation * out.restTangent)) * rotation;
        out.turn = rotation.normalized();
        double stretch = 1.0;
        if (shifted && !equilibrium)
            stretch = out.warped ? freeStretch(out.shrink * outward / shifted, out.nu) : boundedStretch(out.shrink * outward / shifted);
        Matrix3d turned = out.turn.toRotationMatrix(), swollen = Matrix3d::Identity();
        if (out.jiggle) {
            JointJiggle::Place place{turned, at, stretch};
            if (stopped) out.jiggle->reset(place);
            out.jiggle->step(frameSeconds, place, swollen);
            if (!(place.rotation == turned)) {
                const Quaterniond jiggled(place.rotation);
                out.turn = jiggled.dot(out.turn) < 0.0 ? Quaterniond(-jiggled.coeffs()) : jiggled;
            }
            turned = place.rotation;
            at = place.at;
        }
        if (equilibrium) {
            out.rotation = out.map.linear = turned;
            out.map.shift = at - out.map.linear * out.restPlace;
            return;
        }
        const Vec3& n = out.restNormal;
        const Matrix3d across = n * n.transpose();
        out.map.linear = turned * (across + stretch * (Matrix3d::Identity() - across));
        if (out.jiggle) out.map.linear = out.map.linear * swollen;
        out.map.shift = at - out.map.linear * out.restPlace;
    }

    // The joints of an element in its own frame, as coefficients of its bases.
    void measure(std::size_t e) {
        const auto& given = input.elements[e];
        auto& out = elements[e];
        if (!given.response) return;
        for (std::size_t f = 0; f < given.faces.size(); ++f) {
            const auto& face = given.faces[f];
            const AffineMap& joint = joints[out.jointOf[f]].map;
            JointMap local;
            local.linear = face.frame.axes.transpose() * (out.frame.linear.transpose() * joint.linear) * face.frame.axes;
            local.shift = face.frame.axes.transpose() *
                          (out.frame.linear.transpose() * (joint(face.frame.origin) - out.frame(face.frame.origin)));
            double lost = 0.0;
            given.response->bases[f].coefficients(local, out.restOfFace[f], face.size, out.v.data() + given.response->firstColumn[f], lost);
            if (lost > kVisibleLoss) updateWarnings |= static_cast<unsigned>(FrameWarning::BasisLosesTwist);
        }
    }

    // The shape of a joint is of small motions. Where elements are warped it fades while the joint turns away from them: they keep their volume with rigid
    // joints, and creases would come back.
    [[nodiscard]] double shownPart(std::size_t j) const {
        double angle = 0.0;
        for (const auto& f : input.joints[j].faces)
            angle = std::max(angle, joints[j].turn.angularDistance(elements[static_cast<std::size_t>(f.element)].rotation));
        const double part = 1.0 - std::min(1.0, angle * angle / (kFadedAngle * kFadedAngle));
        return part * part;
    }

    // What acts on the joints of an element besides its stiffness.
    [[nodiscard]] static std::span<const double> forcesOn(const ElementState& e) {
        if (!e.loads) return {};
        return {e.loads->forces.data(), static_cast<std::size_t>(e.loads->forces.size())};
    }

    // The shapes of all joints, from rigid ones.
    void relax() {
        for (std::size_t j = 0; j < joints.size(); ++j) equilibrium->setJoint(static_cast<int>(j), joints[j].rotation);
        for (std::size_t e = 0; e < elements.size(); ++e)
            if (input.elements[e].response)
                equilibrium->setElement(static_cast<int>(e), elements[e].frame.linear, elements[e].v, forcesOn(elements[e]));
        equilibrium->solve();
        for (std::size_t j = 0; j < joints.size(); ++j) {
            auto& out = joints[j];
            const Vec3 at = out.map(out.restPlace);
            out.part = out.warped ? shownPart(j) : 1.0;
            Matrix3d stretch = equilibrium->stretch(static_cast<int>(j));
            if (out.warped) stretch = (Matrix3d::Identity() + out.part * (stretch - Matrix3d::Identity())).eval();
            out.map.linear = out.rotation * stretch;
            out.map.shift = at - out.map.linear * out.restPlace;
            out.warping.noalias() = out.rotation * equilibrium->warping(static_cast<int>(j));
            if (out.warped) out.warping *= out.part;
        }
        for (std::size_t e = 0; e < elements.size(); ++e)
            if (elements[e].v.size() > 0) elements[e].v = equilibrium->parameters(static_cast<int>(e));
    }

    // Force per volume and pressure in the frame of the element. What would deform it too much is felt less, all alike.
    void load(std::size_t e, double seconds) {
        auto& out = elements[e];
        if (!out.loads) return;
        auto& loads = *out.loads;
        const auto& given = input.elements[e];
        const Eigen::Index first = loads.first(), count = loads.all.size() - first;
        if (loads.gravity) {
            const Vec3 place = out.frame(out.middle);
            if (stopped) loads.felt.reset(place);
            loads.felt.step(seconds, place);
            const auto& gravity = *effects.gravity;
            const double softness = given.density / (gravity.shearModulus * given.stiffness);
            loads.all.segment<3>(first) = softness * (out.frame.linear.transpose() * (gravity.acceleration - gravity.inertia * loads.felt.value()));
        }
        if (loads.inflated) {
            const auto& inflate = *effects.inflate;
            loads.all[first + count - 1] = (inflate.pressure + inflate.breath * std::sin(breath)) / given.stiffness;
        }
        const double wanted = loads.all.tail(count).cwiseAbs().dot(out.columnSize.tail(count)), most = kMostLoaded * out.size;
        if (wanted <= 0.0) return;
        loads.all.tail(count) *= most * std::tanh(wanted / most) / wanted;
        if (wanted > most) updateWarnings |= static_cast<unsigned>(FrameWarning::LoadsBounded);
        if (!equilibrium) return;
        loads.forces.setZero();
        if (loads.gravity) loads.forces.noalias() += given.response->loadForces.leftCols<3>() * loads.all.segment<3>(first);
        if (loads.inflated) loads.forces.noalias() += given.response->loadForces.col(3) * loads.all[first + count - 1];
    }

    // Whether time alone changes what is shown.
    [[nodiscard]] bool resting() const {
        if (effects.inflate && effects.inflate->breath > 0.0 && effects.inflate->breathHertz > 0.0)
            for (const auto& e : elements)
                if (e.loads && e.loads->inflated) return false;
        for (const auto& e : elements) {
            if (e.loads && e.loads->gravity && !e.loads->felt.resting()) return false;
            if (e.touched && e.touched->active()) return false;
        }
        for (const auto& j : joints)
            if (j.jiggle && !j.jiggle->resting()) return false;
        if (explicitJoints && !explicitJoints->resting()) return false;
        return true;
    }

    void update(const Pose& wanted, double seconds) {
        const auto start = std::chrono::steady_clock::now();
        updateWarnings = 0;
        stats.evaluatedElements = stats.evaluatedVertices = 0;
        frameSeconds = seconds;
        if (wanted.points.empty() && !pose.points.empty())
            assign(poseOfRest);
        else if (fits(input.skeleton, wanted))
            assign(wanted);
        else
            updateWarnings |= static_cast<unsigned>(FrameWarning::PoseRefused);
        for (std::size_t e = 0; e < elements.size(); ++e) placeElement(e);
        const auto placing = std::chrono::steady_clock::now();
        for (std::size_t j = 0; j < joints.size(); ++j) placeJoint(j);
        if (effects.jointDynamics) stats.jointDynamicsMs = milliseconds(placing, std::chrono::steady_clock::now());
        for (std::size_t e = 0; e < elements.size(); ++e) measure(e);
        double loadMs = 0.0;
        if (effects.gravity || effects.inflate) {
            const auto begun = std::chrono::steady_clock::now();
            if (effects.inflate)
                breath = !stopped && effects.inflate->breath > 0.0 ? std::fmod(breath + kTurn * effects.inflate->breathHertz * seconds, kTurn) : 0.0;
            for (std::size_t e = 0; e < elements.size(); ++e) load(e, seconds);
            loadMs = milliseconds(begun, std::chrono::steady_clock::now());
        }
        if (explicitJoints) stepExplicitJoints();
        if (equilibrium) {
            const auto rigid = std::chrono::steady_clock::now();
            relax();
            stats.equilibriumMs = milliseconds(rigid, std::chrono::steady_clock::now());
        }
        for (auto& e : elements)
            if (e.loads) e.loads->all.head(e.v.size()) = e.v;
        const auto measured = std::chrono::steady_clock::now();
        std::size_t bytes = 0;
        stats.bendWarpMs = stats.touchMs = 0.0;
        for (std::size_t e = 0; e < elements.size(); ++e) {
            decideWork(e);
            if (elements[e].warped) bend(elements[e], input.elements[e]);
            if (elements[e].moved) bytes += elements[e].blocks.count() * elements[e].blocks.bytesPerBlock();
        }
        share(bytes, productPieces, [this](const Piece& p) { showPositions(elements[p.element], p.begin, p.end); });
        for (std::size_t e = 0; e < elements.size(); ++e)
            if (elements[e].touched) press(elements[e], input.elements[e]);
        for (auto& e : elements) holdVertices(e);
        const auto placed = std::chrono::steady_clock::now();
        share(bytes, normalPieces, [this](const Piece& p) {
            auto& out = elements[p.element];
            if (out.moved)
                findNormals(out.positions.data(), out.stencils.data(), static_cast<float>(out.scale()), p.begin, p.end, out.normals.data());
        });
        for (auto& e : elements) holdNormals(e);
        closeSeams();
        const auto done = std::chrono::steady_clock::now();
        stats.jointsMs = milliseconds(start, measured);
        stats.productMs = milliseconds(measured, placed);
        stats.normalsMs = milliseconds(placed, done);
        stats.warnings = solveWarnings | updateWarnings;
        if (effects.gravity || effects.inflate) shareLoadTime(loadMs);
        stopped = false;
    }

    // The time of body loads: their own and that of their columns in the product.
    void shareLoadTime(double loadMs) {
        double columns = 0.0, gravity = 0.0, inflated = 0.0;
        for (const auto& e : elements) {
            if (e.work != Work::Evaluate && e.work != Work::EvaluateAndKeep) continue;
            const auto vertices = static_cast<double>(e.free.size());
            columns += vertices * static_cast<double>(e.weights().size());
            if (e.loads && e.loads->gravity) gravity += 3.0 * vertices;
            if (e.loads && e.loads->inflated) inflated += vertices;
        }
        const double share = columns > 0.0 ? stats.productMs / columns : 0.0;
        const double own = effects.gravity && effects.inflate ? 0.5 * loadMs : loadMs;
        stats.gravityMs = effects.gravity ? own + share * gravity : 0.0;
        stats.inflateMs = effects.inflate ? own + share * inflated : 0.0;
    }

    void assign(const Pose& p) {
        std::copy(p.points.begin(), p.points.end(), pose.points.begin());
        std::copy(p.frames.begin(), p.frames.end(), pose.frames.begin());
        std::copy(p.roll.begin(), p.roll.end(), pose.roll.begin());
    }

    template <class Body>
    void share(std::size_t bytes, const std::vector<Piece>& pieces, const Body& body) {
        if (crew && bytes >= kBytesWorthThreads)
            crew->run(pieces.size(), [&](std::size_t i) { body(pieces[i]); });
        else
            for (const auto& p : pieces) body(p);
    }

    void decideWork(std::size_t e) {
        auto& out = elements[e];
        out.moved = !out.shown || !(out.frame == out.shownFrame);
        for (std::size_t f = 0; f < out.jointOf.size(); ++f) {
            out.moved = out.moved || !(joints[out.jointOf[f]].map == out.shownJoints[f]);
            out.shownJoints[f] = joints[out.jointOf[f]].map;
        }
        for (std::size_t f = 0; f < out.shownWarping.size(); ++f) {
            out.moved = out.moved || joints[out.jointOf[f]].warping != out.shownWarping[f];
            out.shownWarping[f] = joints[out.jointOf[f]].warping;
        }
        bool sameShape = out.shown && ((out.weights() - out.shownV).cwiseAbs().cwiseProduct(out.columnSize).array() <= kSameShape * out.size).all();
        // The bend warp bends by more than v says where the basis loses twist.
        if (out.warped && out.moved && input.basis == BasisKind::Paper) sameShape = false;
        const bool touched = out.touched && out.touched->active();
        out.moved = out.moved || !sameShape || touched;
        out.work = Work::None;
        if (!out.moved) return;
        out.shownFrame = out.frame;
        ++out.revision;

        const Vec3 shift = out.frame(out.middle);
        for (int i = 0; i < 3; ++i) {
            out.placement.shift[i] = static_cast<float>(shift[i]);
            for (int k = 0; k < 3; ++k) out.placement.linear[3 * i + k] = static_cast<float>(out.frame.linear(i, k));
        }
        if (sameShape && out.localShown) {
            out.work = Work::Place;
            return;
        }
        // Who bends goes on bending, mostly: the bent shape is kept when it moves as it is, and at the start.
        out.localShown = sameShape || !out.shown || touched;
        out.work = out.localShown ? Work::EvaluateAndKeep : Work::Evaluate;
        if (!sameShape) out.shownV = out.weights();
        out.blocks.weigh(out.shownV);
        out.shown = true;
        ++stats.evaluatedElements;
        stats.evaluatedVertices += static_cast<int>(out.free.size());
    }

    // The shape under large motions instead of the product, into `local`.
    void bend(ElementState& out, const CharacterInput::Element& given) {
        if (out.work != Work::Evaluate && out.work != Work::EvaluateAndKeep) return;
        const auto start = std::chrono::steady_clock::now();
        auto& w = *out.warped;
        const Matrix3d toElement = out.frame.linear.transpose();
        for (std::size_t f = 0; f < w.motions.size(); ++f) {
            const auto& joint = joints[static_cast<std::size_t>(out.jointOf[f])];
            auto& motion = w.motions[f];
            motion.linear = toElement * joint.map.linear;
            motion.shift = toElement * (joint.map.shift - out.frame.shift);
            motion.rotation = out.rotation.conjugate() * joint.turn;
            if (!out.sameTree[f] && motion.rotation.w() < 0.0) motion.rotation.coeffs() = -motion.rotation.coeffs();
            if (const int modes = given.response->bases[f].modes; equilibrium && modes > 0) {
                const int first = given.response->firstColumn[f] + given.response->bases[f].plainColumns();
                w.warping.segment(first, modes) = joint.part * out.v.segment(first, modes);
            }
        }
        for (std::size_t i = 0; i < w.heldOf.size(); ++i)
            w.held.row(static_cast<Eigen::Index>(i)) = (toElement * (heldAt(out, w.heldOf[i]) - out.frame.shift)).transpose();
        w.warp.evaluate(w.motions, w.warping, w.held, out.local.data());
        if (out.loads) {
            // What loads do to the shape at rest is added; `weights` without its joints is what they do alone.
            out.loads->all.head(out.v.size()).setZero();
            out.blocks.weigh(out.loads->all);
            evaluateAndPlace(out.blocks.view(), out.blocks.weights(), out.placement, 0, out.blocks.count(), w.loaded.data(), out.positions.data());
            out.loads->all.head(out.v.size()) = out.v;
            const float* rest = out.blocks.rest().data();
            for (std::size_t i = 0; i < out.local.size(); ++i) out.local[i] += w.loaded[i] - rest[i];
        }
        out.localShown = true;
        out.work = Work::Place;
        stats.bendWarpMs += milliseconds(start, std::chrono::steady_clock::now());
    }

    // Fingers: after the pose alone is in `local`, before it is shown.
    void press(ElementState& out, const CharacterInput::Element& given) {
        auto& t = *out.touched;
        if (!t.active()) return;
        const auto start = std::chrono::steady_clock::now();
        const Matrix3d toElement = out.frame.linear.transpose();
        for (int i = 0; i < TouchContact::kFingers; ++i) {
            if (!t.contact.down(i)) continue;
            std::array<Vec3, 3> corners;
            for (int c = 0; c < 3; ++c) corners[static_cast<std::size_t>(c)] = poseAt(out, given.mesh->body.triangles(t.contact.triangle(i), c));
            const Vec3 target = toElement * (t.fingers[static_cast<std::size_t>(i)].target - out.frame.shift);
            t.contact.aim(i, corners, target);
        }
        if (frameSeconds > 0.0)
            t.contact.step(frameSeconds);
        else
            t.contact.settle();
        t.wasDented = !t.contact.idle();
        if (t.wasDented) {
            t.blocks.weigh(t.contact.patchForces());
            std::copy_n(out.local.data(), out.local.size(), t.dented.data());
            t.blocks.add(0, out.blocks.count(), t.dented.data());
            place(t.dented.data(), out.blocks.first(), out.placement, 0, out.blocks.count(), out.positions.data());
        }
        stats.touchMs += milliseconds(start, std::chrono::steady_clock::now());
    }

    // Where the pose alone has a body vertex in the frame of its element.
    [[nodiscard]] Vec3 poseAt(const ElementState& e, std::int32_t vertex) const {
        const auto held = std::find_if(e.held.begin(), e.held.end(), [vertex](const HeldVertex& h) { return h.vertex == vertex; });
        if (held != e.held.end()) return e.frame.linear.transpose() * (heldAt(e, static_cast<std::size_t>(held - e.held.begin())) - e.frame.shift);
        return localAt(e, vertex, false);
    }

    // The same of a free one, with or without dents.
    [[nodiscard]] static Vec3 localAt(const ElementState& e, std::int32_t vertex, bool dented) {
        const std::int32_t* first = e.blocks.first();
        const std::size_t block = static_cast<std::size_t>(std::upper_bound(first, first + e.blocks.count(), vertex) - first) - 1;
        const float* at = (dented ? e.touched->dented : e.local).data() + block * 3 * kVertexBlock + (vertex - first[block]);
        return e.middle + Vec3(at[0], at[kVertexBlock], at[2 * kVertexBlock]);
    }

    static void showPositions(ElementState& out, std::size_t begin, std::size_t end) {
        if (out.work == Work::None) return;
        if (out.work == Work::Place)
            place(out.local.data(), out.blocks.first(), out.placement, begin, end, out.positions.data());
        else
            evaluateAndPlace(out.blocks.view(), out.blocks.weights(), out.placement, begin, end,
                             out.work == Work::EvaluateAndKeep ? out.local.data() : nullptr, out.positions.data());
    }

    void holdVertices(ElementState& out) const {
        if (!out.moved) return;
        if (equilibrium || explicitJoints) return holdWarped(out);
        for (const auto& h : out.held) {
            const Vec3 p = joints[h.joint].map(h.rest);
            for (int i = 0; i < 3; ++i) out.positions[3 * static_cast<std::size_t>(h.vertex) + i] = static_cast<float>(p[i]);
        }
    }

    // Where its joint has the i-th held vertex.
    [[nodiscard]] Vec3 heldAt(const ElementState& element, std::size_t i) const {
        const auto& h = element.held[i];
        const auto& joint = joints[h.joint];
        Vec3 p = joint.map(h.rest);
        if (equilibrium) p.noalias() += joint.warping * element.heldShapes.col(static_cast<Eigen::Index>(i));
        if (explicitJoints) p += joint.turn * explicitJoints->offset(h.node);
        return p;
    }

    void holdWarped(ElementState& out) const {
        for (std::size_t k = 0; k < out.held.size(); ++k) {
            const Vec3 p = heldAt(out, k);
            for (int i = 0; i < 3; ++i) out.positions[3 * static_cast<std::size_t>(out.held[k].vertex) + i] = static_cast<float>(p[i]);
        }
    }

    void holdNormals(ElementState& out) const {
        if (!out.moved) return;
        for (const auto& h : out.hidden) {
            const Vec3 n = (joints[h.joint].map.linear * h.normal).normalized();
            for (int i = 0; i < 3; ++i) out.normals[3 * static_cast<std::size_t>(h.vertex) + i] = static_cast<float>(n[i]);
        }
        for (auto& r : out.rim) r.normal = Eigen::Map<const Eigen::Vector3f>(out.normals.data() + 3 * static_cast<std::ptrdiff_t>(r.vertex));
    }

    void closeSeams() {
        for (const auto& s : seams) {
            auto& out = elements[s.element];
            if (!out.moved && !elements[s.other].moved) continue;
            const auto& rim = elements[s.other].rim;
            const Eigen::Vector3f own = out.rim[s.own].normal;
            const Eigen::Vector3f across = (1.0f - s.part) * rim[s.from].normal + s.part * rim[s.to].normal;
            const Eigen::Vector3f sum = own + across;
            const float length = sum.norm();
            const Eigen::Vector3f n = length > 1e-3f ? Eigen::Vector3f(sum / length) : own;
            float* to = out.normals.data() + 3 * static_cast<std::ptrdiff_t>(s.vertex);
            if (std::equal(n.data(), n.data() + 3, to)) continue;
            std::copy_n(n.data(), 3, to);
            if (!out.moved) seamOnly[s.element] = 1;
        }
        for (std::size_t e = 0; e < elements.size(); ++e) {
            if (seamOnly[e]) ++elements[e].revision;
            seamOnly[e] = 0;
        }
    }

    const CharacterInput input;
    std::optional<Error> failure;              // of the constructor
    std::optional<ExplicitJoints> explicitJoints;
    bool stopped = true;                       // the next update() starts from rest
    double frameSeconds = 0.0;                 // of the update() that runs
    CharacterEffects effects = input.effects;  // with their numbers of now
    double breath = 0.0;                       // phase, radians
    const BoneTree tree;
    const Pose poseOfRest = restPose(input.skeleton);
    InverseKinematics kinematics;
    Pose pose;  // the last good one
    double boneLength = 0.0;
    std::vector<JointState> joints;
    std::vector<ElementState> elements;
    std::vector<SeamNormal> seams;
    std::vector<Piece> productPieces, normalPieces;
    std::unique_ptr<FrameCrew> crew;
    std::unique_ptr<JointEquilibrium> equilibrium;  // null: joints are not smooth
    std::vector<char> seamOnly = std::vector<char>(input.elements.size(), 0);
    unsigned solveWarnings = 0, updateWarnings = 0;
    Stats stats;
};

Character::Character(std::unique_ptr<State> state) : state_(std::move(state)) {}
Character::Character(Character&&) noexcept = default;
Character& Character::operator=(Character&&) noexcept = default;
Character::~Character() = default;

Result<Character> Character::build(CharacterInput input) {
    if (auto ok = check(input); !ok) return tl::unexpected(ok.error());
    auto state = std::make_unique<State>(std::move(input));
    if (state->failure) return tl::unexpected(*state->failure);
    return Character(std::move(state));
}

const CharacterInput& Character::input() const { return state_->input; }

InverseKinematics::Report Character::solvePose(const std::vector<Hold>& holds, Pose& pose) {
    const auto start = std::chrono::steady_clock::now();
    const auto report = state_->kinematics.solve(holds, pose);
    state_->solveWarnings = (report.outOfReach ? static_cast<unsigned>(FrameWarning::TargetOutOfReach) : 0u) |
                            (report.finite ? 0u : static_cast<unsigned>(FrameWarning::PoseRefused));
    state_->stats.poseMs = milliseconds(start, std::chrono::steady_clock::now());
    state_->stats.warnings = state_->solveWarnings | state_->updateWarnings;
    return report;
}

void Character::update(const Pose& pose, double seconds) { state_->update(pose, seconds); }

void Character::stop() { state_->stopped = true; }

void Character::tune(const CharacterEffects& effects) {
    auto& now = state_->effects;
    if (now.gravity && effects.gravity) now.gravity = effects.gravity;
    if (now.inflate && effects.inflate) now.inflate = effects.inflate;
    if (now.jointDynamics && effects.jointDynamics &&
        (now.jointDynamics->hertz != effects.jointDynamics->hertz || now.jointDynamics->damping != effects.jointDynamics->damping)) {
        now.jointDynamics = effects.jointDynamics;
        for (auto& joint : state_->joints)
            if (joint.jiggle) (void)joint.jiggle->set(*now.jointDynamics);  // refused numbers leave it as it is
    }
    if (now.previousModel && effects.previousModel) {
        const auto &was = *now.previousModel, &is = *effects.previousModel;
        const bool same = was.step == is.step && was.damping == is.damping && was.shearModulus == is.shearModulus;
        now.previousModel = is;
        if (!same && state_->explicitJoints) (void)state_->explicitJoints->set(is);
    }
    if (now.touch && effects.touch) {
        now.touch = effects.touch;
        for (auto& e : state_->elements)
            if (e.touched) (void)e.touched->contact.set(*now.touch);
    }
}

bool Character::setFinger(int element, int finger, const Vec3& rest, const Vec3& target, double radius) {
    auto& e = state_->elements[static_cast<std::size_t>(element)];
    if (!e.touched || !allFinite(target)) return false;
    auto& t = *e.touched;
    auto& known = t.fingers[static_cast<std::size_t>(finger)];
    // A finger that only moves keeps its place: finding it again costs more than a frame.
    if (!t.contact.down(finger) || rest != known.rest || radius != known.radius)
        if (!t.contact.place(finger, t.contact.nearest(rest), radius)) return false;
    known = {rest, target, radius};
    return true;
}

void Character::liftFinger(int element, int finger) {
    if (auto& touched = state_->elements[static_cast<std::size_t>(element)].touched) touched->contact.lift(finger);
}

bool Character::resting() const { return state_->resting(); }

Character::Surface Character::surface(int element) const {
    const auto& e = state_->elements[element];
    return {e.positions.data(), e.normals.data(), static_cast<int>(e.vertices), e.revision};
}

Points Character::positions(int element) const {
    const auto& given = state_->input.elements[element];
    const auto& e = state_->elements[element];
    Points out(given.mesh->body.vertices.rows(), 3);
    std::vector<double> displacement(3 * e.free.size(), 0.0);
    Eigen::Map<Eigen::VectorXd> x(displacement.data(), static_cast<Eigen::Index>(displacement.size()));
    if (given.response && given.response->columns() > 0) x.noalias() = given.response->response * e.v;
    if (e.loads) {
        const Eigen::Index first = e.loads->first();
        if (e.loads->gravity) x.noalias() += given.response->loads.leftCols<3>() * e.loads->all.segment<3>(first);
        if (e.loads->inflated) x.noalias() += given.response->loads.col(3) * e.loads->all[e.loads->all.size() - 1];
    }
    for (std::size_t i = 0; i < e.free.size(); ++i) {
        const Vec3 rest = given.mesh->body.vertices.row(e.free[i]).transpose();
        out.row(e.free[i]) = e.frame(rest + x.segment<3>(3 * static_cast<Eigen::Index>(i))).transpose();
    }
    // What only a frame knows is as precise as it is shown.
    if (e.warped || (e.touched && e.touched->wasDented))
        for (const auto v : e.free) out.row(v) = e.frame(state_->localAt(e, v, e.touched && e.touched->wasDented)).transpose();
    for (std::size_t i = 0; i < e.held.size(); ++i) out.row(e.held[i].vertex) = state_->heldAt(e, i).transpose();
    return out;
}

const Eigen::VectorXd& Character::jointParameters(int element) const { return state_->elements[element].v; }

Eigen::Isometry3d Character::frame(int element) const {
    const auto& f = state_->elements[element].frame;
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = f.linear;
    out.translation() = f.shift;
    return out;
}

const Character::Stats& Character::stats() const { return state_->stats; }

Character::Memory Character::memory(int element) const {
    const auto& e = state_->elements[element];
    return {e.blocks.responseBytes(), e.blocks.rest().bytes() + e.local.bytes() + e.positions.bytes() + e.normals.bytes() + e.stencils.size() * sizeof(NormalStencil)};
}

double Character::formatError(int element) const { return state_->elements[element].blocks.error(); }

double Character::formatError() const {
    double worst = 0.0;
    for (std::size_t e = 0; e < state_->elements.size(); ++e) worst = std::max(worst, formatError(static_cast<int>(e)));
    return worst;
}

double Character::shrink(int joint) const { return state_->joints[joint].shrink; }

Points deformElement(const ElementMesh& mesh, const std::vector<JointFace>& faces, const ElementResponse& response, const Eigen::VectorXd& v) {
    Points out = mesh.body.vertices;
    const Eigen::VectorXd x = response.response * v;
    for (std::size_t i = 0; i < response.freeVertices.size(); ++i)
        out.row(response.freeVertices[i]) += x.segment<3>(3 * static_cast<Eigen::Index>(i)).transpose();
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const auto& frame = faces[f].frame;
        const auto part = v.segment(response.firstColumn[f], response.bases[f].columns());
        int i = 0;
        for (const auto p : faces[f].vertices) {
            const Vec3 rest = mesh.body.vertices.row(p).transpose();
            out.row(p) += (frame.axes * (response.bases[f].at(frame.toLocal(rest), i++) * part)).transpose();
        }
    }
    return out;
}

}  // namespace imomushi
