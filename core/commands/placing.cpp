// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/placing.h"

#include <Eigen/LU>

#include "core/document/command_support.h"
#include "core/joints/carried_face.h"
#include "core/reduction/congruence.h"

namespace imomushi {

namespace {

void turnRound(Triangles& triangles) { triangles.col(1).swap(triangles.col(2)); }

}  // namespace

Element placed(const Element& element, const Placing& placing) {
    Element out = element;
    out.mesh = std::make_shared<const ElementMesh>(placing.mesh(*element.mesh));
    for (JointFace& face : out.faces) face = placing.face(face);
    for (Handle& handle : out.handles) handle.point = placing.point(handle.point), handle.radius *= placing.scale;
    return out;
}

CharacterSource placed(const CharacterSource& character, const Placing& placing) {
    CharacterSource out = character;
    if (!placing.moves()) return out;
    RenderModel model = *character.model;
    model.mesh = placing.mesh(character.model->mesh);
    for (MorphTarget& target : model.morphs) target.deltas = (target.deltas * placing.linear.transpose().cast<float>()).eval();
    Body body = *character.body;
    body.mesh = placing.mesh(character.body->mesh);
    for (Vec3& place : body.report.gaps.places) place = placing.point(place);
    for (FleshLink& link : body.report.links) {
        link.from = placing.point(link.from), link.to = placing.point(link.to);
        link.radius *= placing.scale, link.volume *= placing.scale * placing.scale * placing.scale;
    }
    for (Cut& cut : out.cuts) cut.plane = placing.plane(cut.plane);
    if (out.rig) {
        Rig rig = *out.rig;
        Eigen::Matrix4d place = Eigen::Matrix4d::Identity();
        place.topLeftCorner<3, 3>() = placing.linear;
        place.topRightCorner<3, 1>() = placing.shift;
        placeRig(rig, place);
        out.rig = std::make_shared<const Rig>(std::move(rig));
    }
    for (auto& [part, attachment] : out.attachments)
        if (attachment.pivot) attachment.pivot = placing.point(*attachment.pivot);
    out.model = std::make_shared<const RenderModel>(std::move(model));
    out.body = std::make_shared<const Body>(std::move(body));
    return out;
}

void placeElement(DocumentEdit& edit, PartId id, const Placing& placing, const StoredResponse* known) {
    const DocumentResponses& responses = edit.responses();
    const ResponseInput from = responses.inputOf(id);
    const ContentKey shape = responses.shapeOf(id);
    const bool fresh = known && responses.isFresh(id, *known), draft = known && known->key == responseKey(responses.inputOfDraft(id));
    exchangePart(edit.document.elements, id, [&](Element& element) { element = placed(element, placing); });
    if (!known || (!fresh && shape != known->shape)) return;
    const auto congruence = findCongruence(from, responses.inputOf(id));
    if (!congruence) return;
    auto carried = congruence->carry(*known->response);
    if (!carried) return;
    ContentKey carriedKey = draft ? responseKey(responses.inputOfDraft(id)) : responses.keyOf(id);
    if (!fresh && !draft) {  // it only fits, and no precompute would give it: neither has another one its key
        ContentHasher hasher;
        hasher.text("carried");
        hasher.text(known->key.hex());
        hasher.text(carriedKey.hex());
        carriedKey = hasher.key();
    }
    edit.bring(id, {carriedKey, responses.shapeOf(id), std::make_shared<const ElementResponse>(std::move(*carried))});
}

Placing Placing::mirror(int axis, double at) {
    Placing out;
    out.linear(axis, axis) = -1.0;
    out.shift[axis] = 2.0 * at;
    return out;
}

Placing Placing::about(const Vec3& centre, const Eigen::Quaterniond& rotation, double scale, const Vec3& shift) {
    Placing out;
    const bool turned = rotation.vec().norm() > 0.0;
    if (turned) out.linear = rotation.toRotationMatrix();
    out.linear *= scale;
    out.scale = scale;
    out.shift = turned || scale != 1.0 ? Vec3(centre - out.linear * centre + shift) : shift;
    return out;
}

bool Placing::mirrors() const { return linear.determinant() < 0.0; }

TriangleMesh Placing::mesh(const TriangleMesh& mesh) const {
    TriangleMesh out = mesh;
    if (turns())
        for (Eigen::Index v = 0; v < out.vertices.rows(); ++v) out.vertices.row(v) = point(mesh.vertices.row(v).transpose()).transpose();
    else
        out.vertices.rowwise() += shift.transpose();
    if (mirrors()) turnRound(out.triangles);
    return out;
}

ElementMesh Placing::mesh(const ElementMesh& mesh) const {
    ElementMesh out = mesh;
    out.body = this->mesh(mesh.body);
    if (mirrors()) turnRound(out.renderMesh.triangles);
    if (turns()) out.renderMesh.normals = (mesh.renderMesh.normals * (linear.transpose() / scale).cast<float>()).eval();
    return out;
}

JointFace Placing::face(const JointFace& face) const {
    JointFace out = face;
    if (turns())
        out.frame = faceFrame(point(face.frame.origin), (linear * face.frame.axes.col(2)).normalized());
    else
        out.frame.origin += shift;
    out.area *= scale * scale;
    out.size *= scale;
    out.planarityError *= scale;
    return out;
}

}  // namespace imomushi
