// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/proposal_commands.h"

#include <algorithm>
#include <chrono>

#include "core/base/formatted.h"
#include "core/commands/core_commands.h"
#include "core/commands/import_request.h"
#include "core/document/attachments.h"
#include "core/document/command_support.h"
#include "core/mesh/bounds.h"
#include "core/proposal/proposal_edit.h"
#include "core/proposal/rig_proposal.h"
#include "core/proposal/shape_proposal.h"
#include "core/session/session_access.h"

namespace imomushi {

namespace {

/// Characters are meant to be this tall or long, m: from a flea to a whale.
constexpr double kSmallestMeant = 2e-3, kLargestMeant = 40.0;
/// A unit is suggested that brings the size into the middle of this.
constexpr double kSmallestUsual = 0.1, kLargestUsual = 10.0;

Result<Json> propose(SessionAccess& access, const Json& arguments, const Progress& progress) {
    IMOMUSHI_TRY(const auto character, characterOf(access.document(), text(arguments, "character")));
    IMOMUSHI_TRY(const auto request, proposalRequestFrom(arguments));
    const auto start = std::chrono::steady_clock::now();
    IMOMUSHI_TRY(const auto proposal, access.services.propose(*character, request, progress));
    Json answer = proposalJson(*character, proposal);
    answer["size"] = sizeJson(*character);
    answer["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return answer;
}

// ---- a proposal that is given back

struct ProposalFault {
    std::string text;
};

/// Reads one entry of a proposal's list; throws ProposalFault within this file.
class ProposalEntry {
public:
    ProposalEntry(const char* list, const Json& json) : list_(list), json_(json) {
        if (!json.is_object()) throw ProposalFault{std::string("\"") + list + "\" of a proposal needs objects."};
    }
    [[nodiscard]] const Json* value(const char* key) const {
        const Json* found = find(json_, key);
        return found && !found->is_null() ? found : nullptr;
    }
    [[nodiscard]] std::string name(const char* key, bool needed = true) const {
        const Json* found = value(key);
        if (found && found->is_string()) return found->get<std::string>();
        if (found || needed) fault(key, "a text");
        return {};
    }
    [[nodiscard]] Vec3 place(const char* key) const {
        const Json* found = value(key);
        const auto read = found ? vector3(*found) : std::nullopt;
        if (!read) fault(key, "three numbers [x,y,z]");
        return *read;
    }
    [[noreturn]] void fault(const char* key, const std::string& wanted) const {
        throw ProposalFault{std::string("An entry of \"") + list_ + "\" of the proposal needs " + wanted + " for \"" + key + "\"."};
    }

private:
    const char* list_;
    const Json& json_;
};

template <class Each>
void eachEntry(const Json& json, const char* list, const Each& each) {
    const Json* found = find(json, list);
    if (!found || found->is_null()) return;
    if (!found->is_array()) throw ProposalFault{std::string("\"") + list + "\" of a proposal is a list."};
    for (const Json& entry : *found) each(entry);
}

/// The entry with a name, -1: none.
template <class List, class Member>
int indexNamed(const List& list, Member member, const std::string& name) {
    const auto found = std::find_if(list.begin(), list.end(), [&](const auto& entry) { return entry.*member == name; });
    return found == list.end() ? -1 : static_cast<int>(found - list.begin());
}

ProposedBone proposedBoneFrom(const Proposal& proposal, const ProposalEntry& entry) {
    ProposedBone bone;
    bone.name = entry.name("name");
    bone.start = entry.place("start");
    bone.end = entry.place("end");
    if (const std::string parent = entry.name("parent", false); !parent.empty()) {
        bone.parent = indexNamed(proposal.bones, &ProposedBone::name, parent);
        if (bone.parent < 0) entry.fault("parent", "the name of a bone before it");
        const ProposedBone& of = proposal.bones[static_cast<std::size_t>(bone.parent)];
        bone.fromParentStart = bone.start == of.start && bone.start != of.end;
    }
    const auto cut = [&](const char* key) {
        const std::string name = entry.name(key, false);
        const int index = name.empty() ? -1 : indexNamed(proposal.cuts, &ProposedCut::name, name);
        if (!name.empty() && index < 0) entry.fault(key, "the name of one of its cuts");
        return index;
    };
    bone.startCut = cut("start_cut");
    bone.endCut = cut("end_cut");
    if (const std::string piece = entry.name("piece", false); !piece.empty() && piece != proposal.root) {
        bone.piece = indexNamed(proposal.cuts, &ProposedCut::piece, piece);
        if (bone.piece < 0) entry.fault("piece", "the root or the piece of one of its cuts");
    }
    return bone;
}

ProposedPin proposedPinFrom(const Proposal& proposal, const Json& json) {
    const std::string text = json.is_string() ? json.get<std::string>() : std::string();
    const std::size_t slash = text.rfind('/');
    const std::string end = slash == std::string::npos ? std::string() : text.substr(slash + 1);
    const int bone = slash == std::string::npos ? -1 : indexNamed(proposal.bones, &ProposedBone::name, text.substr(0, slash));
    if (bone < 0 || (end != "end" && end != "start")) throw ProposalFault{"\"pins\" of a proposal are ends of its bones, such as \"leg/end\"."};
    return {bone, end == "end"};
}

}  // namespace

Result<Proposal> proposalFrom(const CharacterSource& character, const Json& json) {
    Proposal proposal;
    try {
        if (!json.is_object()) throw ProposalFault{"\"proposal\" is what propose answers: an object."};
        if (const Json* from = find(json, "from")) proposal.from = *from == "skeleton" ? Proposal::Source::Skeleton : Proposal::Source::Shape;
        proposal.root = ProposalEntry("proposal", json).name("root", false);
        eachEntry(json, "cuts", [&](const Json& entry) {
            const ProposalEntry e("cuts", entry);
            proposal.cuts.push_back({e.name("name"), e.name("piece", false), {e.place("origin"), e.place("normal")}});
        });
        eachEntry(json, "bones", [&](const Json& entry) { proposal.bones.push_back(proposedBoneFrom(proposal, ProposalEntry("bones", entry))); });
        eachEntry(json, "pins", [&](const Json& entry) { proposal.pins.push_back(proposedPinFrom(proposal, entry)); });
        eachEntry(json, "handles", [&](const Json& entry) {
            const ProposalEntry e("handles", entry);
            ProposedHandle handle{e.name("name"), e.place("point"), 0.0, false};
            const Json *radius = e.value("radius"), *pinned = e.value("pinned");
            if (!radius || !radius->is_number()) e.fault("radius", "a number");
            if (pinned && !pinned->is_boolean()) e.fault("pinned", "true or false");
            handle.radius = radius->get<double>();
            handle.pinned = pinned && pinned->get<bool>();
            proposal.handles.push_back(std::move(handle));
        });
        std::optional<Error> unknown;
        eachEntry(json, "parts", [&](const Json& entry) {
            const ProposalEntry e("parts", entry);
            const auto part = modelPartNamed(character, e.name("name"));
            if (!part && !unknown) unknown = part.error();
            if (part) proposal.parts.push_back({*part, e.value("pivot") ? std::optional(e.place("pivot")) : std::nullopt});
        });
        if (unknown) return tl::unexpected(*unknown);
    } catch (const ProposalFault& fault) {
        return fail("bad-proposal", fault.text);
    }
    if (const auto good = checkProposal(proposal); !good) return tl::unexpected(good.error());
    return proposal;
}

Result<ProposalRequest> proposalRequestFrom(const Json& arguments) {
    ProposalRequest request;
    using From = ProposalRequest::From;
    const auto from = choiceFrom<From>(arguments, "from", {{"auto", From::Auto}, {"skeleton", From::Skeleton}, {"shape", From::Shape}}, From::Auto);
    IMOMUSHI_TRY(request.from, from);
    if (auto ok = readNumber(arguments, "least", 0.0, 1.0, request.least); !ok) return tl::unexpected(ok.error());
    if (const Json* bones = find(arguments, "bones")) {
        if (request.from == ProposalRequest::From::Shape || request.least >= 0.0) return fail("bad-value", "\"bones\" says which bones of the skeleton stay: leave out \"from\": \"shape\" and \"least\".");
        request.bones.emplace();
        for (const Json& name : *bones) {
            if (!name.is_string()) return fail("bad-type", "\"bones\" must be names of bones of the file's skeleton.");
            request.bones->push_back(name.get<std::string>());
        }
        request.from = ProposalRequest::From::Skeleton;
    }
    return request;
}

bool canBecomeSoft(const Document& document, const CharacterSource& character) {
    if (!character.body || !character.cuts.empty()) return false;
    const auto elements = document.elementsOf(character.id);
    const auto own = [&](PartId element) { return std::find(elements.begin(), elements.end(), element) != elements.end(); };
    return std::all_of(elements.begin(), elements.end(), [&](PartId id) { return document.elements.at(id)->handles.empty(); }) &&
           std::none_of(document.bones.begin(), document.bones.end(), [&](const auto& bone) { return own(bone.second->element); });
}

bool canBecomeSoft(const Document& document, const Element& element) {
    return !element.piece && element.faces.empty() && std::none_of(document.bones.begin(), document.bones.end(), [&](const auto& bone) { return bone.second->element == element.id; });
}

Json proposalJson(const CharacterSource& character, const Proposal& proposal) {
    Json answer{{"from", proposal.from == Proposal::Source::Shape ? "shape" : "skeleton"}, {"root", proposal.root}};
    Json& cuts = answer["cuts"] = Json::array();
    for (const ProposedCut& cut : proposal.cuts) cuts.push_back({{"name", cut.name}, {"piece", cut.piece}, {"origin", json(cut.plane.origin)}, {"normal", json(cut.plane.normal)}});
    const auto cutName = [&](int cut) { return cut < 0 ? Json() : Json(proposal.cuts[static_cast<std::size_t>(cut)].name); };
    Json& bones = answer["bones"] = Json::array();
    for (const ProposedBone& bone : proposal.bones)
        bones.push_back({{"name", bone.name},
                         {"parent", bone.parent < 0 ? Json() : Json(proposal.bones[static_cast<std::size_t>(bone.parent)].name)},
                         {"start", json(bone.start)},
                         {"end", json(bone.end)},
                         {"piece", bone.piece < 0 ? proposal.root : proposal.cuts[static_cast<std::size_t>(bone.piece)].piece},
                         {"start_cut", cutName(bone.startCut)},
                         {"end_cut", cutName(bone.endCut)}});
    Json& pins = answer["pins"] = Json::array();
    for (const ProposedPin& pin : proposal.pins) pins.push_back(proposal.bones[static_cast<std::size_t>(pin.bone)].name + (pin.atEnd ? "/end" : "/start"));
    Json& handles = answer["handles"] = Json::array();
    for (const ProposedHandle& handle : proposal.handles)
        handles.push_back({{"name", handle.name}, {"point", json(handle.point)}, {"radius", handle.radius}, {"pinned", handle.pinned}});
    Json& parts = answer["parts"] = Json::array();
    for (const ProposedPart& part : proposal.parts)
        parts.push_back({{"name", character.model->namedParts().nameOf(part.part)}, {"pivot", part.pivot ? json(*part.pivot) : Json()}});
    Json& merged = answer["merged"] = Json::array();
    for (const ProposedMerge& merge : proposal.merged) merged.push_back({{"what", merge.what}, {"into", merge.into}, {"share", merge.share}, {"why", merge.why}});
    Json& notes = answer["notes"] = Json::array();
    for (const Error& note : proposal.notes) notes.push_back({{"code", note.code}, {"text", note.message}});
    answer["symmetry"] = proposal.symmetry ? Json{{"origin", json(proposal.symmetry->origin)}, {"normal", json(proposal.symmetry->normal)}} : Json();
    return answer;
}

std::optional<SizeDoubt> doubtedSize(const Points& vertices) {
    SizeDoubt doubt;
    doubt.size = boundsOf(vertices).size().maxCoeff();
    if (doubt.size >= kSmallestMeant && doubt.size <= kLargestMeant) return std::nullopt;
    for (const auto& [unit, metres] : {std::pair("cm", 0.01), std::pair("mm", 0.001)}) {
        const double then = doubt.size * metres;
        if (!doubt.unit.empty() || then < kSmallestUsual || then > kLargestUsual) continue;
        doubt.unit = unit;
        doubt.meant = then;
    }
    return doubt;
}

Json sizeJson(const CharacterSource& character) {
    const Points& vertices = character.model->mesh.body.vertices;
    const Bounds box = boundsOf(vertices);
    Json answer{{"height", box.size().y()}, {"diagonal", box.diagonal()}};
    const auto doubt = doubtedSize(vertices);
    if (!doubt) return answer;
    if (doubt->unit.empty()) {
        answer["note"] = formatted("It is %.3g m large. That is hardly meant: scale it in a modelling program.", doubt->size);
    } else {
        answer["suggested_unit"] = doubt->unit;
        answer["note"] = formatted("It is %.3g m large. That is hardly meant: with \"unit\": \"%s\" it is %.3g m.", doubt->size, doubt->unit.c_str(), doubt->meant);
    }
    return answer;
}

void addProposalCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("propose",
                       "Proposes cuts, bones and pins for a character, from the skeleton of its file or from its shape: limbs are cut where they leave the trunk and divided by their length, a shape "
                       "that mirrors itself gets a proposal that does. All cuts were tried together. Changes nothing; make-soft does what is proposed, or what you made of it.",
                       {{"character", Type::Text, true, "The character."},
                        {"from", Type::Text, false, "\"skeleton\", \"shape\", or \"auto\": the skeleton where the file brought one (unless given)."},
                        {"least", Type::Number, false, "The smallest share of the flesh of a piece, 0 to 1 (0.00005 for shapes; 0.01 for skeletons, or more where that would make many pieces; a fifth of it is enough for limbs of a human and for hair that swings); what is smaller stays with its neighbour."},
                        {"bones", Type::Array, false, "Names of the bones of the file's skeleton that stay; all others are merged into them (those that move enough flesh stay unless given)."}},
                       propose);
}

}  // namespace imomushi
