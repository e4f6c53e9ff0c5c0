// SPDX-License-Identifier: GPL-3.0-or-later
// What a user would use instead, beside what we do, for the bodies of tests/data/reference, on all processors: second-order finite elements
// (meshing, factorisation, seconds per pose, error, peak memory) at three gradings; the precompute of core; and the assembly of the
// boundary-element matrix by numerical quadrature beside core's closed forms. Each in a process of its own, so that peak memory is its own.
//   bench_finite_elements [NAME | cylinder:VERTICES ...]
// A cylinder of any number of vertices has no reference: its errors are not printed. Of large bodies some rows of the matrix are assembled, spread
// evenly, and the seconds of all of them stated.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/parallel.h"
#include "core/reduction/element_response.h"
#include "tests/bench/quadrature_assembly.h"
#include "tests/support/finite_elements.h"
#include "tests/support/reference_case.h"
#include "tests/support/shapes.h"

using namespace imomushi;

namespace {

const std::string kFolder = std::string(IMOMUSHI_TEST_DATA) + "/reference";
constexpr double kNu = 0.45;

class Stopwatch {
public:
    [[nodiscard]] double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Runs `work` in a child and prints the child's peak memory after what it prints itself.
void measured(const std::function<void()>& work) {
    std::fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        work();
        std::fflush(stdout);
        _exit(0);
    }
    rusage usage{};
    int status = 0;
    wait4(child, &status, 0, &usage);
    if (status == 0)
        std::printf(", peak %.0f MB\n", static_cast<double>(usage.ru_maxrss) / 1024.0);
    else
        std::printf(": ended with status %d\n", status);
}

/// Errors of the cases stretch, bend, tilt_shift (rel_l2) and asym (rel_l2_scaled), in percent.
class Errors {
public:
    void add(const ReferenceBody& body, const ReferenceCase& wanted, const Points& displacement) {
        if (wanted.displacement.rows() == 0) return;
        const bool asym = wanted.name == "asym";
        const ReferenceError error = referenceError(body, displacement, wanted.displacement);
        text_ += (text_.empty() ? "" : " / ") + percent(asym ? error.scaled : error.relative);
    }
    [[nodiscard]] std::string text() const { return text_.empty() ? "" : ", error " + text_ + " %"; }

private:
    static std::string percent(double x) {
        std::array<char, 32> text{};
        std::snprintf(text.data(), text.size(), "%.2f", 100.0 * x);
        return text.data();
    }
    std::string text_;
};

void finiteElements(const ReferenceBody& body, const std::vector<ReferenceCase>& cases, double rim, double growth) {
    double size = 1e300;
    for (const JointFace& face : body.faces) size = std::min(size, std::sqrt(face.area / std::numbers::pi));
    const Stopwatch meshing;
    const auto mesh = finite_elements::meshBody(body.mesh->body, body.faces,
                                                {.rim = rim * size, .crease = 4.0 * rim * size, .bulk = 0.4 * size, .growth = growth});
    const double meshSeconds = meshing.seconds();
    if (!mesh) {
        std::printf("  finite elements: %s", mesh.error().message.c_str());
        return;
    }
    const Stopwatch factoring;
    auto solver = finite_elements::Elastostatics::build(*mesh, kNu);
    const double factorSeconds = factoring.seconds();
    if (!solver) {
        std::printf("  finite elements: %s", solver.error().message.c_str());
        return;
    }
    Errors errors;
    double poseSeconds = 0.0;
    for (const ReferenceCase& wanted : cases) {
        const Points held = faceDisplacement(body, wanted, mesh->nodes, mesh->nodesOfFace);
        const Stopwatch pose;
        const auto solution = solver->solve(std::array<Points, 1>{held});
        poseSeconds += pose.seconds() / static_cast<double>(cases.size());
        errors.add(body, wanted, mesh->atVertices(solution->displacement[0]));
    }
    std::printf("  finite elements, rim %.3f: %7ld unknowns, meshing %6.2f s, factor %6.2f s, pose %.3f s%s", rim,
                static_cast<long>(solver->unknowns()), meshSeconds, factorSeconds, poseSeconds, errors.text().c_str());
}

void boundaryElements(const ReferenceBody& body, const std::vector<ReferenceCase>& cases) {
    ResponseInput input;
    input.mesh = body.mesh;
    input.faces = body.faces;
    input.nu = kNu;
    input.basis = BasisKind::Paper;
    input.threads = hardwareThreads();
    const auto response = buildResponse(input, {});
    if (!response) {
        std::printf("  core: %s", response.error().message.c_str());
        return;
    }
    Errors errors;
    double poseSeconds = 0.0;
    for (const ReferenceCase& wanted : cases) {
        Eigen::VectorXd v = Eigen::VectorXd::Zero(response->columns());
        for (std::size_t f = 0; f < body.faces.size(); ++f) {
            const auto parameters = wanted.faces.find(body.faces[f].name);
            double lost = 0.0;
            if (parameters != wanted.faces.end())
                response->bases[f].coefficients(jointMap(parameters->second), body.faces[f].size, v.data() + response->firstColumn[f],
                                                lost);
        }
        const Stopwatch pose;
        const Eigen::VectorXd u = response->response * v;
        poseSeconds += pose.seconds() / static_cast<double>(cases.size());
        Points all = Points::Zero(body.mesh->body.vertices.rows(), 3);
        for (std::size_t i = 0; i < response->freeVertices.size(); ++i)
            all.row(response->freeVertices[i]) = u.segment<3>(3 * static_cast<Eigen::Index>(i)).transpose();
        errors.add(body, wanted, all);
    }
    std::printf("  core, default:              precompute %.2f s, pose %.6f s%s", response->quality.seconds, poseSeconds,
                errors.text().c_str());
}

/// |a - b| / |b|, and the largest difference relative to the largest entry.
std::array<double, 2> difference(const std::vector<double>& a, const std::vector<double>& b) {
    double error = 0.0, size = 0.0, worst = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        error += (a[i] - b[i]) * (a[i] - b[i]);
        size += b[i] * b[i];
        worst = std::max(worst, std::abs(a[i] - b[i]));
        largest = std::max(largest, std::abs(b[i]));
    }
    return {std::sqrt(error / size), worst / largest};
}

void assembly(const ReferenceBody& body) {
    const TriangleMesh& mesh = body.mesh->body;
    std::vector<std::int32_t> held, rows, some;
    for (const JointFace& face : body.faces) held.insert(held.end(), face.triangles.begin(), face.triangles.end());
    constexpr double kEntries = 2e6;  // of 18 numbers: 0.3 GB
    const double vertices = static_cast<double>(mesh.vertices.rows()), share = std::min(1.0, kEntries / (vertices * vertices));
    for (double v = 0.0; v < vertices; v += 1.0 / share) {
        rows.push_back(static_cast<std::int32_t>(v));
        if (rows.size() % 16 == 1) some.push_back(rows.back());
    }
    const double all = vertices / static_cast<double>(rows.size());
    const auto seconds = [&](const std::function<void(int)>& assemble, int threads) {
        double best = 1e30;
        for (int round = 0; round < 2; ++round) {
            const Stopwatch watch;
            assemble(threads);
            best = std::min(best, watch.seconds());
        }
        return best * all;
    };
    // Far beyond what anybody would spend: what the others are measured against.
    const AssembledRows exact =
        assembleByQuadrature(mesh, held, some, kNu, {.far = 4, .near = 24, .reach = 4.0, .singularParts = 6}, hardwareThreads());
    const auto closed = [&](int threads) { assembleInClosedForm(mesh, held, rows, kNu, threads); };
    const double one = seconds(closed, 1), two = seconds(closed, 2);
    const AssembledRows core = assembleInClosedForm(mesh, held, some, kNu, 1);
    const auto [h, hMost] = difference(core.h, exact.h);
    const auto [g, gMost] = difference(core.g, exact.g);
    std::printf("  assembly, %-35s 1 thread %7.3f s, 2 threads %7.3f s; from the finest quadrature H %.0e (at most %.0e), G %.0e (%.0e)\n",
                "closed form (core)", one, two, h, hMost, g, gMost);
    struct Choice {
        const char* name;
        Quadrature quadrature;
    };
    for (const auto& [name, quadrature] :
         {Choice{"7 points everywhere", {.far = 1, .near = 1, .reach = 0.0, .singularParts = 1}},
          Choice{"28 points (SurfaceOnlyDeformables)", {.far = 2, .near = 2, .reach = 0.0, .singularParts = 2}},
          Choice{"7 points, 112 where near", {.far = 1, .near = 4, .reach = 3.0, .singularParts = 2}}}) {
        const auto assemble = [&](int threads) { assembleByQuadrature(mesh, held, rows, kNu, quadrature, threads); };
        const double slow = seconds(assemble, 1), fast = seconds(assemble, 2);
        const AssembledRows theirs = assembleByQuadrature(mesh, held, some, kNu, quadrature, 1);
        const auto [hError, hWorst] = difference(theirs.h, core.h);
        const auto [gError, gWorst] = difference(theirs.g, core.g);
        std::printf(
            "  assembly, %-35s 1 thread %7.3f s, 2 threads %7.3f s, %.1f and %.1f times core; from core H %.0e (at most %.0e), G %.0e "
            "(%.0e)\n",
            name, slow, fast, slow / one, fast / two, hError, hWorst, gError, gWorst);
    }
}

/// A cylinder of radius 1 and length 3 of about so many vertices.
ReferenceBody cylinderOf(double vertices) {
    const int around = static_cast<int>(std::lround(std::sqrt(vertices / 0.87)));
    const auto shape = shapes::cylinder(1.0, 3.0, around, around / 2);
    ReferenceBody body;
    body.mesh = std::make_shared<ElementMesh>();
    body.mesh->body = shape.mesh;
    std::vector<char> held(static_cast<std::size_t>(shape.mesh.vertices.rows()));
    for (const auto& end : shape.ends) {
        body.faces.push_back(jointFaceByVertices(shape.mesh, end.vertices).value());
        body.faces.back().name = std::to_string(body.faces.size());
        for (const std::int32_t v : end.vertices) held[static_cast<std::size_t>(v)] = 1;
    }
    for (std::size_t v = 0; v < held.size(); ++v)
        if (!held[v]) body.freeVertices.push_back(static_cast<std::int32_t>(v));
    return body;
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> names(argv + 1, argv + argc);
    if (names.empty()) names = {"a_cylinder_coarse", "c_barrel_coarse", "a_cylinder_fine"};
    try {
        for (const std::string& name : names) {
            constexpr std::string_view kCylinder = "cylinder:";
            const bool made = name.starts_with(kCylinder);
            const ReferenceBody body = made ? cylinderOf(std::atof(name.c_str() + kCylinder.size())) : readReferenceBody(kFolder, name);
            std::vector<ReferenceCase> cases;
            if (made)
                cases.push_back({"stretch", kNu, {{"1", {0.9, 0.9, 0.0, 0.0, 0.2}}, {"2", {0.9, 0.9, 0.0, 0.0, 0.2}}}, {}});
            else
                for (ReferenceCase& one : readReferenceCases(kFolder, name))
                    if (one.nu == kNu) cases.push_back(std::move(one));
            std::printf("%s: %ld vertices, nu %.2f, %d processors; cases", name.c_str(), static_cast<long>(body.mesh->body.vertices.rows()),
                        kNu, hardwareThreads());
            for (const ReferenceCase& one : cases) std::printf(" %s", one.name.c_str());
            std::puts("");
            for (const auto& [rim, growth] : {std::array{0.04, 0.6}, std::array{0.015, 0.5}, std::array{0.006, 0.4}})
                measured([&] { finiteElements(body, cases, rim, growth); });
            measured([&] { boundaryElements(body, cases); });
            measured([&] {
                assembly(body);
                std::printf("  assemblies together");
            });
        }
    } catch (const std::exception& reason) {
        std::printf("%s\n", reason.what());
        return 1;
    }
    return 0;
}
