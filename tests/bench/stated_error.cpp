// SPDX-License-Identifier: GPL-3.0-or-later
// The error that a precompute states beside the error that is there, for bodies of tests/data/reference:
//   bench_stated_error [--modes] [--bisected N] [--folder FOLDER] [--nu NU] [--setting SETTING ...] [NAME ...]
//   bench_stated_error --file FILE.obj --place X,Y,Z,RADIUS ... [...]   a body of any file, held by the vertices of triangles within each radius, against
//     our own finite elements of 20,000 vertices (`change`: from those of 7,000)
// Errors are over the free vertices, relative to the motion of free and held vertices together (root mean squares), as ResponseQuality::error is: the largest and the root
// mean square over the motions. These are the cases that the folder has answers to, or, with --modes, every joint mode alone and random ones together, against our own second-order
// finite elements (`change`: the largest difference from ones with rims 2.5 times as large; errors below three times that are not known). Settings: default and draft.
// Where a body cannot be filled with tetrahedra, the reason stands above.
// Nodes: d: of a decimated body, l: with linear displacement.
// --bisected N: on the same polyhedron with its triangles bisected to about N vertices of equal spacing, measured at the vertices that it had.
// Ratio: stated over largest. Seconds: also over those of a bare dgetrf of order three times the body's vertices, all on one thread.
#include <lapacke.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/elasticity/dense_lu.h"
#include "core/reduction/element_response.h"
#include "core/reduction/solver_mesh.h"
#include "core/worker/worker.h"
#include "tests/support/finite_elements.h"
#include "tests/support/obj.h"
#include "tests/support/reference_case.h"

using namespace imomushi;

namespace {

constexpr int kRandom = 8;

/// Every joint mode alone, then random ones together, their in-plane stretch and turns as large as shifts by the size of the face: #columns x #motions.
Eigen::MatrixXd motionsOf(const ReferenceBody& body, const std::vector<FaceBasis>& bases) {
    Eigen::Index columns = 0;
    for (const FaceBasis& basis : bases) columns += basis.columns();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(columns, columns + kRandom);
    out.leftCols(columns).setIdentity();
    std::mt19937 random(1);
    for (Eigen::Index m = columns; m < out.cols(); ++m) {
        Eigen::Index at = 0;
        for (std::size_t f = 0; f < bases.size(); ++f)
            for (int c = 0; c < bases[f].columns(); ++c) {
                const double x = 2.0 * static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 1.0;
                const bool shift = c == 5 || c == 6 || c == 7;
                out(at++, m) = shift ? x * body.faces[f].size : x;
            }
    }
    return out;
}

/// Answers of finite elements to `motions` at the vertices of the body. Empty: there are none.
std::vector<Points> finiteElements(const ReferenceBody& body, const std::vector<FaceBasis>& bases, const Eigen::MatrixXd& motions, double nu, double rim, double growth) {
    double size = 1e300;
    for (const JointFace& face : body.faces) size = std::min(size, std::sqrt(face.area / std::numbers::pi));
    const auto mesh = finite_elements::meshBody(body.mesh->body, body.faces, {.rim = rim * size, .crease = 4.0 * rim * size, .bulk = 0.4 * size, .growth = growth});
    if (!mesh) {
        std::printf("  %s\n", mesh.error().message.c_str());
        return {};
    }
    auto solver = finite_elements::Elastostatics::build(*mesh, nu);
    if (!solver) {
        std::printf("  %s\n", solver.error().message.c_str());
        return {};
    }
    std::vector<Points> held(static_cast<std::size_t>(motions.cols()), Points::Zero(mesh->nodes.rows(), 3));
    Eigen::Index first = 0;
    for (std::size_t f = 0; f < bases.size(); ++f) {
        const auto& frame = body.faces[f].frame;
        for (const std::int32_t i : mesh->nodesOfFace[f]) {
            const Eigen::MatrixXd at = frame.axes * bases[f].at(frame.toLocal(mesh->nodes.row(i).transpose())) * motions.middleRows(first, bases[f].columns());
            for (std::size_t m = 0; m < held.size(); ++m) held[m].row(i) = at.col(static_cast<Eigen::Index>(m)).transpose();
        }
        first += bases[f].columns();
    }
    auto solution = solver->solve(held);
    if (!solution) return {};
    std::vector<Points> out;
    for (const Points& all : solution->displacement) out.push_back(mesh->atVertices(all));
    return out;
}

/// Those of our own precompute with another solver mesh, for bodies whose rims gmsh would take hours for.
std::vector<Points> ownAnswers(const ReferenceBody& body, ResponseInput input, const Eigen::MatrixXd& motions, const std::string& solverMesh) {
    input.solverMesh = parseSolverMesh(solverMesh).value();
    input.threads = hardwareThreads();
    const auto response = buildResponse(input, {});
    if (!response) return {};
    const Eigen::MatrixXd u = response->response * motions;
    std::vector<Points> out;
    for (Eigen::Index m = 0; m < motions.cols(); ++m) {
        Points& all = out.emplace_back(Points::Zero(body.mesh->body.vertices.rows(), 3));
        Eigen::Index first = 0;
        for (std::size_t f = 0; f < body.faces.size(); ++f) {
            const auto& frame = body.faces[f].frame;
            const Eigen::VectorXd v = motions.col(m).segment(first, response->bases[f].columns());
            for (const std::int32_t i : body.faces[f].vertices) all.row(i) = (frame.axes * response->bases[f].at(frame.toLocal(body.mesh->body.vertices.row(i).transpose())) * v).transpose();
            first += response->bases[f].columns();
        }
        for (std::size_t i = 0; i < body.freeVertices.size(); ++i) all.row(body.freeVertices[i]) = u.block<3, 1>(3 * static_cast<Eigen::Index>(i), m).transpose();
    }
    return out;
}

/// The cases of `answers` with this Poisson ratio, as coefficients of `bases`.
Eigen::MatrixXd motionsOf(const ReferenceBody& body, const std::vector<FaceBasis>& bases, const std::vector<ReferenceCase>& answers, double nu, std::vector<Points>& displacement) {
    std::vector<Eigen::VectorXd> motions;
    Eigen::Index columns = 0;
    for (const FaceBasis& basis : bases) columns += basis.columns();
    for (const ReferenceCase& one : answers) {
        if (one.nu != nu) continue;
        Eigen::VectorXd& v = motions.emplace_back(Eigen::VectorXd::Zero(columns));
        Eigen::Index first = 0;
        for (std::size_t f = 0; f < bases.size(); ++f) {
            const auto parameters = one.faces.find(body.faces[f].name);
            double lost = 0.0;
            if (parameters != one.faces.end()) bases[f].coefficients(jointMap(parameters->second), body.faces[f].size, v.data() + first, lost);
            first += bases[f].columns();
        }
        displacement.push_back(one.displacement);
    }
    Eigen::MatrixXd out(columns, static_cast<Eigen::Index>(motions.size()));
    for (std::size_t m = 0; m < motions.size(); ++m) out.col(static_cast<Eigen::Index>(m)) = motions[m];
    return out;
}

/// The body of a file, held by the vertices of triangles within each of the balls "X,Y,Z,RADIUS".
ReferenceBody readHeldBody(const std::string& file, const std::vector<std::string>& balls) {
    ReferenceBody body;
    body.name = std::filesystem::path(file).stem().string();
    body.mesh = std::make_shared<ElementMesh>();
    body.mesh->body = readObj(file);
    const Points& vertices = body.mesh->body.vertices;
    std::vector<char> held(static_cast<std::size_t>(vertices.rows()));
    for (const std::string& ball : balls) {
        Vec3 middle = Vec3::Zero();
        double radius = 0.0;
        if (std::sscanf(ball.c_str(), "%lf,%lf,%lf,%lf", &middle[0], &middle[1], &middle[2], &radius) != 4) throw std::runtime_error("\"" + ball + "\" is not X,Y,Z,RADIUS.");
        std::set<std::int32_t> corners;  // of triangles that lie within
        const auto inside = [&](std::int32_t v) { return (vertices.row(v).transpose() - middle).norm() <= radius; };
        for (const auto& t : body.mesh->body.triangles.rowwise())
            if (inside(t[0]) && inside(t[1]) && inside(t[2])) corners.insert({t[0], t[1], t[2]});
        const std::vector<std::int32_t> within(corners.begin(), corners.end());
        for (const std::int32_t v : within) held[static_cast<std::size_t>(v)] = 1;
        auto face = jointFaceByVertices(body.mesh->body, within);
        if (!face) throw std::runtime_error(face.error().message);
        body.faces.push_back(std::move(*face));
    }
    for (std::size_t v = 0; v < held.size(); ++v)
        if (!held[v]) body.freeVertices.push_back(static_cast<std::int32_t>(v));
    return body;
}

struct Errors {
    double largest = 0.0, rms = 0.0;
};

/// `differs(m, v)`: the difference of free vertex v (its place among the free ones) in motion m.
template <class Difference>
Errors errorsOf(const ReferenceBody& body, const std::vector<Points>& truth, const Difference& differs) {
    Errors out;
    const auto free = static_cast<double>(body.freeVertices.size()), held = static_cast<double>(truth.front().rows()) - free;
    for (std::size_t m = 0; m < truth.size(); ++m) {
        double wrong = 0.0, moved = 0.0;
        for (std::size_t i = 0; i < body.freeVertices.size(); ++i) {
            wrong += Vec3(differs(m, i)).squaredNorm() / free;
            moved += truth[m].row(body.freeVertices[i]).squaredNorm();
        }
        const double error = std::sqrt(wrong / (moved / free + (truth[m].squaredNorm() - moved) / held));
        out.largest = std::max(out.largest, error);
        out.rms += error * error / static_cast<double>(truth.size());
    }
    out.rms = std::sqrt(out.rms);
    return out;
}

/// The same polyhedron with at least `vertices` vertices, the new ones after the others. `freeVertices` stay as they are.
void bisect(ReferenceBody& body, int vertices) {
    const TriangleMesh& mesh = body.mesh->body;
    std::vector<std::int32_t> label(static_cast<std::size_t>(mesh.triangles.rows()), -1);
    for (std::size_t f = 0; f < body.faces.size(); ++f)
        for (const std::int32_t t : body.faces[f].triangles) label[static_cast<std::size_t>(t)] = static_cast<std::int32_t>(f);
    SolverMesh fine = plainSolverMesh(mesh, body.faces);
    for (double edge = body.diagonal(); fine.mesh.vertices.rows() < vertices; edge *= 0.97)
        fine = bisectedTo(mesh, label, body.faces.size(), std::vector<double>(static_cast<std::size_t>(mesh.vertices.rows()), edge));
    for (std::size_t f = 0; f < body.faces.size(); ++f) {
        const std::string name = body.faces[f].name;
        body.faces[f] = jointFaceByVertices(fine.mesh, fine.faces[f].vertices).value();
        body.faces[f].name = name;
    }
    body.mesh = std::make_shared<ElementMesh>(ElementMesh{fine.mesh, {}});
}

double secondsOfDgetrf(lapack_int n) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Random(n, n);
    std::vector<lapack_int> pivots(static_cast<std::size_t>(n));
    useSingleThreadedBlas();
    const auto start = std::chrono::steady_clock::now();
    LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n, n, matrix.data(), n, pivots.data());
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void measure(const ReferenceBody& body, const std::vector<ReferenceCase>& answers, bool modes, bool own, double nu, const std::vector<std::string>& settings, double bare) {
    ResponseInput input;
    input.mesh = body.mesh;
    input.faces = body.faces;
    input.nu = nu;
    input.basis = BasisKind::Affine;
    std::vector<FaceBasis> bases;
    for (const JointFace& face : body.faces) bases.push_back(FaceBasis::on(body.mesh->body, face, input.basis));
    std::vector<Points> truth;
    Eigen::MatrixXd motions;
    double change = -1.0;
    if (modes && own) {
        motions = motionsOf(body, bases);
        truth = ownAnswers(body, input, motions, "volume:20000");
        const std::vector<Points> coarse = ownAnswers(body, input, motions, "volume:7000");
        if (truth.empty() || coarse.empty()) return;
        change = errorsOf(body, truth, [&](std::size_t m, std::size_t i) -> Vec3 { return (coarse[m].row(body.freeVertices[i]) - truth[m].row(body.freeVertices[i])).transpose(); }).largest;
    } else if (modes) {
        motions = motionsOf(body, bases);
        truth = finiteElements(body, bases, motions, nu, 0.015, 0.5);
        const std::vector<Points> coarse = finiteElements(body, bases, motions, nu, 0.0375, 0.6);
        if (truth.empty() || coarse.empty()) return;
        change = errorsOf(body, truth, [&](std::size_t m, std::size_t i) -> Vec3 { return (coarse[m].row(body.freeVertices[i]) - truth[m].row(body.freeVertices[i])).transpose(); }).largest;
    } else {
        motions = motionsOf(body, bases, answers, nu, truth);
    }
    if (truth.empty()) return;
    for (const std::string& setting : settings) {
        input.solverMesh = parseSolverMesh(setting).value();
        const auto response = buildResponse(input, {});
        if (!response) {
            std::printf("%-22s %s\n", body.name.c_str(), response.error().message.c_str());
            continue;
        }
        const Eigen::MatrixXd u = response->response * motions;
        const Errors errors = errorsOf(body, truth, [&](std::size_t m, std::size_t i) -> Vec3 {
            return u.block<3, 1>(3 * static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(m)) - truth[m].row(body.freeVertices[i]).transpose();
        });
        const ResponseQuality& quality = response->quality;
        if (!quality.noFilling.empty()) std::printf("  %s\n", quality.noFilling.c_str());
        const double stated = quality.error + quality.mappingError;
        std::printf("%-22s %5ld %.2f %-9s %5d %c %6.2f %6.2f %6.2f %6.2f %6.2f %6.2f %7.2f %7.1f", body.name.c_str(), static_cast<long>(body.mesh->body.vertices.rows()), nu, setting.c_str(),
                    quality.solverNodes, quality.decimated ? 'd' : quality.solverNodes == quality.solverVertices ? 'l' : ' ', 100.0 * quality.error, 100.0 * quality.mappingError, 100.0 * quality.shapeError, 100.0 * errors.largest,
                    100.0 * errors.rms, stated / errors.largest, quality.seconds, quality.seconds / bare);
        if (change >= 0.0) std::printf(" %6.2f", 100.0 * change);
        std::puts("");
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    // This very program is its worker.
    if (argc > 1 && std::string(argv[1]) == "worker") return workerMain();
    setWorkerProgram("/proc/self/exe");
    std::string folder = std::string(IMOMUSHI_TEST_DATA) + "/reference";
    std::string file;
    std::vector<std::string> names, settings, places;
    std::vector<double> ratios;
    bool modes = false;
    int bisected = 0;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--modes")
            modes = true;
        else if (word == "--folder" && i + 1 < argc)
            folder = argv[++i];
        else if (word == "--file" && i + 1 < argc)
            file = argv[++i];
        else if (word == "--place" && i + 1 < argc)
            places.emplace_back(argv[++i]);
        else if (word == "--bisected" && i + 1 < argc)
            bisected = std::atoi(argv[++i]);
        else if (word == "--nu" && i + 1 < argc)
            ratios.push_back(std::atof(argv[++i]));
        else if (word == "--setting" && i + 1 < argc)
            settings.emplace_back(argv[++i]);
        else
            names.push_back(word);
    }
    if (settings.empty()) settings = {"default", "draft"};
    if (ratios.empty()) ratios = {0.3, 0.45};
    if (!file.empty())
        names = {file}, modes = true;
    else if (names.empty())
        names = {"a_cylinder_coarse", "a_cylinder_fine", "b_prism_coarse", "c_barrel_coarse", "d_tentacle_coarse", "d_tentacle_fine", "e_body_coarse", "f_fin_coarse",
                 "g_hexagon_coarse", "h_elbow_coarse", "i_hollow_elbow_coarse", "j_bored_elbow_coarse", "k_caterpillar_coarse", "l_barrel_coarse", "l_barrel_fine"};
    std::printf("%-22s %5s %4s %-9s %5s   %6s %6s %6s %6s %6s %6s %7s %7s%s\n", "body", "verts", "nu", "setting", "nodes", "stated", "mapped", "shape", "true", "rms", "ratio", "seconds",
                "/dgetrf", modes ? " change" : "");
    try {
        for (const std::string& name : names) {
            ReferenceBody body = file.empty() ? readReferenceBody(folder, name) : readHeldBody(file, places);
            if (bisected > 0) bisect(body, bisected);
            const std::vector<ReferenceCase> answers = modes ? std::vector<ReferenceCase>() : readReferenceCases(folder, name);
            const double bare = secondsOfDgetrf(static_cast<lapack_int>(3 * body.mesh->body.vertices.rows()));
            for (const double nu : ratios) measure(body, answers, modes, !file.empty(), nu, settings, bare);
        }
    } catch (const std::exception& reason) {
        std::printf("%s\n", reason.what());
        return 1;
    }
    return 0;
}
