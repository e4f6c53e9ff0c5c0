// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string_view>

#include "core/base/decompositions.h"
#include "core/base/hash.h"
#include "core/commands/copied_parts.h"
#include "core/commands/core_commands.h"
#include "core/commands/pasted_parts.h"
#include "core/document/character_input.h"
#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/joints/joint_face.h"
#include "core/session/document_edit.h"

namespace imomushi {

std::string shapeOfBody(const TriangleMesh& body) {
    ContentHasher hasher;
    hasher.number(static_cast<std::int64_t>(body.vertices.rows()));
    hasher.array(std::span<const std::int32_t>(body.triangles.data(), static_cast<std::size_t>(body.triangles.size())));
    return hasher.key().hex();
}

std::optional<Json> corners(const TriangleMesh& body, const Vec3& point) {
    const SurfacePoint place = nearestOnSurface(body, point);
    if (place.triangle < 0) return std::nullopt;
    const auto corner = [&](int k) { return Vec3(body.vertices.row(body.triangles(place.triangle, k)).transpose()); };
    Eigen::MatrixXd edges(3, 2);
    edges << corner(1) - corner(0), corner(2) - corner(0);
    const Eigen::Vector2d w = leastSquares(edges, Eigen::VectorXd(place.point - corner(0)));
    if (!w.allFinite()) return std::nullopt;
    return Json::array({place.triangle, 1.0 - w[0] - w[1], w[0], w[1]});
}

std::optional<Vec3> pointAtCorners(const TriangleMesh& body, const Json& corners) {
    if (!corners.is_array() || corners.size() != 4 || !std::all_of(corners.begin(), corners.end(), [](const Json& n) { return n.is_number(); })) return std::nullopt;
    const double triangle = corners[0].get<double>();
    if (!(triangle >= 0.0 && triangle < static_cast<double>(body.triangles.rows())) || triangle != std::floor(triangle)) return std::nullopt;
    Vec3 point = Vec3::Zero();
    for (int k = 0; k < 3; ++k) point += corners[static_cast<std::size_t>(k + 1)].get<double>() * body.vertices.row(body.triangles(static_cast<Eigen::Index>(triangle), k)).transpose();
    if (!(point.cwiseAbs().maxCoeff() <= kMaxCoordinate)) return std::nullopt;
    return point;
}

namespace {

/// Ends of bones nearer to a place than this, of the largest coordinate or 1 m, are at it.
constexpr double kAt = 1e-6;

bool near(const Vec3& a, const Vec3& b) { return (a - b).norm() <= kAt * std::max(1.0, a.cwiseAbs().maxCoeff()); }

std::string headOf(const std::string& path) { return path.substr(0, path.find('/')); }

/// The commands that parts are made by.
const CommandRegistry& makers() {
    static const CommandRegistry registry = [] {
        CommandRegistry made;
        for (const auto add : {addAppendCommand, addBoneCommands, addElementCommands, addHandleCommands, addCutCommands, addPropertyCommands, addEffectCommands}) add(made);
        return made;
    }();
    return registry;
}

/// Does what was copied, one command after the other; what is refused is left out and told.
class Paster {
public:
    Paster(DocumentEdit& edit, std::string onto) : edit_(edit), document_(edit.document), onto_(std::move(onto)) {
        for (const char* list : {"elements", "characters", "cuts", "handles", "bones", "faces", "effects", "not_pasted"}) answer_[list] = Json::array();
    }

    /// Where bones go that would lie on others: beside them, along x.
    void findShift(const Json& lines) {
        Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
        bool lies = false;
        for (const Json& line : lines) {
            const auto from = was(line, "from"), to = was(line, "to");
            if (!from || !to) continue;
            low = low.cwiseMin(*from).cwiseMin(*to);
            high = high.cwiseMax(*from).cwiseMax(*to);
            for (const auto& [id, bone] : document_.bones) {
                const auto start = restPosition(document_, bone->start), end = restPosition(document_, bone->end);
                lies = lies || (start && end && near(*start, *from) && near(*end, *to));
            }
        }
        if (lies) shift(Vec3(besideBones(low, high), 0.0, 0.0));
    }
    void shift(const Vec3& by) { shift_ = by; }

    /// Errors: "cancelled".
    Result<void> paste(const Json& given, const Progress& progress) {
        Json line = given;
        const Json hint = line.is_object() && line.contains(kPasteHint) ? line[kPasteHint] : Json::object();
        if (line.is_object()) line.erase(kPasteHint);
        const Json* named = line.is_object() ? find(line, "do") : nullptr;
        const std::string verb = named && named->is_string() ? named->get<std::string>() : std::string();
        const Command* command = makers().find(verb);
        static constexpr std::string_view kPasted[] = {"append", "add-bone", "add-joint-face", "handle", "cut", "set", "enable", "disable"};
        if (!command || std::find(std::begin(kPasted), std::end(kPasted), verb) == std::end(kPasted)) {
            leaveOut(verb, {"unknown-command", "\"" + verb + "\" is nothing that can be pasted."});
            return {};
        }
        if (auto ok = checkArguments(*command, line); !ok) {
            leaveOut(subject(line), ok.error());
            return {};
        }
        const std::string wish = subject(line);
        if (!prepare(verb, hint, line)) return {};
        const Document before = document_;
        const auto done = command->change(edit_, line, progress);
        if (!done) {
            document_ = before;
            if (done.error().code == "cancelled") return tl::unexpected(done.error());
            if (verb == "add-bone" || verb == "handle" || verb == "cut") names_[wish] = std::nullopt;
            leaveOut(wish, done.error());
            return {};
        }
        tell(verb, line, wish, *done);
        return {};
    }

    Json finish() {
        if (shift_ != Vec3::Zero() && !answer_["bones"].empty()) answer_["offset"] = json(shift_);
        return std::move(answer_);
    }
    [[nodiscard]] bool any() const {
        return std::any_of(answer_.begin(), answer_.end(), [&](const Json& list) { return &list != &answer_["not_pasted"] && !list.empty(); });
    }
    [[nodiscard]] const Json& left() const { return answer_["not_pasted"]; }

private:
    static std::optional<Vec3> was(const Json& line, const char* key) {
        if (!line.is_object() || !line.contains(kPasteHint) || !line[kPasteHint].is_object() || !line[kPasteHint].contains(key)) return std::nullopt;
        return vector3(line[kPasteHint][key]);
    }
    /// How the artist calls what a command makes.
    static std::string subject(const Json& line) {
        for (const char* key : {"name", "target", "effect", "path", "do"})
            if (const Json* value = line.is_object() ? find(line, key) : nullptr; value && value->is_string()) return value->get<std::string>();
        return {};
    }
    void leaveOut(const std::string& name, const Error& error) { answer_["not_pasted"].push_back({{"name", name}, {"code", error.code}, {"why", error.message}}); }

    std::string fresh(const std::string& wish) const { return checkNewName(document_, wish) ? wish : numberedName(document_, freeText(wish)); }
    static std::string freeText(std::string name) {
        std::replace(name.begin(), name.end(), '/', '_');
        return name.empty() ? std::string("part") : name;
    }
    /// How a part that was copied is called here; none: it was not pasted.
    std::optional<std::string> here(const std::string& name) const {
        const auto known = names_.find(name);
        return known == names_.end() ? std::optional(name) : known->second;
    }
    /// The element that a face goes on: the wanted one, the one that was pasted, or the one of that name.
    std::string elementFor(const std::string& name) const {
        return onto_.empty() ? here(name).value_or(name) : onto_;
    }
    /// Of a whole character its only element.
    std::string faceElementFor(const std::string& name) const {
        const std::string wanted = elementFor(name);
        const CharacterSource* character = document_.characterNamed(wanted);
        if (!character) return wanted;
        const std::vector<PartId> pieces = document_.elementsOf(character->id);
        return pieces.size() == 1 ? document_.elements.at(pieces.front())->name : wanted;
    }

    bool prepare(const std::string& verb, const Json& hint, Json& line) {
        if (verb == "add-bone") return prepareBone(hint, line);
        if (verb == "add-joint-face") return prepareFace(hint, line);
        if (verb == "handle") return prepareHandle(hint, line);
        if (verb == "cut") {
            line["element"] = elementFor(text(line, "element"));
            if (line.contains("name")) line["name"] = fresh(text(line, "name"));
            return true;
        }
        if (verb == "set") {
            const std::string target = text(line, "target");
            if (effectNamed(target)) return true;
            const auto known = names_.find(target);
            if (known == names_.end()) leaveOut(target, {"no-such-target", "\"" + target + "\" was not pasted."});
            if (known == names_.end() || !known->second) return false;
            line["target"] = *known->second;
            return true;
        }
        if (verb == "enable" && line.contains("target")) {
            const std::string target = text(line, "target");
            line["target"] = here(target).value_or(target);
        }
        // What is off already stays so.
        if (verb == "disable")
            if (const auto kind = effectNamed(text(line, "effect")); kind && !document_.effects.has(*kind)) return false;
        return true;
    }

    bool prepareBone(const Json& hint, Json& line) {
        const std::string wish = text(line, "name");
        line["name"] = fresh(wish);
        if (line.contains("parent")) {
            const auto parent = here(text(line, "parent"));
            if (parent && document_.boneNamed(*parent)) line["parent"] = *parent;
            else line.erase("parent");
        }
        if (line.contains("element")) {
            const auto element = here(text(line, "element"));
            if (element && document_.elementNamed(*element) && shift_ == Vec3::Zero()) line["element"] = *element;
            else line.erase("element");
        }
        for (const char* key : {"from", "to"}) {
            Json& place = line[key];
            const auto at = hint.is_object() && hint.contains(key) ? vector3(hint[key]) : vector3(place);
            if (vector3(place)) {
                place = json(*at + shift_);
            } else if (place.is_string()) {
                const std::string path = place.get<std::string>(), head = headOf(path);
                if (names_.contains(head) && names_.at(head)) {
                    place = *names_.at(head) + path.substr(head.size());
                } else if (!stands(path, at)) {
                    if (!at) continue;  // the command says what is missing
                    place = json(*at + shift_);
                    loose_.push_back({{"name", line["name"].get<std::string>() + (std::string_view(key) == "from" ? "/start" : "/end")},
                                      {"code", "loose-end"},
                                      {"why", "\"" + path + "\" is not there: this end is a point of its own."}});
                }
            }
        }
        return true;
    }
    /// The place is here, where it was.
    bool stands(const std::string& path, const std::optional<Vec3>& at) const {
        if (shift_ != Vec3::Zero()) return false;
        Result<Vec3> now = fail("no-such-place", "");
        if (const auto face = document_.face(path)) now = restPosition(document_, *face);
        else if (const auto end = document_.endpoint(path)) now = restPosition(document_, *end);
        return now && (!at || near(*now, *at));
    }

    bool prepareFace(const Json& hint, Json& line) {
        const std::string name = faceElementFor(text(line, "element"));
        line["element"] = name;
        const Element* element = document_.elementNamed(name);
        if (!element) return true;  // the command says so
        const std::string wish = text(line, "name");
        std::string free = wish;
        for (int n = 2; element->faceIndex(free) >= 0; ++n) free = wish + " " + std::to_string(n);
        line["name"] = free;
        // Numbers of vertices mean the same on a body of the same triangles alone.
        if (hint.is_object() && hint.contains("body") && hint["body"] != shapeOfBody(element->mesh->body) && hint.contains("plane")) {
            line.erase("vertices");
            line["plane"] = hint["plane"];
            const Command& command = *makers().find("add-joint-face");
            if (auto ok = checkArguments(command, line); !ok) {
                leaveOut(wish, ok.error());
                return false;
            }
        }
        return true;
    }

    bool prepareHandle(const Json& hint, Json& line) {
        const std::string name = faceElementFor(text(line, "element"));
        line["element"] = name;
        const Element* element = document_.elementNamed(name);
        if (!element) return true;
        if (line.contains("name")) {
            std::string free = fresh(text(line, "name"));
            for (int n = 2; element->faceIndex(free) >= 0; ++n) free = numberedName(document_, free, n);
            line["name"] = free;
        }
        if (line.contains("bone")) {
            const std::string path = text(line, "bone"), head = headOf(path);
            const auto bone = here(head);
            if (bone && document_.boneNamed(*bone)) line["bone"] = *bone + path.substr(head.size());
            else line.erase("bone");
        }
        if (hint.is_object() && hint.contains("at") && hint.contains("body") && hint["body"] == shapeOfBody(element->mesh->body))
            if (const auto point = pointAtCorners(element->mesh->body, hint["at"])) line["point"] = json(*point);
        return true;
    }

    void tell(const std::string& verb, const Json& line, const std::string& wish, const Json& done) {
        const auto made = [&](const char* list, const std::string& name) {
            answer_[list].push_back({{"name", name}, {"from", wish}});
            names_[wish] = name;
        };
        if (verb == "add-bone") {
            made("bones", text(line, "name"));
            for (Json& end : loose_) answer_["not_pasted"].push_back(std::move(end));
            loose_.clear();
        } else if (verb == "handle") {
            made("handles", done.at("name").get<std::string>());
        } else if (verb == "cut") {
            made("cuts", done.at("cut").get<std::string>());
        } else if (verb == "add-joint-face") {
            answer_["faces"].push_back({{"name", text(line, "element") + "/" + text(line, "name")}, {"from", wish}});
        } else if (verb == "append") {
            std::map<std::string, std::string> from;
            for (const Json& renamed : done.at("renamed")) from[renamed.at("to").get<std::string>()] = renamed.at("from").get<std::string>();
            for (const char* list : {"elements", "bones", "handles"})
                for (const Json& name : done.at(list)) {
                    const auto was = from.find(name.get<std::string>());
                    answer_[list].push_back({{"name", name}, {"from", was == from.end() ? name : Json(was->second)}});
                    names_[was == from.end() ? name.get<std::string>() : was->second] = name.get<std::string>();
                }
            for (const auto& [id, character] : document_.characters)
                for (const Json& element : done.at("elements"))
                    if (const Element* piece = document_.elementNamed(element.get<std::string>()); piece && piece->piece && piece->piece->character == id) {
                        const auto was = from.find(character->name);
                        answer_["characters"].push_back({{"name", character->name}, {"from", was == from.end() ? character->name : was->second}});
                        names_[was == from.end() ? character->name : was->second] = character->name;
                        break;
                    }
        } else if (verb == "enable" || verb == "disable" || (verb == "set" && effectNamed(wish))) {
            const Json name = verb == "set" ? line["target"] : line["effect"];
            if (std::find(answer_["effects"].begin(), answer_["effects"].end(), name) == answer_["effects"].end()) answer_["effects"].push_back(name);
        }
    }

    DocumentEdit& edit_;
    Document& document_;
    const std::string onto_;
    Vec3 shift_ = Vec3::Zero();
    std::map<std::string, std::optional<std::string>> names_;  ///< what was pasted, by what it was called; none: it could not be
    std::vector<Json> loose_;  ///< ends of the bone that is being pasted
    Json answer_;
};

}  // namespace

void addPasteCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("paste",
                       "Does what \"copy\" answered, here, as one step. Names that are taken get a number; bones that would lie on others go beside them, elements beside all that is there. What could not be "
                       "pasted is told with the reason.",
                       {{"commands", Type::Array, true, "The commands of the answer of \"copy\"."},
                        {"onto", Type::Text, false, "An element or a character that joint faces, handles and cuts go on (what they were on, by its name)."},
                        {"offset", Type::Vector3, false, "Metres that bones are shifted by."}},
                       [](DocumentEdit& edit, const Json& arguments, const Progress& progress) -> Result<Json> {
                           const Json& lines = arguments.at("commands");
                           const Json* onto = find(arguments, "onto");
                           if (onto && !onto->empty() && !edit.document.characterNamed(text(arguments, "onto")))
                               if (const auto element = elementOf(edit.document, text(arguments, "onto")); !element) return tl::unexpected(element.error());
                           Paster paster(edit, onto ? onto->get<std::string>() : std::string());
                           if (const Json* offset = find(arguments, "offset")) paster.shift(*vector3(*offset));
                           else paster.findShift(lines);
                           for (const Json& line : lines)
                               if (auto done = paster.paste(line, progress); !done) return tl::unexpected(done.error());
                           if (paster.any()) return paster.finish();
                           if (paster.left().empty()) return fail("nothing-to-paste", "There is nothing to paste: \"commands\" is empty.");
                           const Json& first = paster.left()[0];
                           return fail("nothing-to-paste", "\"" + first["name"].get<std::string>() + "\" cannot be pasted: " + first["why"].get<std::string>());
                       });
}

}  // namespace imomushi
