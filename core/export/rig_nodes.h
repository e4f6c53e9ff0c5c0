// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "core/mesh/rig.h"

namespace imomushi {

/// The skeleton that came with a mesh of a scene, and what moves its bones.
struct ExportedRig {
    std::shared_ptr<const Rig> rig;
    int mesh = -1;  ///< of the scene
    /// What carries a bone of the file: a bone of the skeleton, or where that is -1 the frame of an element; both -1: it rests. Bones that were merged have the mover of their piece.
    struct Mover {
        int bone = -1, element = -1;
        bool operator==(const Mover&) const = default;
    };
    std::vector<Mover> movers;  ///< per bone of the rig
    /// Per element of the scene the bone of the rig that moves its flesh, -1: none does.
    std::vector<int> leads;
};

/// The nodes of a rig as a file has them: hierarchy, names and local transformations of the imported file, below a node that takes its unit and axes to the scene's. So
/// animations of the old file play on it. A file that scales its nodes by different factors along their axes gets rigid nodes in metres instead, since the shear of such
/// chains is no transformation of a node, and one whose skin rests elsewhere than its nodes gets them where the skin rests.
class RigNodes {
public:
    explicit RigNodes(const Rig& rig);

    struct Local {
        Vec3 translation = Vec3::Zero();
        Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit
        double scale = 1.0;                                            ///< of all axes; negative: mirrored
    };
    /// Rest to world where nothing has moved.
    struct Place {
        Vec3 at = Vec3::Zero();  ///< m
        Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
        double scale = 1.0;
        [[nodiscard]] Eigen::Affine3d matrix() const;
    };
    [[nodiscard]] std::size_t count() const { return places_.size(); }
    [[nodiscard]] int parent(std::size_t node) const { return rig_.nodes[node].parent; }
    [[nodiscard]] const std::string& name(std::size_t node) const { return names_[node]; }
    [[nodiscard]] int boneOf(std::size_t node) const { return bones_[node]; }  ///< -1: it is none
    [[nodiscard]] const Place& place(std::size_t node) const { return places_[node]; }
    /// The node above all others: the unit and axes of the file.
    [[nodiscard]] const Place& root() const { return root_; }
    [[nodiscard]] bool hasRoot() const;

    /// `motions`: rest to world, per bone of the rig.
    [[nodiscard]] Local local(std::size_t node, const Eigen::Isometry3d* motions) const;
    [[nodiscard]] Local restLocal(std::size_t node) const;
    /// The same of something that moves by `motion` below a bone, and has its scale: programs bear no others within a skeleton.
    [[nodiscard]] Local below(int bone, const Eigen::Isometry3d* motions, const Vec3& origin, const Eigen::Isometry3d& motion) const;

private:
    [[nodiscard]] static Local between(const Place& parent, const Place& own);
    [[nodiscard]] Place moved(std::size_t node, const Eigen::Isometry3d* motions) const;

    const Rig& rig_;
    Place root_;
    std::vector<Place> places_;       // per node
    std::vector<int> bones_, carrier_;  // per node: the bone that it is; and that or the nearest one above it, -1: none
    std::vector<std::string> names_;
};

}  // namespace imomushi
