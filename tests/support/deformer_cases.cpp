// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/deformer_cases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/comparison/paper_caterpillar.h"
#include "core/mesh/cgal/intersections.h"
#include "core/mesh/topology.h"
#include "tests/character/caterpillar.h"
#include "tests/support/obj.h"
#include "tests/support/voxels.h"

namespace imomushi {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kFoldAngle = 120.0 * kDegree;
constexpr std::size_t kMaxPairs = 10000;
constexpr double kRow = 1e-6;  // m: vertices of a row have the same distance from the seam

struct Place {
    Vec3 origin, normal;
};

void addElement(CharacterInput& input, std::shared_ptr<const ElementMesh> mesh, const std::vector<Place>& faces, std::vector<int> bones) {
    CharacterInput::Element element;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        auto face = jointFaceByPlane(mesh->body, faces[f].origin, faces[f].normal, 1e-6).value();
        face.name = "face " + std::to_string(f);
        element.faces.push_back(std::move(face));
    }
    element.mesh = std::move(mesh);
    element.bones = std::move(bones);
    input.elements.push_back(std::move(element));
}

void addJoint(CharacterInput& input, int point, std::vector<CharacterInput::Joint::Face> faces) {
    CharacterInput::Joint joint;
    joint.point = point;
    joint.faces = std::move(faces);
    if (joint.faces.size() >= 2) caterpillar::weld(input, joint);
    input.joints.push_back(std::move(joint));
}

std::shared_ptr<const ElementMesh> shared(TriangleMesh mesh) {
    auto out = std::make_shared<ElementMesh>();
    out->body = std::move(mesh);
    return out;
}

/// A row of elements along an axis, a bone through each, caps held.
CharacterInput row(const std::vector<std::shared_ptr<const ElementMesh>>& meshes, const Vec3& from, const Vec3& step) {
    CharacterInput input;
    const int n = static_cast<int>(meshes.size());
    for (int i = 0; i <= n; ++i) input.skeleton.points.push_back(from + i * step);
    for (int i = 0; i < n; ++i) {
        input.skeleton.bones.push_back({i, i + 1, i - 1, step.norm()});
        addElement(input, meshes[i], {{from + i * step, -step}, {from + (i + 1) * step, step}}, {i});
    }
    for (int i = 1; i < n; ++i) addJoint(input, i, {{i - 1, 1, i - 1}, {i, 0, i}});
    addJoint(input, 0, {{0, 0, 0}});
    addJoint(input, n, {{n - 1, 1, n - 1}});
    return input;
}

/// Bones turn relative to their parents about a common axis, and are stretched.
Pose posed(const Skeleton& skeleton, const Vec3& axis, const std::vector<double>& turns, double stretch = 1.0) {
    Pose pose = restPose(skeleton);
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        const auto& bone = skeleton.bones[b];
        const Eigen::Quaterniond before = bone.parent < 0 ? Eigen::Quaterniond::Identity() : pose.frames[bone.parent];
        pose.frames[b] = before * Eigen::Quaterniond(Eigen::AngleAxisd(turns[b], axis));
        pose.points[bone.end] = pose.points[bone.start] + stretch * (pose.frames[b] * (skeleton.points[bone.end] - skeleton.points[bone.start]));
    }
    return pose;
}

DeformerCase made(std::string name, const CharacterInput& input, Pose pose, const Vec3& seamOrigin, const Vec3& seamNormal) {
    return {std::move(name), input, weldedSurface(input), std::move(pose), seamOrigin, seamNormal};
}

CharacterInput cylinder(const std::string& folder) {
    return row({shared(readObj(folder + "/bend_cylinder_left.obj")), shared(readObj(folder + "/bend_cylinder_right.obj"))}, Vec3(-4, 0, 0), Vec3(4, 0, 0));
}

DeformerCase bent(const CharacterInput& input, double angle) {
    return made("bend " + std::to_string(std::lround(angle / kDegree)), input, posed(input.skeleton, Vec3::UnitZ(), {0.0, angle}), Vec3::Zero(), Vec3::UnitX());
}

CharacterInput branched() {
    using shapes::block, shapes::operator+;
    constexpr double kSide = 0.125;
    CharacterInput input;
    input.skeleton.points = {Vec3(0, 0, -3), Vec3(0, 0, -1), Vec3(0, 0, 0), Vec3(0, 0, 3), Vec3(1, 0, -1), Vec3(3, 0, -1)};
    input.skeleton.bones = {{0, 1, -1, 2.0}, {1, 2, 0, 1.0}, {2, 3, 1, 3.0}, {1, 4, 0, 1.0}, {4, 5, 3, 2.0}};
    const auto body = [&](const shapes::Voxels& voxels) { return shared(shapes::surfaceOf(voxels, kSide)); };
    const Vec3 x = Vec3::UnitX(), z = Vec3::UnitZ();
    addElement(input, body(block({-4, -4, -24}, {4, 4, 0}) + block({4, -4, -12}, {8, 4, -4})), {{Vec3(0, 0, -3), -z}, {Vec3(0, 0, 0), z}, {Vec3(1, 0, -1), x}},
               {0, 1, 3});
    addElement(input, body(block({-4, -4, 0}, {4, 4, 24})), {{Vec3(0, 0, 0), -z}, {Vec3(0, 0, 3), z}}, {2});
    addElement(input, body(block({8, -4, -12}, {24, 4, -4})), {{Vec3(1, 0, -1), -x}, {Vec3(3, 0, -1), x}}, {4});
    addJoint(input, 2, {{0, 1, 1}, {1, 0, 2}});
    addJoint(input, 4, {{0, 2, 3}, {2, 0, 4}});
    addJoint(input, 0, {{0, 0, 0}});
    addJoint(input, 3, {{1, 1, 2}});
    addJoint(input, 5, {{2, 1, 4}});
    return input;
}

double quality(const Points& p, const Triangles& triangles, Eigen::Index t) {
    const Vec3 a = p.row(triangles(t, 0)).transpose(), b = p.row(triangles(t, 1)).transpose(), c = p.row(triangles(t, 2)).transpose();
    return 2.0 * std::sqrt(3.0) * (b - a).cross(c - a).norm() / ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm());
}

}  // namespace

std::vector<DeformerCase> deformerCases(const std::string& folder) {
    std::vector<DeformerCase> out;
    const CharacterInput two = cylinder(folder);
    out.push_back(bent(two, 90.0 * kDegree));
    out.push_back(bent(two, 150.0 * kDegree));
    Pose twisted = restPose(two.skeleton);
    twisted.roll = {0.0, std::numbers::pi / 2.0, std::numbers::pi};
    out.push_back(made("twist 180", two, twisted, Vec3::Zero(), Vec3::UnitX()));
    out.push_back(made("stretch 250", two, posed(two.skeleton, Vec3::UnitZ(), {0.0, 0.0}, 2.5), Vec3::Zero(), Vec3::UnitX()));
    out.push_back(made("squash 40", two, posed(two.skeleton, Vec3::UnitZ(), {0.0, 0.0}, 0.4), Vec3::Zero(), Vec3::UnitX()));
    std::vector<std::shared_ptr<const ElementMesh>> thirds;
    for (int i = 0; i < 3; ++i) thirds.push_back(shared(closedCylinder(1.0, 8.0 / 3.0 * i, 8.0 / 3.0, 48, 21)));
    const CharacterInput three = row(thirds, Vec3::Zero(), Vec3(0, 0, 8.0 / 3.0));
    out.push_back(made("S-bend", three, posed(three.skeleton, Vec3::UnitX(), {0.0, 75.0 * kDegree, -75.0 * kDegree}), Vec3(0, 0, 8.0 / 3.0), Vec3::UnitZ()));
    const CharacterInput tree = branched();
    out.push_back(made("branch", tree, posed(tree.skeleton, Vec3::UnitY(), {0.0, 0.0, 60.0 * kDegree, 0.0, 0.0}), Vec3::Zero(), Vec3::UnitZ()));
    return out;
}

DeformerCase deformerCase(const std::string& folder, const std::string& name) {
    for (auto& c : deformerCases(folder))
        if (c.name == name) return c;
    throw std::runtime_error("There is no case \"" + name + "\".");
}

DeformerCase bentCylinder(const std::string& folder, double angle) { return bent(cylinder(folder), angle); }

DeformationMeasures measureDeformation(const DeformerCase& which, const Points& deformed) {
    const Points& rest = which.surface.vertices;
    const Triangles& triangles = which.surface.triangles;
    DeformationMeasures out;
    out.volumeChange = enclosedVolume(deformed, triangles) / enclosedVolume(rest, triangles) - 1.0;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) out.worstQuality = std::min(out.worstQuality, quality(deformed, triangles, t) / quality(rest, triangles, t));
    const TriangleMesh before{rest, triangles}, after{deformed, triangles};
    out.intersections = static_cast<int>(selfIntersections(after, kMaxPairs).size());

    const EdgeTable edges(triangles);
    const auto turn = [&](const TriangleMesh& mesh, int e) {
        const Vec3 a = areaVector(mesh, edges.uses(e)[0].triangle), b = areaVector(mesh, edges.uses(e)[1].triangle);
        return std::atan2(a.cross(b).norm(), a.dot(b));
    };
    const auto distance = [&](std::int32_t v) { return (rest.row(v).transpose() - which.seamOrigin).dot(which.seamNormal); };
    // Rows beside the seam, on each side.
    std::vector<double> rows;
    for (Eigen::Index i = 0; i < triangles.size(); ++i) rows.push_back(distance(triangles.data()[i]));
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end(), [](double a, double b) { return std::abs(a - b) < kRow; }), rows.end());
    const auto above = std::upper_bound(rows.begin(), rows.end(), kRow), seam = std::lower_bound(rows.begin(), rows.end(), -kRow);
    const double high = above == rows.end() ? 0.0 : *std::min(above + 1, rows.end() - 1), low = seam == rows.begin() ? 0.0 : *std::max(seam - 2, rows.begin());
    for (int e = 0; e < edges.size(); ++e) {
        if (edges.uses(e).size() != 2) continue;
        const double angle = turn(after, e);
        // The rim of a cap turns by 90 degrees at rest, and bulging flesh beside it is no fold.
        if (angle > std::max(kFoldAngle, 0.5 * (turn(before, e) + std::numbers::pi))) ++out.folds;
        const double a = distance(edges.uses(e)[0].low), b = distance(edges.uses(e)[0].high);
        if (std::abs(a - b) > kRow || a > high + kRow || a < low - kRow) continue;
        auto& to = std::abs(a) < kRow ? out.crease : out.creaseBeside;
        to = std::max(to, angle);
    }
    return out;
}

}  // namespace imomushi
