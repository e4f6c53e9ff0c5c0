// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/mend_surface.h"

#include <algorithm>
#include <utility>

namespace imomushi {

void MendFace::turn() {
    std::swap(v[1], v[2]);
    std::swap(r[1], r[2]);
    turned = !turned;
}

MendSurface::MendSurface(RawSurface raw) : points(std::move(raw.mesh.body.vertices)), renderMesh(std::move(raw.mesh.renderMesh)) {
    const Triangles& corners = raw.mesh.body.triangles;
    const bool plain = renderMesh.triangles.rows() == 0;
    faces.resize(static_cast<std::size_t>(corners.rows()));
    for (Eigen::Index f = 0; f < corners.rows(); ++f) {
        MendFace& face = faces[static_cast<std::size_t>(f)];
        face.source = static_cast<std::int32_t>(f);
        for (int k = 0; k < 3; ++k) {
            face.v[static_cast<std::size_t>(k)] = corners(f, k);
            face.r[static_cast<std::size_t>(k)] = plain ? corners(f, k) : renderMesh.triangles(f, k);
        }
        if (!renderMesh.material.empty()) face.material = renderMesh.material[static_cast<std::size_t>(f)];
        if (!raw.part.empty()) face.part = raw.part[static_cast<std::size_t>(f)];
    }
    attributes = renderMesh.normals.rows() + renderMesh.texCoords.rows() + renderMesh.colors.rows() > 0;
}

Triangles MendSurface::triangles() const {
    Triangles t(static_cast<Eigen::Index>(faces.size()), 3);
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (int k = 0; k < 3; ++k) t(static_cast<Eigen::Index>(f), k) = faces[f].v[static_cast<std::size_t>(k)];
    return t;
}

void MendSurface::say(const char* code, std::string text, std::size_t count) {
    issues.push_back({Severity::Info, code, std::move(text), static_cast<int>(count), true, {}, {}});
}

void MendSurface::dropCollapsed() {
    collapsed += std::erase_if(faces, [](const MendFace& f) { return f.v[0] == f.v[1] || f.v[1] == f.v[2] || f.v[2] == f.v[0]; });
}

std::vector<char> soundComponents(const Triangles& triangles, const EdgeTable& edges, const std::vector<std::int32_t>& component, int count) {
    std::vector<char> sound(at(count), 1);
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() != 2 || uses[0].forward == uses[1].forward) sound[at(component[at(uses[0].triangle)])] = 0;
    }
    const std::vector<std::int32_t> pinched = nonManifoldVertices(triangles, edges);
    if (!pinched.empty()) {
        // Two components that only touch in a vertex pinch neither of them.
        std::vector<std::vector<std::int32_t>> own(at(count));
        for (Eigen::Index f = 0; f < triangles.rows(); ++f)
            if (std::any_of(triangles.row(f).begin(), triangles.row(f).end(),
                            [&](std::int32_t v) { return std::binary_search(pinched.begin(), pinched.end(), v); }))
                own[at(component[static_cast<std::size_t>(f)])].push_back(static_cast<std::int32_t>(f));
        for (std::size_t c = 0; c < own.size(); ++c) {
            if (own[c].empty() || !sound[c]) continue;
            Triangles part(static_cast<Eigen::Index>(own[c].size()), 3);
            for (std::size_t i = 0; i < own[c].size(); ++i) part.row(static_cast<Eigen::Index>(i)) = triangles.row(own[c][i]);
            for (const std::int32_t v : nonManifoldVertices(part, EdgeTable(part)))
                if (std::binary_search(pinched.begin(), pinched.end(), v)) sound[c] = 0;
        }
    }
    return sound;
}

}  // namespace imomushi
