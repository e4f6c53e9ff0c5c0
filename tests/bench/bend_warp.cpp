// SPDX-License-Identifier: GPL-3.0-or-later
// What the bend warp makes of large motions beside the plain linear response, and what it costs:
//   poses: the capped cylinder of tests/data/reference in two halves, nu = .49, and a body of three faces; volume, worst quality relative to rest,
//   folds
//          (edges where the surface turns back by more than 150 degrees), self-intersections, creases (largest normal jump) at the seam and in rows
//          beside it;
//   speed: milliseconds of processor time per frame at three sizes, one thread, beside the product A' v of the same element in the same run.
//   coarse: distance of bodies that a coarse one carries from the same bodies solved whole, and what both cost.
// The first argument chooses a part; the second is a folder that poses are written to as OBJ files.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <tuple>

#include "core/character/response_blocks.h"
#include "core/mesh/cgal/intersections.h"
#include "core/mesh/bounds.h"
#include "core/mesh/topology.h"
#include "core/warp/bend_warp_tables.h"
#include "tests/support/shapes.h"
#include "tests/warp/bent_bodies.h"

using namespace imomushi;
using namespace imomushi::warped;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
const std::string kReference = IMOMUSHI_REFERENCE "/";
std::string folder;

void writeObj(const std::string& name, const TriangleMesh& mesh) {
    if (folder.empty()) return;
    std::ofstream out(folder + "/" + name + ".obj");
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) out << "v " << mesh.vertices.row(v) << "\n";
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
        out << "f " << mesh.triangles(t, 0) + 1 << " " << mesh.triangles(t, 1) + 1 << " " << mesh.triangles(t, 2) + 1 << "\n";
}

/// One surface of several bodies, welded where vertices are at the same place at rest; triangles that two bodies share are inside and left out.
struct Whole {
    TriangleMesh rest;
    std::vector<std::vector<std::int32_t>> index;  // per body
    explicit Whole(const std::vector<const TriangleMesh*>& bodies) {
        std::map<std::array<long, 3>, std::int32_t> at;
        std::vector<Vec3> points;
        std::map<std::array<std::int32_t, 3>, int> seen;
        std::vector<std::array<std::int32_t, 3>> triangles;
        for (const auto* body : bodies) {
            auto& list = index.emplace_back();
            for (Eigen::Index v = 0; v < body->vertices.rows(); ++v) {
                const Vec3 p = body->vertices.row(v).transpose();
                const std::array<long, 3> key{std::lround(p.x() * 1e6), std::lround(p.y() * 1e6), std::lround(p.z() * 1e6)};
                const auto [it, fresh] = at.try_emplace(key, static_cast<std::int32_t>(points.size()));
                if (fresh) points.push_back(p);
                list.push_back(it->second);
            }
        }
        const auto sorted = [&](std::size_t b, Eigen::Index t) {
            std::array<std::int32_t, 3> k;
            for (int c = 0; c < 3; ++c) k[c] = index[b][bodies[b]->triangles(t, c)];
            std::sort(k.begin(), k.end());
            return k;
        };
        // Caps of both sides may be cut in other triangles: inside is what has all corners in both bodies.
        std::vector<int> in(points.size(), 0);
        for (const auto& list : index)
            for (const auto v : list) ++in[v];
        for (std::size_t b = 0; b < bodies.size(); ++b)
            for (Eigen::Index t = 0; t < bodies[b]->triangles.rows(); ++t) {
                const auto k = sorted(b, t);
                if (in[k[0]] > 1 && in[k[1]] > 1 && in[k[2]] > 1) continue;
                triangles.push_back(
                    {index[b][bodies[b]->triangles(t, 0)], index[b][bodies[b]->triangles(t, 1)], index[b][bodies[b]->triangles(t, 2)]});
            }
        rest = shapes::detail::meshOf(points, {});
        rest.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
        for (std::size_t t = 0; t < triangles.size(); ++t)
            for (int c = 0; c < 3; ++c) rest.triangles(static_cast<Eigen::Index>(t), c) = triangles[t][c];
    }
    [[nodiscard]] Points join(const std::vector<Points>& bodies) const {
        Points out = rest.vertices;
        for (std::size_t b = bodies.size(); b-- > 0;)
            for (std::size_t v = 0; v < index[b].size(); ++v) out.row(index[b][v]) = bodies[b].row(static_cast<Eigen::Index>(v));
        return out;
    }
};

double angleBetween(const TriangleMesh& mesh, std::int32_t a, std::int32_t b) {
    const Vec3 m = areaVector(mesh, a), n = areaVector(mesh, b);
    return std::atan2(m.cross(n).norm(), m.dot(n)) / kDegree;
}

void report(const std::string& name, const std::string& how, const Whole& whole, const Points& x, double wantedVolume, bool seam) {
    const TriangleMesh mesh{x, whole.rest.triangles};
    const EdgeTable edges(mesh.triangles);
    int folds = 0;
    double crease[5] = {};
    for (int e = 0; e < edges.size(); ++e) {
        const auto uses = edges.uses(e);
        if (uses.size() != 2) continue;
        const double now = angleBetween(mesh, uses[0].triangle, uses[1].triangle);
        if (now > 150.0 && angleBetween(whole.rest, uses[0].triangle, uses[1].triangle) < 120.0) ++folds;
        const double from = std::abs(whole.rest.vertices(uses[0].low, 0)), to = std::abs(whole.rest.vertices(uses[0].high, 0));
        const long row = std::lround(8.0 * from);
        if (seam && std::abs(from - to) < 1e-6 && row < 5) crease[row] = std::max(crease[row], now);
    }
    const double change = 100.0 * (enclosedVolume(x, mesh.triangles) / enclosedVolume(whole.rest.vertices, mesh.triangles) - 1.0);
    const auto pairs = selfIntersections(mesh, 10000);
    std::printf("%-34s %-12s %+8.2f %% %8.2f %8.3f %5d %7zu", name.c_str(), how.c_str(), change, wantedVolume,
                worstQuality(whole.rest.vertices, x, mesh.triangles), folds, pairs.size());
    if (seam) std::printf("   %5.1f | %5.1f %5.1f %5.1f", crease[0], crease[1], crease[2], crease[3]);
    std::printf("\n");
    std::fflush(stdout);
    std::string file = name + "_" + how;
    std::replace(file.begin(), file.end(), ' ', '_');
    writeObj(file, mesh);
}

void head() {
    std::printf("%-34s %-12s %10s %8s %7s %6s %7s   %s\n", "pose", "", "volume", "", "quality", "folds", "pairs",
                "crease at the seam | rows beside it (degrees)");
}

/// In-plane stretches and warping of the joint face (0) that take the least energy, with everything else given; v, and the motion by them.
struct Smooth {
    Eigen::VectorXd warping;
    Points held;
    FaceMotion face;
};
Smooth smooth(const Element& e, const std::vector<FaceMotion>& motions, const Vec3& turn) {
    const auto& face = e.input.faces[0];
    const auto& r = *e.response;
    Eigen::VectorXd v = Eigen::VectorXd::Zero(r.columns());
    for (std::size_t f = 0; f < motions.size(); ++f) {
        JointMap map;
        const auto& axes = e.input.faces[f].frame.axes;
        const Vec3 w = f == 0 ? turn : Vec3(Vec3::Zero());
        Eigen::Matrix3d skew;
        skew << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
        map.linear += axes.transpose() * skew * axes;
        double lost = 0.0;
        r.bases[f].coefficients(map, e.input.faces[f].size, v.data() + r.firstColumn[f], lost);
    }
    std::vector<int> open{0, 1, 2};
    for (int c = 9; c < r.bases[0].columns(); ++c)
        if ((c - 9) % 3 != 2) open.push_back(c);
    Eigen::MatrixXd k(open.size(), open.size());
    Eigen::VectorXd right(open.size());
    const Eigen::VectorXd force = r.stiffness * v;
    for (std::size_t i = 0; i < open.size(); ++i) {
        right[i] = -force[open[i]];
        for (std::size_t j = 0; j < open.size(); ++j) k(i, j) = r.stiffness(open[i], open[j]);
    }
    // Few unknowns: Gauss-Seidel to rounding needs no factorisation header here.
    Eigen::VectorXd x = Eigen::VectorXd::Zero(right.size());
    for (int sweep = 0; sweep < 20000; ++sweep)
        for (Eigen::Index i = 0; i < x.size(); ++i) x[i] += (right[i] - k.row(i).dot(x)) / k(i, i);
    Smooth out{Eigen::VectorXd::Zero(r.columns()), {}, motions[0]};
    Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();
    stretch(0, 0) += x[0], stretch(0, 1) += x[1], stretch(1, 0) += x[1], stretch(1, 1) += x[2];
    out.face = motion(face, turn, Vec3::Zero(), face.frame.axes * stretch * face.frame.axes.transpose());
    for (std::size_t i = 3; i < open.size(); ++i) out.warping[open[i]] = x[static_cast<Eigen::Index>(i)];
    auto all = motions;
    all[0] = out.face;
    out.held = e.heldPlaces(all);
    const Points local = localVertices(e.body(), face);
    for (Eigen::Index i = 0; i < local.rows(); ++i)
        out.held.row(i) +=
            (out.face.rotation *
             (face.frame.axes * (r.bases[0].at(local.row(i).transpose(), static_cast<int>(i)) * out.warping.head(r.firstColumn[1]))))
                .transpose();
    return out;
}

Points turned(const Points& x, const Vec3& about, double angle) {
    const Eigen::Matrix3d r = Eigen::AngleAxisd(angle, about).toRotationMatrix();
    return x * r.transpose();
}

void poses() {
    const SolverMeshSetting solver{SolverMeshSetting::Kind::Default, 0};
    auto leftInput = between(readObj(kReference + "bend_cylinder_left.obj"), 0, 0.49, solver),
         rightInput = between(readObj(kReference + "bend_cylinder_right.obj"), 0, 0.49, solver);
    std::swap(leftInput.faces[0], leftInput.faces[1]);  // face 0: the joint
    for (auto* in : {&leftInput, &rightInput}) in->basis = {BasisKind::Modes, 12};
    Element left(leftInput), right(rightInput);
    const Whole whole({&left.body(), &right.body()}), half({&right.body()});
    using Motions = std::vector<FaceMotion>;
    const auto both = [&](const std::string& name, const Motions& l, const Motions& r,
                          const std::function<Points(const Points&, bool)>& place, double wanted) {
        report(name, "linear", whole, whole.join({place(left.linear(l), true), place(right.linear(r), false)}), wanted, true);
        report(name, "warp", whole, whole.join({place(left.bend(l), true), place(right.bend(r), false)}), wanted, true);
    };
    head();
    for (const double angle : {45.0, 90.0, 120.0, 150.0}) {
        const double a = 0.5 * angle * kDegree;
        const Motions l{motion(left.input.faces[0], Vec3(0, 0, a), Vec3::Zero()), motion(left.input.faces[1], Vec3::Zero(), Vec3::Zero())};
        const Motions r{motion(right.input.faces[0], Vec3(0, 0, -a), Vec3::Zero()),
                        motion(right.input.faces[1], Vec3::Zero(), Vec3::Zero())};
        const auto place = [&](const Points& x, bool isLeft) { return turned(x, Vec3::UnitZ(), isLeft ? -a : a); };
        char name[32];
        std::snprintf(name, sizeof name, "bend %.0f", angle);
        both(name, l, r, place, 0.0);
        const auto sl = smooth(left, l, Vec3(0, 0, a)), sr = smooth(right, r, Vec3(0, 0, -a));
        report(name, "warp, modes", whole,
               whole.join({place(left.bend({sl.face, l[1]}, sl.warping, sl.held), true),
                           place(right.bend({sr.face, r[1]}, sr.warping, sr.held), false)}),
               0.0, true);
    }
    {
        const double a = 45.0 * kDegree;
        const Motions l{motion(left.input.faces[0], Vec3(a, 0, 0), Vec3::Zero()),
                        motion(left.input.faces[1], Vec3(-a, 0, 0), Vec3::Zero())};
        const Motions r{motion(right.input.faces[0], Vec3(-a, 0, 0), Vec3::Zero()),
                        motion(right.input.faces[1], Vec3(a, 0, 0), Vec3::Zero())};
        both(
            "twist 180", l, r, [&](const Points& x, bool isLeft) { return turned(x, Vec3::UnitX(), isLeft ? -a : a); }, 0.0);
    }
    for (const bool shrink : {true, false})
        for (const double s : {2.5, 0.4}) {
            const double c = shrink ? 1.0 / std::sqrt(s) : 1.0;
            const Eigen::Matrix3d across = Vec3(1, c, c).asDiagonal();
            const Vec3 far(4.0 * (s - 1.0), 0, 0);
            const Motions l{motion(left.input.faces[0], Vec3::Zero(), Vec3::Zero(), across),
                            motion(left.input.faces[1], Vec3::Zero(), -far, across)};
            const Motions r{motion(right.input.faces[0], Vec3::Zero(), Vec3::Zero(), across),
                            motion(right.input.faces[1], Vec3::Zero(), far, across)};
            char name[40];
            std::snprintf(name, sizeof name, "%s %.0f %%%s", s > 1 ? "stretch" : "squash", 100 * s, shrink ? "" : ", rigid faces");
            both(
                name, l, r, [](const Points& x, bool) { return x; }, 100 * (std::pow(s, 0.02) - 1));
        }
    const auto one = [&](const std::string& name, const Motions& m) {
        report(name, "linear", half, right.linear(m), 0.0, false);
        report(name, "warp", half, right.bend(m), 0.0, false);
    };
    for (const double angle : {45.0, 75.0}) {
        const double a = angle * kDegree;
        const auto& f = right.input.faces;
        char name[40];
        std::snprintf(name, sizeof name, "half: S-bend +%.0f +%.0f", angle, angle);
        one(name, {motion(f[0], Vec3(0, 0, -a), Vec3::Zero()), motion(f[1], Vec3(0, 0, -a), Vec3::Zero())});
        std::snprintf(name, sizeof name, "half: C-bend +%.0f -%.0f", angle, angle);
        one(name, {motion(f[0], Vec3(0, 0, -a), Vec3::Zero()), motion(f[1], Vec3(0, 0, a), Vec3::Zero())});
    }
    one("half: shear by its length",
        {motion(right.input.faces[0], Vec3::Zero(), Vec3::Zero()), motion(right.input.faces[1], Vec3::Zero(), Vec3(0, 4, 0))});
}

// One face of a body turned by `turn`, the others at rest; or all but one.
void branch() {
    std::printf(
        "\na bend beside a branch: e_body_coarse (three faces), nu = .49, each face in turn at half of a bend of 90 and of 150 degrees\n");
    head();
    auto mesh = readObj(kReference + "e_body_coarse.obj");
    ResponseInput in;
    in.mesh = mesh;
    in.nu = 0.49;
    in.solverMesh = {SolverMeshSetting::Kind::Default, 0};
    std::ifstream file(kReference + "e_body_coarse.faces.json");
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    for (std::size_t at = 0; (at = text.find("\"vertices\": [", at)) != std::string::npos;) {
        at = text.find('[', at);
        const auto end = text.find(']', at);
        std::istringstream numbers(text.substr(at + 1, end - at - 1));
        std::vector<std::int32_t> vertices;
        for (std::string number; std::getline(numbers, number, ',');) vertices.push_back(std::stoi(number));
        if (const auto face = jointFaceByVertices(mesh->body, vertices)) in.faces.push_back(*face);
        at = end;
    }
    Element e(in);
    const Whole whole({&e.body()});
    for (const double angle : {45.0, 75.0})
        for (std::size_t f = 0; f < in.faces.size(); ++f) {
            std::vector<FaceMotion> m;
            for (std::size_t o = 0; o < in.faces.size(); ++o)
                m.push_back(
                    motion(in.faces[o], o == f ? Vec3(angle * kDegree * in.faces[o].frame.axes.col(0)) : Vec3(Vec3::Zero()), Vec3::Zero()));
            char name[40];
            std::snprintf(name, sizeof name, "body: face %zu turned by %.0f", f, angle);
            report(name, "linear", whole, e.linear(m), 0.0, false);
            report(name, "warp", whole, e.bend(m), 0.0, false);
        }
}

// Of this thread, in seconds: other programs do not count.
double processorTime() {
    std::timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void speed() {
    std::printf("\n%10s %8s %10s %12s %12s %8s %12s %12s %12s %10s\n", "vertices", "free", "g", "product ms", "warp ms", "ratio",
                "product MB", "warp MB", "factor", "build s");
    for (const auto& [around, along, solver] : {std::tuple{20, 22, SolverMeshSetting{SolverMeshSetting::Kind::AsIs, 0}},
                                                std::tuple{40, 46, SolverMeshSetting{SolverMeshSetting::Kind::Decimated, 500}},
                                                std::tuple{150, 180, SolverMeshSetting{SolverMeshSetting::Kind::Decimated, 500}}}) {
        auto mesh = std::make_shared<ElementMesh>();
        mesh->body = shapes::cylinder(1.0, 4.0, around, along).mesh;
        Element e(between(mesh, 2, 0.49, solver));
        ResponseBlocks blocks(e.body().vertices, e.response->freeVertices, Vec3::Zero(), e.response->response, ResponseFormat::Float);
        std::vector<float> shown(3 * static_cast<std::size_t>(e.body().vertices.rows() + BendWarp::kBlock));
        const std::vector<FaceMotion> m{motion(e.input.faces[0], Vec3(0.8, 0, 0.3), Vec3::Zero()),
                                        motion(e.input.faces[1], Vec3(0, -0.2, -0.3), Vec3(0, 0, 0.5))};
        const Points held = e.heldPlaces(m);
        const Eigen::VectorXd none = Eigen::VectorXd::Zero(e.response->columns()),
                              v = Eigen::VectorXd::Constant(e.response->columns(), 0.1);
        constexpr AffineFloat kInPlace = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
        std::vector<double> product, warp;
        for (int round = 0; round < 41; ++round) {
            const auto start = processorTime();
            blocks.weigh(v);
            evaluateAndPlace(blocks.view(), blocks.weights(), kInPlace, 0, blocks.count(), nullptr, shown.data());
            const auto middle = processorTime();
            e.warp->evaluate(m, none, held, e.local.data());
            const auto end = processorTime();
            product.push_back(1e3 * (middle - start));
            warp.push_back(1e3 * (end - middle));
        }
        std::sort(product.begin(), product.end());
        std::sort(warp.begin(), warp.end());
        const double p = product[product.size() / 2], w = warp[warp.size() / 2];
        const auto cost = e.warp->cost();
        std::printf("%10td %8zu %10d %12.4f %12.4f %8.1f %12.2f %12.2f %12zu %10.3f\n", e.body().vertices.rows(),
                    e.response->freeVertices.size(), e.response->columns(), p, w, w / p,
                    static_cast<double>(blocks.count() * blocks.bytesPerBlock()) / 1e6, static_cast<double>(cost.bytes) / 1e6, cost.factor,
                    cost.seconds);
        std::fflush(stdout);
    }
}

struct Solved {
    ResponseInput input;
    ElementResponse response;
};

/// The response of a body on another mesh of the same shape.
ElementResponse responseOn(const ResponseInput& input, const Solved& from) {
    ElementResponse out = from.response;
    const auto& body = input.mesh->body;
    std::vector<char> held(static_cast<std::size_t>(body.vertices.rows()), 0);
    for (const auto& face : input.faces)
        for (const auto v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
    out.freeVertices.clear();
    for (std::int32_t v = 0; v < body.vertices.rows(); ++v)
        if (!held[static_cast<std::size_t>(v)]) out.freeVertices.push_back(v);
    Points points(static_cast<Eigen::Index>(out.freeVertices.size()), 3);
    for (std::size_t i = 0; i < out.freeVertices.size(); ++i) points.row(static_cast<Eigen::Index>(i)) = body.vertices.row(out.freeVertices[i]);
    const auto& solved = from.input.mesh->body;
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * solved.vertices.rows(), out.columns());
    for (std::size_t i = 0; i < from.response.freeVertices.size(); ++i)
        all.middleRows<3>(3 * from.response.freeVertices[i]) = from.response.response.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    for (std::size_t f = 0; f < from.input.faces.size(); ++f)
        for (const auto v : from.input.faces[f].vertices)
            all.block(3 * v, out.firstColumn[f], 3, out.bases[f].columns()) =
                from.input.faces[f].frame.axes * out.bases[f].at(from.input.faces[f].frame.toLocal(solved.vertices.row(v).transpose()));
    const std::vector<char> covered(from.input.faces.size(), 0);
    EmbeddedMapping::Input in;
    in.body = &solved, in.faces = from.input.faces, in.covered = covered, in.points = &points;
    out.response = EmbeddedMapping::build(in).value().apply(all, 1);
    return out;
}

// Bodies that a coarse one carries beside the same bodies solved whole.
void coarse() {
    std::printf("\n%10s %-12s %14s %14s %12s %12s %12s\n", "vertices", "pose", "largest o/oo", "rms o/oo", "turn deg", "fold whole", "fold coarse");
    std::optional<Solved> first;
    for (const auto& [around, along] : {std::pair{150, 180}, std::pair{400, 600}}) {
        auto mesh = std::make_shared<ElementMesh>();
        mesh->body = shapes::cylinder(1.0, 4.0, around, along).mesh;
        for (Eigen::Index v = 0; v < mesh->body.vertices.rows(); ++v) {  // waves of 3 % of the radius, along it and around it
            auto p = mesh->body.vertices.row(v);
            const double wave = 1.0 + 0.03 * std::sin(2.5 * std::numbers::pi * p.z()) * std::sin(4.0 * std::atan2(p.y(), p.x()));
            p.head<2>() *= wave;
        }
        const auto input = between(mesh, 2, 0.49, {SolverMeshSetting::Kind::Decimated, 1500});
        Element e = first ? Element(input, responseOn(input, *first)) : Element(input);
        auto whole = BendWarpTables::buildWhole(e.body(), e.input.faces, *e.response, e.input.nu, e.blocks, Vec3::Zero(), {});
        auto exact = std::make_unique<BendWarp>(std::move(*whole));
        std::printf("%10td build %.2f s, whole %.2f s; %zu carried\n", e.body().vertices.rows(), e.warp->cost().seconds, exact->cost().seconds, e.warp->carried());
        const double size = diagonalOf(e.body().vertices);
        const auto& f = e.input.faces;
        const double right = 0.25 * std::numbers::pi;
        const std::vector<std::pair<const char*, std::vector<FaceMotion>>> poses{
            {"rest", {FaceMotion{}, FaceMotion{}}},
            {"bend 90", {motion(f[0], Vec3(right, 0, 0), Vec3::Zero()), motion(f[1], Vec3(-right, 0, 0), Vec3::Zero())}},
            {"bend 150", {motion(f[0], Vec3(5.0 / 3.0 * right, 0, 0), Vec3::Zero()), motion(f[1], Vec3(-5.0 / 3.0 * right, 0, 0), Vec3::Zero())}},
            {"twist 180", {motion(f[0], Vec3(0, 0, 2.0 * right), Vec3::Zero()), motion(f[1], Vec3(0, 0, -2.0 * right), Vec3::Zero())}},
            {"S-bend 75", {motion(f[0], Vec3(5.0 / 3.0 * right, 0, 0), Vec3::Zero()), motion(f[1], Vec3(5.0 / 3.0 * right, 0, 0), Vec3::Zero())}},
            {"stretch", {FaceMotion{}, motion(f[1], Vec3::Zero(), Vec3(0, 0, 4.0))}}};
        const EdgeTable edges(e.body().triangles);
        for (const auto& [name, m] : poses) {
            const Points carried = e.bend(m);
            std::swap(e.warp, exact);
            const Points solved = e.bend(m);
            std::swap(e.warp, exact);
            double most = 0.0, sum = 0.0, turn = 0.0;
            for (Eigen::Index v = 0; v < solved.rows(); ++v) {
                const double d = (carried.row(v) - solved.row(v)).norm() / size;
                most = std::max(most, d);
                sum += d * d;
            }
            const TriangleMesh a{carried, e.body().triangles}, b{solved, e.body().triangles};
            for (Eigen::Index t = 0; t < e.body().triangles.rows(); ++t) {
                const Vec3 p = areaVector(a, static_cast<std::int32_t>(t)), q = areaVector(b, static_cast<std::int32_t>(t));
                turn = std::max(turn, std::atan2(p.cross(q).norm(), p.dot(q)) / kDegree);
            }
            // The largest angle between neighbouring triangles.
            double fold[2] = {};
            for (int i = 0; i < edges.size(); ++i)
                if (const auto uses = edges.uses(i); uses.size() == 2)
                    for (const auto* x : {&b, &a}) fold[x == &a] = std::max(fold[x == &a], angleBetween(*x, uses[0].triangle, uses[1].triangle));
            std::printf("%10td %-12s %14.3f %14.3f %12.2f %12.1f %12.1f\n", solved.rows(), name, 1e3 * most, 1e3 * std::sqrt(sum / static_cast<double>(solved.rows())), turn,
                        fold[0], fold[1]);
        }
        if (!first) first = {e.input, *e.response};
        std::vector<double> times[3];
        ResponseBlocks blocks(e.body().vertices, e.response->freeVertices, Vec3::Zero(), e.response->response, ResponseFormat::Float);
        std::vector<float> shown(3 * static_cast<std::size_t>(e.body().vertices.rows() + BendWarp::kBlock));
        constexpr AffineFloat kInPlace = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
        const auto& m = poses[1].second;
        const Points held = e.heldPlaces(m);
        const Eigen::VectorXd none = Eigen::VectorXd::Zero(e.response->columns()), v = Eigen::VectorXd::Constant(e.response->columns(), 0.1);
        for (int round = 0; round < 15; ++round) {
            const double t0 = processorTime();
            blocks.weigh(v);
            evaluateAndPlace(blocks.view(), blocks.weights(), kInPlace, 0, blocks.count(), nullptr, shown.data());
            const double t1 = processorTime();
            e.warp->solve(m, none, held, e.local.data());
            const double t2 = processorTime();
            e.warp->carry(0, e.warp->carried(), e.local.data());
            const double t3 = processorTime();
            times[0].push_back(1e3 * (t1 - t0));
            times[1].push_back(1e3 * (t2 - t1));
            times[2].push_back(1e3 * (t3 - t2));
        }
        for (auto& list : times) std::sort(list.begin(), list.end());
        const double p = times[0][7], solve = times[1][7], carry = times[2][7];
        double slow = 0.0;
        for (int round = 0; round < 3; ++round) {
            const double t0 = processorTime();
            exact->evaluate(m, none, held, e.local.data());
            const double t1 = processorTime();
            if (round == 0 || 1e3 * (t1 - t0) < slow) slow = 1e3 * (t1 - t0);
        }
        std::printf("%10td product %.3f ms, warp %.3f ms = solve %.3f + carry %.3f: %.1f times the product; solved whole %.2f ms: %.1f times\n", e.body().vertices.rows(), p,
                    solve + carry, solve, carry, (solve + carry) / p, slow, slow / p);
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string part = argc > 1 ? argv[1] : "";
    if (argc > 2) folder = argv[2];
    if (part.empty() || part == "poses") poses();
    if (part.empty() || part == "branch") branch();
    if (part.empty() || part == "speed") speed();
    if (part.empty() || part == "coarse") coarse();
    return 0;
}
