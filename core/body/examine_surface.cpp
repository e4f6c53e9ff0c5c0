// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "core/body/prepared_surface.h"
#include "core/body/repair.h"

namespace imomushi {
namespace {

constexpr std::size_t kMostPlaces = 1000;  // that an issue shows

bool hasStep(std::span<const RepairAction> steps, RepairAction action) { return std::find(steps.begin(), steps.end(), action) != steps.end(); }

const MeshIssue* withCode(const std::vector<MeshIssue>& issues, std::string_view code) {
    const auto it = std::find_if(issues.begin(), issues.end(), [&](const MeshIssue& i) { return i.code == code; });
    return it == issues.end() ? nullptr : &*it;
}

std::vector<std::int32_t> firstPlaces(std::vector<std::int32_t> places) {
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    if (places.size() > kMostPlaces) places.resize(kMostPlaces);
    return places;
}

MeshIssue flaw(Severity severity, const char* code, std::string text, std::size_t count) {
    return {severity, code, std::move(text), static_cast<int>(count), false, {}, {}};
}

/// checkMesh() of the surface, with the places of the mesh that it was made of.
std::vector<MeshIssue> checkSurface(const MendSurface& s) {
    std::vector<std::int32_t> number(static_cast<std::size_t>(s.points.rows()), -1), used;
    for (const MendFace& f : s.faces)
        for (const std::int32_t v : f.v) number[at(v)] = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] < 0) continue;
        number[v] = static_cast<std::int32_t>(used.size());
        used.push_back(static_cast<std::int32_t>(v));
    }
    TriangleMesh mesh{s.points(used, Eigen::all), s.triangles()};
    for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) mesh.triangles.data()[i] = number[at(mesh.triangles.data()[i])];
    std::vector<MeshIssue> issues = checkMesh(mesh);
    for (MeshIssue& issue : issues) {
        issue.severity = std::min(issue.severity, Severity::Warning);
        for (std::int32_t& f : issue.triangles) f = s.faces[at(f)].source;
        std::erase(issue.triangles, -1);
        for (std::int32_t& v : issue.vertices) v = used[at(v)];
        if (!issue.vertices.empty() && issue.triangles.empty()) {  // what is shown are triangles
            const std::vector<std::int32_t>& near = issue.vertices;
            for (const MendFace& f : s.faces)
                if (f.source >= 0 && std::any_of(f.v.begin(), f.v.end(), [&](std::int32_t v) { return std::binary_search(near.begin(), near.end(), v); }))
                    issue.triangles.push_back(f.source);
        }
        issue.triangles = firstPlaces(std::move(issue.triangles));
        std::erase_if(issue.vertices, [&](std::int32_t v) { return at(v) >= number.size(); });
    }
    return issues;
}

}  // namespace

void placeIssues(std::vector<MeshIssue>& issues, const std::vector<MeshIssue>& found) {
    for (MeshIssue& issue : issues) {
        const MeshIssue* place = withCode(found, issue.code);
        if (!place || !issue.triangles.empty() || !issue.vertices.empty()) continue;
        issue.triangles = place->triangles;
        issue.vertices = place->vertices;
    }
}

Result<SurfaceReport> examineSurface(const TriangleMesh& mesh, std::span<const std::int32_t> part, std::span<const RepairAction> steps) {
    if (auto ok = checkTriangles(mesh, part); !ok) return tl::unexpected(ok.error());
    SurfaceReport out;
    MendSurface s(rawSurface(mesh, part));
    dropUnused(s);
    for (MeshIssue& issue : s.issues) {  // unused vertices; nothing else is said yet
        MeshIssue& seen = out.found.emplace_back(flaw(Severity::Info, "unused-vertex", counted(static_cast<std::size_t>(issue.count), "vertex belongs", "vertices belong") + " to no triangle.",
                                                      static_cast<std::size_t>(issue.count)));
        std::vector<char> used(static_cast<std::size_t>(mesh.vertices.rows()), 0);
        for (Eigen::Index i = 0; i < mesh.triangles.size(); ++i) used[at(mesh.triangles.data()[i])] = 1;
        for (std::size_t v = 0; v < used.size() && seen.vertices.size() < kMostPlaces; ++v)
            if (!used[v]) seen.vertices.push_back(static_cast<std::int32_t>(v));
    }
    std::vector<std::int32_t> collapsed;
    for (const MendFace& f : s.faces)
        if (f.v[0] == f.v[1] || f.v[1] == f.v[2] || f.v[2] == f.v[0]) collapsed.push_back(f.source);
    s.dropCollapsed();

    weldVertices(s);
    std::vector<std::int32_t> seams;
    std::size_t merged = 0;
    for (const MeshIssue& issue : s.issues)
        if (issue.code == "unwelded") merged += static_cast<std::size_t>(issue.count);
    for (const MendFace& f : s.faces)
        if (merged > 0 && f.v != f.r) seams.push_back(f.source);  // as the file has them: no step has turned a triangle yet
    if (merged > 0) {
        out.found.push_back(flaw(Severity::Warning, "unwelded", counted(merged, "vertex lies", "vertices lie") + " at the same place as others.", merged));
        out.found.back().triangles = firstPlaces(std::move(seams));
    }
    if (s.faces.empty()) {
        out.left = out.found;
        return out;
    }
    std::vector<MeshIssue> checked = checkSurface(s);
    if (!collapsed.empty()) {
        const MeshIssue* flat = withCode(checked, "degenerate");
        const std::size_t all = collapsed.size() + (flat ? static_cast<std::size_t>(flat->count) : 0);
        if (flat) collapsed.insert(collapsed.end(), flat->triangles.begin(), flat->triangles.end());
        std::erase_if(checked, [](const MeshIssue& i) { return i.code == "degenerate"; });
        checked.insert(checked.begin(), flaw(Severity::Warning, "degenerate", counted(all, "triangle has", "triangles have") + " no area.", all));
        checked.front().triangles = firstPlaces(std::move(collapsed));
    }
    out.found.insert(out.found.end(), std::make_move_iterator(checked.begin()), std::make_move_iterator(checked.end()));
    if (steps.empty()) {
        out.left = out.found;
        return out;
    }

    // Welded it is in any case: other issues could not be told from seams.
    const bool drops = hasStep(steps, RepairAction::Drop), welds = hasStep(steps, RepairAction::Weld);
    if (drops) dropUseless(s);
    if (hasStep(steps, RepairAction::Separate)) separateNonManifold(s);
    if (hasStep(steps, RepairAction::Orient)) orientSurface(s);
    if (hasStep(steps, RepairAction::Fill)) {
        capHoles(s);
        closeHoles(s);
    }
    for (const MeshIssue& issue : out.found)
        if ((issue.code == "unwelded" && !welds) || (issue.code == "unused-vertex" && !drops)) out.left.push_back(issue);
    if (!s.faces.empty())
        for (MeshIssue& issue : checkSurface(s)) out.left.push_back(std::move(issue));
    if (const MeshIssue* flat = withCode(out.found, "degenerate"); flat && !drops && !withCode(out.left, "degenerate")) out.left.push_back(*flat);
    // A surface with one side stays wound against itself.
    if (const MeshIssue* oneSided = withCode(s.issues, "non-orientable"))
        for (MeshIssue& issue : out.left)
            if (issue.code == "mixed-winding") issue.code = oneSided->code, issue.text = oneSided->text;
    for (MeshIssue& issue : s.issues)
        if (issue.fixed && !(issue.code == "unwelded" && !welds) && !(issue.code == "unused-vertex" && !drops)) out.done.push_back(std::move(issue));
    placeIssues(out.done, out.found);
    return out;
}

}  // namespace imomushi
