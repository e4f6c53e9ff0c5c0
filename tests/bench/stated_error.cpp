// SPDX-License-Identifier: GPL-3.0-or-later
// The error that a precompute states beside the error that is there, for bodies of tests/data/reference:
//   bench_stated_error [--modes] [--write] [--handles] [--rigid] [--bisected N] [--folder FOLDER] [--nu NU] [--setting SETTING ...] [NAME ...]
//   bench_stated_error --file FILE.obj --place X,Y,Z,RADIUS ... [...]   a body of any file, held by the vertices of triangles within each radius (with --handles by three handles), against
//     our own finite elements on the body itself
// Errors are over the free vertices, relative to the motion of free and held vertices together (root mean squares), as ResponseQuality::error is: the largest and the root
// mean square over the motions. These are the cases that the folder has answers to, or, with --modes, every joint mode alone and random ones together, against our own second-order
// finite elements, extrapolated from rims of two sizes (`change`: the largest difference between them; the answer is off by a tenth of it, about). --write keeps them as
// NAME.modes.json, at the ratios of all --nu. Settings: default and draft.
// --handles: three handles take the place of the faces; every move and turn alone, and random ones together. --rigid: the same motions of the faces.
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
#include "core/meshing/body_surface.h"
#include "core/meshing/solver_mesh.h"
#include "core/meshing/volume_body.h"
#include "core/reduction/element_response.h"
#include "core/reduction/element_statics.h"
#include "core/reduction/held_modes.h"
#include "core/worker/worker.h"
#include "tests/support/bisected_body.h"
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

/// Moves and turns of every handle alone, then random ones together: #columns x #motions.
Eigen::MatrixXd rigidMotionsOf(const ReferenceBody& body, const std::vector<FaceBasis>& bases) {
    std::vector<Eigen::VectorXd> motions;
    Eigen::Index columns = 0, first = 0;
    for (const FaceBasis& basis : bases) columns += basis.columns();
    for (std::size_t f = 0; f < bases.size(); ++f) {
        const auto add = [&] { return motions.emplace_back(Eigen::VectorXd::Zero(columns)).data() + first; };
        for (int axis = 0; axis < 3; ++axis) {
            JointMap move, turn;
            move.shift = Vec3::Unit(axis);
            const int next = (axis + 1) % 3, last = (axis + 2) % 3;
            turn.linear(last, next) = 1.0;
            turn.linear(next, last) = -1.0;
            double lost = 0.0;
            bases[f].coefficients(move, body.faces[f].size, add(), lost);
            bases[f].coefficients(turn, body.faces[f].size, add(), lost);
        }
        first += bases[f].columns();
    }
    const auto n = static_cast<Eigen::Index>(motions.size());
    Eigen::MatrixXd alone(columns, n);
    for (Eigen::Index m = 0; m < n; ++m) alone.col(m) = motions[static_cast<std::size_t>(m)];
    Eigen::MatrixXd together = Eigen::MatrixXd::Zero(n, n + kRandom);
    together.leftCols(n).setIdentity();
    std::mt19937 random(1);
    for (Eigen::Index m = n; m < together.cols(); ++m)
        for (Eigen::Index k = 0; k < n; ++k) together(k, m) = (k % 2 == 0 ? body.faces.front().size : 1.0) * (2.0 * static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 1.0);
    return alone * together;
}

/// Three handles in place of the body's faces, far from each other, of a radius of 6 % of its diagonal.
void putHandles(ReferenceBody& body) {
    const TriangleMesh& mesh = body.mesh->body;
    body.faces.clear();
    std::vector<double> distance(static_cast<std::size_t>(mesh.triangles.rows()), 1e300);
    const double diagonal = body.diagonal();
    Vec3 from = mesh.vertices.colwise().mean();
    const auto centre = [&](std::size_t t) -> Vec3 {
        Vec3 c = Vec3::Zero();
        for (int k = 0; k < 3; ++k) c += mesh.vertices.row(mesh.triangles(static_cast<Eigen::Index>(t), k)).transpose() / 3.0;
        return c;
    };
    bool begun = false;
    while (body.faces.size() < 3) {
        std::size_t best = 0;
        double far = -1.0;
        for (std::size_t t = 0; t < distance.size(); ++t) {
            if (distance[t] < 0.0) continue;
            const double d = begun ? distance[t] : (centre(t) - from).norm();
            if (d > far) far = d, best = t;
        }
        if (far < 0.0) break;
        const SurfacePoint place = nearestOnSurface(mesh, centre(best));
        auto face = jointFaceByDisc(mesh, place.triangle, place.point, 0.06 * diagonal);
        if (!face) {
            distance[best] = -1.0;
            continue;
        }
        face->disc = SurfaceDisc{place.point, 0.06 * diagonal};
        body.faces.push_back(std::move(*face));
        begun = true;
        for (std::size_t t = 0; t < distance.size(); ++t)
            if (distance[t] >= 0.0) distance[t] = std::min(distance[t], (centre(t) - place.point).norm());
    }
    body.freeVertices.clear();
    std::vector<char> held(static_cast<std::size_t>(mesh.vertices.rows()));
    for (const JointFace& face : body.faces)
        for (const std::int32_t v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
    for (std::size_t v = 0; v < held.size(); ++v)
        if (!held[v]) body.freeVertices.push_back(static_cast<std::int32_t>(v));
    const BodySurface surface(mesh, body.faces);
    std::printf("  %s: %zu handles, %ld exact, %zu inside\n", body.name.c_str(), body.faces.size(), std::count(surface.discs.exact.begin(), surface.discs.exact.end(), 1), surface.discs.inside.size());
    body.name += "_handles";
}

/// Answers of finite elements to `motions` at the vertices of the body. Empty: there are none.
std::vector<Points> finiteElements(const ReferenceBody& body, const std::vector<FaceBasis>& bases, const Eigen::MatrixXd& motions, double nu, double rim, double growth) {
    double size = 1e300;
    for (const JointFace& face : body.faces) size = std::min(size, std::sqrt(face.area / std::numbers::pi));
    const BodySurface surface(body.mesh->body, body.faces);
    const auto mesh = finite_elements::meshBody(surface.triangles(), surface.faces, {.rim = rim * size, .crease = 4.0 * rim * size, .bulk = 0.4 * size, .growth = growth});
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
    for (const Points& all : solution->displacement) out.push_back(mesh->atVertices(all).topRows(body.mesh->body.vertices.rows()));
    return out;
}

/// Those of our own finite elements on the body itself, with edges of `rim` times the radius of its face at each rim, for bodies that gmsh would take hours for. Empty: there are none.
std::vector<Points> ownAnswers(const ReferenceBody& body, const ResponseInput& input, const std::vector<FaceBasis>& bases, const Eigen::MatrixXd& motions, double rim) {
    const TriangleMesh& mesh = body.mesh->body;
    const auto element = trimmedElement(input, {});
    if (!element) return {};
    const TriangleMesh& trimmed = element->input.mesh->body;
    const auto solved = volumeBody(BodySurface(trimmed, element->input.faces), {static_cast<int>(trimmed.vertices.rows()), rim, true}, {});
    if (!solved) {
        std::printf("  %s\n", solved.error().message.c_str());
        return {};
    }
    std::vector<int> first(1, 0);
    for (const FaceBasis& basis : bases) first.push_back(first.back() + basis.columns());
    const HeldModes modes = heldModes(trimmed, element->input.faces, *solved, bases, first);
    const auto solution = solveStatics(*element, *solved, modes.C * motions, modes.inside * motions, {}, {});
    if (!solution) return {};
    std::vector<Points> out;
    for (Eigen::Index m = 0; m < motions.cols(); ++m) {
        Points& all = out.emplace_back(Points::Zero(mesh.vertices.rows(), 3));
        for (std::size_t f = 0; f < body.faces.size(); ++f) {
            const auto& frame = body.faces[f].frame;
            const Eigen::VectorXd v = motions.col(m).segment(first[f], bases[f].columns());
            for (const std::int32_t i : body.faces[f].vertices) all.row(i) = (frame.axes * bases[f].at(frame.toLocal(mesh.vertices.row(i).transpose())) * v).transpose();
        }
        for (std::size_t i = 0; i < body.freeVertices.size(); ++i) all.row(body.freeVertices[i]) = solution->response.block<3, 1>(3 * static_cast<Eigen::Index>(i), m).transpose();
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

/// Finite elements without end, by Richardson's extrapolation from rims of two sizes: there the error falls a little faster than they do. `answers(rim)`: with edges at rims of so many
/// radii of faces. `change`: between the two, the largest relative one.
template <class Answers>
std::vector<Points> extrapolated(const Answers& answers, double& change) {
    constexpr double kRim = 0.012, kCoarser = 2.5, kLeft = 0.5;
    std::vector<Points> out = answers(kRim);
    const std::vector<Points> coarse = answers(kRim * kCoarser);
    if (out.empty() || coarse.empty()) return {};
    change = 0.0;
    for (std::size_t m = 0; m < out.size(); ++m) {
        const Points difference = out[m] - coarse[m];
        change = std::max(change, difference.norm() / out[m].norm());
        out[m] += kLeft * difference;
    }
    return out;
}

/// What NAME.modes.json keeps of the answers to every joint mode alone.
ReferenceModes kept(const ReferenceBody& body, double nu, const std::vector<Points>& truth) {
    constexpr std::size_t kMost = 100;
    ReferenceModes out;
    out.nu = nu;
    const std::size_t count = std::min(kMost, body.freeVertices.size());
    for (std::size_t i = 0; i < count; ++i) out.vertices.push_back(body.freeVertices[(2 * i + 1) * body.freeVertices.size() / (2 * count)]);
    for (std::size_t m = 0; m + kRandom < truth.size(); ++m) {
        Points& u = out.displacement.emplace_back(static_cast<Eigen::Index>(count), 3);
        for (std::size_t i = 0; i < count; ++i) u.row(static_cast<Eigen::Index>(i)) = truth[m].row(out.vertices[i]);
    }
    return out;
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

double secondsOfDgetrf(lapack_int n) {
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Random(n, n);
    std::vector<lapack_int> pivots(static_cast<std::size_t>(n));
    useSingleThreadedBlas();
    const auto start = std::chrono::steady_clock::now();
    LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n, n, matrix.data(), n, pivots.data());
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// `original`: before it was bisected. `written`: gets what is kept of the answers.
void measure(const ReferenceBody& original, const ReferenceBody& body, const std::vector<ReferenceCase>& answers, bool modes, bool rigid, bool own, double nu, const std::vector<std::string>& settings, double bare,
             std::vector<ReferenceModes>* written) {
    ResponseInput input;
    input.mesh = body.mesh;
    input.faces = body.faces;
    input.nu = nu;
    input.basis = BasisKind::Affine;
    std::vector<FaceBasis> bases;
    for (const JointFace& face : body.faces) bases.push_back(FaceBasis::on(body.mesh->body, face, input.basis));
    std::vector<Points> truth;
    const bool handles = body.faces.front().disc.has_value();
    Eigen::MatrixXd motions;
    double change = -1.0;
    if (modes) motions = handles || rigid ? rigidMotionsOf(original, bases) : motionsOf(original, bases);
    if (modes && own) {
        input.threads = hardwareThreads();
        truth = extrapolated([&](double rim) { return ownAnswers(body, input, bases, motions, rim); }, change);
        input.threads = 1;
    } else if (modes) {
        truth = extrapolated([&](double rim) { return finiteElements(original, bases, motions, nu, rim, 0.5); }, change);
        if (written && !truth.empty()) written->push_back(kept(original, nu, truth));
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
        const Errors errors = errorsOf(original, truth, [&](std::size_t m, std::size_t i) -> Vec3 {
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
    bool modes = false, handles = false, rigid = false, write = false;
    int bisected = 0;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--modes")
            modes = true;
        else if (word == "--write")
            modes = write = true;
        else if (word == "--handles")
            modes = handles = true;
        else if (word == "--rigid")
            modes = rigid = true;
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
            if (handles) putHandles(body);
            std::vector<ReferenceModes> written;
            const ReferenceBody original = body;
            if (bisected > 0) bisect(body, bisected);
            const std::vector<ReferenceCase> answers = modes ? std::vector<ReferenceCase>() : readReferenceCases(folder, name);
            const double bare = secondsOfDgetrf(static_cast<lapack_int>(3 * body.mesh->body.vertices.rows()));
            for (const double nu : ratios) measure(original, body, answers, modes, rigid, !file.empty(), nu, settings, bare, write ? &written : nullptr);
            if (!written.empty()) writeReferenceModes(folder, name, written);
        }
    } catch (const std::exception& reason) {
        std::printf("%s\n", reason.what());
        return 1;
    }
    return 0;
}
