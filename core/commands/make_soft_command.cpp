// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/commands/core_commands.h"
#include "core/commands/proposal_commands.h"
#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

/// A pin not higher than this part of the height is a foot.
constexpr double kFootHeight = 0.2;
constexpr double kAirDamping = 3.0;  ///< 1/s: a sway of the whole body is down to a tenth in a second and a half; limbs that swing at 2.5 Hz get a damping ratio of .1 more

class StopWatch {
public:
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// The commands of one step, taken back unless it ends.
class Step {
public:
    explicit Step(SessionAccess& access) : access_(access) { access_.beginStep(); }
    ~Step() {
        if (open_) access_.cancelStep();
    }
    Step(const Step&) = delete;
    Step& operator=(const Step&) = delete;
    void end(DocumentHistory::Step step) {
        access_.endStep(std::move(step));
        open_ = false;
    }

private:
    SessionAccess& access_;
    bool open_ = true;
};

/// Does what a proposal says, by the ordinary commands. What is refused is told and left out.
class Maker {
public:
    Maker(SessionAccess& access, PartId character, const Proposal& proposal, const Progress& progress)
        : access_(access), character_(character), proposal_(proposal), progress_(progress), cuts_(proposal.cuts.size(), 0), bones_(proposal.bones.size()) {}

    /// Errors: "cancelled".
    Result<void> cut() {
        if (!proposal_.cuts.empty() || !proposal_.handles.empty()) renameRoot();
        if (proposal_.cuts.empty()) return {};
        Json line{{"do", "cut-all"}, {"element", source().name}, {"cuts", Json::array()}};
        std::set<std::string> taken;
        const auto name = [&](const std::string& wish) {
            std::string found = freeName(document(), wish);
            for (int n = 2; !taken.insert(found).second; ++n) found = freeName(document(), wish + " " + std::to_string(n));
            return found;
        };
        for (const ProposedCut& wanted : proposal_.cuts) {
            Json one{{"plane", {{"origin", json(wanted.plane.origin)}, {"normal", json(wanted.plane.normal)}}}, {"name", name(wanted.name)}};
            if (!wanted.piece.empty()) one["piece"] = name(wanted.piece);
            line["cuts"].push_back(std::move(one));
        }
        const auto made = execute(line, proposal_.cuts.size() == 1 ? "The cut \"" + proposal_.cuts[0].name + "\"" : "The cuts");
        if (cancelled()) return cancelledError();
        if (!made) return {};
        for (const Json& one : (*made)["refused"])
            refused.push_back({{"what", "The cut \"" + proposal_.cuts[one["cut"].get<std::size_t>()].name + "\""}, {"code", one["code"]}, {"text", one["text"]}});
        for (std::size_t c = 0; c < cuts_.size(); ++c)
            if (const Json& one = (*made)["cuts"][c]; !one.is_null()) cuts_[c] = source().cuts[static_cast<std::size_t>(source().cutIndex(one["cut"].get<std::string>()))].id;
        return {};
    }

    Result<void> addBones() {
        for (std::size_t b = 0; b < proposal_.bones.size(); ++b) {
            const ProposedBone& wanted = proposal_.bones[b];
            if (cancelled()) return cancelledError();
            const PartId element = elementOfPiece(wanted);
            Json line{{"do", "add-bone"}, {"name", freeName(document(), wanted.name)}};
            if (element != 0) line["element"] = document().elements.at(element)->name;
            const std::string parent = wanted.parent < 0 ? std::string() : bones_[static_cast<std::size_t>(wanted.parent)];
            if (!parent.empty())
                line["from"] = parent + (wanted.fromParentStart ? "/start" : "/end");
            else
                line["from"] = placeAt(wanted.startCut, element, wanted.start);
            line["to"] = placeAt(wanted.endCut, element, wanted.end);
            if (!parent.empty()) line["parent"] = parent;
            const std::string name = line["name"];
            if (execute(line, "The bone \"" + wanted.name + "\"")) bones_[b] = name;
        }
        for (const ProposedPin& pin : proposal_.pins)
            if (const std::string& bone = bones_[static_cast<std::size_t>(pin.bone)]; !bone.empty()) {
                const std::string end = bone + (pin.atEnd ? "/end" : "/start");
                if (execute({{"do", "pin"}, {"endpoint", end}}, "The pin of \"" + bone + "\"")) pins.push_back(end);
            }
        return {};
    }

    Result<void> addHandles() {
        for (const ProposedHandle& wanted : proposal_.handles) {
            if (cancelled()) return cancelledError();
            const std::string name = freeName(document(), wanted.name);
            const std::string element = document().elements.at(document().elementsOf(character_).front())->name;
            if (!execute({{"do", "handle"}, {"element", element}, {"name", name}, {"point", json(wanted.point)}, {"radius", wanted.radius}}, "The handle \"" + wanted.name + "\"")) continue;
            handles.push_back(name);
            if (wanted.pinned && execute({{"do", "pin"}, {"endpoint", name}}, "The pin of \"" + name + "\"")) pins.push_back(name);
        }
        return {};
    }

    Result<void> attachParts() {
        for (const ProposedPart& wanted : proposal_.parts) {
            if (cancelled()) return cancelledError();
            const std::string name = source().model->namedParts().nameOf(wanted.part);
            Json line{{"do", "attach"}, {"character", source().name}, {"part", name}, {"mode", "rigid"}};
            if (wanted.pivot) line["pivot"] = json(*wanted.pivot);
            execute(line, "The part \"" + name + "\"");
        }
        return {};
    }

    /// What an artist expects of a body that is dragged: bends without cracks, a soft skin over joints, flesh that goes along with free ends, bones that swing; of one that stands, the ground and a trunk that stays upright.
    /// What is on already stays as it is.
    void makeAlive() {
        if (proposal_.bones.empty()) return;
        enable(EffectKind::BendWarp, true);
        enable(EffectKind::SmoothJoints, false);
        enable(EffectKind::EndStretch, false);
        if (!document().effects.has(EffectKind::BoneDynamics)) {
            execute({{"do", "set"}, {"target", std::string(effectName(EffectKind::BoneDynamics))}, {"property", "air-damping"}, {"value", kAirDamping}}, "The air damping");
            enable(EffectKind::BoneDynamics, false);
        }
        const Points& vertices = source().body->mesh.vertices;
        const double low = vertices.col(1).minCoeff(), height = vertices.col(1).maxCoeff() - low;
        const bool stands = std::any_of(proposal_.pins.begin(), proposal_.pins.end(), [&](const ProposedPin& pin) {
            const ProposedBone& bone = proposal_.bones[static_cast<std::size_t>(pin.bone)];
            return (pin.atEnd ? bone.end : bone.start).y() - low < kFootHeight * height;
        });
        if (!stands) return;
        if (!document().effects.has(EffectKind::Ground)) {
            execute({{"do", "set"}, {"target", std::string(effectName(EffectKind::Ground))}, {"property", "height"}, {"value", low}}, "The height of the ground");
            enable(EffectKind::Ground, false);
        }
        if (document().settings.bodyFollows == 0.0) execute({{"do", "set"}, {"target", "character"}, {"property", "body-follows"}, {"value", 1.0}}, "The trunk that stays upright");
    }

    Json pins = Json::array(), handles = Json::array();
    Json refused = Json::array();  ///< {"what", "code", "text"}

    /// Names of the bones that there are.
    [[nodiscard]] Json boneNames() const {
        Json names = Json::array();
        for (const std::string& name : bones_)
            if (!name.empty()) names.push_back(name);
        return names;
    }

private:
    [[nodiscard]] const Document& document() const { return access_.document(); }
    [[nodiscard]] const CharacterSource& source() const { return *document().characters.at(character_); }
    [[nodiscard]] bool cancelled() const { return progress_.cancelled(); }
    static tl::unexpected<Error> cancelledError() { return fail(kCancelled, "Making it soft was cancelled."); }

    void enable(EffectKind kind, bool automatic) {
        if (document().effects.has(kind)) return;
        Json line{{"do", "enable"}, {"effect", std::string(effectName(kind))}};
        if (automatic) line["auto"] = true;
        execute(line, "The effect \"" + std::string(effectName(kind)) + "\"");
    }

    Result<Json> execute(const Json& line, const std::string& what) {
        auto answer = access_.execute(line, progress_);
        if (!answer && !cancelled()) refused.push_back({{"what", what}, {"code", answer.error().code}, {"text", answer.error().message}});
        return answer;
    }

    void renameRoot() {
        const auto elements = document().elementsOf(character_);
        if (proposal_.root.empty() || elements.size() != 1) return;
        execute({{"do", "rename"}, {"target", document().elements.at(elements[0])->name}, {"name", freeName(document(), proposal_.root)}}, "The name \"" + proposal_.root + "\"");
    }

    /// The element on one side of a cut; 0: it was not made.
    [[nodiscard]] PartId beside(int cut, bool front) const {
        if (cut < 0 || cuts_[static_cast<std::size_t>(cut)] == 0) return 0;
        for (const PartId id : document().elementsOf(character_)) {
            const CharacterPiece& piece = *document().elements.at(id)->piece;
            const int side = piece.sideIndex(cuts_[static_cast<std::size_t>(cut)]);
            if (side >= 0 && piece.sides[static_cast<std::size_t>(side)].front == front) return id;
        }
        return 0;
    }

    /// What a bone runs through; 0: found from where it is.
    [[nodiscard]] PartId elementOfPiece(const ProposedBone& bone) const {
        if (bone.piece >= 0) return beside(bone.piece, true);
        for (const PartId id : document().elementsOf(character_)) {
            const auto& sides = document().elements.at(id)->piece->sides;
            if (std::none_of(sides.begin(), sides.end(), [](const CutSide& side) { return side.front; })) return id;
        }
        return 0;
    }

    /// The joint face of a cut, of `element` where it has one, else a point.
    [[nodiscard]] Json placeAt(int cut, PartId element, const Vec3& point) const {
        for (const bool front : {false, true})
            if (const PartId id = beside(cut, front); id != 0 && (id == element || front)) {
                const CharacterPiece& piece = *document().elements.at(id)->piece;
                const std::string& face = piece.sides[static_cast<std::size_t>(piece.sideIndex(cuts_[static_cast<std::size_t>(cut)]))].face;
                if (!face.empty()) return faceText(document(), {id, face});
            }
        return json(point);
    }

    SessionAccess& access_;
    PartId character_;
    const Proposal& proposal_;
    const Progress& progress_;
    std::vector<PartId> cuts_;         // of the proposal's, 0: not made
    std::vector<std::string> bones_;   // names, empty: not made
};

/// Errors: "already-cut".
Result<PartId> uncut(const Document& document, const CharacterSource& character) {
    if (canBecomeSoft(document, character)) return character.id;
    return fail("already-cut", "The character \"" + character.name + "\" has cuts, bones or handles already: take them out first, or use propose and do by hand what you want of it.");
}

/// The character that is meant, imported if it is a file, made of an element if it is that. Fills "imported" of the answer. Errors: those of import-character, "already-cut".
Result<PartId> characterFor(SessionAccess& access, const Json& arguments, Json& answer, const Progress& progress) {
    const Document& document = access.document();
    const Json *character = find(arguments, "character"), *element = find(arguments, "element");
    if (character && element) return fail("bad-value", "Give \"character\" or \"element\", not both.");
    if (character || element)
        for (const char* key : {"path", "name", "unit", "up", "body", "detail", "links"})
            if (arguments.contains(key)) return fail("bad-value", std::string("\"") + key + "\" goes with a file, not with what is there.");
    if (character) {
        IMOMUSHI_TRY(const auto found, characterOf(document, character->get_ref<const std::string&>()));
        return uncut(document, *found);
    }
    if (element) {
        IMOMUSHI_TRY(const auto found, elementOf(document, element->get_ref<const std::string&>()));
        if (found->piece) return uncut(document, *document.characters.at(found->piece->character));
        if (!canBecomeSoft(document, *found))
            return fail("already-cut", "The element \"" + found->name + "\" has joint faces, bones or handles already: precompute makes it soft. Take them out first to have others proposed.");
        const std::string name = found->name;
        if (auto made = access.execute({{"do", "make-character"}, {"element", name}}, progress); !made) return tl::unexpected(made.error());
        return document.characterNamed(name)->id;
    }
    if (!arguments.contains("path")) return fail("missing-key", "\"make-soft\" needs the key \"path\", \"character\" or \"element\".");
    Json line{{"do", "import-character"}};
    for (const char* key : {"path", "name", "unit", "up", "body", "detail", "links"})
        if (const Json* value = find(arguments, key)) line[key] = *value;
    IMOMUSHI_TRY(answer, access.execute(line, progress));
    return document.characterNamed(answer["characters"][0]["name"].get<std::string>())->id;
}

/// Makes elements soft at once: coarse answers for those that have none. One that fails is told and does not stop the others. Errors: "cancelled".
Result<int> draftAll(SessionAccess& access, PartId character, Json& refused, const Progress& progress) {
    std::vector<PartId> ids;
    std::vector<ResponseInput> inputs;
    for (const PartId id : access.document().elementsOf(character)) {
        if (access.document().elements.at(id)->faces.empty() || access.responses.fittingOf(id)) continue;
        ids.push_back(id);
        inputs.push_back(access.responses.inputOfDraft(id));
    }
    std::vector<std::optional<Result<ElementResponse>>> responses(ids.size());
    buildResponses(inputs, access.responses.threads(), [&](std::size_t i, Result<ElementResponse> response) { responses[i] = std::move(response); }, progress);
    int made = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (!responses[i]) continue;
        if (auto& response = *responses[i]) {
            access.responses.bring(ids[i], {responseKey(inputs[i]), access.responses.shapeOf(ids[i]), std::make_shared<const ElementResponse>(std::move(*response))});
            ++made;
        } else if (response.error().code != kCancelled) {
            refused.push_back({{"what", "The draft of the element \"" + access.document().elements.at(ids[i])->name + "\""}, {"code", response.error().code}, {"text", response.error().message}});
        }
    }
    if (progress.cancelled()) return fail(kCancelled, "Making drafts was cancelled; what was made stays.");
    return made;
}

/// Precomputes all elements that have joint faces; where one fails it is told and does not stop the others. Errors: "cancelled".
Result<Json> precomputeAll(SessionAccess& access, PartId character, Json& refused, const Progress& progress) {
    std::vector<std::string> names;
    for (const PartId id : access.document().elementsOf(character))
        if (const Element& element = *access.document().elements.at(id); !element.faces.empty()) names.push_back(element.name);
    Json list = Json::array();
    if (names.empty()) return list;
    const auto cancelled = [] { return fail(kCancelled, "Precomputing was cancelled; what was made stays, and what was precomputed."); };
    if (auto all = access.execute({{"do", "precompute"}, {"elements", names}}, progress)) return std::move((*all)["elements"]);
    if (progress.cancelled()) return cancelled();
    for (const std::string& name : names) {
        const auto done = access.execute({{"do", "precompute"}, {"elements", Json::array({name})}}, progress);
        if (progress.cancelled()) return cancelled();
        if (done)
            list.push_back((*done)["elements"][0]);
        else
            refused.push_back({{"what", "The element \"" + name + "\""}, {"code", done.error().code}, {"text", done.error().message}});
    }
    return list;
}

Result<Json> makeSoft(SessionAccess& access, const Json& arguments, const Progress& progress) {
    IMOMUSHI_TRY(const auto request, proposalRequestFrom(arguments));
    if (arguments.contains("proposal"))
        for (const char* key : {"from", "least", "bones"})
            if (arguments.contains(key)) return fail("bad-value", std::string("\"") + key + "\" asks for a proposal: it does not go with \"proposal\", which is one.");
    StopWatch whole, watch;
    Json seconds;
    Step step(access);
    Json imported = Json::object();
    IMOMUSHI_TRY(const auto character, characterFor(access, arguments, imported, progress.part(0.0, 0.1)));
    seconds["body"] = watch.lap();
    const auto source = access.document().characters.at(character);
    const Json* given = find(arguments, "proposal");
    IMOMUSHI_TRY(const auto proposal, given ? proposalFrom(*source, *given) : access.services.propose(*source, request, progress.part(0.1, 0.2)));
    seconds["propose"] = watch.lap();
    const Progress rest = progress.part(0.2, 0.3);
    Maker maker(access, character, proposal, rest);
    if (auto ok = maker.cut(); !ok) return tl::unexpected(ok.error());
    seconds["cut"] = watch.lap();
    for (const auto part : {&Maker::addBones, &Maker::addHandles, &Maker::attachParts})
        if (auto ok = (maker.*part)(); !ok) return tl::unexpected(ok.error());
    if (arguments.value("alive", false)) maker.makeAlive();
    seconds["bones"] = watch.lap();
    step.end({"make-soft", source->name});
    access.changedPose();

    Json precomputed = Json::array();
    int drafts = 0;
    if (arguments.value("draft", false)) {
        IMOMUSHI_TRY(drafts, draftAll(access, character, maker.refused, progress.part(0.3, 0.4)));
        seconds["draft"] = watch.lap();
        access.changedResponses();
    }
    if (arguments.value("precompute", true)) {
        IMOMUSHI_TRY(precomputed, precomputeAll(access, character, maker.refused, progress.part(0.4, 1.0)));
        seconds["precompute"] = watch.lap();
        access.changedResponses();
    }
    seconds["all"] = whole.lap();

    Json answer = characterJson(access.document(), *access.document().characters.at(character));
    answer["character"] = source->name;
    answer.erase("name");
    answer["proposal"] = proposalJson(*source, proposal);
    answer["bones"] = maker.boneNames();
    answer["pins"] = maker.pins;
    answer["handles"] = maker.handles;
    answer["refused"] = maker.refused;
    answer["precomputed"] = std::move(precomputed);
    if (seconds.contains("draft")) answer["drafts"] = drafts;
    for (const char* key : {"issues", "format", "metres_per_unit", "turned_z_up", "clips"})
        if (imported.contains(key)) answer[key] = imported[key];
    answer["size"] = sizeJson(*source);
    answer["seconds"] = std::move(seconds);
    return answer;
}

}  // namespace

void addMakeSoftCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("make-soft",
                       "Makes a whole character, a file or an element of its own soft in one step: a body, what propose says (cuts, bones and pins, or handles where the shape has no limbs), small parts attached, everything "
                       "precomputed. The step consists of the ordinary commands. What cannot be cut or precomputed is told and left out. Afterwards the ends of all bones can be dragged.",
                       {{"path", Type::Text, false, "The file, imported as import-character does."},
                        {"character", Type::Text, false, "Or a character that has no cuts, bones and handles yet."},
                        {"element", Type::Text, false, "Or an element that has no joint faces, bones and handles yet: it becomes a whole character, as make-character does it."},
                        {"from", Type::Text, false, "As in propose."},
                        {"least", Type::Number, false, "As in propose."},
                        {"bones", Type::Array, false, "As in propose."},
                        {"proposal", Type::Object, false, "Instead of these: what propose answered, with cuts, bones, pins, handles and parts changed, dropped or added."},
                        {"alive", Type::Boolean, false, "Enables what a body that is dragged calls for: bend-warp where it bends, smooth-joints, end-stretch, bone-dynamics with air-damping 3; where it stands, ground and "
                         "body-follows 1 (false)."},
                        {"precompute", Type::Boolean, false, "Precomputes its elements (true)."},
                        {"draft", Type::Boolean, false, "Makes coarse answers first, some tenths of a second each (false)."},
                        {"name", Type::Text, false, "Of the file's character, as in import-character; so are the following."},
                        {"unit", Type::Text, false, "The unit of the file."},
                        {"up", Type::Text, false, "The axis of the file that points up."},
                        {"body", Type::Text, false, "How its body is made."},
                        {"detail", Type::Number, false, "Of a wrap, in diagonals of the mesh (0.001 to 0.2)."},
                        {"links", Type::Array, false, "Links of flesh, as in import-character."}},
                       makeSoft);
}

}  // namespace imomushi
