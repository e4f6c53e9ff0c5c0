// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/character/character.h"
#include "core/effects/smooth_joints_job.h"
#include "core/mesh/topology.h"

/// What smooth joints are measured against: all degrees of freedom of all joint faces in equilibrium, with the same rigid part of every joint. For
/// characters whose joints weld every vertex of two flat faces with the same triangles, or have one face: where triangles differ, the vertices of one
/// face carry other shares of a uniform traction than those of the other, and the full model answers with a zigzag. Elements must be solved as they
/// are ("as-is"): on finer meshes the full basis is still linear on the triangles of the body, and others are not.
namespace imomushi::full_joints {

/// The same character with responses of another basis, and smooth joints.
inline CharacterInput smooth(CharacterInput input, const BasisChoice& basis, const SolverMeshSetting& solverMesh, double nu = 0.45) {
    input.basis = basis;
    input.effects.set(SmoothJointsEffect{});
    for (auto& element : input.elements) {
        ResponseInput in;
        in.mesh = element.mesh;
        in.faces = element.faces;
        in.basis = basis;
        in.nu = nu;
        in.solverMesh = solverMesh;
        element.response = std::make_shared<const ElementResponse>(buildResponse(in, {}).value());
    }
    return input;
}

/// A pose of a chain of bones: each bone turned against the one before it, stretched, and rolled at its end.
struct ChainPose {
    std::string name;
    std::vector<Vec3> bend;       ///< per bone, rotation vector against the bone before (or the world)
    std::vector<double> stretch;  ///< per bone
    std::vector<double> roll;     ///< per joint point
};

inline Pose poseOf(const Skeleton& skeleton, const ChainPose& chain) {
    Pose pose = restPose(skeleton);
    pose.roll = chain.roll;
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const auto& bone = skeleton.bones[b];
        const Eigen::Quaterniond before = b == 0 ? Eigen::Quaterniond::Identity() : pose.frames[b - 1];
        const double angle = chain.bend[b].norm();
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, angle > 0.0 ? Vec3(chain.bend[b] / angle) : Vec3(Vec3::UnitX())));
        pose.frames[b] = before * turn;
        pose.points[bone.end] = pose.points[bone.start] + chain.stretch[b] * (pose.frames[b] * (skeleton.points[bone.end] - skeleton.points[bone.start]));
    }
    return pose;
}

/// Stretch, squash, bends, twist and random poses of a chain of `bones` along `along`.
inline std::vector<ChainPose> standardPoses(int bones, const Vec3& along) {
    const Vec3 across = along.unitOrthogonal(), other = along.cross(across).normalized();
    const auto n = static_cast<std::size_t>(bones);
    const auto make = [&](const char* name, const auto& bend, double stretch, double twist) {
        ChainPose out{name, {}, std::vector<double>(n, stretch), {}};
        for (std::size_t b = 0; b < n; ++b) out.bend.push_back(b == 0 ? Vec3(Vec3::Zero()) : Vec3(bend(b)));
        for (std::size_t p = 0; p <= n; ++p) out.roll.push_back(twist * static_cast<double>(p) / static_cast<double>(n));
        return out;
    };
    std::vector<ChainPose> poses;
    poses.push_back(make("stretch", [&](std::size_t) { return Vec3(Vec3::Zero()); }, 1.2, 0.0));
    poses.push_back(make("squash", [&](std::size_t) { return Vec3(Vec3::Zero()); }, 0.85, 0.0));
    poses.push_back(make("bend", [&](std::size_t) { return Vec3(0.35 * across); }, 1.0, 0.0));
    poses.push_back(make("one joint, 60 degrees", [&](std::size_t b) { return Vec3((b == n / 2 ? 1.0472 : 0.0) * across); }, 1.0, 0.0));
    poses.push_back(make("S-bend", [&](std::size_t b) { return Vec3((b <= n / 2 ? 0.4 : -0.4) * other); }, 1.0, 0.0));
    poses.push_back(make("twist", [&](std::size_t) { return Vec3(Vec3::Zero()); }, 1.0, 1.2));
    std::mt19937 random(7);
    std::uniform_real_distribution<double> d(-1.0, 1.0);
    for (int k = 0; k < 4; ++k) {
        auto pose = make("random", [&](std::size_t) {
            const double x = d(random), y = d(random);
            return Vec3(0.4 * (x * across + y * other));
        }, 1.0, 0.0);
        for (auto& s : pose.stretch) s += 0.15 * d(random);
        for (auto& r : pose.roll) r = 0.4 * d(random);
        poses.push_back(std::move(pose));
    }
    return poses;
}

/// Displacements of all body vertices in the moving frame of their element, #V x 3.
inline Points inFrame(const Character& c, int element) {
    const Points& rest = c.input().elements[element].mesh->body.vertices;
    const Eigen::Isometry3d back = c.frame(element).inverse();
    return ((c.positions(element) * back.linear().transpose()).rowwise() + back.translation().transpose()) - rest;
}

class FullModel {
public:
    /// `input`: with responses of the basis "full".
    explicit FullModel(const CharacterInput& input) : input_(input) {
        Eigen::Index next = 0;
        for (const auto& joint : input_.joints) {
            firstOf_.push_back(next);
            next += 3 * static_cast<Eigen::Index>(faceOf(joint, 0).vertices.size());
        }
        unknowns_ = next;
    }

    /// Displacements in moving frames, per element, in the pose that `affine` is in: the same character with smooth joints in the basis "affine".
    [[nodiscard]] std::vector<Points> solve(const Character& affine) const {
        const auto joints = static_cast<Eigen::Index>(input_.joints.size());
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(unknowns_ + 6 * joints, unknowns_ + 6 * joints);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns_ + 6 * joints);
        std::vector<Eigen::Matrix3d> rotation;
        std::vector<Vec3> place;
        for (std::size_t j = 0; j < input_.joints.size(); ++j) {
            rigidOf(affine, input_.joints[j], rotation.emplace_back(), place.emplace_back());
            const Eigen::MatrixXd c = constraints(input_.joints[j]);
            const Eigen::Index row = unknowns_ + 6 * static_cast<Eigen::Index>(j);
            matrix.block(row, firstOf_[j], 6, c.cols()) = c;
            matrix.block(firstOf_[j], row, c.cols(), 6) = c.transpose();
        }
        // v of an element = rigid + turn u, u the displacements of its joints' vertices in the axes of the joint's first face.
        std::vector<Eigen::VectorXd> rigid(input_.elements.size());
        std::vector<Eigen::MatrixXd> turn(input_.elements.size());
        for (std::size_t e = 0; e < input_.elements.size(); ++e) {
            const auto& response = *input_.elements[e].response;
            rigid[e] = Eigen::VectorXd::Zero(response.columns());
            turn[e] = Eigen::MatrixXd::Zero(response.columns(), unknowns_);
        }
        for (std::size_t j = 0; j < input_.joints.size(); ++j) {
            const auto& joint = input_.joints[j];
            const auto& first = faceOf(joint, 0);
            for (std::size_t side = 0; side < joint.faces.size(); ++side) {
                const auto& f = joint.faces[side];
                const auto& element = input_.elements[f.element];
                const auto& face = element.faces[f.face];
                const Eigen::Matrix3d inFace = face.frame.axes.transpose() * affine.frame(f.element).linear().transpose();
                for (std::size_t i = 0; i < face.vertices.size(); ++i) {
                    const Vec3 rest = element.mesh->body.vertices.row(face.vertices[i]).transpose();
                    const Eigen::Index row = element.response->firstColumn[f.face] + 3 * static_cast<Eigen::Index>(i);
                    const Vec3 moved = place[j] + rotation[j] * (rest - first.frame.origin);
                    rigid[f.element].segment<3>(row) = inFace * (moved - affine.frame(f.element) * rest);
                    turn[f.element].block<3, 3>(row, firstOf_[j] + 3 * partner(joint, side, face.vertices[i])) = inFace * rotation[j] * first.frame.axes;
                }
            }
        }
        for (std::size_t e = 0; e < input_.elements.size(); ++e) {
            const Eigen::MatrixXd k = input_.elements[e].stiffness * (turn[e].transpose() * input_.elements[e].response->stiffness);
            matrix.topLeftCorner(unknowns_, unknowns_) += k * turn[e];
            right.head(unknowns_) -= k * rigid[e];
        }
        const double size = matrix.topLeftCorner(unknowns_, unknowns_).diagonal().mean();
        matrix.topLeftCorner(unknowns_, unknowns_).diagonal().array() += 1e-10 * size;
        matrix.bottomRows(6 * joints) *= size;
        matrix.rightCols(6 * joints) *= size;
        const Eigen::VectorXd u = matrix.partialPivLu().solve(right).head(unknowns_);
        std::vector<Points> out;
        for (std::size_t e = 0; e < input_.elements.size(); ++e) {
            const auto& element = input_.elements[e];
            out.push_back(deformElement(*element.mesh, element.faces, *element.response, rigid[e] + turn[e] * u) - element.mesh->body.vertices);
        }
        return out;
    }

private:
    [[nodiscard]] const JointFace& faceOf(const CharacterInput::Joint& joint, std::size_t side) const {
        return input_.elements[joint.faces[side].element].faces[joint.faces[side].face];
    }

    // The vertex of the first face at the place of one of any face of the joint.
    [[nodiscard]] Eigen::Index partner(const CharacterInput::Joint& joint, std::size_t side, std::int32_t v) const {
        const auto& vertices = faceOf(joint, 0).vertices;
        std::int32_t wanted = v;
        if (side == 1)
            for (const auto& [a, b] : joint.welded)
                if (b == v) wanted = a;
        return std::lower_bound(vertices.begin(), vertices.end(), wanted) - vertices.begin();
    }

    // Rotation and place (of the centroid of the first face) of a joint, from its affine motion.
    void rigidOf(const Character& affine, const CharacterInput::Joint& joint, Eigen::Matrix3d& rotation, Vec3& place) const {
        const auto& f = joint.faces[0];
        const auto& face = faceOf(joint, 0);
        const Points& rest = input_.elements[f.element].mesh->body.vertices;
        const Points now = affine.positions(f.element);
        Eigen::MatrixXd left(static_cast<Eigen::Index>(face.vertices.size()), 3), to(left.rows(), 3);
        for (std::size_t i = 0; i < face.vertices.size(); ++i) {
            const Vec3 p = face.frame.toLocal(rest.row(face.vertices[i]).transpose());
            left.row(static_cast<Eigen::Index>(i)) << 1.0, p.x(), p.y();
            to.row(static_cast<Eigen::Index>(i)) = now.row(face.vertices[i]);
        }
        const Eigen::Matrix3d fit = (left.transpose() * left).inverse() * (left.transpose() * to);  // rows: centroid, x, y
        place = fit.row(0).transpose();
        Eigen::Matrix3d linear;
        linear << fit.row(1).transpose(), fit.row(2).transpose(), fit.row(1).cross(fit.row(2)).normalized().transpose();
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
        rotation = svd.matrixU() * svd.matrixV().transpose() * face.frame.axes.transpose();
    }

    // 6 x 3 #vertices: the rigid part of the affine motion that is nearest to displacements in the mean over the area.
    [[nodiscard]] Eigen::MatrixXd constraints(const CharacterInput::Joint& joint) const {
        const auto& f = joint.faces[0];
        const auto& face = faceOf(joint, 0);
        const auto& body = input_.elements[f.element].mesh->body;
        const auto n = static_cast<Eigen::Index>(face.vertices.size());
        Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n), linear(n, 3);
        const auto at = [&](std::int32_t t, int c) { return std::lower_bound(face.vertices.begin(), face.vertices.end(), body.triangles(t, c)) - face.vertices.begin(); };
        for (const auto t : face.triangles)
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) mass(at(t, a), at(t, b)) += (a == b ? 2.0 : 1.0) * areaVector(body, t).norm();
        for (Eigen::Index i = 0; i < n; ++i) {
            const Vec3 p = face.frame.toLocal(body.vertices.row(face.vertices[static_cast<std::size_t>(i)]).transpose());
            linear.row(i) << 1.0, p.x(), p.y();
        }
        const Eigen::MatrixXd fit = (linear.transpose() * mass * linear).inverse() * linear.transpose() * mass;  // 3 x n: mean, slopes along x and y
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(6, 3 * n);
        for (Eigen::Index i = 0; i < n; ++i) {
            out.block<3, 3>(0, 3 * i) = fit(0, i) * Eigen::Matrix3d::Identity() / face.size;
            out(3, 3 * i + 2) = fit(1, i);
            out(4, 3 * i + 2) = fit(2, i);
            out(5, 3 * i + 1) = fit(1, i);
            out(5, 3 * i) = -fit(2, i);
        }
        return out;
    }

    CharacterInput input_;
    std::vector<Eigen::Index> firstOf_;
    Eigen::Index unknowns_ = 0;
};

/// Error on visible vertices: relative to the displacement in moving frames, which leaves out the rigid motion of elements; relative to the whole displacement
/// from rest, in the world (both root mean squares); and the largest in diagonals of its element.
struct Difference {
    double error = 0.0, inFrames = 0.0, whole = 0.0, largest = 0.0;
    [[nodiscard]] double strict() const { return inFrames > 0.0 ? std::sqrt(error / inFrames) : 0.0; }
    [[nodiscard]] double relative() const { return whole > 0.0 ? std::sqrt(error / whole) : 0.0; }
    void add(const Difference& o) {
        error += o.error;
        inFrames += o.inFrames;
        whole += o.whole;
        largest = std::max(largest, o.largest);
    }
};

inline Difference difference(const Character& c, const std::vector<Points>& full) {
    Difference out;
    for (std::size_t e = 0; e < full.size(); ++e) {
        const auto& element = c.input().elements[e];
        const Points& rest = element.mesh->body.vertices;
        std::vector<char> visible(static_cast<std::size_t>(rest.rows()), 0), covered(static_cast<std::size_t>(element.mesh->body.triangles.rows()), 0);
        for (const auto& joint : c.input().joints)
            for (const auto& f : joint.faces)
                if (f.element == static_cast<int>(e) && joint.faces.size() > 1)
                    for (const auto t : element.faces[f.face].triangles) covered[static_cast<std::size_t>(t)] = 1;
        for (Eigen::Index t = 0; t < element.mesh->body.triangles.rows(); ++t)
            for (int k = 0; k < 3 && !covered[static_cast<std::size_t>(t)]; ++k) visible[static_cast<std::size_t>(element.mesh->body.triangles(t, k))] = 1;
        const Points shown = inFrame(c, static_cast<int>(e));
        const double diagonal = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
        for (Eigen::Index v = 0; v < rest.rows(); ++v) {
            if (!visible[static_cast<std::size_t>(v)]) continue;
            out.error += (shown.row(v) - full[e].row(v)).squaredNorm();
            out.inFrames += full[e].row(v).squaredNorm();
            const Vec3 before = rest.row(v).transpose(), after = before + full[e].row(v).transpose();
            out.whole += (c.frame(static_cast<int>(e)) * after - before).squaredNorm();
            out.largest = std::max(out.largest, (shown.row(v) - full[e].row(v)).norm() / diagonal);
        }
    }
    return out;
}

}  // namespace imomushi::full_joints
