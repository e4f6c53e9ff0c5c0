// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/paper_caterpillar.h"
#include "core/base/try.h"

#include <cmath>
#include <map>
#include <numbers>

namespace imomushi {

TriangleMesh closedCylinder(double radius, double low, double length, int around, int along) {
    const int capRings = std::max(1, around / 6);
    // Rings from the middle of the lower cap outwards, up the wall, to the middle of the upper cap.
    std::vector<std::pair<double, double>> rings;  // radius, z
    for (int k = 1; k <= capRings; ++k) rings.emplace_back(radius * k / capRings, low);
    for (int k = 1; k < along; ++k) rings.emplace_back(radius, low + length * k / along);
    for (int k = capRings; k >= 1; --k) rings.emplace_back(radius * k / capRings, low + length);
    const int count = static_cast<int>(rings.size()), last = 1 + count * around;
    TriangleMesh mesh;
    mesh.vertices.resize(last + 1, 3);
    mesh.triangles.resize(2 * count * around, 3);
    mesh.vertices.row(0) << 0.0, 0.0, low;
    mesh.vertices.row(last) << 0.0, 0.0, low + length;
    const auto at = [&](int ring, int i) { return 1 + ring * around + i % around; };
    Eigen::Index t = 0;
    for (int r = 0; r < count; ++r)
        for (int i = 0; i < around; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / around;
            mesh.vertices.row(at(r, i)) << rings[r].first * std::cos(angle), rings[r].first * std::sin(angle), rings[r].second;
            if (r == 0) mesh.triangles.row(t++) << 0, at(r, i + 1), at(r, i);
            if (r + 1 == count) {
                mesh.triangles.row(t++) << last, at(r, i), at(r, i + 1);
                continue;
            }
            const int a = at(r, i), b = at(r, i + 1), c = at(r + 1, i + 1), d = at(r + 1, i);
            if (i % 2) {
                mesh.triangles.row(t++) << a, b, c;
                mesh.triangles.row(t++) << a, c, d;
            } else {
                mesh.triangles.row(t++) << a, b, d;
                mesh.triangles.row(t++) << b, c, d;
            }
        }
    return mesh;
}

CharacterInput paperCaterpillar(int around, int elements) {
    constexpr int kElements = 5, kAround = 24, kRows[kElements] = {9, 9, 11, 9, 9};
    constexpr double kRadius = 0.5;
    CharacterInput input;
    input.basis = BasisKind::Paper;
    for (int e = 0; e <= elements; ++e) input.skeleton.points.emplace_back(0.0, 0.0, e);
    for (int e = 0; e < elements; ++e) {
        input.skeleton.bones.push_back({e, e + 1, e - 1, 1.0});
        auto mesh = std::make_shared<ElementMesh>();
        mesh->body = closedCylinder(kRadius, e, 1.0, around, static_cast<int>(std::lround(static_cast<double>(kRows[e % kElements]) * around / kAround)));
        CharacterInput::Element element;
        for (const int side : {0, 1}) {
            auto face = jointFaceByPlane(mesh->body, Vec3(0, 0, e + side), Vec3(0, 0, side ? 1 : -1), 1e-6).value();
            face.name = side ? "high" : "low";
            element.faces.push_back(std::move(face));
        }
        element.mesh = std::move(mesh);
        element.bones = {e};
        input.elements.push_back(std::move(element));
    }
    for (int j = 0; j <= elements; ++j) {
        CharacterInput::Joint joint;
        joint.point = j;
        if (j > 0) joint.faces.push_back({j - 1, 1, j - 1});
        if (j < elements) joint.faces.push_back({j, 0, j});
        if (joint.faces.size() == 2) {
            const auto& below = input.elements[j - 1];
            const auto& above = input.elements[j];
            // Both caps have the same coordinates: vertices correspond by index.
            std::map<std::pair<double, double>, std::int32_t> places;
            for (const auto b : above.faces[0].vertices) places[{above.mesh->body.vertices(b, 0), above.mesh->body.vertices(b, 1)}] = b;
            for (const auto a : below.faces[1].vertices)
                if (const auto b = places.find({below.mesh->body.vertices(a, 0), below.mesh->body.vertices(a, 1)}); b != places.end()) joint.welded.emplace_back(a, b->second);
        }
        input.joints.push_back(std::move(joint));
    }
    return input;
}

Result<ComparedModels> solvedPaperCaterpillar(const Progress& progress) {
    ComparedModels out;
    out.input = paperCaterpillar();
    out.full.resize(out.input.elements.size());
    for (const std::size_t solved : {0, 2}) {
        const auto& element = out.input.elements[solved];
        ResponseInput in;
        in.mesh = element.mesh;
        in.faces = element.faces;
        in.solverMesh = {SolverMeshSetting::Kind::AsIs, 0};
        for (const BasisKind basis : {BasisKind::Paper, BasisKind::Full}) {
            const double from = (solved == 0 ? 0.0 : 0.5) + (basis == BasisKind::Paper ? 0.0 : 0.2);
            in.basis = basis;
            IMOMUSHI_TRY(auto built, buildResponse(in, progress.part(from, from + (basis == BasisKind::Paper ? 0.2 : 0.3))));
            const auto response = std::make_shared<const ElementResponse>(std::move(built));
            for (std::size_t e = 0; e < out.full.size(); ++e)
                if ((e == 2) == (solved == 2)) (basis == BasisKind::Paper ? out.input.elements[e].response : out.full[e]) = response;
        }
    }
    return out;
}

}  // namespace imomushi
