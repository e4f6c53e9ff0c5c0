// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "remesh.h"

namespace imomushi::samples {

/// A joint of a skeleton in the bind pose, unturned.
struct RigJoint {
    std::string name;
    int parent;   ///< -1: the root
    Vec3 place;   ///< m, in space
};

/// A flat piece of a texture: where a triangle belongs, and how a point of it is unrolled (m).
struct Chart {
    std::function<bool(const Vec3& p, const Vec3& n)> holds;
    std::function<Eigen::Vector2d(const Vec3&)> unroll;
};

/// A part of a rigged character: a mesh of its own with a material.
struct RiggedPart {
    std::string name, material;
    double roughness = 0.5;
    Mesh mesh;
    Shape shape;                                              ///< its normals
    std::function<Vec3(const Vec3& p, const Vec3& n, double texel)> paint;
    std::vector<Chart> charts;                                ///< the first that holds a triangle has it
    std::function<std::vector<double>(const Vec3&)> weights;  ///< of the joints, not negative, sum above 0
    std::string morph;                                        ///< name of a morph target; empty: none
    std::function<Vec3(const Vec3&)> morphBy;                 ///< displacement, m
};

/// Turns of a joint about an axis of space, at times in seconds.
struct RigTurn {
    int joint;
    Vec3 axis;
    std::vector<float> times;
    std::vector<double> angles;  ///< radians
};

struct RigClip {
    std::string name;
    std::vector<RigTurn> turns;
};

struct RiggedCharacter {
    std::string name;
    std::vector<RiggedPart> parts;
    std::vector<RigJoint> joints;  ///< parents first
    std::vector<RigClip> clips;
    int textureSize = 1024;
    Shape shape;         ///< all of it: what darkens hollows
    double shade = 0.3;  ///< how much hollows are darkened
};

/// Lays out one texture for all parts, paints it, and writes meshes, skin and clips as one GLB.
void writeRiggedGlb(const RiggedCharacter& character, const std::filesystem::path& path);

/// The baby dragon: FOLDER/dragon/dragon.glb.
void makeDragon(const std::filesystem::path& folder);

}  // namespace imomushi::samples
