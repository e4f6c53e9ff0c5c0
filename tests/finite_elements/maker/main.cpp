// SPDX-License-Identifier: GPL-3.0-or-later
// Makes NAME.json, the finite-element answers for NAME.obj and NAME.faces.json of a folder (tests/data/reference):
//   imomushi_reference FOLDER NAME [rim crease bulk growth]
// rim and crease: size of the tetrahedra at the rims of the joint faces and at re-entrant edges, relative to the radius of a disc as large
// as the smallest face; bulk: relative to the mean edge; growth per distance. Where NAME.json exists already it is not written: its cases
// are solved and the differences printed (how the errors of the references were found).
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "tests/support/finite_elements.h"
#include "tests/support/reference_case.h"

using namespace imomushi;
using nlohmann::ordered_json;

namespace {

double rounded(double x, double unit) { return std::round(x / unit) * unit; }

/// Seven digits, as text and back; nothing below 1e-15.
double digits(double x) {
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%.7g", x);
    return std::abs(x) < 1e-15 ? 0.0 : std::atof(text.data());
}

/// Stretch, bend, tilt with shift, and in-plane stretch that differs from face to face.
std::vector<ReferenceCase> casesOf(const ReferenceBody& body) {
    constexpr double kDegree = std::numbers::pi / 180.0;
    const double far = rounded(0.06 * body.diagonal(), 1e-4), near = rounded(0.05 * body.diagonal(), 1e-4);
    const auto angle = [&](double degrees) { return rounded(degrees * kDegree, 1e-12); };
    const PaperParameters stretch{0.9, 0.9, 0.0, 0.0, far}, bendFirst{1.0, 1.0, angle(90), angle(30), 0.0},
        bendSecond{1.0, 1.0, 0.0, angle(30), 0.0};
    const PaperParameters tilt{1.0, 1.0, angle(40), angle(15), near};
    const PaperParameters asymFirst{0.9, 1.1, angle(-60), 0.0, 0.0}, asymSecond{1.25, 0.8, angle(25), 0.0, 0.0};
    std::vector<ReferenceCase> cases;
    for (const double nu : {0.3, 0.45}) {
        const std::string& first = body.faces.front().name;
        if (body.faces.size() == 1) {
            cases.push_back({"stretch", nu, {{first, stretch}}, {}});
            cases.push_back({"bend", nu, {{first, bendFirst}}, {}});
            cases.push_back({"tilt_shift", nu, {{first, tilt}}, {}});
            cases.push_back({"asym", nu, {{first, asymSecond}}, {}});
        } else {
            const std::string& second = body.faces[1].name;
            cases.push_back({"stretch", nu, {{first, stretch}, {second, stretch}}, {}});
            cases.push_back({"bend", nu, {{first, bendFirst}, {second, bendSecond}}, {}});
            cases.push_back({"tilt_shift", nu, {{second, tilt}}, {}});
            cases.push_back({"asym", nu, {{first, asymFirst}, {second, asymSecond}}, {}});
        }
    }
    return cases;
}

int run(int argc, char** argv) {
    const std::string folder = argv[1], name = argv[2];
    const auto number = [&](int i, double usual) { return argc > i ? std::atof(argv[i]) : usual; };
    const ReferenceBody body = readReferenceBody(folder, name);
    const TriangleMesh& surface = body.mesh->body;
    double size = 1e300, edge = 0.0;
    for (const JointFace& face : body.faces) size = std::min(size, std::sqrt(face.area / std::numbers::pi));
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
        for (int c = 0; c < 3; ++c)
            edge += (surface.vertices.row(surface.triangles(t, c)) - surface.vertices.row(surface.triangles(t, (c + 1) % 3))).norm();
    edge /= 3.0 * static_cast<double>(surface.triangles.rows());
    const auto mesh = finite_elements::meshBody(
        surface, body.faces,
        {.rim = number(3, 0.006) * size, .crease = number(4, 0.02) * size, .bulk = number(5, 0.8) * edge, .growth = number(6, 0.4)});
    if (!mesh) throw std::runtime_error(mesh.error().message);
    std::printf("%s: %ld tetrahedra, %ld nodes\n", name.c_str(), static_cast<long>(mesh->tets.rows()),
                static_cast<long>(mesh->nodes.rows()));

    const bool given = std::filesystem::exists(folder + "/" + name + ".json");
    std::vector<ReferenceCase> cases = given ? readReferenceCases(folder, name) : casesOf(body);
    ordered_json out = {{"mesh", name + ".obj"},
                        {"faces", name + ".faces.json"},
                        {"units", "angles in radians; displacements in the mesh's units, mesh vertex order, global axes"},
                        {"free_vertices", body.freeVertices},
                        {"results", ordered_json::array()}};
    for (const double nu : {0.3, 0.45}) {
        auto solver = finite_elements::Elastostatics::build(*mesh, nu);
        if (!solver) throw std::runtime_error(solver.error().message);
        for (const ReferenceCase& one : cases) {
            if (one.nu != nu) continue;
            const auto solution = solver->solve(std::array<Points, 1>{faceDisplacement(body, one, mesh->nodes, mesh->nodesOfFace)});
            if (!solution) throw std::runtime_error(solution.error().message);
            const Points displacement = mesh->atVertices(solution->displacement[0]);
            if (given) {
                const ReferenceError error = referenceError(body, displacement, one.displacement);
                std::printf("  nu %.2f %-10s rel_l2 %.4f %%, scaled %.4f %%\n", nu, one.name.c_str(), 100.0 * error.relative,
                            100.0 * error.scaled);
                continue;
            }
            ordered_json faces = ordered_json::object(), rows = ordered_json::array();
            for (const auto& [face, p] : one.faces)
                faces[face] = {{"a", p.a}, {"b", p.b}, {"theta1", p.theta1}, {"theta2", p.theta2}, {"dz", p.dz}};
            for (Eigen::Index v = 0; v < displacement.rows(); ++v)
                rows.push_back({digits(displacement(v, 0)), digits(displacement(v, 1)), digits(displacement(v, 2))});
            out["results"].push_back({{"case", one.name}, {"nu", nu}, {"faces", faces}, {"displacement", rows}});
        }
    }
    if (given) return 0;
    std::ofstream file(folder + "/" + name + ".json");
    file << out.dump();
    return file ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::puts("imomushi_reference FOLDER NAME [rim crease bulk growth]");
        return 2;
    }
    try {
        return run(argc, argv);
    } catch (const std::exception& reason) {
        std::printf("%s\n", reason.what());
        return 1;
    }
}
