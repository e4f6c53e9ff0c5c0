// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/character_repair.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/document/character_cuts.h"
#include "core/document/command_support.h"
#include "core/document/names.h"

namespace imomushi {

namespace {

using Actions = std::vector<RepairAction>;

/// What only making a body says: it is said anew with each body.
constexpr std::array<std::string_view, 15> kOfBody{"differs", "parted", "untangled", "wrapped", "closed-gap", "united", "inside", "linked", "link-refused", "attached", "open-part", "inner-wall", "components", "self-intersection", "flat"};

bool isOfBody(const MeshIssue& issue) { return std::find(kOfBody.begin(), kOfBody.end(), issue.code) != kOfBody.end(); }

bool contains(const Actions& actions, RepairAction action) { return std::find(actions.begin(), actions.end(), action) != actions.end(); }

void addOnce(Actions& actions, RepairAction action) {
    if (!contains(actions, action)) actions.push_back(action);
}

bool hasCode(const std::vector<MeshIssue>& issues, std::string_view code) {
    return std::any_of(issues.begin(), issues.end(), [&](const MeshIssue& i) { return i.code == code; });
}

/// What is left to mend, or to know.
std::vector<MeshIssue> unmended(const std::vector<MeshIssue>& issues) {
    std::vector<MeshIssue> left;
    std::copy_if(issues.begin(), issues.end(), std::back_inserter(left), [](const MeshIssue& i) { return !i.fixed; });
    return left;
}

/// The steps that mend what is not mended.
Actions wantedFor(const std::vector<MeshIssue>& issues) {
    Actions wanted;
    for (const MeshIssue& issue : issues)
        if (const auto action = repairFor(issue.code); action && !issue.fixed) addOnce(wanted, *action);
    std::sort(wanted.begin(), wanted.end());
    return wanted;
}

/// The steps that mended what is mended.
Actions stepsDone(const std::vector<MeshIssue>& issues) {
    Actions done;
    for (const MeshIssue& issue : issues)
        if (const auto action = repairFor(issue.code); action && issue.fixed && *action != RepairAction::Wrap) addOnce(done, *action);
    return done;
}

/// Whether an issue is left that another step would mend.
bool wantsMore(const std::vector<MeshIssue>& left, const Actions& done) {
    return std::any_of(left.begin(), left.end(), [&](const MeshIssue& issue) {
        const auto action = repairFor(issue.code);
        return action && *action != RepairAction::Wrap && !contains(done, *action);
    });
}

/// An issue of making a body, without its places where these are not of the render model.
MeshIssue onModel(MeshIssue issue, const TriangleMesh& model) {
    const auto within = [](const std::vector<std::int32_t>& places, Eigen::Index count) {
        return std::all_of(places.begin(), places.end(), [&](std::int32_t i) { return i >= 0 && i < count; });
    };
    if (!within(issue.triangles, model.triangles.rows())) issue.triangles.clear();
    if (!within(issue.vertices, model.vertices.rows())) issue.vertices.clear();
    return issue;
}

/// The issues after steps that leave others.
std::vector<MeshIssue> issuesAfter(const std::vector<MeshIssue>& before, const SurfaceReport& surface) {
    std::vector<MeshIssue> after;
    for (const MeshIssue& issue : before)
        if (issue.fixed || !repairFor(issue.code)) after.push_back(issue);
    for (const MeshIssue& issue : surface.done)
        if (!hasCode(after, issue.code)) after.push_back(issue);
    for (const MeshIssue& issue : surface.left)
        if (repairFor(issue.code)) after.push_back(issue);
    return after;
}

/// Whether a wrap would be another body, or would mend anything.
bool wrapsAnew(const CharacterSource& character, const MendRequest& request) {
    const BodyReport& report = character.body->report;
    return report.how != BodyKind::Wrapped || (request.detail > 0.0 && request.detail != report.detail) || !wantedFor(character.issues).empty();
}

/// What a request comes to.
struct MendPlan {
    Actions steps;           ///< that somebody needs; none: there is nothing to do
    Actions unneeded;
    Actions done;            ///< with those that were done before, without a wrap
    bool chosen = false;     ///< these steps and no others
    bool wraps = false;      ///< at once, on purpose
    bool mendsFirst = true;  ///< a wrap is the last thing that is tried
    double detail = 0.0;
};

MendPlan planFor(const CharacterSource& character, const MendRequest& request) {
    MendPlan plan;
    const Actions asked = wantedFor(character.issues);
    const Actions wanted = request.actions.value_or(asked);
    plan.chosen = request.actions.has_value();
    plan.detail = request.detail;
    plan.wraps = plan.chosen && contains(wanted, RepairAction::Wrap) && wrapsAnew(character, request);
    plan.done = stepsDone(character.issues);
    for (const RepairAction action : wanted) {
        if (!contains(asked, action) && !(action == RepairAction::Wrap && plan.wraps)) {
            plan.unneeded.push_back(action);
            continue;
        }
        addOnce(plan.steps, action);
        if (action != RepairAction::Wrap) addOnce(plan.done, action);
    }
    // A body that was mended already comes out the same.
    plan.mendsFirst = !plan.wraps && (plan.steps != Actions{RepairAction::Wrap} || character.body->report.how != BodyKind::Mended);
    return plan;
}

struct Mending {
    std::optional<Body> body;  ///< none: another step is wanted first
    SurfaceReport surface;     ///< without a body
};

Result<Mending> mend(const RenderModel& model, const Rig* rig, const MendPlan& plan, const BodyMaker& maker, const Progress& progress) {
    Mending out;
    if (plan.chosen && !plan.wraps) {
        IMOMUSHI_TRY(out.surface, examineSurface(model.mesh.body, model.part, plan.done));
        if (progress.cancelled()) return fail(kCancelled, "Cancelled.");
        if (wantsMore(out.surface.left, plan.done)) return out;
    }
    Result<Body> body = fail("no-volume", "");
    if (plan.mendsFirst) body = maker(model, rig, {}, progress.part(0.0, 0.3));
    const bool crosses = body && hasCode(body->report.issues, "self-intersection");
    if (!plan.mendsFirst || (crosses && contains(plan.steps, RepairAction::Wrap))) body = maker(model, rig, {BodyKind::Wrapped, plan.detail}, progress.part(0.3, 0.95));
    if (!body) return tl::unexpected(body.error());
    body->report.seconds = 0.0;  // the rest of the report is the same each time
    out.body = std::move(*body);
    return out;
}

/// An element by itself with its issues as they are, places on its mesh, as a character of `document`; 0: there is nothing to mend.
PartId wholeOf(Document& document, PartId id, const MendRequest& request, MendReport& report) {
    const Element& element = *document.elements.at(id);
    std::vector<MeshIssue> issues;
    for (const MeshIssue& issue : element.issues)
        if (issue.fixed) issues.push_back(issue);
    for (MeshIssue& issue : checkMesh(element.mesh->body)) issues.push_back(std::move(issue));
    const Actions asked = wantedFor(issues), wanted = request.actions.value_or(asked);
    if (std::none_of(wanted.begin(), wanted.end(), [&](RepairAction a) { return a == RepairAction::Wrap || contains(asked, a); })) {
        report.before = report.after = unmended(issues);
        report.unneeded = wanted;
        return 0;
    }
    const std::string wish = element.name;
    const PartId character = makeCharacter(document, id, {});
    const std::string name = freeName(document, wish);
    exchangePart(document.characters, character, [&](CharacterSource& made) {
        made.name = name;
        made.issues = std::move(issues);
    });
    return character;
}

}  // namespace

std::vector<MeshIssue> issuesWith(const std::vector<MeshIssue>& before, const RenderModel& model, std::vector<MeshIssue> ofBody) {
    std::vector<MeshIssue> issues;
    for (const MeshIssue& issue : before)
        if (!isOfBody(issue) && (issue.fixed || !repairFor(issue.code)) && !hasCode(ofBody, issue.code)) issues.push_back(issue);
    for (MeshIssue& issue : ofBody) issues.push_back(onModel(std::move(issue), model.mesh.body));
    return issues;
}

std::vector<MeshIssue> mendableIssues(const RenderModel& model) {
    auto seen = examineSurface(model.mesh.body, model.part);
    if (!seen) return {};
    const bool any = std::any_of(seen->found.begin(), seen->found.end(), [](const MeshIssue& i) { return i.severity != Severity::Info && repairFor(i.code); });
    return any ? std::move(seen->found) : std::vector<MeshIssue>();
}

Result<MendReport> mendCharacter(Document& document, PartId id, const MendRequest& request, const BodyMaker& maker, const Progress& progress) {
    const CharacterSource character = *document.characters.at(id);  // shares model and body
    MendReport report;
    report.character = id;
    report.before = report.after = unmended(character.issues);
    MendPlan plan = planFor(character, request);
    report.unneeded = std::move(plan.unneeded);
    if (plan.steps.empty()) return report;
    IMOMUSHI_TRY(auto mending, mend(*character.model, character.rig.get(), plan, maker, progress));

    std::vector<MeshIssue> issues;
    if (!mending.body) {  // the wrap stays until nothing is left
        for (const MeshIssue& issue : mending.surface.done)
            if (!std::any_of(character.issues.begin(), character.issues.end(), [&](const MeshIssue& i) { return i.fixed && i.code == issue.code; })) report.done.push_back(issue);
        issues = issuesAfter(character.issues, mending.surface);
    } else {
        BodyReport& made = mending.body->report;
        std::vector<MeshIssue> said = std::exchange(made.issues, {});
        if (made.how == BodyKind::Wrapped && !hasCode(said, "wrapped")) said.push_back({Severity::Info, "wrapped", "A new surface around everything was made.", 1, true, {}, {}});
        std::copy_if(said.begin(), said.end(), std::back_inserter(report.done), [](const MeshIssue& i) { return i.fixed; });
        IMOMUSHI_TRY(report.changed, changeBody(document, id, std::make_shared<const Body>(std::move(*mending.body)), progress));
        issues = issuesWith(character.issues, *character.model, std::move(said));
    }
    report.after = unmended(issues);
    exchangePart(document.characters, id, [&](CharacterSource& changed) { changed.issues = std::move(issues); });
    return report;
}

Result<MendReport> mendElement(Document& document, PartId id, const MendRequest& request, const BodyMaker& maker, const Progress& progress) {
    const auto& piece = document.elements.at(id)->piece;
    if (piece) return mendCharacter(document, piece->character, request, maker, progress);
    MendReport report;
    const PartId character = wholeOf(document, id, request, report);
    if (character == 0) return report;
    return mendCharacter(document, character, request, maker, progress);
}

Result<MendRequest> mendRequestFrom(const Json& arguments) {
    MendRequest request;
    if (const Json* given = find(arguments, "actions")) {
        Actions& actions = request.actions.emplace();
        for (const Json& name : *given) {
            const auto action = name.is_string() ? repairActionOf(name.get_ref<const std::string&>()) : std::nullopt;
            if (!action) return fail("bad-value", "There is no action " + name.dump() + ": \"actions\" is a list of \"weld\", \"drop\", \"separate\", \"orient\", \"fill\" and \"wrap\".");
            addOnce(actions, *action);
        }
        if (actions.empty()) return fail("bad-value", "\"actions\" is empty: leave it out for all that mend the issues there are.");
    }
    if (const Json* value = find(arguments, "detail")) {
        IMOMUSHI_TRY(const auto detail, numberWithin(*value, "detail", kFinestDetail, kCoarsestDetail));
        if (!request.actions || !contains(*request.actions, RepairAction::Wrap)) return fail("bad-value", "\"detail\" is that of a wrap: add \"wrap\" to \"actions\".");
        request.detail = detail;
    }
    return request;
}

Result<MendWork> mendWork(const Document& document, const Json& repair) {
    IMOMUSHI_TRY(const auto request, mendRequestFrom(repair));
    Document copy = document;  // shares all parts
    const std::string& target = text(repair, "element");
    PartId id = 0;
    if (const CharacterSource* whole = copy.characterNamed(target)) {
        id = whole->id;
    } else {
        IMOMUSHI_TRY(const auto element, elementOf(copy, target));
        MendReport report;
        id = element->piece ? element->piece->character : wholeOf(copy, element->id, request, report);
    }
    if (id == 0) return MendWork([](const BodyMaker&, const Progress&) {});
    const CharacterSource& character = *copy.characters.at(id);
    return MendWork([model = character.model, rig = character.rig, plan = planFor(character, request)](const BodyMaker& maker, const Progress& progress) {
        if (!plan.steps.empty()) (void)mend(*model, rig.get(), plan, maker, progress);  // what goes wrong, goes wrong again when the command asks
    });
}

}  // namespace imomushi
