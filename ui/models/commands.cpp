// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/commands.h"

#include "core/commands/proposal_commands.h"
#include "core/document/input_mapping.h"

namespace imomushi::commands {
namespace {

Json vector(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json place(const std::variant<std::string, Vec3>& place) {
    if (const auto* point = std::get_if<Vec3>(&place)) return vector(*point);
    return std::get<std::string>(place);
}

template <class Value>
void add(Json& command, const char* key, const std::optional<Value>& value) {
    if (value) command[key] = *value;
}

Json effectCommand(const char* name, EffectKind effect, const std::optional<std::string>& element) {
    Json command = {{"do", name}, {"effect", std::string(effectName(effect))}};
    add(command, "target", element);
    return command;
}

Json importCommand(const char* name, const Import& import) {
    Json command = {{"do", name}, {"path", import.path}};
    if (!import.unit.empty()) command["unit"] = import.unit;
    if (!import.up.empty()) command["up"] = import.up;
    return command;
}

Json characterCommand(const char* name, const Import& import, const std::string& body, std::optional<double> detail) {
    Json command = importCommand(name, import);
    if (!body.empty()) command["body"] = body;
    add(command, "detail", detail);
    if (import.links) command["links"] = Json::array();
    for (const FleshLink& link : import.links.value_or(std::vector<FleshLink>())) command["links"].push_back({{"from", vector(link.from)}, {"to", vector(link.to)}, {"radius", link.radius}});
    return command;
}

Json planeJson(const Vec3& origin, const Vec3& normal) { return {{"origin", vector(origin)}, {"normal", vector(normal)}}; }

Json recordCommand(const std::string& take, const char* action) { return {{"do", "record"}, {"take", take}, {"action", action}}; }

}  // namespace

Json newProject() { return {{"do", "new"}}; }
Json open(const std::string& path) { return {{"do", "open"}, {"path", path}}; }
Json openAs(const std::string& path, const std::string& original) { return {{"do", "open"}, {"path", path}, {"as", original}}; }
Json save(const std::string& path) { return {{"do", "save"}, {"path", path}}; }
Json saveCopy(const std::string& path) { return {{"do", "save"}, {"path", path}, {"copy", true}}; }
Json openVersion(const std::string& path, std::int64_t version) { return {{"do", "open"}, {"path", path}, {"version", version}, {"as", ""}}; }
Json saveScript(const std::string& path) { return {{"do", "save-script"}, {"path", path}}; }

Json writeMesh(const std::string& path, const std::optional<std::string>& element) {
    Json command = {{"do", "write-mesh"}, {"path", path}, {"state", "current"}};
    add(command, "element", element);
    return command;
}

Json writeCharacterMesh(const std::string& path, const std::string& character) {
    return {{"do", "write-mesh"}, {"path", path}, {"state", "current"}, {"character", character}};
}

Json importElement(const Import& import) {
    Json command = importCommand("import-element", import);
    if (import.split) command["split"] = true;
    return command;
}

Json importCharacter(const Import& import, const std::string& body, std::optional<double> detail) { return characterCommand("import-character", import, body, detail); }

Json makeSoft(const Import& import, const std::string& body, std::optional<double> detail, const ChosenBones& bones) {
    Json command = characterCommand("make-soft", import, body, detail);
    add(command, "bones", bones);
    command["precompute"] = false;
    command["alive"] = true;
    return command;
}

Json makeSoft(const std::string& character, const ChosenBones& bones) {
    Json command = {{"do", "make-soft"}, {"character", character}};
    add(command, "bones", bones);
    command["precompute"] = false;
    command["alive"] = true;
    return command;
}

Json makeCharacter(const std::string& element) { return {{"do", "make-character"}, {"element", element}}; }
Json makeElementSoft(const std::string& element) { return {{"do", "make-soft"}, {"element", element}, {"precompute", false}, {"alive", true}}; }

bool isMakeSoft(const Json& command) { return command.at("do") == "make-soft"; }

Json importSkeleton(const std::string& character, const std::string& path) { return {{"do", "import-skeleton"}, {"character", character}, {"path", path}}; }

Json importClips(const std::string& character, const Import& import) {
    Json command = importCommand("import-clips", import);
    command["character"] = character;
    return command;
}

Json takeClip(const std::string& character, const std::string& clip, const std::string& take) { return {{"do", "take-clip"}, {"character", character}, {"clip", clip}, {"take", take}}; }

Json makeSoft(const CharacterSource& character, const Proposal& proposal) {
    return {{"do", "make-soft"}, {"character", character.name}, {"proposal", proposalJson(character, proposal)}, {"precompute", false}, {"alive", true}};
}

Json append(const std::string& path, bool beside) {
    Json command = {{"do", "append"}, {"path", path}};
    if (beside) command["beside"] = true;
    return command;
}

Json replaceMesh(const std::string& name, bool character, const Import& import, const std::string& body) {
    Json command = importCommand("replace-mesh", import);
    command[character ? "character" : "element"] = name;
    if (character && !body.empty()) command["body"] = body;
    return command;
}

Json repair(const std::string& element, const std::vector<std::string>& actions, std::optional<double> detail) {
    Json command = {{"do", "repair"}, {"element", element}};
    if (!actions.empty()) command["actions"] = actions;
    add(command, "detail", detail);
    return command;
}

Json exportCharacter(const Export& choices) {
    Json command = {{"do", "export"}, {"path", choices.path}, {"layout", choices.layout}, {"preset", choices.preset}};
    if (choices.what == Export::What::OneTake) command["take"] = choices.take;
    if (choices.what == Export::What::Pose) command["take"] = Json::array();
    if (choices.what == Export::What::Pose || choices.what == Export::What::TakesAndPose) command["pose"] = true;
    add(command, "fps", choices.fps);
    if (choices.targets) command["targets"] = *choices.targets > 0 ? Json(*choices.targets) : Json("all");
    add(command, "split", choices.split);
    add(command, "quantise", choices.quantise);
    add(command, "compress", choices.compress);
    add(command, "normals", choices.normals);
    return command;
}

Json undo(int steps) { return {{"do", "undo"}, {"count", steps}}; }
Json redo(int steps) { return {{"do", "redo"}, {"count", steps}}; }

Json setValue(const std::string& target, const char* key, Json value) { return {{"do", "set"}, {"target", target}, {"property", key}, {"value", std::move(value)}}; }

Json set(EffectKind effect, const EffectProperty& property, std::span<const double> values) {
    Json value = values.front();
    if (property.size > 1) value = std::vector(values.begin(), values.end());
    return setValue(std::string(effectName(effect)), std::string(property.name).c_str(), std::move(value));
}

Json rename(const std::string& target, const std::string& name) { return {{"do", "rename"}, {"target", target}, {"name", name}}; }

Json enable(EffectKind effect, const std::optional<std::string>& element, std::optional<bool> automatic) {
    Json command = effectCommand("enable", effect, element);
    add(command, "auto", automatic);
    return command;
}
Json disable(EffectKind effect, const std::optional<std::string>& element) { return effectCommand("disable", effect, element); }

Json duplicate(const std::vector<std::string>& names) { return {{"do", "duplicate"}, {"names", names}}; }
Json copy(const std::vector<std::string>& names, const std::string& path) { return {{"do", "copy"}, {"names", names}, {"path", path}}; }
Json paste(Json commands, const std::string& onto) {
    Json command = {{"do", "paste"}, {"commands", std::move(commands)}};
    if (!onto.empty()) command["onto"] = onto;
    return command;
}
Json mirror(const std::vector<std::string>& names, char axis) { return {{"do", "mirror"}, {"from", names}, {"axis", std::string(1, axis)}}; }
Json mirrorAt(const std::vector<std::string>& names, double at) { return {{"do", "mirror"}, {"from", names}, {"axis", "x"}, {"at", at}}; }
Json transform(const std::vector<std::string>& names, const Vec3& shift, const Eigen::Quaterniond& rotation, double scale, const Vec3& about) {
    Json command = {{"do", "transform"}, {"names", names}};
    if (shift != Vec3::Zero()) command["shift"] = vector(shift);
    if (rotation.vec().norm() > 0.0) command["rotation"] = {rotation.x(), rotation.y(), rotation.z(), rotation.w()};
    if (scale != 1.0) command["scale"] = scale;
    if (command.contains("rotation") || command.contains("scale")) command["about"] = vector(about);
    return command;
}
Json removeElement(const std::string& name) { return {{"do", "remove-element"}, {"name", name}}; }

Json attach(const Attach& choices) {
    Json command = {{"do", "attach"}, {"character", choices.character}, {"part", choices.part}, {"mode", choices.mode}};
    if (choices.pivotInMiddle)
        command["pivot"] = nullptr;
    else if (choices.pivot)
        command["pivot"] = vector(*choices.pivot);
    add(command, "element", choices.element);
    return command;
}

Json addJointFace(const std::string& element, const std::string& name, const std::vector<std::int32_t>& vertices) {
    return {{"do", "add-joint-face"}, {"element", element}, {"name", name}, {"vertices", vertices}};
}

Json addJointFace(const std::string& element, const std::string& name, const Vec3& origin, const Vec3& normal, double tolerance) {
    return {{"do", "add-joint-face"}, {"element", element}, {"name", name}, {"plane", planeJson(origin, normal)}, {"tolerance", tolerance}};
}

Json editJointFace(const std::string& face, const Vec3& origin, const Vec3& normal, double tolerance) {
    return {{"do", "edit-joint-face"}, {"face", face}, {"plane", planeJson(origin, normal)}, {"tolerance", tolerance}};
}

Json cut(const std::string& element, const Vec3& origin, const Vec3& normal, const std::optional<std::pair<std::string, std::string>>& names,
         const std::optional<std::string>& name) {
    Json command = {{"do", "cut"}, {"element", element}, {"plane", planeJson(origin, normal)}};
    if (names) command["names"] = Json::array({names->first, names->second});
    add(command, "name", name);
    return command;
}

Json moveCut(const std::string& cut, const Vec3& origin, const Vec3& normal) { return {{"do", "move-cut"}, {"cut", cut}, {"plane", planeJson(origin, normal)}}; }
std::optional<CutPlane> planeOfMoved(const Json& command, const std::string& cut) {
    if (command.at("do") != "move-cut" || command.at("cut") != cut) return std::nullopt;
    CutPlane plane;
    for (Eigen::Index k = 0; k < 3; ++k) {
        const auto axis = std::size_t(k);
        plane.origin[k] = command.at("plane").at("origin").at(axis).get<double>();
        plane.normal[k] = command.at("plane").at("normal").at(axis).get<double>();
    }
    return plane;
}
Json removeCut(const std::string& cut) { return {{"do", "remove-cut"}, {"cut", cut}}; }

Json editJointFace(const std::string& face, const std::vector<std::int32_t>& vertices) {
    return {{"do", "edit-joint-face"}, {"face", face}, {"vertices", vertices}};
}

Json growJointFace(const std::string& face, int rings) { return {{"do", "edit-joint-face"}, {"face", face}, {"grow", rings}}; }

Json removeJointFace(const std::string& face) { return {{"do", "remove-joint-face"}, {"face", face}}; }
Json addHandle(const std::string& element, const Vec3& point, double radius) {
    return {{"do", "handle"}, {"element", element}, {"point", vector(point)}, {"radius", radius}};
}
Json placeHandle(const std::string& handle, const Vec3& point) { return {{"do", "set"}, {"target", handle}, {"property", "point"}, {"value", Json::array({point.x(), point.y(), point.z()})}}; }
Json removeHandle(const std::string& handle) { return {{"do", "remove-handle"}, {"handle", handle}}; }
Json join(const std::string& a, const std::string& b) { return {{"do", "join"}, {"a", a}, {"b", b}}; }

Json addBone(const NewBone& bone) {
    Json command = {{"do", "add-bone"}, {"name", bone.name}};
    add(command, "element", bone.element);
    command["from"] = place(bone.from);
    command["to"] = place(bone.to);
    add(command, "parent", bone.parent);
    return command;
}

Json setBoneParent(const std::string& bone, const std::string& parent, const std::optional<std::string>& from) {
    Json command = {{"do", "edit-bone"}, {"name", bone}, {"parent", parent}};
    add(command, "from", from);
    return command;
}

Json setBoneElement(const std::string& bone, const std::string& element) { return {{"do", "edit-bone"}, {"name", bone}, {"element", element}}; }
Json placeEnd(const std::string& bone, bool atEnd, const std::variant<std::string, Vec3>& to) { return {{"do", "edit-bone"}, {"name", bone}, {atEnd ? "to" : "from", place(to)}}; }
Json removeBone(const std::string& name) { return {{"do", "remove-bone"}, {"name", name}}; }

Json precompute() { return {{"do", "precompute"}}; }
Json precompute(const std::vector<std::string>& elements) { return {{"do", "precompute"}, {"elements", elements}}; }

Json drag(const std::string& endpoint, const Vec3& to, std::optional<double> roll) {
    Json command = {{"do", "drag"}, {"endpoint", endpoint}, {"to", vector(to)}};
    add(command, "roll", roll);
    return command;
}

Json morph(const std::string& character, const std::string& target, double weight) { return {{"do", "morph"}, {"character", character}, {"target", target}, {"weight", weight}}; }

Json express(const std::string& character, const std::string& expression, double weight) {
    return {{"do", "express"}, {"character", character}, {"expression", expression}, {"weight", weight}};
}

Json turnPart(const std::string& character, const std::string& part, const Eigen::Quaterniond& turn) {
    return {{"do", "turn-part"}, {"character", character}, {"part", part}, {"rotation", Json::array({turn.x(), turn.y(), turn.z(), turn.w()})}};
}

Json dragHandle(const std::string& handle, const Vec3& to, const Eigen::Quaterniond& turn) {
    return {{"do", "drag"}, {"endpoint", handle}, {"to", vector(to)}, {"rotation", Json::array({turn.x(), turn.y(), turn.z(), turn.w()})}};
}

Json pinOrientation(const std::string& endpoint, bool held) { return {{"do", "pin"}, {"endpoint", endpoint}, {"orientation", held}}; }
Json setPinned(const std::string& endpoint, bool pinned) { return {{"do", pinned ? "pin" : "unpin"}, {"endpoint", endpoint}}; }
Json release(const std::string& endpoint) { return {{"do", "release"}, {"endpoint", endpoint}}; }
Json releaseAll() { return {{"do", "release"}}; }
Json rest() { return {{"do", "rest"}}; }
Json keepPose(const std::string& name) {
    Json command = {{"do", "keep-pose"}};
    if (!name.empty()) command["name"] = name;
    return command;
}
Json applyPose(const std::string& name, double share, bool mirrored) {
    Json command = {{"do", "apply-pose"}, {"name", name}};
    if (share < 1.0) command["share"] = share;
    if (mirrored) command["mirrored"] = true;
    return command;
}
Json mirrorPose() { return {{"do", "mirror-pose"}}; }
Json restBones(const std::vector<std::string>& bones, bool chain) {
    Json command = {{"do", "rest-bones"}, {"bones", bones}};
    if (chain) command["chain"] = true;
    return command;
}
Json renamePose(const std::string& pose, const std::string& name) { return {{"do", "rename-pose"}, {"pose", pose}, {"name", name}}; }
Json removePose(const std::string& pose) { return {{"do", "remove-pose"}, {"pose", pose}}; }
Json addCycle(const std::string& name, const std::vector<std::string>& poses, std::optional<double> seconds) {
    Json command{{"do", "add-cycle"}};
    if (!name.empty()) command["name"] = name;
    if (!poses.empty()) command["poses"] = poses;
    if (seconds) command["seconds"] = *seconds;
    return command;
}
Json suggestCycles(const Json& names) { return {{"do", "suggest-cycles"}, {"names", names}}; }
Json renameCycle(const std::string& cycle, const std::string& name) { return {{"do", "rename-cycle"}, {"cycle", cycle}, {"name", name}}; }
Json removeCycle(const std::string& cycle, bool poses) {
    Json command{{"do", "remove-cycle"}, {"cycle", cycle}};
    if (poses) command["poses"] = true;
    return command;
}

Json touch(const std::string& element, const Vec3& point, const std::optional<Vec3>& to) {
    return {{"do", "touch"}, {"element", element}, {"point", vector(point)}, {"to", to ? vector(*to) : Json()}};
}

Json mapInput(const InputMapping& mapping, std::optional<std::size_t> position) {
    Json command = mappingJson(mapping);
    command["do"] = "map-input";
    add(command, "position", position);
    return command;
}

Json unmapInput(const InputMapping& mapping) { return {{"do", "unmap-input"}, {"source", mapping.row.source}, {"channel", mapping.row.channel}, {"component", mapping.row.component}, {"target", mapping.target}}; }
Json suggestMappings(InputProtocol protocol, const std::string& source) { return {{"do", "suggest-mappings"}, {"protocol", protocolName(protocol)}, {"source", source}}; }
Json calibrateSource(const std::string& source, const std::string& pose, const std::map<std::string, std::vector<double>>& said) {
    Json command{{"do", "calibrate-source"}, {"source", source}, {"values", Json::object()}};
    if (!pose.empty()) command["pose"] = pose;
    for (const auto& [channel, numbers] : said) command["values"][channel] = numbers;
    return command;
}
Json clearCalibration(const std::string& source, const std::string& pose) { return {{"do", "clear-calibration"}, {"source", source}, {"pose", pose}}; }
Json saveMappings(const std::string& path) { return {{"do", "save-mappings"}, {"path", path}}; }
Json loadMappings(const std::string& path) { return {{"do", "load-mappings"}, {"path", path}}; }

Json startRecording(const std::string& take) { return recordCommand(take, "start"); }
Json stopRecording(const std::string& take) { return recordCommand(take, "stop"); }
Json play(const std::string& take, double time) { return {{"do", "play"}, {"take", take}, {"time", time}}; }
Json trimTake(const std::string& take, double from, double to) { return {{"do", "trim-take"}, {"take", take}, {"from", from}, {"to", to}}; }
Json duplicateTake(const std::string& take, const std::string& name) { return {{"do", "duplicate-take"}, {"take", take}, {"name", name}}; }
Json renameTake(const std::string& take, const std::string& name) { return {{"do", "rename-take"}, {"take", take}, {"name", name}}; }
Json removeTake(const std::string& take) { return {{"do", "remove-take"}, {"take", take}}; }

}  // namespace imomushi::commands
