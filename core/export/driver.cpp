// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/driver.h"

#include <algorithm>
#include <optional>

#include "core/character/lateral_contraction.h"
#include "core/effects/body_loads_job.h"
#include "core/effects/joint_equilibrium.h"
#include "core/effects/previous_model_job.h"
#include "core/effects/smooth_joints_job.h"
#include "core/skeleton/bone_tree.h"

namespace imomushi {

namespace {

using Json = nlohmann::ordered_json;

template <class Dense>
Json numbers(const Dense& values) {
    Json out = Json::array();
    for (Eigen::Index i = 0; i < values.size(); ++i) out.push_back(values.data()[i]);
    return out;
}

Json rowByRow(const Eigen::MatrixXd& matrix) { return numbers(Eigen::MatrixXd(matrix.transpose())); }

/// The body loads of an element as JSON, null: none.
Json loadsOf(const GltfContent& content, std::size_t e) {
    const auto& element = content.scene.character.elements[e];
    const auto& effects = content.scene.character.effects;
    const auto columns = content.motion.character.loadColumns(static_cast<int>(e));
    if (columns.empty()) return {};
    const Points& body = element.mesh->body.vertices;
    const Vec3 size = (body.colwise().maxCoeff() - body.colwise().minCoeff()).transpose();
    Json out{{"column", element.response->columns()}, {"most", BodyLoadsJob::kMaxLoaded * size.norm()}, {"sizes", Json::array()}};
    Eigen::MatrixXd forces(element.response->columns(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto column = element.response->loads.col(columns[i]);
        double largest = 0.0;
        for (Eigen::Index p = 0; p < column.size(); p += 3) largest = std::max(largest, column.segment<3>(p).norm());
        out["sizes"].push_back(largest);
        forces.col(static_cast<Eigen::Index>(i)) = element.stiffness * element.response->loadForces.col(columns[i]);
    }
    if (columns.front() == 0) {
        const auto* gravity = effects.find<GravityEffect>();
        const double modulus = !gravity || !gravity->on(e) ? 0.0 : gravity->shearModulus > 0.0 ? gravity->shearModulus : modulusForSag(content.scene.character, gravity->sag)[e];
        out["softness"] = modulus > 0.0 ? element.density / (modulus * element.stiffness) : 0.0;
        const auto* stretch = effects.find<EndStretchEffect>();
        if (const auto at = stretch && stretch->on(e) ? freeEndOf(content.scene.character, e) : std::nullopt)
            out["stretch"] = {{"near", at->near}, {"end", at->end}, {"length", at->length}, {"longer", stretch->kMostLonger}, {"shorter", stretch->kMostShorter}, {"perMetre", numbers(at->perMetre)}};
    }
    if (columns.back() == 3) out["pressure"] = effects.find<InflateEffect>()->pressure / element.stiffness;
    if (effects.has<SmoothJointsEffect>()) out["forces"] = rowByRow(forces);
    return out;
}

}  // namespace

Json driverData(const GltfContent& content) {
    const CharacterInput& input = content.scene.character;
    const Skeleton& skeleton = input.skeleton;
    const BoneTree tree = boneTree(skeleton);
    Json out{{"version", 1}, {"points", Json::array()}, {"bones", Json::array()}, {"elements", Json::array()}, {"joints", Json::array()}};
    for (std::size_t p = 0; p < skeleton.points.size(); ++p) out["points"].push_back({{"name", content.scene.points[p]}, {"rest", numbers(skeleton.points[p])}});
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const auto& bone = skeleton.bones[b];
        out["bones"].push_back({{"name", content.scene.bones[b]}, {"start", bone.start}, {"end", bone.end}, {"parent", tree.parent[b]}, {"tree", tree.tree[b]},
                                {"direction", numbers(tree.restDirection[b])}, {"rollSign", tree.rollSign[b]}, {"length", bone.length}});
    }
    std::optional<JointEquilibrium::Constants> smooth;
    if (input.effects.has<SmoothJointsEffect>() && !input.effects.has<PreviousModelEffect>()) smooth = JointEquilibrium(input).constants();
    if (smooth) {
        Json entries = Json::array();
        for (const auto& entry : smooth->entries) entries.push_back(entry);
        out["smooth"] = {{"entries", std::move(entries)}, {"parameters", smooth->parameters}, {"leastStiffness", JointEquilibrium::kMinStiffness},
                         {"stretch", {JointEquilibrium::kMinStretch, JointEquilibrium::kMaxStretch}}, {"fold", JointEquilibrium::kMaxFold}, {"slope", JointEquilibrium::kMaxSlope}};
    }
    if (const auto* gravity = input.effects.find<GravityEffect>(); gravity || input.effects.has<EndStretchEffect>()) out["gravity"] = numbers(gravity ? gravity->acceleration : Vec3(Vec3::Zero()));
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        const auto& element = input.elements[e];
        Json item{{"name", content.scene.elements[e]}, {"frame", content.scene.elements[e] + " frame"}, {"middle", numbers(content.morphs[e].middle)}, {"bones", element.bones}};
        int anchorJoint = -1;
        Vec3 anchor = Vec3::Zero();
        double length = 0.0;
        for (const int b : element.bones) {
            const auto& bone = skeleton.bones[static_cast<std::size_t>(b)];
            length += bone.length;
            anchor += 0.5 * bone.length * (skeleton.points[static_cast<std::size_t>(bone.start)] + skeleton.points[static_cast<std::size_t>(bone.end)]);
        }
        if (length > 0.0) anchor /= length;
        item["faces"] = Json::array();
        for (std::size_t f = 0; f < element.faces.size(); ++f)
            for (std::size_t j = 0; j < input.joints.size(); ++j)
                for (const auto& jf : input.joints[j].faces) {
                    if (jf.element != static_cast<int>(e) || jf.face != static_cast<int>(f)) continue;
                    if (hangsOnItsJoint(element, input.joints[j])) {
                        anchorJoint = static_cast<int>(j);
                        anchor = skeleton.points[static_cast<std::size_t>(input.joints[j].point)];
                    }
                    const auto& face = element.faces[f];
                    Json told{{"name", face.name}, {"joint", j}, {"origin", numbers(face.frame.origin)}, {"axes", numbers(face.frame.axes)}};
                    if (element.response) {
                        const FaceBasis& basis = element.response->bases[f];
                        told["basis"] = basis.kind == BasisKind::Modes ? "affine" : basisName(basis.choice());
                        told["flat"] = basis.flat;
                        told["column"] = element.response->firstColumn[f];
                        if (smooth) told["spread"] = rowByRow(smooth->spread[e].at(f));
                    }
                    item["faces"].push_back(std::move(told));
                }
        item["anchorJoint"] = anchorJoint;
        item["anchor"] = numbers(anchor);
        item["boneLength"] = length;
        const auto& matrix = content.morphs[e].matrix;
        item["columns"] = matrix.cols();
        item["matrix"] = Json::array();
        for (Eigen::Index t = 0; t < matrix.rows(); ++t)
            for (Eigen::Index c = 0; c < matrix.cols(); ++c) item["matrix"].push_back(matrix(t, c));
        for (int part = -1; const RenderSurface& surface : content.surfaces) {
            if (surface.part == part) continue;
            part = surface.part;
            for (const auto& mover : content.movers(surface))
                if (mover.element == static_cast<int>(e)) item["parts"].push_back({part, mover.first});
        }
        if (smooth && element.response) item["stiffness"] = rowByRow(element.stiffness * element.response->stiffness);
        if (Json loads = loadsOf(content, e); !loads.is_null()) item["loads"] = std::move(loads);
        out["elements"].push_back(std::move(item));
    }
    for (std::size_t j = 0; j < input.joints.size(); ++j) {
        const auto& joint = input.joints[j];
        const auto& first = input.elements[static_cast<std::size_t>(joint.faces[0].element)].faces[static_cast<std::size_t>(joint.faces[0].face)].frame;
        Vec3 tangent = Vec3::Zero();
        bool led = false;
        Json faces = Json::array();
        for (const auto& f : joint.faces) {
            led = led || input.elements[static_cast<std::size_t>(f.element)].leadsJointPlanes;
            if (f.bone >= 0) tangent += tree.rollSign[static_cast<std::size_t>(f.bone)] * tree.restDirection[static_cast<std::size_t>(f.bone)];
            faces.push_back({{"element", f.element}, {"face", f.face}, {"bone", f.bone}, {"leads", input.elements[static_cast<std::size_t>(f.element)].leadsJointPlanes}});
        }
        if (const double n = tangent.norm(); n > 1e-6)
            tangent /= n;
        else
            tangent.setZero();
        const Vec3 place = joint.point >= 0 ? skeleton.points[static_cast<std::size_t>(joint.point)] : first.origin;
        Json told{{"point", joint.point}, {"place", numbers(place)}, {"normal", numbers(Vec3(first.axes.col(2)))}, {"tangent", numbers(tangent)},
                                 {"shrink", content.motion.character.lateralContraction(static_cast<int>(j))}, {"led", led}, {"faces", std::move(faces)}};
        if (smooth) {
            told["axes"] = numbers(smooth->joints[j].axes);
            told["slopes"] = Json::array();
            for (const auto& slope : smooth->joints[j].slopes) told["slopes"].push_back(rowByRow(slope));
        }
        out["joints"].push_back(std::move(told));
    }
    return out;
}

}  // namespace imomushi
