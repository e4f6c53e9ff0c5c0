// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/character/aligned_buffer.h"
#include "core/character/character.h"
#include "core/character/explicit_joints.h"
#include "core/character/felt_acceleration.h"
#include "core/character/joint_equilibrium.h"
#include "core/character/joint_jiggle.h"
#include "core/character/normal_stencils.h"
#include "core/character/response_blocks.h"
#include "core/character/surface_recipe.h"
#include "core/character/vertex_kernels.h"
#include "core/skeleton/bone_tree.h"
#include "core/touch/touch_blocks.h"
#include "core/touch/touch_contact.h"
#include "core/warp/bend_warp.h"

// Of the character's own files alone.
namespace imomushi {

/// x -> linear * x + shift, rest to world.
struct AffineMap {
    Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
    Vec3 shift = Vec3::Zero();
    [[nodiscard]] Vec3 operator()(const Vec3& p) const { return linear * p + shift; }
    bool operator==(const AffineMap& o) const { return linear == o.linear && shift == o.shift; }
};

inline double milliseconds(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

/// Errors: "bad-value": indices that name nothing, numbers that are none, a response of another mesh.
Result<void> checkInput(const CharacterInput& input);

/// What a character is between frames.
struct Character::State {
    using Matrix3d = Eigen::Matrix3d;
    using Quaterniond = Eigen::Quaterniond;

    // Threads share a frame in pieces of about this many bytes, and only frames with this many: less is done before a helper wakes up.
    static constexpr std::size_t kBytesPerPiece = 1 << 17, kBytesWorthThreads = 1 << 20;

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
        double bendMs = 0.0, loadMs = 0.0;  // of the last bend
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
        bool replayed = false;        // of a shape that is shown: forces are these
        Eigen::VectorXd shownForces = {};
        [[nodiscard]] const Eigen::VectorXd& forces() const { return replayed ? shownForces : contact.patchForces(); }
        [[nodiscard]] bool active() const {
            if (replayed) return wasDented || (shownForces.array() != 0.0).any();
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
        bool elsewhere = false;      // somebody wants to make the surface from the recipe
        bool madeElsewhere = false;  // and does, since the last update()
        bool pending = false;        // positions and normals here are not those of the last update()
        bool seamsOpen = false;      // normals on seams are not
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
        std::uint64_t revision = 0, moves = 0;  // moves: without changes of normals on seams
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

    /// Sets `failure` where an effect cannot be built.
    explicit State(CharacterInput given);
    // Once (character_build.cpp).
    // Until all elements are precomputed for it the character does without.
    void buildExplicitJoints();
    void buildWarpAndTouch(std::size_t e);
    void buildEquilibrium();
    JointState buildJoint(const CharacterInput::Joint& joint, double shrink) const;
    void buildElement(int e);
    void addLoads(const CharacterInput::Element& given, ElementState& out, Eigen::MatrixXd& response) const;
    // Which vertices of two joined rims share normals.
    void buildSeam(const CharacterInput::Joint& joint);
    std::int32_t rimIndex(int element, std::int32_t v);

    // Each frame (character.cpp).
    void update(const Pose& wanted, double seconds);
    // Its second half: what vertices do.
    void showShape(std::chrono::steady_clock::time_point start);
    // The time of body loads: their own and that of their columns in the product.
    void shareLoadTime();
    void assign(const Pose& p);
    template <class Part, class Body>
    void share(std::size_t bytes, const std::vector<Part>& pieces, const Body& body) {
        if (pool && bytes >= kBytesWorthThreads)
            pool->run(pieces.size(), [&](std::size_t i) { body(pieces[i]); });
        else
            for (const auto& p : pieces) body(p);
    }

    // Pose -> joints and v (character_pose.cpp).
    [[nodiscard]] Quaterniond rolled(int bone) const;
    void placeElement(std::size_t e);
    void placeJoint(std::size_t j);
    // The joints of an element in its own frame, as coefficients of its bases.
    void measure(std::size_t e);
    // The shape of a joint is of small motions. Where elements are warped it fades while the joint turns away from them: they keep their volume with rigid
    // joints, and creases would come back.
    [[nodiscard]] double shownPart(std::size_t j) const;
    // What acts on the joints of an element besides its stiffness.
    [[nodiscard]] static std::span<const double> forcesOn(const ElementState& e);
    // The shapes of all joints, from rigid ones.
    void relax();
    // Force per volume and pressure in the frame of the element. What would deform it too much is felt less, all alike.
    void load(std::size_t e, double seconds);
    // What joint faces do by themselves in the previous model, on top of where the bones have them.
    void stepExplicitJoints();
    // Whether time alone changes what is shown.
    [[nodiscard]] bool resting() const;

    // v -> vertices (character_surface.cpp).
    void decideWork(std::size_t e);
    // The shapes under large motions instead of products, into `local`: of all elements that want one, side by side; of one.
    void bendElements();
    void bend(ElementState& out, const CharacterInput::Element& given) const;
    // Fingers: after the pose alone is in `local`, before it is shown.
    void press(ElementState& out, const CharacterInput::Element& given);
    void aimFingers(ElementState& out, const CharacterInput::Element& given);
    // Where the pose alone has a body vertex in the frame of its element.
    [[nodiscard]] Vec3 poseAt(const ElementState& e, std::int32_t vertex) const;
    // The same of a free one, with or without dents.
    [[nodiscard]] static Vec3 localAt(const ElementState& e, std::int32_t vertex, bool dented);
    static void showPositions(ElementState& out, std::size_t begin, std::size_t end);
    void holdVertices(ElementState& out) const;
    // Where its joint has the i-th held vertex.
    [[nodiscard]] Vec3 heldAt(const ElementState& element, std::size_t i) const;
    void holdWarped(ElementState& out) const;
    void holdNormals(ElementState& out) const;
    void closeSeams();
    // True: the normal changed.
    bool closeSeam(const SeamNormal& s);

    // Surfaces that are made elsewhere (surface_recipe.cpp).
    void buildRecipe();
    void fillRecipe(std::size_t e);
    // Positions and normals of an element as of the last update().
    void catchUp(std::size_t e);
    // The same without normals on seams.
    void evaluateHere(std::size_t e);
    // Of a node of explicit joints, in the rest axes of its joint.
    [[nodiscard]] Vec3 offset(int node) const { return replaying ? shownOffsets[static_cast<std::size_t>(node)] : explicitJoints->offset(node); }

    const CharacterInput input;
    std::optional<Error> failure;              // of the constructor
    std::optional<ExplicitJoints> explicitJoints;
    bool stopped = true;                       // the next update() starts from rest
    bool exact = false;                        // see keepExact()
    bool replaying = false;                    // the last frame was a shape, with these offsets of nodes
    std::vector<Vec3> shownOffsets;
    double frameSeconds = 0.0;                 // of the update() that runs
    double loadMs = 0.0;                       // of its body loads alone
    CharacterEffects effects = input.effects;  // with their numbers of now
    double breath = 0.0;                       // phase, radians
    const BoneTree tree;
    const Pose poseOfRest = restPose(input.skeleton);
    InverseKinematics kinematics;
    Pose pose;  // the last good one
    std::vector<JointState> joints;
    std::vector<ElementState> elements;
    std::vector<SeamNormal> seams;
    std::vector<Piece> productPieces, normalPieces;
    std::vector<std::size_t> bent;  // elements that are bent in this frame
    std::shared_ptr<ThreadPool> pool;               // null: the frames of this character are too small for threads
    std::unique_ptr<JointEquilibrium> equilibrium;  // null: joints are not smooth
    std::unique_ptr<SurfaceRecipe> recipe;          // null: nobody asked for it
    std::vector<char> seamOnly = std::vector<char>(input.elements.size(), 0);
    unsigned solveWarnings = 0, updateWarnings = 0;
    Stats stats;
};

}  // namespace imomushi
