// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/tools/symmetry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/document/side_names.h"
#include "core/mesh/bounds.h"

namespace imomushi {
namespace {

/// Places mirror each other, or are in the plane, as far as this share of the size of what is there.
constexpr double kSameSide = 0.02;
/// A middle nearer to the origin than this, of the diagonal, is the origin.
constexpr double kAtOrigin = 0.01;

struct Width {
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest(), diagonal = 0.0;
    void add(const Points& v) {
        if (v.rows() == 0) return;
        low = std::min(low, v.col(0).minCoeff());
        high = std::max(high, v.col(0).maxCoeff());
        diagonal = std::max(diagonal, diagonalOf(v));
    }
    [[nodiscard]] double middle() const {
        if (low > high) return 0.0;
        const double m = 0.5 * (low + high);
        return std::abs(m) <= kAtOrigin * diagonal ? 0.0 : m;
    }
};

double lengthOf(const Document& d, PartId bone) {
    const auto start = endpointRestPosition(d, {bone, false}), end = endpointRestPosition(d, {bone, true});
    return start && end ? (*end - *start).norm() : 0.0;
}

}  // namespace

Symmetry Symmetry::ofElement(const Document& document, PartId id) {
    Width width;
    const auto element = document.elements.find(id);
    if (element != document.elements.end() && element->second->piece)
        width.add(document.characters.at(element->second->piece->character)->body->mesh.vertices);
    else
        for (const auto& [other, e] : document.elements) width.add(e->mesh->body.vertices);
    return Symmetry(width.middle());
}

Symmetry Symmetry::ofBone(const Document& document, PartId id) {
    const auto bone = document.bones.find(id);
    return ofElement(document, bone == document.bones.end() ? 0 : bone->second->element);
}

bool Symmetry::holds(const Vec3& p, double size) const { return std::abs(p.x() - middle_) <= kSameSide * size; }

std::optional<EndpointRef> Symmetry::imageOf(const Session& session, const EndpointRef& end) const {
    const Document& d = session.document();
    const auto bone = d.bones.find(end.bone);
    const auto at = endpointRestPosition(d, end);
    if (bone == d.bones.end() || !at) return std::nullopt;
    const double size = lengthOf(d, end.bone);
    if (holds(*at, size)) return std::nullopt;
    const int own = session.pointIndex(end);
    const auto other = [&](const EndpointRef& e) { return session.pointIndex(e) != own ? std::optional(e) : std::nullopt; };
    if (const std::string name = otherSide(bone->second->name); name != bone->second->name)
        if (const Bone* image = d.boneNamed(name)) return other({image->id, end.atEnd});
    const Vec3 there = point(*at);
    for (const auto& [id, candidate] : d.bones)
        for (const bool atEnd : {true, false})
            if (const auto p = endpointRestPosition(d, {id, atEnd}); p && (*p - there).norm() <= kSameSide * size)
                if (const auto image = other({id, atEnd})) return image;
    return std::nullopt;
}

std::optional<FaceRef> Symmetry::imageOf(const Document& d, const FaceRef& handle) const {
    const auto element = d.elements.find(handle.element);
    const Handle* own = element == d.elements.end() ? nullptr : element->second->handleOf(handle.face);
    if (!own || holds(own->point, own->radius)) return std::nullopt;
    if (const std::string name = otherSide(handle.face); name != handle.face)
        if (const auto image = d.handle(name)) return image;
    const Vec3 there = point(own->point);
    for (const auto& [id, e] : d.elements)
        for (const Handle& candidate : e->handles)
            if ((candidate.point - there).norm() <= std::max(0.25 * own->radius, kSameSide * diagonalOf(e->mesh->body.vertices)) && !(FaceRef{id, candidate.face} == handle)) return FaceRef{id, candidate.face};
    return std::nullopt;
}

std::optional<PoseGrip> Symmetry::imageOf(const Session& session, const PoseGrip& grip) const {
    if (grip.isHandle()) {
        const auto image = imageOf(session.document(), grip.handle);
        return image ? std::optional(PoseGrip{{}, *image}) : std::nullopt;
    }
    const auto image = imageOf(session, grip.end);
    return image ? std::optional(PoseGrip{holdingEndpoint(session, *image), {}}) : std::nullopt;
}

bool Symmetry::central(const Document& d, const PoseGrip& grip) const {
    if (!grip.isHandle()) {
        const auto at = endpointRestPosition(d, grip.end);
        return at && holds(*at, lengthOf(d, grip.end.bone));
    }
    const auto element = d.elements.find(grip.handle.element);
    const Handle* own = element == d.elements.end() ? nullptr : element->second->handleOf(grip.handle.face);
    return own && holds(own->point, own->radius);
}

Bone::Place Symmetry::placeAt(const Document& d, const Vec3& rest, const std::vector<EndpointRef>& but, double size) {
    const double near = kSameSide * size;
    for (const auto& [id, element] : d.elements)
        for (const JointFace& face : element->faces)
            if (!element->handleOf(face.name) && (face.frame.origin - rest).norm() <= near) return FaceRef{id, face.name};
    for (const auto& [id, bone] : d.bones)
        for (const bool atEnd : {true, false}) {
            const bool own = std::any_of(but.begin(), but.end(), [&, b = id](const EndpointRef& e) { return e.bone == b; });
            if (const auto at = own ? std::nullopt : endpointRestPosition(d, {id, atEnd}); at && (*at - rest).norm() <= near) return EndpointRef{id, atEnd};
        }
    return rest;
}

}  // namespace imomushi
