// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/proposal_commands.h"

#include <chrono>
#include <cstdio>

#include "core/proposal/rig_proposal.h"
#include "core/proposal/shape_proposal.h"
#include "core/document/command_support.h"
#include "core/document/session_access.h"
#include "core/mesh/bounds.h"

namespace imomushi {

namespace {

/// Characters are meant to be this tall or long, m: from a flea to a whale.
constexpr double kSmallestMeant = 2e-3, kLargestMeant = 40.0;
/// A unit is suggested that brings the size into the middle of this.
constexpr double kSmallestUsual = 0.1, kLargestUsual = 10.0;

Result<Json> propose(SessionAccess& access, const Json& arguments, const Progress& progress) {
    const auto character = characterOf(access.document(), text(arguments, "character"));
    if (!character) return tl::unexpected(character.error());
    const auto request = proposalRequestFrom(arguments);
    if (!request) return tl::unexpected(request.error());
    const auto start = std::chrono::steady_clock::now();
    const auto proposal = access.propose(**character, *request, progress);
    if (!proposal) return tl::unexpected(proposal.error());
    Json answer = proposalJson(**character, *proposal);
    answer["size"] = sizeJson(**character);
    answer["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return answer;
}

}  // namespace

Result<ProposalRequest> proposalRequestFrom(const Json& arguments) {
    ProposalRequest request;
    if (const Json* from = find(arguments, "from")) {
        if (*from == "auto")
            request.from = ProposalRequest::From::Auto;
        else if (*from == "skeleton")
            request.from = ProposalRequest::From::Skeleton;
        else if (*from == "shape")
            request.from = ProposalRequest::From::Shape;
        else
            return fail("bad-value", "\"from\" must be one of \"auto\", \"skeleton\", \"shape\".");
    }
    if (const Json* value = find(arguments, "least")) {
        const auto least = numberWithin(*value, "least", 0.0, 1.0);
        if (!least) return tl::unexpected(least.error());
        request.least = *least;
    }
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

Result<Proposal> proposeFor(const CharacterSource& character, const ProposalRequest& request, const Progress& progress) {
    using From = ProposalRequest::From;
    if (character.rig && request.from != From::Shape) {
        std::optional<std::vector<int>> chosen;
        if (request.bones) {
            chosen.emplace();
            for (const std::string& name : *request.bones) {
                chosen->push_back(character.rig->boneIndex(name));
                if (chosen->back() < 0) return fail("no-such-bone", "The skeleton of \"" + character.name + "\" has no bone \"" + name + "\".");
            }
        }
        auto proposal = proposeFromRig(*character.rig, character.model->mesh.body, character.body->mesh, request.least < 0.0 ? std::nullopt : std::optional(request.least), progress, chosen);
        // A skeleton that divides nothing is no reason to leave a shape whole.
        if (!proposal || !proposal->cuts.empty() || request.from == From::Skeleton) return proposal;
    }
    if (request.from == From::Skeleton)
        return fail("no-skeleton", "The character \"" + character.name + "\" came without a skeleton: import one, or propose from its \"shape\".");
    return proposeFromShape(character.body->mesh, request.least < 0.0 ? kLeastShare : request.least, progress);
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
    char text[200];
    if (doubt->unit.empty()) {
        std::snprintf(text, sizeof text, "It is %.3g m large. That is hardly meant: scale it in a modelling program.", doubt->size);
    } else {
        answer["suggested_unit"] = doubt->unit;
        std::snprintf(text, sizeof text, "It is %.3g m large. That is hardly meant: with \"unit\": \"%s\" it is %.3g m.", doubt->size, doubt->unit.c_str(), doubt->meant);
    }
    answer["note"] = text;
    return answer;
}

void addProposalCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addAction("propose",
                       "Proposes cuts, bones and pins for a character, from the skeleton of its file or from its shape: limbs are cut where they leave the trunk and divided by their length, a shape "
                       "that mirrors itself gets a proposal that does. All cuts were tried together. Changes nothing; make-soft does what is proposed.",
                       {{"character", Type::Text, true, "The character."},
                        {"from", Type::Text, false, "\"skeleton\", \"shape\", or \"auto\": the skeleton where the file brought one (unless given)."},
                        {"least", Type::Number, false, "The smallest share of the flesh of a piece, 0 to 1 (0.0005 for shapes; 0.01 for skeletons, or more where that would make many pieces); what is smaller stays with its neighbour."},
                        {"bones", Type::Array, false, "Names of the bones of the file's skeleton that stay; all others are merged into them (those that move enough flesh stay unless given)."}},
                       propose);
}

}  // namespace imomushi
