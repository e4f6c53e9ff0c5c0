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
    return request;
}

Result<Proposal> proposeFor(const CharacterSource& character, const ProposalRequest& request, const Progress& progress) {
    using From = ProposalRequest::From;
    if (character.rig && request.from != From::Shape) {
        auto proposal = proposeFromRig(*character.rig, character.model->mesh.body, character.body->mesh, request.least < 0.0 ? std::nullopt : std::optional(request.least), progress);
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

Json sizeJson(const CharacterSource& character) {
    const Bounds box = boundsOf(character.model->mesh.body.vertices);
    const double size = box.size().maxCoeff();
    Json answer{{"height", box.size().y()}, {"diagonal", box.diagonal()}};
    if (size >= kSmallestMeant && size <= kLargestMeant) return answer;
    char text[200];
    for (const auto& [unit, metres] : {std::pair("cm", 0.01), std::pair("mm", 0.001)}) {
        const double then = size * metres;
        if (then < kSmallestUsual || then > kLargestUsual) continue;
        answer["suggested_unit"] = unit;
        std::snprintf(text, sizeof text, "It is %.3g m large. That is hardly meant: with \"unit\": \"%s\" it is %.3g m.", size, unit, then);
        answer["note"] = text;
        return answer;
    }
    std::snprintf(text, sizeof text, "It is %.3g m large. That is hardly meant: scale it in a modelling program.", size);
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
                        {"least", Type::Number, false, "The smallest share of the flesh of a piece, 0 to 1 (0.0005 for shapes; 0.01 for skeletons, or more where that would make many pieces); what is smaller stays with its neighbour."}},
                       propose);
}

}  // namespace imomushi
