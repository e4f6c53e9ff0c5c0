// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/check_input.h"

#include <algorithm>
#include <cmath>

#include "core/base/finite.h"

namespace imomushi {

namespace {

tl::unexpected<Error> bad(const std::string& what) { return fail("bad-value", "The character contradicts itself: " + what + "."); }
bool in(int i, int n) { return i >= 0 && i < n; }

Result<void> checkSkeleton(const Skeleton& skeleton) {
    const int points = static_cast<int>(skeleton.points.size());
    for (int b = 0; b < static_cast<int>(skeleton.bones.size()); ++b) {
        const auto& bone = skeleton.bones[static_cast<std::size_t>(b)];
        if (!in(bone.start, points) || !in(bone.end, points) || bone.start == bone.end) return bad("a bone has an end that is not there");
        if (bone.parent >= b) return bad("a bone comes before its parent");
        if (!(bone.length > 0.0) || !std::isfinite(bone.length)) return bad("a bone has no length");
        if (!(bone.minStretch >= 0.0) || !(bone.maxStretch >= bone.minStretch)) return bad("a bone's stretch limits are in the wrong order");
        if (!(bone.maxBend >= 0.0) || !(bone.maxTwist >= 0.0)) return bad("a bone's limit of bend or twist is negative or not a number");
        if (!(bone.stiffness > 0.0) || !std::isfinite(bone.stiffness)) return bad("a bone's stiffness is not above 0");
    }
    for (const auto& p : skeleton.points)
        if (!allFinite(p)) return bad("a joint point is not a number");
    return {};
}

Result<void> checkBody(const CharacterInput::Element& element) {
    const auto vertices = element.mesh->body.vertices.rows();
    if (!allFinite(element.mesh->body.vertices)) return bad("a vertex is not a number");
    const auto& triangles = element.mesh->body.triangles;
    if (triangles.size() > 0 && (triangles.minCoeff() < 0 || triangles.maxCoeff() >= vertices)) return bad("a triangle has a corner that is not there");
    std::vector<char> onFace(static_cast<std::size_t>(vertices), 0);
    for (const auto& face : element.faces) {
        for (const auto v : face.vertices) {
            if (v < 0 || v >= vertices) return bad("a joint face names a vertex that is not there");
            if (onFace[static_cast<std::size_t>(v)]++) return bad("two joint faces share a vertex");
        }
        for (const auto t : face.triangles)
            if (t < 0 || t >= triangles.rows()) return bad("a joint face names a triangle that is not there");
    }
    return {};
}

Result<void> checkEmbedded(const CharacterInput::Element& element) {
    const EmbeddedPoints& points = *element.embedded;
    const auto count = points.rest.rows();
    if (!allFinite(points.rest) || !allFinite(points.normals)) return bad("an embedded point or its normal is not a number");
    const auto many = [count](Eigen::Index given) { return given == 0 || given == count; };
    if (!many(points.normals.rows()) || !many(static_cast<Eigen::Index>(points.bodyVertex.size())))
        return bad("the normals or body vertices of embedded points are not as many as the points");
    for (const auto v : points.bodyVertex)
        if (v < -1 || v >= element.mesh->body.vertices.rows()) return bad("an embedded point names a body vertex that is not there");
    std::vector<char> attached(static_cast<std::size_t>(count), 0);
    for (const auto& part : points.attached) {
        if (!allFinite(part.pivot)) return bad("the pivot of an attached part is not a number");
        for (const auto i : part.points) {
            if (i < 0 || i >= count) return bad("an attached part names a point that is not there");
            if (attached[static_cast<std::size_t>(i)]++) return bad("two attached parts share a point");
            if (!points.bodyVertex.empty() && points.bodyVertex[static_cast<std::size_t>(i)] >= 0) return bad("an attached point is at a body vertex, too");
        }
    }
    return {};
}

/// The same points at the same numbers.
bool sameBodies(const CharacterInput& a, const CharacterInput& b) {
    return std::equal(a.elements.begin(), a.elements.end(), b.elements.begin(), b.elements.end(), [](const auto& p, const auto& q) { return p.mesh == q.mesh && p.embedded == q.embedded; });
}

Result<void> checkRenderMeshes(const CharacterInput& input, const std::vector<const CharacterInput*>& checked) {
    std::vector<const EmbeddedMesh*> good;
    for (const CharacterInput* other : checked)
        if (sameBodies(*other, input))
            for (const auto& mesh : other->renderMeshes) good.push_back(mesh.get());
    for (const auto& mesh : input.renderMeshes) {
        if (!mesh) return bad("a render mesh is missing");
        if (std::find(good.begin(), good.end(), mesh.get()) != good.end()) continue;
        const auto count = static_cast<Eigen::Index>(mesh->vertices.size());
        if (mesh->triangles.size() > 0 && (mesh->triangles.minCoeff() < 0 || mesh->triangles.maxCoeff() >= count))
            return bad("a triangle of a render mesh has a corner that is not there");
        if (mesh->normals.rows() != 0 && mesh->normals.rows() != count) return bad("the normals of a render mesh are not as many as its vertices");
        if (!allFinite(mesh->normals)) return bad("a normal of a render mesh is not a number");
        if (mesh->model && !checkMorphs(mesh->model->morphs, mesh->vertices.size()).empty()) return bad("the morph targets of a render mesh are of another one");
        for (const auto& v : mesh->vertices) {
            if (!in(v.element, static_cast<int>(input.elements.size()))) return bad("a render mesh names an element that is not there");
            const auto& element = input.elements[static_cast<std::size_t>(v.element)];
            const Eigen::Index points = v.onBody ? element.mesh->body.vertices.rows() : element.embedded ? element.embedded->rest.rows() : 0;
            if (v.index < 0 || v.index >= points) return bad("a render mesh names a point that is not there");
        }
    }
    return {};
}

Result<void> checkResponse(const CharacterInput::Element& element) {
    const auto& r = *element.response;
    const auto vertices = element.mesh->body.vertices.rows();
    bool fits = r.bases.size() == element.faces.size() && r.firstColumn.size() == element.faces.size() + 1;
    for (std::size_t f = 0; fits && f < r.bases.size(); ++f) fits = r.firstColumn[f + 1] - r.firstColumn[f] == r.bases[f].columns();
    fits = fits && r.response.rows() == 3 * static_cast<Eigen::Index>(r.freeVertices.size()) && r.response.cols() == r.columns() &&
           r.stiffness.rows() == r.columns() && r.stiffness.cols() == r.columns() && allFinite(r.response) && allFinite(r.stiffness);
    fits = fits && (r.loads.size() == 0 || (r.loads.rows() == r.response.rows() && r.loads.cols() == 4 && allFinite(r.loads) &&
                                            r.loadForces.rows() == r.columns() && r.loadForces.cols() == 4 && allFinite(r.loadForces)));
    std::vector<char> onFace(static_cast<std::size_t>(vertices), 0);
    std::size_t held = 0;
    for (const auto& face : element.faces) {
        held += face.vertices.size();
        for (const auto v : face.vertices) onFace[static_cast<std::size_t>(v)] = 1;
    }
    fits = fits && r.freeVertices.size() + held == static_cast<std::size_t>(vertices);
    for (const auto v : r.freeVertices) fits = fits && v >= 0 && v < vertices && !onFace[static_cast<std::size_t>(v)];
    if (!fits) return bad("a response belongs to another mesh or other joint faces; precompute again");
    return {};
}

Result<void> checkHandles(const CharacterInput& input) {
    std::vector<char> used(input.joints.size(), 0);
    for (const auto& handle : input.handles) {
        if (!in(handle.joint, static_cast<int>(input.joints.size()))) return bad("a handle names a joint that is not there");
        const auto& joint = input.joints[static_cast<std::size_t>(handle.joint)];
        if (joint.faces.size() != 1 || joint.point >= 0) return bad("a handle holds a joint that has other faces or a joint point");
        if (used[static_cast<std::size_t>(handle.joint)]++) return bad("two handles hold one joint");
        if (handle.bone < -1 || handle.bone >= static_cast<int>(input.skeleton.bones.size())) return bad("a handle hangs on a bone that is not there");
    }
    return {};
}

Result<void> checkJoints(const CharacterInput& input) {
    const int points = static_cast<int>(input.skeleton.points.size()), bones = static_cast<int>(input.skeleton.bones.size());
    std::vector<std::vector<int>> used(input.elements.size());
    for (std::size_t e = 0; e < used.size(); ++e) used[e].assign(input.elements[e].faces.size(), 0);
    for (const auto& joint : input.joints) {
        if (joint.point < -1 || joint.point >= points || joint.faces.empty()) return bad("a joint has no face or no joint point");
        for (const auto& f : joint.faces) {
            if (!in(f.element, static_cast<int>(input.elements.size())) ||
                !in(f.face, static_cast<int>(used[static_cast<std::size_t>(f.element)].size())))
                return bad("a joint names a face that is not there");
            if (f.bone < -1 || f.bone >= bones) return bad("a joint names a bone that is not there");
            ++used[static_cast<std::size_t>(f.element)][static_cast<std::size_t>(f.face)];
        }
        if (!joint.welded.empty() && joint.faces.size() < 2) return bad("a joint welds a face to nothing");
        const auto vertices = [&](std::size_t side) {
            return static_cast<int>(input.elements[static_cast<std::size_t>(joint.faces[side].element)].mesh->body.vertices.rows());
        };
        for (const auto& [a, b] : joint.welded)
            if (!in(a, vertices(0)) || !in(b, vertices(1))) return bad("a joint welds a vertex that is not there");
    }
    for (const auto& faces : used)
        for (const int n : faces)
            if (n != 1) return bad("a joint face belongs to no joint or to several");
    return {};
}

}  // namespace

Result<void> checkInput(const CharacterInput& input, const ElementRuntimes& known, const std::vector<const CharacterInput*>& checked) {
    if (auto ok = checkSkeleton(input.skeleton); !ok) return ok;
    for (const auto& element : input.elements) {
        if (!element.mesh) return bad("an element has no mesh");
        const bool fits = known.knows(element.mesh, element.faces, element.response);
        if (!fits && !known.knows(element.mesh, element.faces))
            if (auto ok = checkBody(element); !ok) return ok;
        for (const int b : element.bones)
            if (!in(b, static_cast<int>(input.skeleton.bones.size()))) return bad("an element names a bone that is not there");
        if (!(element.density > 0.0) || !std::isfinite(element.density)) return bad("an element has no density");
        if (!(element.damping >= 0.0) || !std::isfinite(element.damping)) return bad("an element's damping is below 0");
        if (!fits && element.response)
            if (auto ok = checkResponse(element); !ok) return ok;
        if (element.embedded)
            if (auto ok = checkEmbedded(element); !ok) return ok;
    }
    if (auto ok = checkRenderMeshes(input, checked); !ok) return ok;
    if (auto ok = checkJoints(input); !ok) return ok;
    if (auto ok = checkHandles(input); !ok) return ok;
    for (const auto& effect : input.effects)
        if (auto ok = effect->validate(); !ok) return ok;
    return {};
}

}  // namespace imomushi
