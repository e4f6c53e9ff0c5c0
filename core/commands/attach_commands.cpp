// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/core_commands.h"
#include "core/document/attachments.h"
#include "core/document/command_support.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

constexpr double kLongestTurn = 1e6;  // s

struct Named {
    std::shared_ptr<const CharacterSource> character;
    ModelPart part;
};
Result<Named> attachableFrom(const Document& document, const Json& arguments) {
    IMOMUSHI_TRY(auto character, characterOf(document, text(arguments, "character")));
    IMOMUSHI_TRY(const auto part, modelPartNamed(*character, text(arguments, "part")));
    return Named{std::move(character), part};
}

/// The element "name" of the character; 0 for "".
Result<PartId> followedElement(const Document& document, const CharacterSource& character, const std::string& name) {
    if (name.empty()) return PartId(0);
    IMOMUSHI_TRY(const auto element, elementOf(document, name));
    if (!element->piece || element->piece->character != character.id)
        return fail("bad-value", "The element \"" + name + "\" is no piece of the character \"" + character.name + "\": name one of its elements, or \"\" for the one that is nearest.");
    return element->id;
}

Result<Json> attach(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto named, attachableFrom(document, arguments));
    const CharacterSource& character = *named.character;
    const std::string& mode = text(arguments, "mode");
    if (mode != "auto" && mode != "flesh" && mode != "rigid") return fail("bad-value", "\"mode\" must be \"auto\", \"flesh\" or \"rigid\".");
    const Json *pivot = find(arguments, "pivot"), *element = find(arguments, "element");
    if (pivot && mode != "rigid") return fail("bad-value", "\"pivot\" goes with the mode \"rigid\".");
    if (element && mode == "auto") return fail("bad-value", "\"element\" goes with the modes \"flesh\" and \"rigid\".");
    const auto known = character.attachments.find(named.part);
    Attachment made = known == character.attachments.end() ? Attachment() : known->second;
    made.mode = mode == "rigid" ? Attachment::Mode::Rigid : Attachment::Mode::Flesh;
    if (made.mode == Attachment::Mode::Flesh || (pivot && pivot->is_null())) made.pivot.reset();
    if (pivot && !pivot->is_null()) {
        made.pivot = vector3(*pivot);
        if (!made.pivot) return fail("bad-type", "\"pivot\" must be three numbers [x,y,z], or null for the middle of the part.");
    }
    if (element)
        if (auto ok = assign(made.element, followedElement(document, character, element->get_ref<const std::string&>())); !ok) return tl::unexpected(ok.error());
    exchangePart(document.characters, character.id, [&](CharacterSource& changed) {
        if (mode == "auto")
            changed.attachments.erase(named.part);
        else
            changed.attachments.insert_or_assign(named.part, made);
    });
    const CharacterSource& now = *document.characters.at(character.id);
    std::erase_if(document.turns, [&now](const auto& turn) { return turn.first.character == now.id && !isRigid(now, turn.first.part); });
    Json answer{{"part", now.model->namedParts().nameOf(named.part)}, {"vertices", attachedVertices(now, named.part).size()}};
    if (isRigid(now, named.part)) answer["pivot"] = json(pivotOf(now, named.part));
    return answer;
}

Result<Json> turnPart(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    IMOMUSHI_TRY(const auto named, attachableFrom(document, arguments));
    if (!isRigid(*named.character, named.part))
        return fail("not-rigid", "The part \"" + text(arguments, "part") + "\" is not rigid by itself: attach it with the mode \"rigid\" before it is turned.");
    IMOMUSHI_TRY(const auto rotation, rotationFrom(arguments.at("rotation"), "rotation"));
    TurnGoal made;
    made.target = rotation;
    if (auto ok = readNumber(arguments, "seconds", 0.0, kLongestTurn, made.seconds); !ok) return tl::unexpected(ok.error());
    const PartRef ref{named.character->id, named.part};
    if (const auto known = document.turns.find(ref); known != document.turns.end()) made.from = known->second.now();
    const bool rest = made.target.coeffs() == Eigen::Quaterniond::Identity().coeffs() && made.seconds == 0.0;
    if (rest)
        document.turns.erase(ref);
    else
        document.turns.insert_or_assign(ref, made);
    return Json{{"rotation", Json::array({made.target.x(), made.target.y(), made.target.z(), made.target.w()})}};
}

Result<Json> showTurn(LiveCharacter& live, const Json&, Json answer) {
    if (auto alive = live.built(); !alive) return tl::unexpected(alive.error());
    live.showPose();
    return answer;
}

}  // namespace

void addAttachCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    const CommandKey character{"character", Type::Text, true, "The character."};
    const CommandKey part{"part", Type::Text, true,
                          "A part by its name in the file, \"NAME (2)\" the second of that name; \"NAME#2\" the second of its shells where it does not hang together; open and list tell them."};
    registry.addChange("attach",
                       "Says how a part of what is seen (eyes, teeth, a hat) follows the body. A shell goes with its part unless it is attached by itself. Nothing is precomputed again.",
                       {character, part,
                        {"mode", Type::Text, true,
                         "\"flesh\": each vertex follows the body beside it; \"rigid\": the part keeps its shape and moves as the body does at its pivot, so that parts with one pivot move as "
                         "one; \"auto\": small parts that the body was made without keep their shape, others are flesh."},
                        {"pivot", Type::Any, false, "Of a rigid part, which it turns about: [x,y,z], metres at rest; null: the middle of its box (as it is, at first the middle)."},
                        {"element", Type::Text, false, "The element of the character that it follows, \"\": the one that is nearest (as it is, at first the nearest)."}},
                       attach);
    registry.addChange("turn-part",
                       "Turns a rigid part about its pivot, like an eye that looks around; the body carries it on, turned. Takes record it.",
                       {character, part,
                        {"rotation", Type::Array, true, "From rest, a quaternion [x,y,z,w] in the axes of the rest pose; [0,0,0,1]: not turned."},
                        {"seconds", Type::Number, false, "Glides there in this time while step runs."}},
                       turnPart, showTurn);
}

}  // namespace imomushi
