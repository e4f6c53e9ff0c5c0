// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/body/body.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <locale>
#include <optional>
#include <sstream>
#include <utility>

#include "core/base/finite.h"
#include "core/base/formatted.h"
#include "core/base/index.h"
#include "core/base/try.h"
#include "core/body/body_codec.h"
#include "core/body/cgal/rays.h"
#include "core/body/cgal/untangle.h"
#include "core/body/mended_body.h"
#include "core/body/parted.h"
#include "core/body/prepared_surface.h"
#include "core/body/repair.h"
#include "core/body/wrapped_body.h"
#include "core/mesh/bounds.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_tree.h"
#include "core/mesh/weld.h"
#include "core/mesh/winding_tree.h"
#include "core/worker/worker.h"

namespace imomushi {
namespace {

/// What an artist is told of: distance of the vertices from the body in diagonals, root mean square; error of the volume.
constexpr double kFarOff = 0.02, kMuchLost = 0.05;
/// What lies so deep in the flesh of a mended body, in diagonals, is not seen.
constexpr double kBuried = 1e-3;

Result<void> checkSetting(const BodySetting& setting) {
    if (setting.detail != 0.0 && !(isFinite(setting.detail) && setting.detail >= kFinestDetail && setting.detail <= kCoarsestDetail))
        return fail("bad-detail", "The detail of a body must be between 0.001 and 0.2 diagonals, or 0 for one that is chosen from the mesh.");
    return {};
}

/// What every body must be. Where it crosses itself, that is said in its report, without the places.
bool sound(Body& body) {
    if (!allFinite(body.mesh.vertices)) return false;
    const MeshFacts facts = meshFacts(body.mesh);
    body.report.components = facts.components;
    if (!facts.closed || !facts.outward) return false;
    for (MeshIssue& issue : checkMesh(body.mesh)) {
        if (issue.severity == Severity::Error) return false;
        if (issue.code != "self-intersection") continue;
        issue.triangles.clear();
        body.report.issues.push_back(std::move(issue));
    }
    return true;
}

/// How far what is seen is from the body. What lies in the flesh of other parts nobody sees: of a mended body in its own, of a wrapped one, which fills gaps as well, in that of the mesh that it was made of.
void measureDistance(const TriangleMesh& render, const TriangleMesh& flesh, Body& body) {
    const double diagonal = diagonalOf(body.mesh.vertices);
    const TriangleTree tree(body.mesh);
    std::optional<RayTree> rays;
    std::optional<WindingTree> winding;
    Points normals;
    const auto buried = [&](std::size_t v, const Vec3& place) {
        if (body.report.how != BodyKind::Wrapped) {
            if (!rays) rays.emplace(body.mesh);
            return rays->inside(place);
        }
        if (!winding) {
            winding.emplace(flesh);
            normals = vertexNormals(render);
        }
        const Vec3 aside = kBuried * diagonal * normals.row(static_cast<Eigen::Index>(v)).transpose();
        return std::abs(winding->at(place + aside)) > 0.5 && std::abs(winding->at(place - aside)) > 0.5;
    };
    std::vector<char> used(static_cast<std::size_t>(render.vertices.rows()), 0);
    for (Eigen::Index i = 0; i < render.triangles.size(); ++i) used[at(render.triangles.data()[i])] = 1;
    double sum = 0.0, largest = 0.0;
    std::size_t count = 0;
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (!used[v]) continue;
        double distance = 0.0;
        if (body.bodyVertex[v] < 0) {  // else welded there
            const Vec3 place = render.vertices.row(static_cast<Eigen::Index>(v));
            distance = std::sqrt(tree.nearest(place).squaredDistance) / diagonal;
            if (distance > kBuried && buried(v, place)) continue;
        }
        ++count;
        sum += distance * distance;
        largest = std::max(largest, distance);
    }
    body.report.distanceRms = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
    body.report.distanceLargest = largest;
}

/// The body that mending alone gives.
struct Mended {
    Body body;
    bool exact = false;
};

bool crossesItself(const Body& body) {
    return std::any_of(body.report.issues.begin(), body.report.issues.end(), [](const MeshIssue& issue) { return issue.code == "self-intersection"; });
}

/// A body with another surface instead of one that crosses itself, where that does not and hangs together in as many parts.
std::optional<Body> withSurface(const Body& body, std::optional<TriangleMesh> mesh) {
    if (!mesh || meshFacts(*mesh).components != meshFacts(body.mesh).components) return std::nullopt;
    Body out;
    out.report = body.report;
    std::erase_if(out.report.issues, [](const MeshIssue& issue) { return issue.code == "self-intersection"; });
    out.mesh = std::move(*mesh);
    if (!sound(out) || crossesItself(out)) return std::nullopt;
    const std::vector<std::int32_t> now = samePlaces(body.mesh.vertices, out.mesh.vertices);  // those that stay keep their coordinates
    const auto lost = static_cast<std::size_t>(std::count(now.begin(), now.end(), -1));
    for (const std::int32_t v : body.bodyVertex) out.bodyVertex.push_back(v < 0 ? -1 : now[at(v)]);
    out.report.issues.push_back({Severity::Info, "untangled", "The surface crosses itself: around " + counted(lost, "vertex", "vertices") + " the body has other triangles, which do not.",
                                 static_cast<int>(lost), true, {}, {}});
    return out;
}

/// The same body where its surface touches itself, with a little room there. None where it does not, or where that makes it cross itself.
std::optional<Body> withoutTouching(const Body& body) {
    Body out;
    out.mesh = body.mesh;
    const std::vector<std::int32_t> moved = partTouching(out.mesh);
    if (moved.empty()) return std::nullopt;
    out.report = body.report;
    std::erase_if(out.report.issues, [](const MeshIssue& issue) { return issue.code == "self-intersection"; });
    if (!sound(out) || crossesItself(out)) return std::nullopt;
    for (const std::int32_t v : body.bodyVertex) out.bodyVertex.push_back(std::ranges::binary_search(moved, v) ? -1 : v);
    out.report.issues.push_back({Severity::Info, "parted", counted(moved.size(), "vertex of the body that touched its surface elsewhere was", "vertices of the body that touched its surface elsewhere were") + " moved a little away from it.",
                                 static_cast<int>(moved.size()), true, {}, {}});
    return out;
}

/// The same body without its crossings: other triangles around them, or else, where flesh overlaps, its outer side alone.
std::optional<Body> withoutCrossings(const Body& body) {
    {
        const Attempt untangling("the crossings of a surface with itself");
        if (untangling)
            if (auto out = withSurface(body, untangled(body.mesh))) return out;
    }
    const Attempt splitting("the outer side of a surface that crosses itself");
    if (!splitting) return std::nullopt;
    auto outer = outerSide(body.mesh);
    if (!outer) return std::nullopt;
    const TriangleMesh clean = separated(tidied(*outer));
    if (auto out = withSurface(body, clean)) return out;
    return withSurface(body, untangled(clean));  // what rounding left
}

Result<Mended> mend(const TriangleMesh& render, const BodyBones& bones, const PreparedSurface& prepared, const BodySetting& setting, bool carry, const Progress& progress) {
    BodyBones moved;
    if (!bones.bone.empty()) {
        moved.parent = bones.parent;
        moved.bone.assign(static_cast<std::size_t>(prepared.mesh.vertices.rows()), -1);
        for (std::size_t r = prepared.vertexOf.size(); r-- > 0;)  // of several at one place the first
            if (prepared.vertexOf[r] >= 0 && bones.bone[r] >= 0) moved.bone[at(prepared.vertexOf[r])] = bones.bone[r];
    }
    IMOMUSHI_TRY(auto surface, mendedBody(prepared, moved, setting.links, carry, progress));
    Mended out;
    out.body.mesh = std::move(surface.mesh);
    if (!sound(out.body))
        return fail("not-mendable", "The mesh cannot be closed as it is: mending leaves flaws; choose a wrapped body, or close it in a modelling program.");
    out.body.bodyVertex.assign(prepared.vertexOf.size(), -1);
    for (std::size_t r = 0; r < prepared.vertexOf.size(); ++r)
        if (prepared.vertexOf[r] >= 0) out.body.bodyVertex[r] = surface.vertexOf[at(prepared.vertexOf[r])];
    out.exact = prepared.sameShape && surface.whole;
    for (Eigen::Index i = 0; out.exact && i < render.triangles.size(); ++i) out.exact = out.body.bodyVertex[at(render.triangles.data()[i])] >= 0;
    const auto take = [&](std::optional<Body> body) {
        if (!body) return;
        out.body = std::move(*body);
        out.exact = false;
    };
    take(withoutTouching(out.body));
    if (crossesItself(out.body)) {
        take(withoutCrossings(out.body));
        if (!crossesItself(out.body)) take(withoutTouching(out.body));
    }
    out.body.report.how = out.exact ? BodyKind::Exact : BodyKind::Mended;
    auto& issues = out.body.report.issues;
    issues.insert(issues.begin(), std::make_move_iterator(surface.issues.begin()), std::make_move_iterator(surface.issues.end()));
    if (prepared.sameShape) {
        double flesh = meshFacts(out.body.mesh).volume;
        for (const FleshLink& link : surface.links) flesh -= link.volume;
        out.body.report.volumeError = surface.volumeLeftOut / (surface.volumeLeftOut + flesh);
    }
    out.body.report.links = std::move(surface.links);
    return out;
}

Result<Body> wrap(const PreparedSurface& prepared, double detail, double volume, const Progress& progress) {
    IMOMUSHI_TRY(auto surface, wrappedBody(prepared.mesh, detail, volume, progress));
    Body body;
    body.mesh = std::move(surface.mesh);
    if (!sound(body))
        return fail("no-volume", "No closed surface with a volume can be made of this mesh: give it thickness or close it in a modelling program.");
    body.bodyVertex.assign(prepared.vertexOf.size(), -1);
    body.report.how = BodyKind::Wrapped;
    body.report.detail = surface.detail;
    body.report.gaps = std::move(surface.gaps);
    if (const ClosedGaps& gaps = body.report.gaps; gaps.area > 0.0) {
        std::ostringstream text;
        text.imbue(std::locale::classic());
        text << "Gaps of up to " << std::setprecision(2) << 100.0 * gaps.widest << " % of the size were closed in " << counted(gaps.places.size(), "place", "places")
             << ": what lies on their two sides moves as one; choose a finer detail to keep them open.";
        body.report.issues.push_back({Severity::Warning, "closed-gap", text.str(), static_cast<int>(gaps.places.size()), false, {}, {}});
    }
    if (volume > 0.0) body.report.volumeError = std::abs(meshFacts(body.mesh).volume / volume - 1.0);
    return body;
}

}  // namespace

std::string_view nameOf(BodyKind how) {
    switch (how) {
        case BodyKind::Auto: return "auto";
        case BodyKind::Exact: return "exact";
        case BodyKind::Mended: return "mended";
        case BodyKind::Wrapped: return "wrapped";
    }
    return "";
}

namespace {

Result<Body> makeBodyHere(const TriangleMesh& render, const std::vector<std::int32_t>& part, const BodyBones& bones, const BodySetting& setting, const Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    if (auto ok = checkSetting(setting); !ok) return tl::unexpected(ok.error());
    if (auto ok = checkTriangles(render, part); !ok) return tl::unexpected(ok.error());
    if (!bones.bone.empty() && bones.bone.size() != static_cast<std::size_t>(render.vertices.rows())) return fail("bad-index", "The skin of the mesh belongs to other vertices: export the mesh again.");
    progress.report("mend", 0.0);
    const PreparedSurface prepared = prepareSurface(render, part);
    if (prepared.mesh.triangles.rows() == 0) return fail("no-volume", "The mesh has no triangle with an area: choose a file with a mesh.");
    if (progress.cancelled()) return fail(kCancelled, "Cancelled.");

    auto mended = mend(render, bones, prepared, setting, true, progress.part(0.1, 0.2));
    if (!mended && mended.error().code == kCancelled) return tl::unexpected(mended.error());
    // Measures the body, and what may take its place. A mended body that crosses itself cannot be solved everywhere, one that lost flesh is not the mesh, and one in pieces falls apart: one that carries no parts takes its place, or else
    // a wrap, where it does none of this, or less.
    const auto fits = [](const Body& body) { return !crossesItself(body) && body.report.distanceRms <= kFarOff && body.report.volumeError <= kMuchLost; };
    const auto replaceWhatFails = [&](Body& body) {
        measureDistance(render, prepared.mesh, body);
        const bool fitting = fits(body);
        const bool pieces = std::ranges::any_of(body.report.issues, [](const MeshIssue& issue) { return issue.code == "components"; });  // a cavity is a surface of its own, too
        if (fitting && !pieces) return;
        const int most = body.report.components - (fitting ? 1 : 0);  // what fits but is in pieces is left for what is in fewer
        if (auto whole = mend(render, bones, prepared, setting, false, progress.part(0.15, 0.2))) {
            measureDistance(render, prepared.mesh, whole->body);
            if (fits(whole->body) && whole->body.report.components <= most) {
                body = std::move(whole->body);
                return;
            }
        }
        const bool crosses = crossesItself(body);
        const double flesh = meshFacts(body.mesh).volume / (1.0 - std::clamp(body.report.volumeError, 0.0, 0.9));  // nothing is known to be lost where that is negative
        auto other = wrap(prepared, setting.detail, flesh, progress.part(0.2, 0.95));
        if (!other) return;
        measureDistance(render, prepared.mesh, *other);
        const bool nearer = other->report.distanceRms < body.report.distanceRms && other->report.volumeError <= std::max(kMuchLost, body.report.volumeError);
        const bool better = fits(*other) || (!fitting && !crossesItself(*other) && (crosses || nearer));
        if (!better || other->report.components > most) return;
        const std::string why = crosses ? "cross itself" : fitting ? "fall into pieces" : "lose too much of it";
        other->report.issues.push_back({Severity::Info, "wrapped", "A body of the mesh itself would " + why + ": a new surface around everything was made.", 1, true, {}, {}});
        body = std::move(*other);
    };
    Result<Body> body = fail("no-volume", "");
    if (setting.how == BodyKind::Exact && !(mended && mended->exact)) {
        return fail("not-exact", mended ? "The mesh had to be mended to be a body: choose \"mended\" or \"auto\"." : mended.error().message);
    } else if (setting.how == BodyKind::Mended && !mended) {
        return tl::unexpected(mended.error());
    } else if (mended && setting.how != BodyKind::Wrapped) {
        body = std::move(mended->body);
        if (setting.how == BodyKind::Auto)
            replaceWhatFails(*body);
        else
            measureDistance(render, prepared.mesh, *body);
    } else {
        body = wrap(prepared, setting.detail, mended ? meshFacts(mended->body.mesh).volume : 0.0, progress.part(0.2, 0.95));
        if (!body) return tl::unexpected(body.error());
        if (setting.how == BodyKind::Auto) body->report.issues.push_back({Severity::Info, "wrapped", "The mesh cannot be closed by mending: a new surface around everything was made.", 1, true, {}, {}});
        measureDistance(render, prepared.mesh, *body);
    }
    BodyReport& report = body->report;
    if (!prepared.sameShape) report.volumeError = -1.0;  // what a mesh with holes encloses is a guess
    report.issues.insert(report.issues.begin(), prepared.issues.begin(), prepared.issues.end());
    if (report.how == BodyKind::Wrapped)
        for (MeshIssue& issue : report.issues)
            if (issue.code == "non-orientable") {
                issue.severity = Severity::Info;
                issue.text = "The surface has only one side, like a Moebius strip: a new surface was made around it.";
                issue.fixed = true;
            }
    if (!report.issues.empty())
        if (const auto seen = examineSurface(render, part)) placeIssues(report.issues, seen->found);
    sayLeftOut(report.issues);
    if (report.distanceRms > kFarOff || report.volumeError > kMuchLost) {
        std::string text = "The body is not quite the mesh: vertices are " + formatted("%.2g", 100.0 * report.distanceRms) + " % of the size away from it (root mean square)";
        if (report.volumeError > 0.0) text += ", and its volume is off by " + formatted("%.2g", 100.0 * report.volumeError) + " %";
        report.issues.push_back({Severity::Warning, "differs", text + ": choose another way to make it, or repair the mesh.", 1, false, {}, {}});
    }
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return body;
}

const Operation<Result<Body>(TriangleMesh, std::vector<std::int32_t>, BodyBones, BodySetting)> kMakeBody("make-body", makeBodyHere);

}  // namespace

Result<Body> makeBody(const TriangleMesh& render, std::span<const std::int32_t> part, const BodySetting& setting, const Progress& progress, const BodyBones& bones) {
    return kMakeBody(render, {part.begin(), part.end()}, bones, setting, progress);
}

Result<Body> makeBody(const RenderModel& model, const Rig* rig, const BodySetting& setting, const Progress& progress) {
    BodyBones bones;
    if (!rig || rig->weights.first.size() != static_cast<std::size_t>(model.mesh.body.vertices.rows()) + 1) return makeBody(model.mesh.body, model.part, setting, progress);
    for (const RigBone& bone : rig->bones) bones.parent.push_back(bone.parent);
    for (std::size_t v = 0; v + 1 < rig->weights.first.size(); ++v) {
        std::int32_t most = -1;
        float weight = 0.0F;
        for (auto i = at(rig->weights.first[v]); i < at(rig->weights.first[v + 1]); ++i)
            if (rig->weights.weight[i] > weight) weight = rig->weights.weight[i], most = rig->weights.bone[i];
        bones.bone.push_back(most);
    }
    return makeBody(model.mesh.body, model.part, setting, progress, bones);
}

}  // namespace imomushi
