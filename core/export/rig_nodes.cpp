// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/rig_nodes.h"

#include <Eigen/LU>

namespace imomushi {

namespace {

// Relative: scales along axes that differ by less are what programs round over long chains. Places of bones are exact all the same.
constexpr double kEven = 1e-3;
constexpr double kSmallest = 1e-9;  // of a scale

/// The scale of a transformation that scales all axes alike, negative where it mirrors; 0: it does not.
double evenScale(const Eigen::Matrix3d& linear) {
    const Vec3 lengths = linear.colwise().norm().transpose();
    const double mean = lengths.mean();
    if (!(mean > kSmallest)) return 0.0;
    const Eigen::Matrix3d gram = linear.transpose() * linear / (mean * mean);
    if ((gram - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kEven) return 0.0;
    return linear.determinant() < 0.0 ? -mean : mean;
}

Eigen::Matrix4d matrixOf(const RigNode& node) {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = node.rotation.toRotationMatrix() * node.scale.asDiagonal();
    m.topRightCorner<3, 1>() = node.translation;
    return m;
}

}  // namespace

Eigen::Affine3d RigNodes::Place::matrix() const {
    Eigen::Affine3d out = Eigen::Affine3d::Identity();
    out.linear() = scale * rotation.toRotationMatrix();
    out.translation() = at;
    return out;
}

RigNodes::RigNodes(const Rig& rig) : rig_(rig) {
    const std::size_t count = rig.nodes.size();
    bones_.assign(count, -1);
    carrier_.assign(count, -1);
    names_.resize(count);
    for (std::size_t b = 0; b < rig.bones.size(); ++b) {
        bones_[static_cast<std::size_t>(rig.bones[b].node)] = static_cast<int>(b);
        names_[static_cast<std::size_t>(rig.bones[b].node)] = rig.bones[b].name;
    }
    std::vector<Eigen::Matrix4d> chain(count);
    bool even = evenScale(rig.toScene.topLeftCorner<3, 3>()) != 0.0;
    for (std::size_t n = 0; n < count; ++n) {
        const RigNode& node = rig.nodes[n];
        chain[n] = (node.parent < 0 ? rig.toScene : chain[static_cast<std::size_t>(node.parent)]) * matrixOf(node);
        even = even && evenScale(chain[n].topLeftCorner<3, 3>()) != 0.0;
        carrier_[n] = bones_[n] >= 0 || node.parent < 0 ? bones_[n] : carrier_[static_cast<std::size_t>(node.parent)];
        if (names_[n].empty()) names_[n] = node.name.empty() ? "node" : node.name;
    }
    const auto placeOf = [even](const Eigen::Matrix4d& m) {
        return Place{m.topRightCorner<3, 1>(), nearestRotation(m.topLeftCorner<3, 3>()), even ? evenScale(m.topLeftCorner<3, 3>()) : 1.0};
    };
    if (even) root_ = placeOf(rig.toScene);
    for (std::size_t n = 0; n < count; ++n) {
        Place& place = places_.emplace_back(placeOf(chain[n]));
        if (bones_[n] < 0) continue;
        place.at = rig.bones[static_cast<std::size_t>(bones_[n])].head;
        place.rotation = rig.bones[static_cast<std::size_t>(bones_[n])].rotation;
    }
}

bool RigNodes::hasRoot() const {
    const Eigen::Matrix4d m = root_.matrix().matrix();
    return (m - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff() > 1e-12;
}

RigNodes::Local RigNodes::between(const Place& parent, const Place& own) {
    const Eigen::Quaterniond back = parent.rotation.conjugate();
    return {back * (own.at - parent.at) / parent.scale, (back * own.rotation).normalized(), own.scale / parent.scale};
}

RigNodes::Place RigNodes::moved(std::size_t node, const Eigen::Isometry3d* motions) const {
    Place out = places_[node];
    if (carrier_[node] < 0) return out;
    const Eigen::Isometry3d& motion = motions[carrier_[node]];
    out.at = motion * out.at;
    out.rotation = (Eigen::Quaterniond(motion.linear()) * out.rotation).normalized();
    return out;
}

RigNodes::Local RigNodes::local(std::size_t node, const Eigen::Isometry3d* motions) const {
    const int above = parent(node);
    return between(above < 0 ? root_ : moved(static_cast<std::size_t>(above), motions), moved(node, motions));
}

RigNodes::Local RigNodes::restLocal(std::size_t node) const {
    const int above = parent(node);
    return between(above < 0 ? root_ : places_[static_cast<std::size_t>(above)], places_[node]);
}

RigNodes::Local RigNodes::below(int bone, const Eigen::Isometry3d* motions, const Vec3& origin, const Eigen::Isometry3d& motion) const {
    const Place parent = moved(static_cast<std::size_t>(rig_.bones[static_cast<std::size_t>(bone)].node), motions);
    return between(parent, Place{motion * origin, Eigen::Quaterniond(motion.linear()), parent.scale});
}

}  // namespace imomushi
