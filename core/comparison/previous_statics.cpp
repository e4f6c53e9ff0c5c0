// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "core/comparison/previous_model_state.h"

namespace imomushi {

namespace {

constexpr double kStaticsResidual = 1e-8;  // of forces, relative: errors of the models are a thousand times larger
constexpr int kStaticsSteps = 2000;

}  // namespace

// Minimises the elastic energy by conjugate gradients. Unknowns: offsets times the square root of their area, orthogonal to the rigid motions of each joint.
Result<std::vector<Points>> PreviousModel::statics(const Pose& pose, const Progress& progress) {
    State& s = *state_;
    s.carrier.update(pose);
    s.orient();
    const std::size_t count = s.elements.size();
    std::vector<Points> out;
    std::vector<Eigen::VectorXd> wanted(count);  // joint parameters of the faces as bones carry them
    for (std::size_t e = 0; e < count; ++e) {
        out.push_back(s.carrier.positions(static_cast<int>(e)));
        const auto frame = s.carrier.frame(static_cast<int>(e));
        const auto& held = s.elements[e].held;
        wanted[e].resize(3 * static_cast<Eigen::Index>(held.size()));
        for (std::size_t i = 0; i < held.size(); ++i)
            wanted[e].segment<3>(3 * static_cast<Eigen::Index>(i)) =
                held[i].axes.transpose() * (frame.linear().transpose() * (out[e].row(held[i].vertex).transpose() - frame.translation()) -
                                            s.elements[e].rest.row(held[i].vertex).transpose());
    }
    std::vector<Eigen::Index> first = {0};
    for (const auto& joint : s.joints) first.push_back(first.back() + joint.force.size());
    Eigen::VectorXd root(first.back());
    for (std::size_t j = 0; j < s.joints.size(); ++j)
        for (std::size_t i = 0; i < s.joints[j].nodes.size(); ++i)
            root.segment<3>(first[j] + 3 * static_cast<Eigen::Index>(i)).setConstant(std::sqrt(s.joints[j].nodes[i].area));
    const auto turn = [&](std::size_t e, const State::FaceVertex& h) -> Matrix3d {
        return h.axes.transpose() * s.carrier.frame(static_cast<int>(e)).linear().transpose() * s.joints[h.joint].axes;
    };
    const auto parameters = [&](std::size_t e, const Eigen::VectorXd& w) {
        Eigen::VectorXd v(wanted[e].size());
        for (std::size_t i = 0; i < s.elements[e].held.size(); ++i) {
            const auto& h = s.elements[e].held[i];
            v.segment<3>(3 * static_cast<Eigen::Index>(i)) = turn(e, h) * w.segment<3>(first[h.joint] + 3 * h.node);
        }
        return v;
    };
    const auto free = [&](Eigen::VectorXd& y) {  // symmetric: held motions are orthonormal in these coordinates
        for (std::size_t j = 0; j < s.joints.size(); ++j) {
            const Eigen::Index n = first[j + 1] - first[j];
            const auto weight = root.segment(first[j], n);
            for (int k = 0; k < 6; ++k) {
                const Eigen::VectorXd motion = s.joints[j].held.col(k).cwiseProduct(weight);
                y.segment(first[j], n) -= motion * motion.dot(y.segment(first[j], n));
            }
        }
    };
    const auto forces = [&](const std::vector<Eigen::VectorXd>& v) {  // energy's derivative
        Eigen::VectorXd f = Eigen::VectorXd::Zero(root.size());
        for (std::size_t e = 0; e < count; ++e) {
            if (!s.responses[e]) continue;
            const Eigen::VectorXd k = s.elements[e].stiffness * (s.responses[e]->stiffness * v[e]);
            for (std::size_t i = 0; i < s.elements[e].held.size(); ++i) {
                const auto& h = s.elements[e].held[i];
                f.segment<3>(first[h.joint] + 3 * h.node) += turn(e, h).transpose() * k.segment<3>(3 * static_cast<Eigen::Index>(i));
            }
        }
        f = f.cwiseQuotient(root);
        free(f);
        return f;
    };
    const auto apply = [&](const Eigen::VectorXd& y) {
        const Eigen::VectorXd w = y.cwiseQuotient(root);
        std::vector<Eigen::VectorXd> v;
        for (std::size_t e = 0; e < count; ++e) v.push_back(parameters(e, w));
        return forces(v);
    };
    Eigen::VectorXd y = Eigen::VectorXd::Zero(root.size()), r = -forces(wanted), p = r;
    double square = r.squaredNorm();
    const double enough = kStaticsResidual * kStaticsResidual * square;
    for (int step = 0; square > enough && square > 0.0; ++step) {
        if (progress.cancelled()) return fail(kCancelled, "The comparison was cancelled.");
        if (step == kStaticsSteps) return fail("not-solved", "The equilibrium of the joint faces was not found: check the element's precompute (rcond).");
        const Eigen::VectorXd a = apply(p);
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
    for (std::size_t e = 0; e < count; ++e) {
        const auto& element = s.elements[e];
        const auto frame = s.carrier.frame(static_cast<int>(e));
        for (const auto& h : element.held)
            out[e].row(h.vertex) += (s.joints[h.joint].axes * w.segment<3>(first[h.joint] + 3 * h.node)).transpose();
        if (!s.responses[e]) continue;
        const Eigen::VectorXd u = s.responses[e]->response * (wanted[e] + parameters(e, w));
        for (std::size_t i = 0; i < element.free.size(); ++i)
            out[e].row(element.free[i]) = (frame * Vec3(element.rest.row(element.free[i]).transpose() + u.segment<3>(3 * static_cast<Eigen::Index>(i)))).transpose();
    }
    return out;
}

}  // namespace imomushi
