// SPDX-License-Identifier: GPL-3.0-or-later
// What a frame of the vertex engine costs, and what its number formats and normals get wrong, always side by side:
//   28,257 vertices (the most that the paper shows at 60 frames per second): product and placement against linear blend skinning with four weights;
//   normals in three ways; 1,000,000 vertices against the memory triad and on all processors; the previous model's product at the paper's size.
// Responses of the first three are those of a coarse elastic tube, carried over to fine ones. Arguments choose parts: frame, normals, million, previous.
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/thread_pool.h"
#include "core/character/aligned_buffer.h"
#include "core/character/character.h"
#include "core/character/normal_stencils.h"
#include "core/character/response_blocks.h"
#include "core/comparison/paper_caterpillar.h"
#include "core/comparison/skin_kernels.h"
#include "core/comparison/timing.h"
#include "tests/bench/elastic_tube.h"
#include "tests/bench/reference_loops.h"

using namespace imomushi;

namespace {

using Clock = std::chrono::steady_clock;
constexpr ResponseFormat kFormats[] = {ResponseFormat::Float, ResponseFormat::Half, ResponseFormat::Int16};

constexpr double kSeconds = 20.0;  // of one measurement, at most

double milliseconds(Clock::time_point from) { return std::chrono::duration<double, std::milli>(Clock::now() - from).count(); }

Points areaWeightedNormals(const Points& p, const Triangles& triangles) {
    Points n = Points::Zero(p.rows(), 3);
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
        const Vec3 a = p.row(triangles(t, 0)).transpose(), b = p.row(triangles(t, 1)).transpose(), c = p.row(triangles(t, 2)).transpose();
        const Eigen::RowVector3d area = (b - a).cross(c - a).transpose();
        for (int i = 0; i < 3; ++i) n.row(triangles(t, i)) += area;
    }
    return n;
}

AffineFloat turned() {
    const Eigen::Matrix3d r = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    AffineFloat p{};
    for (int i = 0; i < 9; ++i) p.linear[i] = static_cast<float>(r(i / 3, i % 3));
    return p;
}
const AffineFloat kTurned = turned();
constexpr AffineFloat kInPlace = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

/// What a frame does with the vertices of an element.
void show(ResponseBlocks& blocks, const Eigen::VectorXd& v, float* positions, const AffineFloat& placement = kTurned) {
    blocks.weigh(v);
    evaluateAndPlace(blocks.view(), blocks.weights(), placement, 0, blocks.count(), nullptr, positions);
}

/// GB/s of a = b + s c over arrays far larger than any cache, the best of several, with that many threads.
double triadRate(int threads) {
    const std::size_t each = (std::size_t(48) << 20) / static_cast<std::size_t>(threads), n = each * static_cast<std::size_t>(threads);
    AlignedBuffer<float> a(n), b(n), c(n);
    double best = 0.0;
    for (int k = 0; k < 8; ++k) {
        const auto start = Clock::now();
        parallelFor(threads, n, each, [&](std::size_t begin, std::size_t end) {
            reference::triad(a.data() + begin, b.data() + begin, c.data() + begin, 0.5f, end - begin);
        });
        best = std::max(best, 12.0 * static_cast<double>(n) / milliseconds(start) * 1e-6);
    }
    return best;
}

/// Largest error of the kernel in a pose over the largest displacement.
double poseError(const Tube& tube, ResponseBlocks& blocks, const Eigen::VectorXd& v) {
    std::vector<float> shown(3 * (tube.all.size() + kVertexBlock));
    show(blocks, v, shown.data(), kInPlace);
    const Points exact = tube.moved(v);
    double wrong = 0.0;
    for (Eigen::Index i = 0; i < exact.rows(); ++i)
        wrong = std::max(wrong, (exact.row(i) - Eigen::Map<const Eigen::RowVector3f>(shown.data() + 3 * i).cast<double>()).norm());
    return wrong / (exact - tube.mesh.vertices).rowwise().norm().maxCoeff();
}

// --- 28,257 vertices ---------------------------------------------------------------------------------------------------------------------------

struct Skinned {
    AlignedBuffer<float> matrices, rest, weights, blockRest, blockWeights, positions;
    AlignedBuffer<std::uint16_t> offsets;
    AlignedBuffer<std::int32_t> blockOffsets;
    std::size_t vertices;

    /// Four bones along each tube, with smooth weights that are never zero.
    explicit Skinned(const std::vector<Tube>& tubes) : vertices(0) {
        for (const auto& t : tubes) vertices += t.all.size();
        const std::size_t padded = (vertices + 15) / 16 * 16, count = 4 * tubes.size();
        matrices = AlignedBuffer<float>(16 * count);
        rest = AlignedBuffer<float>(4 * padded), weights = AlignedBuffer<float>(4 * padded), offsets = AlignedBuffer<std::uint16_t>(4 * padded);
        blockRest = AlignedBuffer<float>(3 * padded), blockWeights = AlignedBuffer<float>(4 * padded), blockOffsets = AlignedBuffer<std::int32_t>(4 * padded);
        positions = AlignedBuffer<float>(3 * padded + 16);
        for (std::size_t b = 0; b < count; ++b) {
            const Eigen::Matrix3f r = Eigen::AngleAxisf(0.1f * static_cast<float>(b), Eigen::Vector3f(1, 2, 0).normalized()).toRotationMatrix();
            for (int c = 0; c < 4; ++c)
                for (int i = 0; i < 4; ++i) matrices[16 * b + 4 * c + i] = i == 3 ? (c == 3 ? 1.0f : 0.0f) : c == 3 ? 0.01f * static_cast<float>(b) : r(i, c);
        }
        std::size_t v = 0;
        for (std::size_t t = 0; t < tubes.size(); ++t)
            for (const auto i : tubes[t].all) {
                const Vec3 p = tubes[t].mesh.vertices.row(i).transpose();
                double sum = 0.0, w[4];
                for (int k = 0; k < 4; ++k) sum += w[k] = std::exp(-8.0 * std::pow(p.z() / tubes[t].length - k / 3.0, 2));
                for (int k = 0; k < 4; ++k) {
                    const auto offset = static_cast<std::uint16_t>(16 * (4 * t + k));
                    weights[4 * v + k] = blockWeights[64 * (v / 16) + 16 * k + v % 16] = static_cast<float>(w[k] / sum);
                    offsets[4 * v + k] = offset;
                    blockOffsets[64 * (v / 16) + 16 * k + v % 16] = offset;
                    rest[4 * v + k] = k < 3 ? static_cast<float>(p[k]) : 1.0f;
                    if (k < 3) blockRest[48 * (v / 16) + 16 * k + v % 16] = static_cast<float>(p[k]);
                }
                ++v;
            }
    }
    void byMatrix() { skinByMatrix({matrices.data(), rest.data(), weights.data(), offsets.data()}, 0, vertices, positions.data()); }
    void byGather() {
        skinByGather({matrices.data(), blockRest.data(), blockWeights.data(), blockOffsets.data()}, (vertices + 15) / 16, positions.data());
    }
};

std::vector<Tube> paperTubes() {
    std::vector<Tube> tubes(4, Tube(74, 76));
    tubes.emplace_back(71, 81);
    return tubes;
}

void frame() {
    const auto tubes = paperTubes();
    Skinned skin(tubes);
    const Eigen::VectorXd v = tubes[0].pose(std::numbers::pi / 6, 0.1);
    std::vector<std::vector<ResponseBlocks>> engine;
    for (const auto format : kFormats) {
        auto& all = engine.emplace_back();
        for (const auto& t : tubes) all.emplace_back(t.mesh.vertices, t.all, Vec3::Zero(), t.response, format);
    }
    AlignedBuffer<float> positions(3 * (skin.vertices + 6 * kVertexBlock));
    std::vector<std::function<void()>> loops = {[&] { skin.byMatrix(); }, [&] { skin.byGather(); }};
    for (auto& all : engine)
        loops.emplace_back([&] {
            std::size_t first = 0;
            for (std::size_t t = 0; t < all.size(); ++t) {
                show(all[t], v, positions.data() + 3 * first);
                first += tubes[t].all.size();
            }
        });
    const auto ms = mediansInTurn(300, kSeconds, loops);
    const double best = std::min(ms[0], ms[1]), vertices = static_cast<double>(skin.vertices);
    std::printf("\n%zu vertices in %zu elements, 12 columns each, one thread: product and placement (target: at most 1.2 times skinning)\n", skin.vertices,
                tubes.size());
    std::printf("%-44s %9s %10s %9s %9s %12s %12s %6s\n", "", "ms", "ns/vertex", "MB", "/ skin", "error unit", "error bend", "modes");
    const auto row = [&](const char* name, double t, double bytes) {
        std::printf("%-44s %9.4f %10.2f %9.2f %9.2f", name, t, 1e6 * t / vertices, bytes * 1e-6, t / best);
    };
    row("linear blend skinning, matrix blended", ms[0], vertices * (16 + 16 + 8 + 12)), std::printf("\n");
    row("linear blend skinning, entries gathered", ms[1], vertices * (12 + 16 + 16 + 12)), std::printf("\n");
    for (std::size_t f = 0; f < engine.size(); ++f) {
        double bytes = 12.0 * vertices, unit = 0.0, bend = 0.0;
        for (std::size_t t = 0; t < tubes.size(); ++t) {
            auto& b = engine[f][t];
            bytes += static_cast<double>(b.responseBytes() + b.rest().bytes());
            unit = std::max(unit, b.error());
            bend = std::max(bend, poseError(tubes[t], b, v));
        }
        row(("A' in " + formatName(kFormats[f])).c_str(), ms[2 + f], bytes);
        std::printf(" %12.1e %12.1e %6d\n", unit, bend, engine[f][0].modes());
    }
    std::printf("errors: of the largest displacement; unit: worst of the unit poses; bend: bent by 30 degrees and stretched by a tenth\n");
}

// --- normals -----------------------------------------------------------------------------------------------------------------------------------

struct Angles {
    double rms = 0.0, largest = 0.0;  // degrees
};

Angles angles(const float* normals, const Points& wanted) {
    Angles a;
    for (Eigen::Index v = 0; v < wanted.rows(); ++v) {
        const Vec3 n = Eigen::Map<const Eigen::Vector3f>(normals + 3 * v).cast<double>().normalized(), w = wanted.row(v).transpose().normalized();
        const double angle = std::atan2(n.cross(w).norm(), n.dot(w)) * 180.0 / std::numbers::pi;
        a.rms += angle * angle / static_cast<double>(wanted.rows());
        a.largest = std::max(a.largest, angle);
    }
    a.rms = std::sqrt(a.rms);
    return a;
}

/// Derivative of the area-weighted normals with respect to v, each divided by the length of the normal at rest: like a response.
Eigen::MatrixXd normalModes(const Tube& tube) {
    const auto& p = tube.mesh.vertices;
    const auto& triangles = tube.mesh.triangles;
    const Points rest = areaWeightedNormals(p, triangles);
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(tube.response.rows(), tube.response.cols());
    for (Eigen::Index c = 0; c < out.cols(); ++c) {
        const auto at = [&](int v) -> Vec3 { return tube.response.block<3, 1>(3 * v, c); };
        for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
            const int i = triangles(t, 0), j = triangles(t, 1), k = triangles(t, 2);
            const Vec3 e = (p.row(j) - p.row(i)).transpose(), f = (p.row(k) - p.row(i)).transpose();
            const Vec3 d = (at(j) - at(i)).cross(f) + e.cross(at(k) - at(i));
            for (const int v : {i, j, k}) out.block<3, 1>(3 * v, c) += d / rest.row(v).norm();
        }
    }
    return out;
}

void normals() {
    const Tube tube(119, 237);
    const std::size_t n = tube.all.size(), padded = (n + 15) / 16 * 16;
    const auto corners = tube.corners();
    const auto stencils = normalStencils(tube.mesh.vertices, corners, 1.0 / tube.length);
    Points atRest = areaWeightedNormals(tube.mesh.vertices, tube.mesh.triangles);
    atRest.rowwise().normalize();
    ResponseBlocks modes(atRest, tube.all, Vec3::Zero(), normalModes(tube), ResponseFormat::Int16);
    AlignedBuffer<float> positions(3 * padded + 64), out(3 * padded + 64), sums(4 * padded);
    const auto triangleLoop = [&] { reference::normalsOfTriangles(positions.data(), corners.data(), corners.size() / 3, sums.data(), out.data(), padded); };
    Eigen::VectorXd pose;
    const auto modeLoop = [&] {
        show(modes, pose, out.data(), kInPlace);
        reference::normalise(out.data(), padded);
    };
    const auto stencilLoop = [&] { findNormals(positions.data(), stencils.data(), static_cast<float>(1.0 / tube.length), 0, n, out.data()); };

    std::printf("\nnormals of %zu vertices, one thread; angles in degrees against area-weighted triangles in double precision, rms / largest\n", n);
    std::printf("%-30s %21s %21s %21s\n", "positions in float:", "all triangles", "linear modes, int16", "across the ring");
    const auto compare = [&](const char* name, const Eigen::VectorXd& v, ResponseFormat format) {
        ResponseBlocks blocks(tube.mesh.vertices, tube.all, Vec3::Zero(), tube.response, format);
        show(blocks, v, positions.data(), kInPlace);
        pose = v;
        const Points wanted = areaWeightedNormals(tube.moved(v), tube.mesh.triangles);
        std::printf("%-30s", name);
        for (const std::function<void()>& loop : {std::function<void()>(triangleLoop), std::function<void()>(modeLoop), std::function<void()>(stencilLoop)}) {
            loop();
            const auto a = angles(out.data(), wanted);
            std::printf("     %8.3f /%7.3f", a.rms, a.largest);
        }
        std::printf("\n");
    };
    const double degree = std::numbers::pi / 180.0;
    compare("rest", tube.pose(0.0, 0.0), ResponseFormat::Float);
    compare("bent by 30 degrees", tube.pose(30 * degree, 0.0), ResponseFormat::Float);
    compare("bent by 60, stretched by .2", tube.pose(60 * degree, 0.2), ResponseFormat::Float);
    compare("the same, positions in half", tube.pose(60 * degree, 0.2), ResponseFormat::Half);
    compare("the same, positions in int16", tube.pose(60 * degree, 0.2), ResponseFormat::Int16);
    const auto ms = mediansInTurn(200, kSeconds, {triangleLoop, modeLoop, stencilLoop});
    std::printf("%-30s", "ms");
    for (const double t : ms) std::printf(" %20.4f ", t);
    std::printf("\n");
}

// --- 1,000,000 vertices ------------------------------------------------------------------------------------------------------------------------

void million() {
    const int processors = hardwareThreads();
    const Tube tube(1000, 1000);
    const double vertices = static_cast<double>(tube.all.size());
    std::vector<int> counts = {1};
    if (processors > 1) counts.push_back(processors);
    std::printf("\n%.0f vertices, 12 columns: product and placement against the memory triad (target: 80 %% of it)\n", vertices);
    std::printf("%-10s %8s %12s %10s %10s %14s %12s\n", "format", "threads", "ms", "GB/s", "triad", "of the triad", "error unit");
    constexpr std::size_t kTriad = std::size_t(1) << 25;
    AlignedBuffer<float> a(kTriad), b(kTriad), c(kTriad);
    const Eigen::VectorXd v = tube.pose(0.5, 0.1);
    for (const auto format : kFormats) {
        ResponseBlocks blocks(tube.mesh.vertices, tube.all, Vec3::Zero(), tube.response, format);
        AlignedBuffer<float> positions(3 * (tube.all.size() + kVertexBlock));
        blocks.weigh(v);
        for (const int threads : counts) {
            ThreadPool pool(threads);
            const auto part = [](std::size_t i, std::size_t parts, std::size_t count) { return count * i / parts; };
            constexpr std::size_t kPieces = 512;
            const auto ms = mediansInTurn(12, kSeconds, {[&] {
                                            pool.run(kPieces, [&](std::size_t i) {
                                                const std::size_t begin = kTriad / kPieces * i;
                                                reference::triad(a.data() + begin, b.data() + begin, c.data() + begin, 0.5f, kTriad / kPieces);
                                            });
                                        },
                                        [&] {
                                            pool.run(kPieces, [&](std::size_t i) {
                                                evaluateAndPlace(blocks.view(), blocks.weights(), kTurned, part(i, kPieces, blocks.count()),
                                                                 part(i + 1, kPieces, blocks.count()), nullptr, positions.data());
                                            });
                                        }});
            const double bytes = static_cast<double>(blocks.responseBytes()) + 24.0 * vertices, rate = bytes / ms[1] * 1e-6, triad = 12.0 * kTriad / ms[0] * 1e-6;
            std::printf("%-10s %8d %12.3f %10.1f %10.1f %12.0f %% %12.1e\n", formatName(format).c_str(), threads, ms[1], rate, triad, 100 * rate / triad,
                        blocks.error());
        }
    }

    std::printf("whole frames: positions and normals of a character of one element, bent a little more every frame\n");
    std::printf("%-10s %8s %12s %12s %12s %12s\n", "format", "threads", "product", "normals", "frame", "per second");
    for (const auto format : kFormats)
        for (const int threads : counts) {
            CharacterInput input;
            input.basis = BasisKind::Paper;
            input.format = format;
            input.threads = threads;
            input.skeleton.points = {Vec3::Zero(), Vec3(0, 0, tube.length)};
            input.skeleton.bones.push_back({0, 1, -1, tube.length});
            CharacterInput::Element element;
            auto mesh = std::make_shared<ElementMesh>();
            mesh->body = tube.mesh;
            element.mesh = mesh;
            element.bones = {0};
            auto response = std::make_shared<ElementResponse>();
            for (int f = 0; f < 2; ++f) {
                std::vector<std::int32_t> cap;
                for (int i = 0; i <= 1000; ++i) cap.push_back(f == 0 ? i : static_cast<std::int32_t>(tube.all.size()) - 1 - i);
                element.faces.push_back(jointFaceByVertices(tube.mesh, cap).value());
                response->bases.push_back(FaceBasis{.kind = BasisKind::Paper});
                response->firstColumn.push_back(6 * f);
            }
            response->firstColumn.push_back(12);
            response->freeVertices.assign(tube.all.begin() + 1001, tube.all.end() - 1001);
            response->response = tube.response.middleRows(3 * 1001, 3 * static_cast<Eigen::Index>(response->freeVertices.size()));
            response->stiffness = Eigen::MatrixXd::Zero(12, 12);
            element.response = response;
            input.elements.push_back(element);
            input.joints = {{0, {{0, 0, 0}}, {}}, {1, {{0, 1, 0}}, {}}};
            auto character = Character::build(std::move(input)).value();
            Pose pose = restPose(character.input().skeleton);
            std::vector<double> product, normal, whole;
            for (int i = 0; i < 40; ++i) {
                pose.points[1].z() = tube.length * (1.0 + 0.001 * i);
                const auto start = Clock::now();
                character.update(pose);
                whole.push_back(milliseconds(start));
                product.push_back(character.stats().productMs), normal.push_back(character.stats().normalsMs);
            }
            for (auto* s : {&product, &normal, &whole}) std::sort(s->begin(), s->end());
            std::printf("%-10s %8d %12.3f %12.3f %12.3f %12.0f\n", formatName(format).c_str(), threads, product[20], normal[20], whole[20], 1000 / whole[20]);
        }
}

// --- the previous model ------------------------------------------------------------------------------------------------------------------------

void previous() {
    const auto models = solvedPaperCaterpillar({}).value();
    const auto table = compareModels(models, {}).value();
    const auto &a = table.proposed, &b = table.previous;
    std::printf("\nthe paper's size: %d elements, %d vertices, float, one thread (targets: 30 times faster, 15 times smaller)\n", a.elements, a.vertices);
    std::printf("%-44s %12s %12s %8s\n", "", "proposed", "previous", "ratio");
    const auto row = [](const char* name, double p, double q, double ratio) { std::printf("%-44s %12.4f %12.4f %8.1f\n", name, p, q, ratio); };
    row("matrices (MB)", 1e-6 * static_cast<double>(a.bytes), 1e-6 * static_cast<double>(b.bytes), static_cast<double>(b.bytes) / static_cast<double>(a.bytes));
    row("read by a frame (MB)", 1e-6 * static_cast<double>(a.frameBytes), 1e-6 * static_cast<double>(b.frameBytes),
        static_cast<double>(b.frameBytes) / static_cast<double>(a.frameBytes));
    row("product alone (ms; the proposed one placed)", a.productMs, b.productMs, b.productMs / a.productMs);
    row("whole frame (ms)", a.frameMs, b.frameMs, b.frameMs / a.frameMs);
    row("vertices at 60 frames per second", a.verticesAt60(), b.verticesAt60(), a.verticesAt60() / b.verticesAt60());
    for (const auto& e : table.errors)
        std::printf("error in pose %-10s %.4f relative L2, %.3f %% of the diagonal at most%s\n", e.pose.c_str(), e.relative, e.percent,
                    e.beyondBasis ? " (beyond the basis)" : "");
}

}  // namespace

int main(int argc, char** argv) {
    const auto wants = [&](const std::string& part) { return argc < 2 || std::find(argv + 1, argv + argc, part) != argv + argc; };
    std::printf("memory triad: %.1f GB/s with one thread, %.1f GB/s with %d\n", triadRate(1), triadRate(hardwareThreads()), hardwareThreads());
    if (wants("frame")) frame();
    if (wants("normals")) normals();
    if (wants("previous")) previous();
    if (wants("million")) million();
    return 0;
}
