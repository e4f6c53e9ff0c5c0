// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/character/aligned_buffer.h"
#include "core/character/character.h"
#include "core/character/element_runtime.h"
#include "core/character/free_end.h"
#include "core/character/pose_watch.h"
#include "core/character/rigid_fit.h"
#include "core/character/vertex_kernels.h"
#include "core/skeleton/bone_tree.h"
#include "core/touch/touch_blocks.h"

// The plain data of a frame, which its steps and the jobs of effects read and write. Only the files of the character and of its jobs know it.
namespace imomushi {

/// x -> linear * x + shift, rest to world.
struct AffineMap {
    Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
    Vec3 shift = Vec3::Zero();
    [[nodiscard]] Vec3 operator()(const Vec3& p) const { return linear * p + shift; }
    [[nodiscard]] AffineFloat toFloat() const;
    bool operator==(const AffineMap& o) const { return linear == o.linear && shift == o.shift; }
};

struct JointState {
    // Fixed by the character.
    Vec3 restPlace = Vec3::Zero();    // m
    Vec3 restNormal = Vec3::UnitZ();
    Vec3 restTangent = Vec3::Zero();  // that roll turns about; zero: no bones meet here
    double contraction = 0.0;         // 1/m, see lateral_contraction.h
    bool led = false;                 // its plane turns with elements that lead (CharacterInput::Element::leadsJointPlanes)
    bool warped = false;              // an element keeps its volume here
    bool fades = false;               // as far as its pose calls for it: warpPart changes from frame to frame
    double nu = 0.45;                 // Poisson ratio of that element
    bool handle = false;              // placed by a handle: it moves rigidly

    // Stage::Joints
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // rest to world; its sign says which way a bend went round
    Eigen::Matrix3d rotationMatrix = Eigen::Matrix3d::Identity();  // the same
    Vec3 at = Vec3::Zero();                                    // where restPlace is, m, world
    double stretch = 1.0;                                      // in its plane
    double pull = 0.0;                                         // what it follows from, relative
    double warpPart = 1.0;                                     // the largest ElementState::warpPart of its elements
    // Stage::JointMaps; Stage::Equilibrium
    AffineMap map;
    Eigen::Matrix3Xd warping;  // with smooth joints: world, per scalar shape
    double part = 1.0;         // of its shape in equilibrium that is shown: less where it turns far and elements are warped
};

/// A joint whose pose is given.
struct HandleFrame {
    HandlePose pose;
    Eigen::Quaterniond carrierTurn = Eigen::Quaterniond::Identity();
    AffineMap carrier;  // rest to world
};

/// A vertex that its joint places, and the rest position that it is placed from.
struct HeldVertex {
    std::int32_t vertex = 0;
    int joint = 0;
    Vec3 rest = Vec3::Zero();
    int node = 0;  // in Frame::offsets
};

/// A vertex of a seam, and its normal from this element alone.
struct RimNormal {
    std::int32_t vertex = 0;
    Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
};

/// What a frame does for the free vertices of an element: nothing; place what `local` has; evaluate the product; the same and keep it in `local`.
enum class VertexWork { None, Place, Evaluate, EvaluateAndKeep };

struct ElementState {
    // Fixed by the character.
    std::shared_ptr<const ElementRuntime> runtime;
    double boneLength = 0.0;         // m, of its bones together
    int anchorJoint = -1;            // it hangs on this joint; -1: on the middle of its bones
    Vec3 restAnchor = Vec3::Zero();  // m
    std::vector<int> jointOf;        // per face
    std::vector<int> handles;        // of its faces
    std::optional<FreeEnd> freeEnd;  // that stretches its flesh; nullopt: none, or no effect asked for it
    std::shared_ptr<RigidFit> fit;   // of these, what the element moves with where it has no bones; null: none
    std::vector<HeldVertex> held;
    Eigen::MatrixXd heldShapes;      // with smooth joints: #shapes x #held, warping shapes of the joint, m

    // Its motion, v, and columns after v.
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    AffineMap frame;                 // rest to world
    Eigen::VectorXd v;
    Eigen::VectorXd withLoads;       // v, then loads; without such columns: empty
    Eigen::VectorXd jointForces;     // of loads on its joints, see ElementResponse::loadForces; empty: none
    // Forces on its touch patches, three per patch, divided by its shear modulus, m^2, along its rest axes. Empty: it has no touch tables. A frame
    // starts at 0. A job adds its forces in Stage::Weights; if it needs `local` first, it sets wantsLocal there and adds them in Stage::Dents.
    Eigen::VectorXd patchForces;
    // Under finger tips (DentSurface); empty: the touch of this element has none. Added together with forces on patches.
    std::vector<Dent> fingerDents, shownFingerDents;
    [[nodiscard]] const Eigen::VectorXd& weights() const { return withLoads.size() > 0 ? withLoads : v; }
    /// Where a free vertex is in the element's frame, m, by `local` or what has its layout.
    [[nodiscard]] Vec3 localAt(std::int32_t vertex, const float* blocksOf) const;

    double aloft = 1.0;              // height of its lowest flesh above the ground in the last frame, over 0.1 sizes of the element, 0...1; 1 without a ground

    // Of the bend warp: how much of it is shown, 0 (the product alone, nothing is computed) ... 1; it fades where it is automatic (weighEffects()).
    double warpPart = 0.0;
    bool fades = false;              // fixed by the character
    std::vector<FaceMotion> watched; // where it fades: the motions of its faces
    PoseWatch::Room watchRoom;

    // Of attached parts (EmbeddedPoints): rotation vectors about their pivots in the axes of the rest pose, radians. As asked for, as of this frame, and as shown last.
    std::vector<Vec3> askedTurns, turns, shownTurns;

    // What was shown last.
    AffineMap shownFrame;
    Eigen::VectorXd shownWeights;
    std::vector<AffineMap> shownJoints;          // per face
    std::vector<Eigen::Matrix3Xd> shownWarping;  // per face, with smooth joints
    bool shown = false, moved = false;  // moved: in Stage::Weights, frame, joints, turns or shape differ from those shown last; after it, also if dents or the place of evaluation change
    bool sameShape = false;          // its weights and warp are those that were shown
    Eigen::VectorXd shownPatchForces;
    bool localShown = false;         // `local` belongs to shownWeights
    double shownWarpPart = 0.0;

    // Vertices.
    ResponseBlocks blocks;           // of the runtime, with the weights of this frame
    int evaluatedVertices = 0;       // in a frame: free ones; where the body is not seen those that render meshes need, and embedded points
    bool wantsLocal = false;         // Stage::Weights: `local` is read in this frame
    VertexWork work = VertexWork::None;
    AffineFloat placement{};
    AlignedBuffer<float> local;      // free vertices in the element's frame about its middle, in blocks, m
    const float* dented = nullptr;   // the same with the dents of patchForces: dents; null: there are none
    AlignedBuffer<float> dents;
    TouchBlocks touchBlocks;         // of the runtime, with the forces of this frame
    AlignedBuffer<float> positions, normals;
    std::vector<RimNormal> rim;
    std::uint64_t revision = 0, moves = 0;  // moves: without changes of normals on seams

    // Deformation by somebody else (deform_input.h).
    bool wantsExternal = false;  // it is asked for
    bool wantsHere = false;      // Stage::Weights: a job reads what render meshes need in this frame
    bool external = false;       // and done, since the last update()
    bool seenPending = false;    // what render meshes need of positions here is not that of the last update()
    std::vector<AffineFloat> parts;  // of attached parts, from their pivots at rest to the world; up to date while `external`
    bool pending = false;        // positions and normals here are not those of the last update()
    bool seamsOpen = false;      // normals on seams are not

    // Under render meshes its body is not seen: of its vertices a frame evaluates those that they need, and no normals; the rest when somebody asks.
    bool unseen = false;         // fixed by the character
    bool partial = false;        // of the positions of the body some are not those of the last update()
    bool localPart = false;      // nor is `local`
};

struct Frame {
    // Threads share a frame in pieces of about this many bytes, and only frames with this many: less is done before a helper wakes up.
    static constexpr std::size_t kBytesPerPiece = 1 << 17, kBytesWorthThreads = 1 << 20;

    explicit Frame(CharacterInput given) : input(std::move(given)), tree(boneTree(input.skeleton)), pose(restPose(input.skeleton)) {}
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;

    /// body(part) for all pieces, on all threads where there are `bytes` enough.
    template <class Part, class Body>
    void share(std::size_t bytes, const std::vector<Part>& pieces, const Body& body) {
        if (pool && bytes >= kBytesWorthThreads)
            pool->run(pieces.size(), [&](std::size_t i) { body(pieces[i]); });
        else
            for (const auto& p : pieces) body(p);
    }
    void warn(FrameWarning warning) { warnings |= static_cast<unsigned>(warning); }
    /// Where its joint has the i-th held vertex, m, world.
    [[nodiscard]] Vec3 heldAt(const ElementState& element, std::size_t i) const;
    void setTime(std::string_view effect, double ms);

    const CharacterInput input;
    const BoneTree tree;
    std::vector<JointState> joints;
    std::vector<ElementState> elements;
    std::vector<HandleFrame> handles;
    bool smooth = false;       // joints take their shape in Stage::Equilibrium, none from lateral contraction
    int warpingShapes = 0;     // per joint, with smooth joints
    std::vector<Vec3> offsets; // per node of the previous model: m, in the rest axes of its joint
    std::vector<std::vector<double>> askedMorphs, morphs;  // weights of morph targets, per render mesh: as asked for, and as of this frame

    Vec3 up = Vec3::UnitY();   // away from the ground
    Pose pose;                 // the last good one
    double seconds = 0.0;      // that pass in this frame
    bool stopped = true;       // it starts from rest
    bool again = false;        // see Character::correct()
    bool shifted = false;      // see Character::shift()
    bool exact = false;        // see Character::keepExact()
    bool replaying = false;    // it shows numbers of Character::shape(), jobs before Stage::Weights do not run
    unsigned warnings = 0;     // of FrameWarning
    double loadMsOfWarp = 0.0; // ms of the bend warp that body loads caused: statistics count them as theirs
    double dentMs = 0.0;       // of placing dents: statistics count them as those of who presses
    Character::Stats stats;
    std::shared_ptr<ThreadPool> pool;  // null: frames of this character are too small for threads
};

/// Of what goes on and on in frames.
class Phase {
public:
    /// Radians after this frame; back to 0 where it is stopped.
    double step(const Frame& frame, double hertz) {
        constexpr double kTurn = 2.0 * std::numbers::pi;
        return radians_ = frame.stopped ? 0.0 : std::fmod(radians_ + kTurn * hertz * frame.seconds, kTurn);
    }
    [[nodiscard]] double radians() const { return radians_; }

private:
    double radians_ = 0.0;  // 0 ... 2 pi
};

}  // namespace imomushi
