// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/lateral_contraction.h"

#include <cmath>

#include "core/base/decompositions.h"

namespace imomushi {

bool hangsOnItsJoint(const CharacterInput::Element& element, const CharacterInput::Joint& joint) {
    if (static_cast<int>(element.faces.size()) - element.handles != 1 || joint.point < 0) return false;
    for (const auto& face : joint.faces)
        if (face.bone >= 0)
            for (const int bone : element.bones)
                if (bone == face.bone) return true;
    return false;
}

namespace {

/// v of the face `f` of an element under `map`, zero elsewhere.
Eigen::VectorXd parametersOf(const CharacterInput::Element& element, int f, const JointMap& map) {
    const ElementResponse& response = *element.response;
    const auto i = static_cast<std::size_t>(f);
    Eigen::VectorXd v = Eigen::VectorXd::Zero(response.columns());
    double lost = 0.0;
    response.bases[i].coefficients(map, localVertices(element.mesh->body, element.faces[i]), element.faces[i].size, v.data() + response.firstColumn[i], lost);
    return v;
}

}  // namespace

std::vector<double> leastEnergyContractions(const CharacterInput& input) {
    const int joints = static_cast<int>(input.joints.size());
    if (joints == 0) return {};
    std::vector<double> shift(joints, 0.0);  // mean outward, per unit of strain
    // Per element: v at unit strain of the bones, and which joint stretches each face in its plane.
    std::vector<Eigen::VectorXd> strained(input.elements.size());
    std::vector<std::vector<int>> jointOf(input.elements.size());
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        const auto& response = input.elements[e].response;
        strained[e] = Eigen::VectorXd::Zero(response ? response->columns() : 0);
        jointOf[e].assign(input.elements[e].faces.size(), -1);
    }
    for (int j = 0; j < joints; ++j) {
        const auto& joint = input.joints[j];
        int count = 0;
        for (const auto& f : joint.faces) {
            const auto& element = input.elements[f.element];
            jointOf[f.element][f.face] = j;
            if (f.bone < 0) continue;
            ++count;
            if (hangsOnItsJoint(element, joint)) continue;
            const auto& bone = input.skeleton.bones[f.bone];
            const int far = bone.start == joint.point ? bone.end : bone.start;
            const Vec3 local = element.faces[f.face].frame.axes.transpose() *
                               (0.5 * (input.skeleton.points[joint.point] - input.skeleton.points[far]));
            shift[j] += local.z();
            if (!element.response) continue;
            JointMap moved;
            moved.shift = local;
            strained[f.element] += parametersOf(element, f.face, moved);
        }
        if (count > 0) shift[j] /= count;
    }

    // Stationary in all in-plane stretches at once.
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(joints, joints);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(joints);
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        const auto& element = input.elements[e];
        if (!element.response || element.response->columns() == 0) continue;
        const auto& response = *element.response;
        JointMap stretched;
        stretched.linear.diagonal() = Vec3(2.0, 2.0, 1.0);
        std::vector<Eigen::VectorXd> wide;  // v when one face is stretched in its plane
        for (std::size_t f = 0; f < jointOf[e].size(); ++f) wide.push_back(parametersOf(element, static_cast<int>(f), stretched));
        for (std::size_t f = 0; f < wide.size(); ++f) {
            const Eigen::VectorXd force = element.stiffness * (response.stiffness * wide[f]);
            right[jointOf[e][f]] -= force.dot(strained[e]);
            for (std::size_t g = 0; g < wide.size(); ++g) matrix(jointOf[e][f], jointOf[e][g]) += force.dot(wide[g]);
        }
    }
    // Joints without a response, and combinations that cost nothing, stay as they are.
    const double ridge = 1e-12 * std::max(matrix.diagonal().cwiseAbs().maxCoeff(), 1e-300);
    matrix.diagonal().array() += ridge;
    const Eigen::VectorXd stretch = solveSymmetric(matrix, right);
    std::vector<double> c(joints, 0.0);
    for (int j = 0; j < joints; ++j)
        if (std::abs(shift[j]) > 0.0 && std::isfinite(stretch[j])) c[j] = stretch[j] / shift[j];
    return c;
}

}  // namespace imomushi
