// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/result.h"
#include "core/character/handle_pose.h"
#include "core/character/response_format.h"
#include "core/document/character_source.h"
#include "core/document/effects.h"
#include "core/document/take.h"
#include "core/joints/face_basis.h"
#include "core/joints/joint_face.h"
#include "core/mesh/health.h"
#include "core/mesh/mesh.h"
#include "core/meshing/solver_mesh_setting.h"
#include "core/skeleton/skeleton.h"

namespace imomushi {

/// One end of a bone.
struct EndpointRef {
    PartId bone = 0;
    bool atEnd = false;  ///< false: "bone/start"
    auto operator<=>(const EndpointRef&) const = default;
};

/// A joint face that is moved by itself: a disc of the surface, dragged and turned freely. It is one of its element's faces and has its name, which no
/// other handle, element or bone has.
struct Handle {
    std::string face;
    Vec3 point = Vec3::Zero();  ///< middle of the disc, on the body at rest, m
    double radius = 0.0;        ///< m, along the surface
    std::optional<EndpointRef> bone;  ///< what it hangs on; none: its element carries it
    bool operator==(const Handle&) const = default;
};

struct Element {
    PartId id = 0;
    std::string name;
    std::shared_ptr<const ElementMesh> mesh;
    std::vector<JointFace> faces;
    std::vector<Handle> handles;  ///< which of the faces are handles, in the order of the faces
    double nu = 0.45;        ///< Poisson ratio, 0...0.5
    double stiffness = 1.0;  ///< relative shear modulus, > 0
    double density = 1000.0; ///< kg/m^3, > 0
    double damping = 1.0;    ///< of joint dynamics, times the ratio of its effect, 0 ... kMaxDamping
    static constexpr double kMaxDamping = 100.0;
    /// Linear RGB of an element whose mesh brings no colours of its own.
    Eigen::Vector3f color = Eigen::Vector3f(0.55f, 0.75f, 0.45f);
    bool visible = true;
    bool locked = false;     ///< not picked or changed in the viewport
    /// Where the boundary problem is solved.
    SolverMeshSetting solverMesh;
    /// Who turns the joint planes of this element: Auto = the element itself where it has a single face, the bisector otherwise.
    enum class JointPlanes { Auto, Bisector, Element } jointPlanes = JointPlanes::Auto;
    std::vector<MeshIssue> issues;  ///< as found on import
    std::optional<CharacterPiece> piece;  ///< none: an element of its own, its render mesh is what is seen of it
    [[nodiscard]] int faceIndex(std::string_view face) const;  ///< -1: no such face
    [[nodiscard]] CutSide* sideOf(std::string_view face);      ///< whose face it is, null: the face is no cut's
    [[nodiscard]] const Handle* handleOf(std::string_view face) const;  ///< null: the face is none
};

/// A joint face by element and name.
struct FaceRef {
    PartId element = 0;
    std::string face;
    auto operator<=>(const FaceRef&) const = default;
};

/// Faces that must look like one surface (two or more).
struct Joint {
    PartId id = 0;
    std::vector<FaceRef> faces;
};

struct Bone {
    PartId id = 0;
    std::string name;
    PartId element = 0;  ///< 0: runs through no element
    /// Where an end is: at the centroid of a face, at another bone's end, or at a point (m, at rest).
    using Place = std::variant<FaceRef, EndpointRef, Vec3>;
    Place start, end;
    PartId parent = 0;
    double roll = 0.0;          ///< radians at rest, turns the bone's x axis about its direction
    double minStretch = 0.5;    ///< of the rest length
    double maxStretch = 2.0;
    double maxBend = Skeleton::Bone::kFreeBend;    ///< rad from rest, against its parent
    double maxTwist = Skeleton::Bone::kFreeTwist;  ///< rad between its ends
    double stiffness = 1.0;     ///< against stretch and bend, relative to other bones
    double weight = 1.0;        ///< times what its flesh weighs, in bone dynamics
    bool visible = true;        ///< false: not drawn and not picked in the viewport
    bool locked = false;        ///< not picked or changed there
    static constexpr double kMaxRatio = 1e3;  ///< stiffness and weight: from its inverse
};

/// A dragged or pinned endpoint. A pin holds the endpoint where it is at rest until it is dragged.
struct EndpointGoal {
    bool pinned = false;
    Vec3 target = Vec3::Zero();      ///< where it is to be
    std::optional<double> roll;      ///< radians
    double fromRoll = 0.0;           ///< glide: the roll it started with
    Vec3 from = Vec3::Zero();        ///< glide: where it started,
    double seconds = 0.0;            ///<        how long it takes (0: at once),
    double elapsed = 0.0;            ///<        and how much of that has passed
    std::optional<std::array<double, 4>> rotation;  ///< its bone is held as turned from rest, too: a unit quaternion x y z w
    bool operator==(const EndpointGoal&) const = default;
};

/// Where a handle was taken: dragged, pinned, or left lying. One that was never moved has none.
struct HandleGoal {
    /// `target.held`: it is held there in the world, until it is released; else it lies there, relative to what carries it (HandlePose).
    HandlePose target;
    bool pinned = false;      ///< only of one that is held
    HandlePose from;          ///< glide: where it started, in the world
    double seconds = 0.0;     ///<        how long it takes (0: at once),
    double elapsed = 0.0;     ///<        and how much of that has passed
    bool operator==(const HandleGoal&) const = default;
    /// Where it is to be now.
    [[nodiscard]] HandlePose now() const;
};

/// A part of what is seen of a character.
struct PartRef {
    PartId character = 0;
    ModelPart part;
    auto operator<=>(const PartRef&) const = default;
};

/// A morph target of a character.
struct MorphRef {
    PartId character = 0;
    std::int32_t target = 0;  ///< of RenderModel::morphs
    auto operator<=>(const MorphRef&) const = default;
};

/// How a rigid part is turned about its pivot.
struct TurnGoal {
    Eigen::Quaterniond target = Eigen::Quaterniond::Identity();  ///< unit, from rest, in the axes of the rest pose: the body turns it besides
    Eigen::Quaterniond from = Eigen::Quaterniond::Identity();    ///< glide: where it started,
    double seconds = 0.0;     ///<        how long it takes (0: at once),
    double elapsed = 0.0;     ///<        and how much of that has passed
    bool operator==(const TurnGoal& o) const {
        return target.coeffs() == o.target.coeffs() && from.coeffs() == o.from.coeffs() && seconds == o.seconds && elapsed == o.elapsed;
    }
    [[nodiscard]] Eigen::Quaterniond now() const;
};

/// A finger on an element.
struct Touch {
    PartId element = 0;
    int finger = 0;              ///< of that element, the smallest that is free when it is put down
    Vec3 point = Vec3::Zero();   ///< of the surface at rest, m
    Vec3 to = Vec3::Zero();      ///< where it pushes that point, m, world
    double radius = 0.0;         ///< m; 0: as small as can be
    bool operator==(const Touch&) const = default;
};

struct CharacterSettings {
    BasisChoice basis;
    ResponseFormat format = ResponseFormat::Float;
    int threads = 0;  ///< 0: as many as the machine has
    int rate = 60;    ///< steps per second where it is performed: one of kRates
    static constexpr std::array<int, 3> kRates = {60, 120, 240};
    double bodyFollows = 0.0;  ///< 0...kMostFollow: how much limbs move before the trunk does, see letBodyFollow()
    static constexpr double kMostFollow = 10.0;
    bool operator==(const CharacterSettings&) const = default;
};

/// What a newer program wrote into a project and this one does not know: it has no effect, and is written again as it was.
struct UnknownRows {
    std::map<std::string, int> effects;                                               ///< by name, with their state: off, on, automatic
    std::map<std::pair<std::string, std::string>, std::array<double, 3>> properties;  ///< by effect and name
    std::map<std::string, std::set<PartId>> elements;                                 ///< that an effect is on
    std::map<std::string, std::string> settings;                                      ///< of the project
};

/// What live input drives (input_mapping.h): of rows of one target the first one wins that is heard.
struct InputMapping;
using InputMappings = std::vector<InputMapping>;

/// Poses that the artist kept by name (kept_pose.h), in their order.
struct KeptPose;
using KeptPoses = std::vector<KeptPose>;

/// Movements that repeat through kept poses (cycle.h), in their order.
struct Cycle;
using Cycles = std::vector<Cycle>;

/// What the artist authors, in immutable parts: a change replaces a part by another one. Commands change it (document_edit.h); as frames pass, inverse kinematics
/// moves `pose` and glides advance (live_character.h).
struct Document {
    std::map<PartId, std::shared_ptr<const Element>> elements;  ///< in order of creation
    std::map<PartId, std::shared_ptr<const Joint>> joints;
    std::map<PartId, std::shared_ptr<const Bone>> bones;
    std::map<PartId, std::shared_ptr<const CharacterSource>> characters;  ///< every one has its elements, see CharacterPiece
    CharacterSettings settings;
    Effects effects;
    std::map<PartId, std::shared_ptr<const Take>> takes;
    std::map<EndpointRef, EndpointGoal> goals;  ///< targets of drags, and pins
    std::map<FaceRef, HandleGoal> handleGoals;  ///< of handles that are not at rest
    std::map<PartRef, TurnGoal> turns; ///< of rigid parts that are turned
    std::map<MorphRef, double> morphs; ///< weights of morph targets where they are not those at rest (MorphTarget::atRest)
    std::vector<Touch> touches;        ///< fingers that are down
    std::shared_ptr<const InputMappings> mappings;  ///< null: nothing is mapped
    std::shared_ptr<const KeptPoses> poses;  ///< null: none is kept
    std::shared_ptr<const Cycles> cycles;    ///< null: there is none
    Pose pose;                         ///< empty: at rest
    PartId nextId = 1;
    UnknownRows unknown;

    [[nodiscard]] const Element* elementNamed(std::string_view name) const;
    [[nodiscard]] const Bone* boneNamed(std::string_view name) const;
    [[nodiscard]] const CharacterSource* characterNamed(std::string_view name) const;
    /// The character that has a cut of this name, null: none.
    [[nodiscard]] const CharacterSource* characterOfCut(std::string_view cut) const;
    /// The elements of a character, ascending.
    [[nodiscard]] std::vector<PartId> elementsOf(PartId character) const;
    /// Takes have names of their own: one may be called like an element.
    [[nodiscard]] const Take* takeNamed(std::string_view name) const;
    /// The joint that `face` belongs to, null: none.
    [[nodiscard]] const Joint* jointOf(const FaceRef& face) const;
    /// "element/face". Errors: "no-such-element", "no-such-face", with the names there are.
    [[nodiscard]] Result<FaceRef> face(std::string_view path) const;
    /// A handle by its name; none: there is none. With `path` "element/face", too.
    [[nodiscard]] std::optional<FaceRef> handle(std::string_view path) const;
    /// "bone/start", "bone/end". Errors: "no-such-bone", "bad-value".
    [[nodiscard]] Result<EndpointRef> endpoint(std::string_view path) const;
};

}  // namespace imomushi
