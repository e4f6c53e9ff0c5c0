// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/character/character_shape.h"
#include "core/character/effect_settings.h"
#include "core/character/embedded_mesh.h"
#include "core/character/frame_job.h"
#include "core/character/handle_pose.h"
#include "core/character/pose_watch.h"
#include "core/character/response_format.h"
#include "core/dynamics/flesh_clearance.h"
#include "core/joints/joint_face.h"
#include "core/reduction/element_response.h"
#include "core/skeleton/inverse_kinematics.h"

namespace imomushi {

struct DeformInput;

/// What a live character is made of; a document makes one (document/character_input.h). Indices, no names.
struct CharacterInput {
    struct Element {
        std::shared_ptr<const ElementMesh> mesh;
        std::vector<JointFace> faces;
        std::shared_ptr<const ElementResponse> response;  ///< null: not precomputed, the element follows its bones rigidly
        static constexpr double kStandardDensity = 1000.0;  ///< kg/m^3
        double stiffness = 1.0;                           ///< relative shear modulus
        double density = kStandardDensity;                ///< kg/m^3
        double damping = 1.0;                             ///< of joint dynamics, times the ratio of its effect
        double nu = 0.45;                                 ///< Poisson ratio
        int handles = 0;                                  ///< how many of its faces are handles
        std::vector<int> bones;                           ///< bones that run through it; empty: it stays at rest, or moves with its handles (RigidFit)
        /// True: joint planes at its faces are not bisected, they turn with this element (the manual's model, "Large motion", free ends).
        bool leadsJointPlanes = false;
        std::shared_ptr<const EmbeddedPoints> embedded;   ///< what its body moves besides itself; null: nothing
    };
    /// One joint: faces that must look like one surface, at one joint point.
    struct Joint {
        struct Face {
            int element = -1;
            int face = -1;
            int bone = -1;       ///< the bone of that element that ends here, -1: none (the element's frame stands in)
        };
        int point = -1;          ///< joint point of the skeleton, -1: none (the joint follows its elements' frames)
        std::vector<Face> faces; ///< one: a free face or a cap held by its bone
        std::vector<std::pair<std::int32_t, std::int32_t>> welded;  ///< of faces 0 and 1: body vertices that are one point
    };
    /// A joint whose pose is given (setHandle()) instead of found from bones.
    struct Handle {
        int joint = -1;  ///< of a single face, at no joint point
        int bone = -1;   ///< that it hangs on, at one end; -1: its element carries it
        bool atEnd = true;
    };
    Skeleton skeleton;
    std::vector<Element> elements;
    std::vector<Joint> joints;  ///< every joint face belongs to exactly one joint
    /// What is seen instead of the bodies that move it. Bodies under them are evaluated as far as these need them, and wholly when somebody asks (surface()).
    std::vector<std::shared_ptr<const EmbeddedMesh>> renderMeshes;
    std::vector<Handle> handles;
    BasisChoice basis;
    CharacterEffects effects;
    ResponseFormat format = ResponseFormat::Float;
    int threads = 1;  ///< of a frame, 0: all of this machine; large characters only. They change no byte of what is shown
};

/// Things a frame wants to say without failing.
enum class FrameWarning : unsigned {
    BasisLosesTwist = 1,   ///< the pose twists or shifts a face in its plane and the basis "paper" cannot: choose "affine"
    TargetOutOfReach = 2,
    PoseRefused = 4,       ///< a pose came out non-finite; the last good one stays
    Diverged = 16,         ///< the explicit dynamics of the previous model diverged; its joints stand still at their last good place
    LoadsBounded = 8,      ///< gravity or pressure would deform an element beyond what is linear: it feels less of them
    ContactsBounded = 32,  ///< flesh is pressed in more places than contact looks at: the deepest are held, others may cross
    HeldByGround = 64,     ///< a target is in the ground, which keeps its endpoint above (LiveCharacter: no character knows of it)
};

/// A live character: pose -> joint maps -> v -> A' v -> world positions and normals (the manual's model, "One element" and "Large motion").
/// Built once, then update() is the per-frame job: it neither allocates, locks nor fails.
class Character {
public:
    /// Takes over what `previous` ones (null: none) have built for elements whose mesh, faces, response (the same objects) and settings are the same: an edit of one element
    /// builds the tables of that element. Errors: "bad-value" when the input contradicts itself.
    static Result<Character> build(CharacterInput input, std::initializer_list<const Character*> previous = {});
    Character(Character&&) noexcept;
    Character& operator=(Character&&) noexcept;
    ~Character();

    [[nodiscard]] const CharacterInput& input() const;

    /// A frame of inverse kinematics, of so many seconds, from `pose` towards `goals`, in place.
    InverseKinematics::Report solvePose(const std::vector<IkGoal>& goals, Pose& pose, double seconds = InverseKinematics::kUsualFrame);

    /// Deforms all elements to `pose`. Elements whose v did not change are moved as they are, after one more evaluation in the first such frame; those that
    /// did not move either are left alone. `seconds` passed since the last update(), for effects that have a past; 0: none, what oscillates stays at its phase.
    void update(const Pose& pose, double seconds = 0.0);
    /// Repeats the last update() with another pose in the same frame: 0 s pass, and contact takes one step instead of converging. Times and warnings of stats() accumulate.
    void correct(const Pose& pose);
    /// As correct(), if `pose` is the last pose translated as a whole: loads and dents are kept, so that the flesh is translated by the same vector.
    void shift(const Pose& pose);
    /// Where a handle is to be in the next update(); at rest until then. False: not finite, or no rotation, and nothing changes.
    bool setHandle(int handle, const HandlePose& pose);
    [[nodiscard]] const HandlePose& handlePose(int handle) const;        ///< as it was set
    [[nodiscard]] HandlePose shownHandle(int handle) const;             ///< as it is shown, in the world
    /// Rest to world, of what carried it in the last update().
    [[nodiscard]] Eigen::Isometry3d handleCarrier(int handle) const;
    /// How an attached part (of EmbeddedPoints::attached) is turned about its pivot in the next update(), from rest and in the axes of the rest pose: it turns with the
    /// body besides. False: no rotation, or it was turned so already, and nothing changes.
    bool setTurn(int element, int part, const Eigen::Quaterniond& turn);
    /// The weight of a morph target of a render mesh in the next update(). False: it is no number or too large (kLargestMorphWeight), or it had that, and nothing changes.
    bool setMorph(int mesh, int target, double weight);
    /// Forgets all motion: the next update() jumps to its pose, at rest.
    void stop();

    /// New numbers for the effects that it has; others are ignored. Seen in the next update().
    void tune(const CharacterEffects& effects);
    /// See FrameJobs::tune().
    void tune(const EffectSettings& settings);
    [[nodiscard]] FrameJobs& jobs();
    [[nodiscard]] const FrameJobs& jobs() const;
    /// The job of one of its effects, for what that takes and tells besides settings; null: it has none. It stays while the character does.
    template <class Job>
    [[nodiscard]] Job* job() {
        return jobs().template find<Job>();
    }
    template <class Job>
    [[nodiscard]] const Job* job() const {
        return jobs().template find<Job>();
    }

    [[nodiscard]] const Pose& pose() const;  ///< of the last update()

    /// No effect goes on by itself: the next update() of the same pose changes nothing.
    [[nodiscard]] bool resting() const;

    /// What the last update() left, single precision, ready for display. Memory stays where it is for the character's life.
    struct Surface {
        const float* positions = nullptr;  ///< #body vertices x 3, world, m
        const float* normals = nullptr;    ///< #body vertices x 3, unit, world; those of area-weighted triangles (normal_stencils.h)
        int vertices = 0;
        std::uint64_t revision = 0;        ///< changes when the content does
    };
    /// Of an element that somebody else deforms, or whose body is under a render mesh, this evaluates the vertices now, on this thread.
    [[nodiscard]] Surface surface(int element) const;
    /// The same of a render mesh: its vertices in the order of its file, and their normals (RenderMeshTables). Where somebody else deforms its elements, this makes it now.
    [[nodiscard]] Surface renderSurface(int mesh) const;

    /// With what others may deform the surfaces, a graphics card for one (deform_input.h). Kept up to date by update() from the first call on, which
    /// allocates.
    const DeformInput& deformInput();
    /// From the next update() on, somebody else deforms this element, where it can be: update() leaves its vertices alone but for frames in which a
    /// finger presses, or a morph target of a render mesh shows. False: it is deformed here (the bend warp and joints of the previous model are more than a product).
    bool deformExternally(int element, bool external);

    /// The same pose in double precision for files and measurements: #body vertices x 3, world. Allocates.
    [[nodiscard]] Points positions(int element) const;
    /// The same of a render mesh: #vertices x 3.
    [[nodiscard]] Points renderPositions(int mesh) const;
    [[nodiscard]] const std::vector<double>& morphWeights(int mesh) const;  ///< as it is shown
    [[nodiscard]] const Points& renderRestPositions(int mesh) const;  ///< #vertices x 3, m
    /// Displacement, m in the axes of `element`, of the vertices of render mesh `mesh` that it moves, per unit of each of its weights (v, then loads): three rows per vertex in the order of the mesh, one column per weight. See vertexColumns().
    [[nodiscard]] Eigen::MatrixXd renderColumns(int mesh, int element) const;

    /// Joint parameters v of an element as last updated (all faces, see ElementResponse), and the rigid motion of its frame.
    [[nodiscard]] const Eigen::VectorXd& jointParameters(int element) const;
    [[nodiscard]] Eigen::Isometry3d frame(int element) const;  ///< rest -> world

    /// All that the vertices of a frame follow from, as shapeLayout().size() numbers (character_shape.h): what takes keep. show() of it gives the bytes that
    /// were seen, whatever effects had a part in them, if keepExact() was on. Neither allocates.
    [[nodiscard]] ShapeLayout shapeLayout() const;
    void shape(double* numbers) const;
    /// Shows the shape `numbers` (from shape()) without advancing effects. The next update() continues from the state before show().
    void show(const double* numbers);
    /// Between two shapes, `part` 0...1 of the way: rigid motions turn and move evenly, parameters are linear.
    void between(const double* from, const double* to, double part, double* numbers) const;
    /// Vertices follow even changes that single precision hardly shows (off by default).
    void keepExact(bool exact);

    /// Where body vertices are at rest as they are shown: welded ones at the place of their partner. m
    [[nodiscard]] Points restPositions(int element) const;
    /// Body vertices whose position a joint sets, and their positions in the last update(), m, world. Does not evaluate other vertices.
    [[nodiscard]] std::vector<std::int32_t> heldVertices(int element) const;
    [[nodiscard]] Points heldPositions(int element) const;
    /// Columns of ElementResponse::loads that follow v in the weights of a shape.
    [[nodiscard]] std::vector<int> loadColumns(int element) const;
    /// Its vertices are more than v and loads: bend warp.
    [[nodiscard]] bool isWarped(int element) const;
    /// How much of the bend warp is shown, 0 ... 1: less than all where it is automatic.
    [[nodiscard]] double warpPart(int element) const;

    /// Measures the linear shape A' v of each element in the pose of the last update(), without bend warp, loads and dents. Elements without a response get the values of rest. The first call builds tables (missingWatches()).
    [[nodiscard]] std::vector<PoseMeasures> measurePose();
    /// What measurePose() would make first, about 10 ms each: for any threads, in any order. Empty: nothing.
    [[nodiscard]] std::vector<std::function<void()>> missingWatches() const;

    struct Stats {
        unsigned warnings = 0;          ///< of FrameWarning
        int evaluatedElements = 0;      ///< whose product was computed in the last update()
        int evaluatedVertices = 0;
        double poseMs = 0, jointsMs = 0, productMs = 0, normalsMs = 0;  ///< wall time by stage of the last solvePose() and update()
        std::vector<EffectTime> effects;  ///< those that it has, within these stages; body loads with their share of the product by columns
        /// Of one effect; 0: it has none such.
        [[nodiscard]] double effectMs(std::string_view effect) const;
    };
    [[nodiscard]] const Stats& stats() const;

    /// Bytes of an element that a frame reads and writes, its embedded points among them; without render meshes themselves.
    struct Memory {
        std::size_t response = 0;  ///< A' in the format of the input
        std::size_t surface = 0;   ///< everything that grows with vertices alone
    };
    [[nodiscard]] Memory memory(int element) const;
    /// Largest error of displacements that the number format of A' makes, relative to the largest displacement: the worst of the unit poses,
    /// measured when the character was built. 0 without a response.
    [[nodiscard]] double formatError(int element) const;
    [[nodiscard]] double formatError() const;  ///< of the worst element

    /// Lateral contraction: factor c of joint j in a = b = 1 + c s, s = mean outward shift of its faces in metres: the one of least elastic energy
    /// when the bones are straight (the manual's model, "Large motion"). 1/m, negative: a stretched joint gets thinner. Of no effect with smooth joints.
    [[nodiscard]] double lateralContraction(int joint) const;

private:
    struct State;
    explicit Character(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// Statics of one element alone, in its own rest frame: v (all faces) -> #body vertices x 3 positions.
/// Face vertices follow the basis columns exactly, free vertices A' v.
Points deformElement(const ElementMesh& mesh, const std::vector<JointFace>& faces, const ElementResponse& response,
                     const Eigen::VectorXd& v);

}  // namespace imomushi
