// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/input_mapping.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "core/document/command_support.h"
#include "core/document/cycle.h"
#include "core/document/kept_pose.h"
#include "core/document/morph_weights.h"
#include "core/document/side_names.h"
#include "core/mesh/render_model.h"

namespace imomushi {

namespace {

constexpr std::array<std::string_view, 3> kSilences = {"hold", "rest", "next"};
constexpr std::array<std::string_view, 3> kPlaces = {"x", "y", "z"}, kTurns = {"turn-x", "turn-y", "turn-z"};
constexpr std::array<std::string_view, 17> kKeys = {"source", "channel", "component", "target", "in", "out", "exponent", "dead_zone", "hertz", "reaction", "silence", "after", "mute", "toggle", "spring", "spring_damping", "mirror"};
constexpr const char* kSolo = "solo";
constexpr auto kFileKey = "imomushi-mappings";
constexpr int kFileVersion = 1;
constexpr int kDeepest = 8;  // a file nests less
constexpr double kSlowestSpring = 1e-3;  // Hz: slower ones are none

template <std::size_t count>
int indexIn(const std::array<std::string_view, count>& names, std::string_view name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

/// "a/b/c" is "a" and "b/c"; without a slash there is no second part.
std::pair<std::string_view, std::string_view> divided(std::string_view path) {
    const auto slash = path.find('/');
    return slash == std::string_view::npos ? std::pair(path, std::string_view()) : std::pair(path.substr(0, slash), path.substr(slash + 1));
}

/// A target by its parts, before anybody knows whether it is there.
struct TargetParts {
    MappedTarget target;
    std::string_view name, part;  ///< "tip"; "end", or the morph target
};

std::optional<TargetParts> partsOf(std::string_view text) {
    using Kind = MappedTarget::Kind;
    TargetParts made;
    const auto [kind, path] = divided(text);
    const auto [name, rest] = divided(path);
    made.name = name;
    if (name.empty() || (rest.empty() && kind != "trigger")) return std::nullopt;
    if (kind == "morph" || kind == "effect") {
        made.target.kind = kind == "morph" ? Kind::Morph : Kind::Effect;
        made.part = rest;
        return made;
    }
    if (kind == "pose") {
        if (rest != "weight") return std::nullopt;
        made.target.kind = Kind::Pose;
        return made;
    }
    if (kind == "cycle") {
        if (rest != "amount" && rest != "speed") return std::nullopt;
        made.target.kind = rest == "amount" ? Kind::CycleAmount : Kind::CycleSpeed;
        return made;
    }
    if (kind == "take" || kind == "trigger") {
        if (kind == "trigger" ? name != "let-go" || !rest.empty() : rest != "play" && rest != "stop") return std::nullopt;
        made.target.kind = kind == "trigger" ? Kind::LetGo : rest == "play" ? Kind::PlayTake : Kind::StopTake;
        return made;
    }
    std::string_view number = rest;
    if (kind == "bone") {
        made.target.kind = Kind::BoneTurn;
        made.part = "end";
        if ((made.target.axis = indexIn(kTurns, rest)) >= 0) return made;
        made.target.axis = 0;
        std::tie(made.part, number) = divided(rest);
        if (made.part != "start" && made.part != "end") return std::nullopt;
        made.target.kind = Kind::EndRoll;
        if (number == "roll") return made;
        made.target.kind = Kind::EndPlace;
    } else if (kind == "handle") {
        made.target.kind = Kind::HandleTurn;
        if ((made.target.axis = indexIn(kTurns, number)) >= 0) return made;
        made.target.kind = Kind::HandlePlace;
    } else {
        return std::nullopt;
    }
    made.target.axis = indexIn(kPlaces, number);
    return made.target.axis < 0 ? std::nullopt : std::optional(made);
}

tl::unexpected<Error> badTarget(std::string_view text) {
    return fail("bad-value", "\"" + std::string(text) + "\" is nothing that can be driven: it is \"handle/NAME/x\" (y, z, turn-x, turn-y, turn-z), \"bone/NAME/end/x\" (or start; y, z, roll), \"bone/NAME/turn-x\" (y, z), \"morph/CHARACTER/NAME\", \"pose/NAME/weight\", \"cycle/NAME/amount\" (speed), \"effect/NAME/PROPERTY\", \"take/NAME/play\" (stop) or \"trigger/let-go\".");
}

tl::unexpected<Error> tooMany() { return fail("too-many-mappings", "A table has at most " + std::to_string(InputMapping::kMost) + " mappings: remove some first."); }

Result<void> readRange(const Json& value, const char* key, double largest, double& low, double& high) {
    const Json* given = find(value, key);
    if (!given) return {};
    if (!given->is_array() || given->size() != 2) return fail("bad-type", "\"" + std::string(key) + "\" must be two numbers [low, high].");
    IMOMUSHI_TRY(low, numberWithin((*given)[0], key, -largest, largest));
    IMOMUSHI_TRY(high, numberWithin((*given)[1], key, -largest, largest));
    return {};
}

Result<void> readText(const Json& value, const char* key, std::size_t longest, std::string& to) {
    const Json* given = find(value, key);
    if (!given) return fail("missing-key", "A mapping needs \"source\", \"channel\" and \"target\".");
    if (!given->is_string()) return fail("bad-type", "\"" + std::string(key) + "\" of a mapping must be a text.");
    to = given->get_ref<const std::string&>();
    if (to.empty() || to.size() > longest) return fail("bad-value", "\"" + std::string(key) + "\" of a mapping must have 1 to " + std::to_string(longest) + " bytes.");
    return {};
}

Result<void> readFlag(const Json& value, const char* key, bool& to) {
    const Json* given = find(value, key);
    if (given && !given->is_boolean()) return fail("bad-type", "\"" + std::string(key) + "\" of a mapping must be true or false.");
    if (given) to = given->get<bool>();
    return {};
}

/// What a target may become, in its unit.
double largestOf(const MappedTarget& target) {
    using Kind = MappedTarget::Kind;
    if (target.kind == Kind::CycleSpeed) return Cycle::kFastest;
    return target.kind == Kind::Morph || target.kind == Kind::Pose || target.kind == Kind::CycleAmount ? kLargestMorphWeight : kMaxCoordinate / 4.0;
}

/// "swing-hertz", "acceleration/y". Errors: "no-such-effect", "no-such-property", "bad-value".
Result<void> readEffect(std::string_view name, std::string_view part, MappedTarget& target) {
    const auto kind = effectNamed(name);
    if (!kind) return fail("no-such-effect", "There is no effect \"" + std::string(name) + "\".");
    const auto [property, axis] = divided(part);
    for (const EffectProperty& p : effectProperties(*kind)) {
        if (p.name != property) continue;
        if (p.rebuilds) return fail("bad-value", "\"" + std::string(part) + "\" cannot be driven: the character is solved anew for it. Set it by hand.");
        const int at = p.size == 1 ? (axis.empty() ? 0 : -1) : indexIn(kPlaces, axis);
        if (at < 0) return fail("bad-value", "\"" + std::string(property) + "\" is " + (p.size == 1 ? "one number: name no axis of it." : "a vector: name an axis of it, such as \"" + std::string(property) + "/y\"."));
        target.effect = *kind;
        target.value = Effects::valueOffset(*kind, property) + at;
        return {};
    }
    return fail("no-such-property", "The effect \"" + std::string(name) + "\" has no property \"" + std::string(property) + "\".");
}

}  // namespace

Result<MappedTarget> mappedTarget(const Document& document, std::string_view text) {
    const auto parts = partsOf(text);
    if (!parts) return badTarget(text);
    MappedTarget made = parts->target;
    using Kind = MappedTarget::Kind;
    if (made.kind == Kind::Morph) {
        IMOMUSHI_TRY(made.morph, morphOf(document, parts->name, parts->part));
    } else if (made.kind == Kind::Effect) {
        if (auto ok = readEffect(parts->name, parts->part, made); !ok) return tl::unexpected(ok.error());
    } else if (made.kind == Kind::PlayTake || made.kind == Kind::StopTake) {
        const Take* take = document.takeNamed(std::string(parts->name));
        if (!take) return fail("no-such-take", "There is no take \"" + std::string(parts->name) + "\".");
        made.take = take->id;
    } else if (made.kind == Kind::LetGo) {
        return made;
    } else if (made.kind == Kind::Pose) {
        const KeptPoses& poses = keptPoses(document);
        const KeptPose* pose = keptPose(document, parts->name);
        if (!pose) return fail("no-such-pose", "There is no kept pose \"" + std::string(parts->name) + "\".");
        made.pose = static_cast<std::size_t>(pose - poses.data());
    } else if (made.kind == Kind::CycleAmount || made.kind == Kind::CycleSpeed) {
        const Cycle* cycle = cycleNamed(document, parts->name);
        if (!cycle) return fail("no-such-cycle", "There is no cycle \"" + std::string(parts->name) + "\".");
        made.cycle = static_cast<std::size_t>(cycle - cyclesOf(document).data());
    } else if (made.kind == Kind::HandlePlace || made.kind == Kind::HandleTurn) {
        IMOMUSHI_TRY(made.handle, handleNamed(document, parts->name));
    } else {
        IMOMUSHI_TRY(made.end, document.endpoint(std::string(parts->name) + "/" + std::string(parts->part)));
    }
    return made;
}

std::string otherSideOfTarget(std::string_view target) {
    const auto [kind, path] = divided(target);
    const auto [name, rest] = divided(path);
    const bool morph = kind == "morph";
    if (kind != "bone" && kind != "handle" && kind != "pose" && !morph) return {};
    const std::string_view sided = morph ? rest : name;
    const std::string other = otherSide(sided);
    if (other == sided) return {};
    return std::string(kind) + "/" + (morph ? std::string(name) + "/" + other : other + "/" + std::string(rest));
}

double mirrorSign(const MappedTarget& target) {
    using Kind = MappedTarget::Kind;
    const bool place = target.kind == Kind::HandlePlace || target.kind == Kind::EndPlace, turn = target.kind == Kind::HandleTurn || target.kind == Kind::BoneTurn;
    return (place && target.axis == 0) || (turn && target.axis != 0) || target.kind == Kind::EndRoll ? -1.0 : 1.0;
}

Json mappingJson(const InputMapping& mapping) {
    const InputRow& row = mapping.row;
    return Json{{"source", row.source},
                {"channel", row.channel},
                {"component", row.component},
                {"target", mapping.target},
                {"in", {row.curve.inLow, row.curve.inHigh}},
                {"out", {row.curve.outLow, row.curve.outHigh}},
                {"exponent", row.curve.exponent},
                {"dead_zone", row.curve.deadZone},
                {"hertz", row.filter.hertz},
                {"reaction", row.filter.reaction},
                {"silence", kSilences[static_cast<std::size_t>(row.silence)]},
                {"after", row.after},
                {"mute", row.muted},
                {"toggle", row.toggles},
                {"spring", row.spring.hertz},
                {"spring_damping", row.spring.damping},
                {"mirror", mapping.mirrored},
                {kSolo, mapping.solo}};
}

Result<InputMapping> mappingFrom(const Json& value) {
    if (!value.is_object()) return fail("bad-type", "A mapping is an object: {\"source\":name,\"channel\":name,\"target\":\"handle/NAME/x\"}.");
    for (const auto& [key, of] : value.items())
        if (indexIn(kKeys, key) < 0 && key != kSolo) return fail("unknown-key", "A mapping has no \"" + key + "\".");
    InputMapping made;
    InputRow& row = made.row;
    for (const auto& [key, longest, to] : {std::tuple("source", InputName::kLongest, &row.source), std::tuple("channel", InputName::kLongest, &row.channel),
                                           std::tuple("target", InputMapping::kLongestTarget, &made.target)})
        if (auto ok = readText(value, key, longest, *to); !ok) return tl::unexpected(ok.error());
    const auto parts = partsOf(made.target);
    if (!parts) return badTarget(made.target);
    if (const Json* given = find(value, "component")) {
        IMOMUSHI_TRY(const auto component, numberWithin(*given, "component", 0, InputValue::kMost - 1));
        if (!given->is_number_integer()) return fail("bad-type", "\"component\" must be a whole number.");
        row.component = static_cast<int>(component);
    }
    ResponseCurve& curve = row.curve;
    if (auto ok = readRange(value, "in", InputValue::kLargest, curve.inLow, curve.inHigh); !ok) return tl::unexpected(ok.error());
    if (!(curve.inLow < curve.inHigh)) return fail("bad-value", "\"in\" of a mapping is [low, high]: the first number must be the smaller one.");
    curve.outLow = curve.inLow, curve.outHigh = curve.inHigh;
    const double largest = largestOf(parts->target);
    if (auto ok = readRange(value, "out", largest, curve.outLow, curve.outHigh); !ok) return tl::unexpected(ok.error());
    if (std::max(std::abs(curve.outLow), std::abs(curve.outHigh)) > largest) return fail("bad-value", "\"out\" of this mapping is needed: its \"in\" is more than its target can be.");
    for (const auto& [key, high, to] : {std::tuple("dead_zone", InputMapping::kLargestDeadZone, &curve.deadZone), std::tuple("hertz", InputMapping::kLargestHertz, &row.filter.hertz),
                                        std::tuple("reaction", InputMapping::kLargestHertz, &row.filter.reaction), std::tuple("after", InputMapping::kLongestAfter, &row.after), std::tuple("spring", InputMapping::kFastestSpring, &row.spring.hertz)})
        if (auto ok = readNumber(value, key, 0.0, high, *to); !ok) return tl::unexpected(ok.error());
    if (auto ok = readNumber(value, "exponent", 1.0 / InputMapping::kLargestExponent, InputMapping::kLargestExponent, curve.exponent); !ok) return tl::unexpected(ok.error());
    if (row.spring.hertz < kSlowestSpring) row.spring.hertz = 0.0;
    if (auto ok = readNumber(value, "spring_damping", Spring::kLeastDamping, 1.0, row.spring.damping); !ok) return tl::unexpected(ok.error());
    if (const Json* given = find(value, "silence")) {
        const int index = given->is_string() ? indexIn(kSilences, given->get_ref<const std::string&>()) : -1;
        if (index < 0) return fail("bad-value", "\"silence\" of a mapping is \"hold\", \"rest\" or \"next\".");
        row.silence = static_cast<InputRow::Silence>(index);
    }
    for (const auto& [key, to] : {std::pair("mute", &row.muted), std::pair("toggle", &row.toggles), std::pair("mirror", &made.mirrored), std::pair(kSolo, &made.solo)})
        if (auto ok = readFlag(value, key, *to); !ok) return tl::unexpected(ok.error());
    return made;
}

Json mappingsJson(const InputMappings& mappings) {
    Json list = Json::array();
    for (const InputMapping& mapping : mappings) list.push_back(mappingJson(mapping));
    return list;
}

Result<InputMappings> mappingsFrom(const Json& list) {
    if (!list.is_array()) return fail("bad-type", "Mappings are a list of objects.");
    InputMappings made;
    for (const Json& value : list) {
        IMOMUSHI_TRY(auto mapping, mappingFrom(value));
        if (auto ok = putMapping(made, std::move(mapping)); !ok) return tl::unexpected(ok.error());
    }
    return made;
}

Result<std::size_t> putMapping(InputMappings& mappings, InputMapping mapping, std::optional<std::size_t> place) {
    const auto same = std::find_if(mappings.begin(), mappings.end(), [&](const InputMapping& m) { return m.sameLine(mapping); });
    auto at = static_cast<std::size_t>(same - mappings.begin());
    if (same != mappings.end() && (!place || *place == at)) {
        *same = std::move(mapping);
        return at;
    }
    if (same != mappings.end()) mappings.erase(same);
    if (mappings.size() >= InputMapping::kMost) return tooMany();
    at = std::min(place.value_or(mappings.size()), mappings.size());
    mappings.insert(mappings.begin() + static_cast<std::ptrdiff_t>(at), std::move(mapping));
    return at;
}

void setMappings(Document& document, InputMappings mappings) {
    std::map<std::string_view, std::shared_ptr<const SourceCalibration>> known;
    if (document.mappings)
        for (const InputMapping& mapping : *document.mappings) known.try_emplace(mapping.row.source, mapping.calibration);
    for (InputMapping& mapping : mappings) {
        const auto of = known.find(mapping.row.source);
        mapping.calibration = of == known.end() ? nullptr : of->second;
    }
    if (document.mappings ? *document.mappings == mappings : mappings.empty()) return;
    document.mappings = mappings.empty() ? nullptr : std::make_shared<const InputMappings>(std::move(mappings));
}

void renameMapped(Document& document, std::string_view kind, std::string_view from, std::string_view to) {
    if (!document.mappings) return;
    const std::string before = std::string(kind) + "/" + std::string(from) + "/", after = std::string(kind) + "/" + std::string(to) + "/";
    InputMappings changed = *document.mappings;
    for (InputMapping& mapping : changed)
        if (mapping.target.starts_with(before)) mapping.target = after + mapping.target.substr(before.size());
    setMappings(document, std::move(changed));
}

InputRow heardRow(const InputMapping& mapping, bool solo) {
    InputRow row = mapping.row;
    row.muted = row.muted || (!mapping.solo && solo);
    return row;
}

bool anySolo(const Document& document) { return document.mappings && std::any_of(document.mappings->begin(), document.mappings->end(), [](const InputMapping& m) { return m.solo; }); }

std::vector<std::pair<InputRow, MappedTarget>> triggerRows(const Document& document, std::vector<std::size_t>& mappings) {
    std::vector<std::pair<InputRow, MappedTarget>> rows;
    mappings.clear();
    const bool solo = anySolo(document);
    for (std::size_t i = 0; document.mappings && i < document.mappings->size(); ++i) {
        const InputMapping& mapping = (*document.mappings)[i];
        const auto target = mappedTarget(document, mapping.target);
        if (!target || !target->isTrigger()) continue;
        rows.emplace_back(heardRow(mapping, solo), *target);
        mappings.push_back(i);
    }
    return rows;
}

std::string mappingsText(const InputMappings& mappings) { return Json{{kFileKey, kFileVersion}, {"mappings", mappingsJson(mappings)}}.dump(1) + "\n"; }

Result<InputMappings> mappingsFromText(const std::string& text) {
    const auto refuse = [](const std::string& why) { return fail("not-mappings", "These are no mappings of live input: " + why + " Choose a file that \"save-mappings\" made."); };
    if (text.size() > kMostMappingBytes) return refuse("they are larger than 4 MB.");
    bool deep = false;
    const Json file = Json::parse(
        text, [&](int depth, Json::parse_event_t, Json&) { return !(deep = deep || depth > kDeepest); }, false);
    if (file.is_discarded() || deep) return refuse("they are not JSON of such a file.");
    const Json* version = file.is_object() ? find(file, kFileKey) : nullptr;
    if (!version || !version->is_number_integer()) return refuse(std::string("the key \"") + kFileKey + "\" is missing.");
    if (*version != kFileVersion) return refuse("they are of a newer version of Imomushi.");
    const Json* list = find(file, "mappings");
    if (!list) return refuse("the key \"mappings\" is missing.");
    auto made = mappingsFrom(*list);
    if (!made) return refuse(made.error().message);
    return made;
}

}  // namespace imomushi
