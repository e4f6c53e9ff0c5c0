// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/previous_model.h"

#include <Eigen/QR>
#include <cmath>
#include <map>

#include "core/base/try.h"
#include "core/effects/previous_model_job.h"

namespace imomushi {

namespace {

constexpr double kDamping = 10.0;          // 1/s
constexpr double kSoft = 0.01;             // Pa
constexpr double kStaticsResidual = 1e-8;  // of forces, relative: errors of the models are a thousand times larger
constexpr int kStaticsSteps = 2000;

}  // namespace

PreviousModel::PreviousModel(Character character) : character_(std::move(character)) {
    const CharacterInput& input = character_.input();
    for (const auto& element : input.elements)
        for (auto& held = held_.emplace_back(); const JointFace& face : element.faces)
            for (const auto v : face.vertices) held.push_back({v, -1, face.frame.axes});
    first_ = {0};
    for (const auto& joint : input.joints) {
        std::map<std::int32_t, Eigen::Index> nodeOf;  // of a vertex of the first face
        for (std::size_t f = 0; f < joint.faces.size(); ++f) {
            const auto element = static_cast<std::size_t>(joint.faces[f].element);
            const auto& faces = input.elements[element].faces;
            const auto face = static_cast<std::size_t>(joint.faces[f].face);
            std::size_t at = 0;
            for (std::size_t before = 0; before < face; ++before) at += faces[before].vertices.size();
            for (const double area : vertexAreas(input.elements[element].mesh->body, faces[face])) {
                FaceVertex& h = held_[element][at++];
                if (f == 1)
                    for (const auto& [a, b] : joint.welded)
                        if (b == h.vertex) h.node = nodeOf.at(a);
                if (h.node < 0) {
                    h.node = static_cast<Eigen::Index>(area_.size());
                    area_.push_back(0.0);
                }
                if (f == 0) nodeOf.emplace(h.vertex, h.node);
                area_[static_cast<std::size_t>(h.node)] += area;
            }
        }
        first_.push_back(static_cast<Eigen::Index>(area_.size()));
    }
}

Result<PreviousModel> PreviousModel::build(CharacterInput input, const Progress& progress) {
    for (const auto& e : input.elements)
        if (!e.faces.empty() && (!e.response || e.response->columns() == 0 || e.response->tractions.rows() != e.response->columns()))
            return fail("bad-value", "The previous model needs the tractions of every element with joint faces: precompute them in the basis \"full\".");
    input.basis = BasisKind::Full;
    input.format = ResponseFormat::Float;
    input.threads = 1;
    input.effects = {};
    PreviousModelEffect effect;
    effect.step = kFrame;
    effect.damping = kDamping;
    effect.shearModulus = kSoft;
    input.effects.set(effect);
    IMOMUSHI_TRY(auto character, Character::build(std::move(input)));
    if (progress.cancelled()) return fail(kCancelled, "The comparison was cancelled.");
    return PreviousModel(std::move(character));
}

// Minimises the elastic energy by conjugate gradients. Unknowns: what nodes do beyond where bones have them, world axes, times the square root of their area,
// orthogonal to the rigid motions of each joint.
Result<std::vector<Points>> PreviousModel::statics(const Pose& pose, const Progress& progress) {
    const auto& elements = character_.input().elements;
    character_.stop();
    character_.update(pose);
    std::vector<Points> out;
    std::vector<Eigen::Matrix3d> rotation;  // of frames
    std::vector<Eigen::VectorXd> wanted;    // joint parameters of the faces as bones have them
    Eigen::Matrix3Xd place(3, static_cast<Eigen::Index>(area_.size()));  // of nodes, there
    for (std::size_t e = 0; e < elements.size(); ++e) {
        out.push_back(character_.positions(static_cast<int>(e)));
        const auto frame = character_.frame(static_cast<int>(e));
        rotation.push_back(frame.linear());
        wanted.emplace_back(3 * static_cast<Eigen::Index>(held_[e].size()));
        for (Eigen::Index i = 0; const FaceVertex& h : held_[e]) {
            const Vec3 at = out[e].row(h.vertex).transpose();
            place.col(h.node) = at;
            wanted[e].segment<3>(3 * i++) = h.axes.transpose() * (frame.inverse() * at - elements[e].mesh->body.vertices.row(h.vertex).transpose());
        }
    }
    Eigen::VectorXd root(place.size());
    for (Eigen::Index n = 0; n < place.cols(); ++n) root.segment<3>(3 * n).setConstant(std::sqrt(area_[static_cast<std::size_t>(n)]));
    std::vector<Eigen::MatrixXd> rigid;  // motions of each joint, orthonormal in these coordinates; of vertices in a line fewer than six
    for (std::size_t j = 0; j + 1 < first_.size(); ++j) {
        const Eigen::Index begin = first_[j], count = first_[j + 1] - begin;
        const Vec3 middle = place.middleCols(begin, count).rowwise().mean();
        Eigen::MatrixXd motions(3 * count, 6);
        for (Eigen::Index n = 0; n < count; ++n) {
            const Vec3 r = place.col(begin + n) - middle;
            motions.middleRows<3>(3 * n) << Eigen::Matrix3d::Identity(), Vec3(0, -r.z(), r.y()), Vec3(r.z(), 0, -r.x()), Vec3(-r.y(), r.x(), 0);
        }
        const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(root.segment(3 * begin, 3 * count).asDiagonal() * motions);
        rigid.push_back(qr.householderQ() * Eigen::MatrixXd::Identity(3 * count, qr.rank()));
    }
    const auto parameters = [&](std::size_t e, const Eigen::VectorXd& w) {
        Eigen::VectorXd v(wanted[e].size());
        for (Eigen::Index i = 0; const FaceVertex& h : held_[e]) v.segment<3>(3 * i++) = h.axes.transpose() * (rotation[e].transpose() * w.segment<3>(3 * h.node));
        return v;
    };
    const auto forces = [&](const auto& parametersOf) {  // the energy's derivative
        Eigen::VectorXd f = Eigen::VectorXd::Zero(root.size());
        for (std::size_t e = 0; e < elements.size(); ++e) {
            if (held_[e].empty()) continue;
            const Eigen::VectorXd k = elements[e].stiffness * (elements[e].response->stiffness * parametersOf(e));
            for (Eigen::Index i = 0; const FaceVertex& h : held_[e]) f.segment<3>(3 * h.node) += rotation[e] * (h.axes * k.segment<3>(3 * i++));
        }
        f = f.cwiseQuotient(root);
        for (std::size_t j = 0; j < rigid.size(); ++j) {
            auto part = f.segment(3 * first_[j], rigid[j].rows());
            part -= (rigid[j] * (rigid[j].transpose() * part)).eval();
        }
        return f;
    };
    Eigen::VectorXd y = Eigen::VectorXd::Zero(root.size()), r = -forces([&](std::size_t e) { return wanted[e]; }), p = r;
    double square = r.squaredNorm();
    const double enough = kStaticsResidual * kStaticsResidual * square;
    for (int step = 0; square > enough && square > 0.0; ++step) {
        if (progress.cancelled()) return fail(kCancelled, "The comparison was cancelled.");
        if (step == kStaticsSteps) return fail("not-solved", "The equilibrium of the joint faces was not found: check the element's precompute (rcond).");
        const Eigen::VectorXd w = p.cwiseQuotient(root), a = forces([&](std::size_t e) { return parameters(e, w); });
        const double along = p.dot(a);
        if (!(along > 0.0)) break;  // a direction without stiffness
        const double part = square / along;
        y += part * p;
        r -= part * a;
        const double next = r.squaredNorm();
        p = r + next / square * p;
        square = next;
    }
    const Eigen::VectorXd w = y.cwiseQuotient(root);
    for (std::size_t e = 0; e < elements.size(); ++e) {
        if (held_[e].empty()) continue;
        for (const FaceVertex& h : held_[e]) out[e].row(h.vertex) += w.segment<3>(3 * h.node).transpose();
        const ElementResponse& response = *elements[e].response;
        const auto frame = character_.frame(static_cast<int>(e));
        const Eigen::VectorXd u = response.response * (wanted[e] + parameters(e, w));
        for (Eigen::Index i = 0; const auto v : response.freeVertices)
            out[e].row(v) = (frame * Vec3(elements[e].mesh->body.vertices.row(v).transpose() + u.segment<3>(3 * i++))).transpose();
    }
    return out;
}

std::size_t PreviousModel::matrixBytes() const {
    std::size_t bytes = 0;
    for (const auto& e : character_.input().elements)
        if (!e.faces.empty()) bytes += sizeof(float) * static_cast<std::size_t>((e.response->response.rows() + e.response->tractions.rows()) * e.response->columns());
    return bytes;
}

int PreviousModel::columns() const {
    int count = 0;
    for (const auto& e : character_.input().elements)
        if (!e.faces.empty()) count += e.response->columns();
    return count;
}

}  // namespace imomushi
