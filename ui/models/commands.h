// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/body/body.h"
#include "core/body/cut.h"
#include "core/document/command.h"
#include "core/document/effects.h"
#include "core/input/input_decoder.h"

/// The commands that the studio issues: their names and keys are spelt here and nowhere else in ui. `imomushi run --help` says what each does.
/// Elements, bones and takes go by their names, joint faces by "element/face", endpoints by "bone/start" and "bone/end" (see paths.h).
namespace imomushi {
struct CharacterSource;
struct InputMapping;
struct Proposal;
}

namespace imomushi::commands {

// ---- files -----------------------------------------------------------------------------------------------------------------

Json newProject();
Json open(const std::string& path);
/// What lies in `path`, as if it were the file `original`; empty: a project that was never saved.
Json openAs(const std::string& path, const std::string& original);
Json save(const std::string& path);
/// The project goes on under its own path.
Json saveCopy(const std::string& path);
/// A version of a project, as an unsaved copy. See project_versions.h.
Json openVersion(const std::string& path, std::int64_t version);
Json saveScript(const std::string& path);
/// As it is posed; one element or all.
Json writeMesh(const std::string& path, const std::optional<std::string>& element);
/// The character's own mesh, in the order of its file.
Json writeCharacterMesh(const std::string& path, const std::string& character);

struct Import {
    std::string path;
    std::string unit, up;  ///< empty: as the file says
    bool split = false;    ///< an element for each separate part
    std::optional<std::vector<FleshLink>> links = std::nullopt;  ///< of a body that is mended; none: as found
};
Json importElement(const Import& import);
/// `body`: "auto", "exact", "mended", "wrapped" or "unmended", empty: auto. `detail`: of a wrap, in diagonals.
Json importCharacter(const Import& import, const std::string& body = {}, std::optional<double> detail = {});

/// The same, with the cuts, bones and pins that are proposed for it; nothing is precomputed. `bones`: of the file's skeleton, that stay; none: as proposed.
using ChosenBones = std::optional<std::vector<std::string>>;
Json makeSoft(const Import& import, const std::string& body = {}, std::optional<double> detail = {}, const ChosenBones& bones = {});
/// A character that is there and has no cuts, bones and handles yet.
Json makeSoft(const std::string& character, const ChosenBones& bones = {});
/// An element of its own becomes a character.
Json makeCharacter(const std::string& element);
/// The same, and the character is made soft.
Json makeElementSoft(const std::string& element);
[[nodiscard]] bool isMakeSoft(const Json& command);
/// The bones and clips of a file for a character.
Json importSkeleton(const std::string& character, const std::string& path);
/// The clips of a file for the skeleton that a character has.
Json importClips(const std::string& character, const Import& import);
/// A take of a clip of the character's file. `take`: its name.
Json takeClip(const std::string& character, const std::string& clip, const std::string& take);
/// A character that is there, as a proposal says; nothing is precomputed.
Json makeSoft(const CharacterSource& character, const Proposal& proposal);
/// Another project's elements, beside what is there where they would lie on it.
Json append(const std::string& path, bool beside);
/// Another mesh for a character or an element, which keeps its rig. `body`: of a character, as of importCharacter().
Json replaceMesh(const std::string& name, bool character, const Import& import, const std::string& body = {});

/// The body of an element or a character; what mends the issues there are, or these steps. `detail`: of a wrap, in diagonals.
Json repair(const std::string& element, const std::vector<std::string>& actions = {}, std::optional<double> detail = {});

struct Export {
    std::string path, layout, preset;
    enum class What { Takes, TakesAndPose, OneTake, Pose } what = What::Takes;
    std::string take;                 ///< for OneTake
    std::optional<double> fps;        ///< these stand for what differs from the preset
    std::optional<int> targets;       ///< 0: all
    std::optional<bool> split, quantise, compress, normals;
};
Json exportCharacter(const Export& choices);

// ---- history ---------------------------------------------------------------------------------------------------------------

Json undo(int steps = 1);
Json redo(int steps = 1);

// ---- properties ------------------------------------------------------------------------------------------------------------

/// A key of `set` and what its values are.
template <class Value>
struct Property {
    const char* key;
};
namespace element {
inline constexpr Property<double> kPoissonRatio{"nu"}, kStiffness{"stiffness"}, kDensity{"density"}, kDamping{"damping"};
inline constexpr Property<std::string> kPreset{"preset"};             ///< MaterialPreset::name
inline constexpr Property<std::string> kColor{"color"};             ///< "#rrggbb"
inline constexpr Property<std::string> kJointPlanes{"joint-planes"}, kSolverMesh{"solver-mesh"};
}  // namespace element
inline constexpr Property<bool> kVisible{"visible"}, kLocked{"locked"};                     ///< of elements, joint faces, bones and cuts
namespace bone {
inline constexpr Property<double> kRoll{"roll"};                                            ///< radians
inline constexpr Property<double> kMinStretch{"min-stretch"}, kMaxStretch{"max-stretch"};   ///< of the length at rest
inline constexpr Property<double> kMaxBend{"max-bend"}, kMaxTwist{"max-twist"};             ///< radians
inline constexpr Property<double> kStiffness{"stiffness"}, kWeight{"weight"};               ///< relative to other bones
}  // namespace bone
namespace handle {
inline constexpr Property<double> kRadius{"radius"};       ///< m, along the surface
inline constexpr Property<std::string> kBone{"bone"};      ///< an end of a bone; empty: none
}  // namespace handle
namespace character {
inline constexpr const char* kTarget = "character";
inline constexpr Property<std::string> kBasis{"basis"}, kFormat{"format"};
inline constexpr Property<double> kBodyFollows{"body-follows"};                             ///< 0: limbs and trunk move alike
inline constexpr Property<int> kRate{"rate"};                                               ///< one of CharacterSettings::kRates
inline constexpr Property<int> kThreads{"threads"};                                         ///< 0: all
}  // namespace character

Json setValue(const std::string& target, const char* key, Json value);
template <class Value>
Json set(const std::string& target, Property<Value> property, const std::type_identity_t<Value>& value) {
    return setValue(target, property.key, value);
}
/// `values`: as many as the property has.
Json set(EffectKind effect, const EffectProperty& property, std::span<const double> values);
Json rename(const std::string& target, const std::string& name);

// ---- effects ---------------------------------------------------------------------------------------------------------------

/// On one element, or on all. automatic: only where and while a pose calls for it; nothing: as it is.
Json enable(EffectKind effect, const std::optional<std::string>& element = {}, std::optional<bool> automatic = {});
Json disable(EffectKind effect, const std::optional<std::string>& element = {});
inline Json setEnabled(EffectKind effect, bool on, const std::optional<std::string>& element = {}) { return on ? enable(effect, element) : disable(effect, element); }

// ---- elements, joint faces, bones ------------------------------------------------------------------------------------------

/// Elements, characters and bones; beside the first ones.
Json duplicate(const std::vector<std::string>& names);
/// `path`: of the file for elements and characters.
Json copy(const std::vector<std::string>& names, const std::string& path);
/// What "copy" answered. `onto`: an element or a character, empty: what they were on.
Json paste(Json commands, const std::string& onto);
/// Elements, characters, bones, cuts, handles and joint faces; `axis`: 'x', 'y' or 'z'.
Json mirror(const std::vector<std::string>& names, char axis);
/// Left and right of the plane x = `at`, m.
Json mirrorAt(const std::vector<std::string>& names, double at);
/// Elements and characters, with what hangs together with them: scaled and turned about a point, then shifted, m.
Json transform(const std::vector<std::string>& names, const Vec3& shift, const Eigen::Quaterniond& rotation, double scale, const Vec3& about);
/// Or a whole character.
Json removeElement(const std::string& name);
/// `element`: or a character, whichever of its elements the plane cuts. `names`: of the pieces, the one behind the plane first. m.
Json cut(const std::string& element, const Vec3& origin, const Vec3& normal, const std::optional<std::pair<std::string, std::string>>& names = {},
         const std::optional<std::string>& name = {});
Json moveCut(const std::string& cut, const Vec3& origin, const Vec3& normal);
/// Where a command moves the cut. None: it moves another one, or does something else.
std::optional<CutPlane> planeOfMoved(const Json& command, const std::string& cut);
Json removeCut(const std::string& cut);
struct Attach {
    std::string character, part;
    std::string mode;                     ///< "auto", "flesh" or "rigid"
    std::optional<Vec3> pivot;            ///< m, at rest
    bool pivotInMiddle = false;           ///< instead
    std::optional<std::string> element;   ///< empty: the nearest
};
Json attach(const Attach& choices);
Json addJointFace(const std::string& element, const std::string& name, const std::vector<std::int32_t>& vertices);
/// Where a plane cuts the rest shape; m.
Json addJointFace(const std::string& element, const std::string& name, const Vec3& origin, const Vec3& normal, double tolerance);
Json editJointFace(const std::string& face, const Vec3& origin, const Vec3& normal, double tolerance);
Json editJointFace(const std::string& face, const std::vector<std::int32_t>& vertices);
Json growJointFace(const std::string& face, int rings);
Json removeJointFace(const std::string& face);
Json join(const std::string& a, const std::string& b);
/// A disc about the point of the rest shape; m. Its name is in the answer.
Json addHandle(const std::string& element, const Vec3& point, double radius);
/// `point`: of the surface at rest, m.
Json placeHandle(const std::string& handle, const Vec3& point);
Json removeHandle(const std::string& handle);

struct NewBone {
    std::string name;
    std::optional<std::string> element;             ///< through which it runs
    std::variant<std::string, Vec3> from, to;       ///< a joint face, an endpoint, or a point at rest (m)
    std::optional<std::string> parent;
};
Json addBone(const NewBone& bone);
/// `parent`: empty: found by itself. `from`: where the bone starts from now on.
Json setBoneParent(const std::string& bone, const std::string& parent, const std::optional<std::string>& from = {});
/// `element`: empty: none.
Json setBoneElement(const std::string& bone, const std::string& element);
/// `place`: a joint face, an endpoint, or a point at rest (m).
Json placeEnd(const std::string& bone, bool atEnd, const std::variant<std::string, Vec3>& place);
Json removeBone(const std::string& name);

/// All elements, or these.
Json precompute();
Json precompute(const std::vector<std::string>& elements);

// ---- pose ------------------------------------------------------------------------------------------------------------------

Json drag(const std::string& endpoint, const Vec3& to, std::optional<double> roll = {});  ///< m, radians
/// `turn`: from rest.
Json dragHandle(const std::string& handle, const Vec3& to, const Eigen::Quaterniond& turn);
/// `turn`: from rest, in the axes of the rest pose.
Json morph(const std::string& character, const std::string& target, double weight);
/// An expression of an avatar. `weight`: 0 ... 1.
Json express(const std::string& character, const std::string& expression, double weight);
Json turnPart(const std::string& character, const std::string& part, const Eigen::Quaterniond& turn);
/// Of an endpoint or a handle, as release().
Json setPinned(const std::string& endpoint, bool pinned);
/// Pins an endpoint so that its bone keeps its direction, too, or turns freely.
Json pinOrientation(const std::string& endpoint, bool held);
Json release(const std::string& endpoint);
Json releaseAll();
Json rest();
/// `name`: empty: a new one.
Json keepPose(const std::string& name = {});
/// `share`: how far on the way there, 0...1.
Json applyPose(const std::string& name, double share = 1.0, bool mirrored = false);
Json mirrorPose();
Json restBones(const std::vector<std::string>& bones, bool chain);
Json renamePose(const std::string& pose, const std::string& name);
Json removePose(const std::string& pose);
/// A new one under a name of its own, where `name` is empty; of one that is there, what is left out stays. `seconds`: of a round.
Json addCycle(const std::string& name, const std::vector<std::string>& poses, std::optional<double> seconds = {});
Json suggestCycles(const Json& names);
Json renameCycle(const std::string& cycle, const std::string& name);
/// `poses`: with those that no other cycle goes through.
Json removeCycle(const std::string& cycle, bool poses);
/// A finger at the point `point` of the rest shape, whose tip is at `to`; m. Without `to` it is lifted.
Json touch(const std::string& element, const Vec3& point, const std::optional<Vec3>& to);

// ---- live input ------------------------------------------------------------------------------------------------------------

/// A row of the table of mappings, with all it says. `position`: its place in the table, where it gets another one.
Json mapInput(const InputMapping& mapping, std::optional<std::size_t> position = {});
Json unmapInput(const InputMapping& mapping);
Json suggestMappings(InputProtocol protocol, const std::string& source);
/// `pose`: a kept one; empty: rest. `said`: the numbers of each channel.
Json calibrateSource(const std::string& source, const std::string& pose, const std::map<std::string, std::vector<double>>& said);
Json clearCalibration(const std::string& source, const std::string& pose);
Json saveMappings(const std::string& path);
Json loadMappings(const std::string& path);

// ---- takes -----------------------------------------------------------------------------------------------------------------

Json startRecording(const std::string& take);
Json stopRecording(const std::string& take);
Json play(const std::string& take, double time);                    ///< s
Json trimTake(const std::string& take, double from, double to);     ///< s
Json duplicateTake(const std::string& take, const std::string& name);
Json renameTake(const std::string& take, const std::string& name);
Json removeTake(const std::string& take);

}  // namespace imomushi::commands
