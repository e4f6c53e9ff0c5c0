// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/document/command.h"
#include "core/document/document.h"
#include "core/input/input_mapper.h"

namespace imomushi {

struct SourceCalibration;

/// A row of the table of mappings: which number of which channel drives what. Names are kept, not ids, so that rows can go from one character to another one; a row whose target is not there waits for it.
struct InputMapping {
    static constexpr std::size_t kMost = 1024;      ///< rows of a table
    static constexpr std::size_t kLongestTarget = 4096;  ///< bytes
    static constexpr double kLargestExponent = 16.0, kLargestDeadZone = 0.99, kLargestHertz = 1000.0, kLongestAfter = 3600.0, kFastestSpring = 20.0;
    InputRow row;        ///< without its slot
    std::string target;  ///< see mappedTarget()
    bool solo = false;   ///< where one row is, those that are not are muted
    bool mirrored = false;  ///< the same part of the other side (otherSide()) does the same, mirrored in x, where no other row drives it
    std::shared_ptr<const SourceCalibration> calibration;  ///< of its source, whose rows all have the same; null: none. setMappings() takes care of it, files of mappings are without
    bool operator==(const InputMapping&) const = default;
    /// The same control drives the same target: a table has one such row.
    [[nodiscard]] bool sameLine(const InputMapping& o) const { return row.source == o.row.source && row.channel == o.row.channel && row.component == o.row.component && target == o.target; }
};

/// What can be driven: one number of a character, 0 at rest but for morph targets, the speed of cycles, which is 1, and effects; or a trigger.
struct MappedTarget {
    enum class Kind : std::uint8_t { HandlePlace, HandleTurn, EndPlace, EndRoll, BoneTurn, Morph, Pose, CycleAmount, CycleSpeed, Effect, PlayTake, StopTake, LetGo } kind = Kind::Morph;
    int axis = 0;        ///< of a place (m, world) or of a turn (its rotation vector, radians, in the axes of the world at rest): 0 x, 1 y, 2 z
    FaceRef handle;
    EndpointRef end;     ///< of a bone that is turned, its end
    MorphRef morph;
    EffectKind effect = EffectKind::kCount;
    int value = 0;       ///< in Effect::values
    std::size_t pose = 0;  ///< of keptPoses()
    std::size_t cycle = 0; ///< of cyclesOf()
    PartId take = 0;
    /// A trigger: it fires when the mapped value rises through the middle of "out", and has no value that lasts.
    [[nodiscard]] bool isTrigger() const { return kind == Kind::PlayTake || kind == Kind::StopTake || kind == Kind::LetGo; }
};

/// "handle/NAME/x" (y, z, turn-x, turn-y, turn-z), "bone/NAME/end/x" (start; y, z, roll), "bone/NAME/turn-x" (y, z: about its parent, from rest), "morph/CHARACTER/NAME", "pose/NAME/weight", "cycle/NAME/amount", "cycle/NAME/speed", "effect/NAME/PROPERTY" (of a vector "effect/NAME/PROPERTY/x", y, z; in the unit of the property), "take/NAME/play", "take/NAME/stop",
/// "trigger/let-go". Errors: "bad-value", "no-such-effect", "no-such-property", "no-such-take", "no-such-pose", "no-such-cycle", and of names those of handleNamed(), Document::endpoint() and morphOf().
Result<MappedTarget> mappedTarget(const Document& document, std::string_view target);

/// The same of the part on the other side, by its name; empty: it has no side.
std::string otherSideOfTarget(std::string_view target);
/// -1 where what is mirrored in x goes the other way: x of a place, y and z of a turn, and roll.
double mirrorSign(const MappedTarget& target);

/// As commands, projects and files of mappings write a row; all keys but source, channel and target may be left out. Errors: "bad-type", "bad-value", "missing-key", "unknown-key".
Json mappingJson(const InputMapping& mapping);
Result<InputMapping> mappingFrom(const Json& value);
Json mappingsJson(const InputMappings& mappings);
/// Errors: those of mappingFrom(), "too-many-mappings".
Result<InputMappings> mappingsFrom(const Json& list);

/// Inserts a row at an index of a table, or replaces the same line. Without an index a line that is there keeps its index, a new one goes to the end. Returns the index. Errors: "too-many-mappings".
Result<std::size_t> putMapping(InputMappings& mappings, InputMapping mapping, std::optional<std::size_t> place = std::nullopt);
/// Sets the table of the document; does nothing if it is equal. Sources that have rows before and after keep their calibration.
void setMappings(Document& document, InputMappings mappings);
/// Rows follow what gets another name. `kind`: "handle", "bone", "morph" (of a character), "pose", "cycle", "take".
void renameMapped(Document& document, std::string_view kind, std::string_view from, std::string_view to);

/// One of them is solo.
bool anySolo(const Document& document);
/// A row, muted where others are solo.
InputRow heardRow(const InputMapping& mapping, bool solo);
/// Rows of the document's table that let something happen (InputTriggers), with what, and their places in that table.
std::vector<std::pair<InputRow, MappedTarget>> triggerRows(const Document& document, std::vector<std::size_t>& mappings);

/// The text of a file of mappings, and the rows of one, which nobody trusts. Errors of mappingsFromText(): "not-mappings" with the reason.
std::string mappingsText(const InputMappings& mappings);
Result<InputMappings> mappingsFromText(const std::string& text);
inline constexpr std::size_t kMostMappingBytes = std::size_t{4} << 20;  ///< of such a file

}  // namespace imomushi
