// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/elasticity/volume_problem.h"

#include <cholmod.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>
#include <utility>

#include "core/base/clock.h"
#include "core/base/finite.h"
#include "core/base/floating_point_guard.h"
#include "core/base/parallel.h"
#include "core/elasticity/boundary_input.h"
#include "core/elasticity/dense_lu.h"
#include "core/elasticity/machine_rates.h"
#include "core/elasticity/quadratic_stiffness.h"
#include "core/mesh/topology.h"

/// Of libgomp, which CHOLMOD runs short loops with; <omp.h> comes with GCC alone.
extern "C" void omp_set_max_active_levels(int);

namespace imomushi {
namespace {

using Index = std::int32_t;
/// Right-hand sides that a thread solves at once.
constexpr std::size_t kColumnGrain = 24;
/// Up to so many nodes the approximate minimum degree (Amestoy et al. 2004) gives factors as small as METIS does, in a fifth of the time; at 42,000, half as much work again.
constexpr Index kMinimumDegreeNodes = 30'000;
/// Supernodes of up to so many columns are merged while at most this part of them is zeros: products of a few columns are slow.
constexpr std::array<std::size_t, 3> kMergedColumns{8, 48, 120};
constexpr std::array<double, 3> kMergedZeros{0.9, 0.3, 0.1};
/// Above this residual the solution is refused.
constexpr double kLargestResidual = 1e-6;

/// Measured on bodies of 5,000 to 65,000 nodes: entries of the factor and operations to find it, for n nodes; blocks of the matrix on and below its diagonal.
constexpr double kFactorEntries = 11.3, kFactorExponent = 1.41, kFactorFlops = 15.6, kBlocksPerNode = 13.5;
/// Sparse products over those of single precision on large dense matrices.
constexpr double kSparseRate = 0.12;
/// Filling, assembly and ordering.
constexpr double kNodeSeconds = 25e-6;

}  // namespace

struct VolumeProblem::State {
    TriangleMesh surface;
    const TetrahedralMesh* mesh = nullptr;
    std::vector<std::array<Index, 2>> bubbles;
    std::vector<Index> bubbleNode;      ///< middle of each
    std::vector<Index> freeVertices, heldVertices;
    std::vector<char> heldTriangle;     ///< per triangle of the surface
    struct HeldMiddle {
        Index node, from, to;           ///< the middle of an edge of a patch; its ends in heldVertices
    };
    std::vector<HeldMiddle> heldMiddles;
    std::unique_ptr<QuadraticNodes> middles;
    /// Unknowns: free nodes, then held vertices in the order of heldVertices, then the middles of held edges.
    std::vector<Index> place;           ///< of each node
    Index freeNodes = 0;
    double nu = 0.0;
    int threads = 1;
    SolveQuality quality;
    QuadraticStiffness stiffness;

    cholmod_common common{};
    cholmod_factor* factor = nullptr;

    State() { cholmod_l_start(&common), common.print = 0; }
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        cholmod_l_free_factor(&factor, &common);
        cholmod_l_finish(&common);
    }

    [[nodiscard]] Index nodeCount() const { return static_cast<Index>(place.size()); }
    [[nodiscard]] std::array<Vec3, 4> corners(Eigen::Index t) const {
        std::array<Vec3, 4> out;
        for (int c = 0; c < 4; ++c) out[static_cast<std::size_t>(c)] = mesh->vertices.row(mesh->tetrahedra(t, c)).transpose();
        return out;
    }
    Result<void> factorise(const Progress& progress);
    [[nodiscard]] NodeValues loads(const BoundaryProblem::Loads& loads) const;
    bool solveFactor(NodeValues& x, const Progress& progress) const;
};

Result<void> VolumeProblem::State::factorise(const Progress& progress) {
    const auto n = static_cast<std::size_t>(freeNodes);
    const auto noMemory = [] { return fail("no-memory", "The equations of the tetrahedra do not fit into memory; choose a solver mesh of fewer vertices."); };
    const auto& [start, row, block, freeRows] = stiffness;
    std::size_t entries = 0;
    for (const std::size_t rows : freeRows) entries += rows;
    // The graph of nodes: three times fewer rows to order than unknowns.
    cholmod_sparse* graph = cholmod_l_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_PATTERN, &common);
    cholmod_sparse* matrix = cholmod_l_allocate_sparse(3 * n, 3 * n, 9 * entries - 3 * n, 1, 1, -1, CHOLMOD_REAL, &common);
    if (!graph || !matrix) {
        cholmod_l_free_sparse(&graph, &common);
        cholmod_l_free_sparse(&matrix, &common);
        return noMemory();
    }
    auto* columns = static_cast<std::int64_t*>(graph->p);
    auto* rows = static_cast<std::int64_t*>(graph->i);
    auto* columns3 = static_cast<std::int64_t*>(matrix->p);
    auto* rows3 = static_cast<std::int64_t*>(matrix->i);
    auto* values = static_cast<double*>(matrix->x);
    std::int64_t at = 0, at3 = 0;
    for (std::size_t j = 0; j < n; ++j) {
        columns[j] = at;
        for (std::size_t k = 0; k < freeRows[j]; ++k) rows[at++] = row[start[j] + k];
        for (int c = 0; c < 3; ++c) {
            columns3[3 * j + static_cast<std::size_t>(c)] = at3;
            for (std::size_t k = 0; k < freeRows[j]; ++k)
                for (int r = k == 0 ? c : 0; r < 3; ++r) {
                    rows3[at3] = 3 * std::int64_t{row[start[j] + k]} + r;
                    values[at3++] = block[start[j] + k](r, c);
                }
        }
    }
    columns[n] = at;
    columns3[3 * n] = at3;
    std::vector<std::int64_t> order(n), order3(3 * n);
    bool ordered = false;
    if (freeNodes <= kMinimumDegreeNodes) {
        ordered = cholmod_l_amd(graph, nullptr, 0, order.data(), &common) != 0;
    } else {
        // METIS seeds the C library's random numbers, which all threads share.
        static std::mutex mutex;
        const std::scoped_lock lock(mutex);
        ordered = cholmod_l_metis(graph, nullptr, 0, 1, order.data(), &common) != 0;
    }
    cholmod_l_free_sparse(&graph, &common);
    for (std::size_t c = 0; c < 3 * n; ++c) order3[c] = 3 * order[c / 3] + static_cast<std::int64_t>(c % 3);
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder = 1;
    common.supernodal = CHOLMOD_SUPERNODAL;
    for (std::size_t i = 0; i < 3; ++i) common.nrelax[i] = kMergedColumns[i], common.zrelax[i] = kMergedZeros[i];
    if (ordered && !progress.cancelled()) factor = cholmod_l_analyze_p(matrix, order3.data(), nullptr, 0, &common);
    if (progress.cancelled()) {
        cholmod_l_free_sparse(&matrix, &common);
        return fail(kCancelled, "The precompute was cancelled.");
    }
    if (factor && sizeof(double) * factor->xsize > availableMemory()) {
        cholmod_l_free_sparse(&matrix, &common);
        return noMemory();
    }
    progress.report("factorise", 0.3);
    const bool done = factor && cholmod_l_factorize(matrix, factor, &common) != 0 && common.status != CHOLMOD_OUT_OF_MEMORY;
    const bool definite = common.status != CHOLMOD_NOT_POSDEF;
    cholmod_l_free_sparse(&matrix, &common);
    if (!done) return noMemory();
    if (!definite) return fail("singular", "The equations of this body have no unique answer; check that every separate part of it has a joint face.");
    return {};
}

/// Forces on all nodes, by their places.
NodeValues VolumeProblem::State::loads(const BoundaryProblem::Loads& wanted) const {
    NodeValues out = NodeValues::Zero(3 * static_cast<Eigen::Index>(nodeCount()), wanted.columns());
    const auto rowOf = [&](Index node) { return static_cast<Eigen::Index>(3) * place[static_cast<std::size_t>(node)]; };
    if (wanted.body)
        for (Eigen::Index t = 0; t < mesh->tetrahedra.rows(); ++t) {
            const std::array<Vec3, 4> corner = corners(t);
            const double volume = (corner[1] - corner[0]).cross(corner[2] - corner[0]).dot(corner[3] - corner[0]) / 6.0;
            for (int a = 0; a < 10; ++a)
                for (int axis = 0; axis < 3; ++axis) out(rowOf(middles->nodes(t, a)) + axis, axis) += (a < 4 ? -0.05 : 0.2) * volume;
        }
    const Eigen::Index first = wanted.body ? BoundaryEquation::kLoads : 0;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
        if (heldTriangle[static_cast<std::size_t>(t)]) continue;
        const std::array<Index, 3> v{surface.triangles(t, 0), surface.triangles(t, 1), surface.triangles(t, 2)};
        const std::array<Index, 3> m{middles->at(v[0], v[1]), middles->at(v[1], v[2]), middles->at(v[2], v[0])};  // m[c] is opposite to v[(c + 2) % 3]
        const Vec3 area = 0.5 * areaVector(surface, static_cast<Index>(t));
        if (wanted.body)
            for (const Index node : m)
                for (int axis = 0; axis < 3; ++axis) out(rowOf(node) + axis, 3) += area[axis] / 3.0;
        if (!wanted.tractions) continue;
        const double size = area.norm();
        for (Eigen::Index p = 0; p < wanted.tractions->cols(); ++p) {
            const std::array<double, 3> s{(*wanted.tractions)(v[0], p), (*wanted.tractions)(v[1], p), (*wanted.tractions)(v[2], p)};
            const double sum = s[0] + s[1] + s[2];
            if (sum == 0.0 && s[0] == 0.0 && s[1] == 0.0) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                const double atCorner = size * (3.0 * s[c] - sum) / 60.0, atMiddle = size * (2.0 * sum - s[(c + 2) % 3]) / 15.0;
                for (int axis = 0; axis < 3; ++axis) {
                    out(rowOf(v[c]) + axis, first + 3 * p + axis) += atCorner;
                    out(rowOf(m[c]) + axis, first + 3 * p + axis) += atMiddle;
                }
            }
        }
    }
    return out;
}

bool VolumeProblem::State::solveFactor(NodeValues& x, const Progress& progress) const {
    const auto n = static_cast<std::size_t>(3 * freeNodes), k = static_cast<std::size_t>(x.cols());
    bool ok = true;
    std::vector<char> done((k + kColumnGrain - 1) / kColumnGrain);
    parallelFor(threads, k, kColumnGrain, [&](std::size_t begin, std::size_t end) {
        if (progress.cancelled()) return;
        cholmod_common own;
        cholmod_l_start(&own);
        own.print = 0;
        if (cholmod_dense* right = cholmod_l_allocate_dense(n, end - begin, n, CHOLMOD_REAL, &own)) {
            Eigen::Map<Eigen::MatrixXd> values(static_cast<double*>(right->x), static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(end - begin));
            values = x.block(0, static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(end - begin));
            if (cholmod_dense* answer = cholmod_l_solve(CHOLMOD_A, factor, right, &own)) {
                x.block(0, static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(end - begin)) =
                    Eigen::Map<Eigen::MatrixXd>(static_cast<double*>(answer->x), static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(end - begin));
                cholmod_l_free_dense(&answer, &own);
                done[begin / kColumnGrain] = 1;
            }
            cholmod_l_free_dense(&right, &own);
        }
        cholmod_l_finish(&own);
    });
    for (const char d : done) ok = ok && d != 0;
    return ok;
}

Result<VolumeProblem> VolumeProblem::build(const Input& input, const Progress& progress) {
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    useSingleThreadedBlas();
    static std::once_flag large;
    std::call_once(large, [] { SuiteSparse_config.malloc_func = allocateLarge; });  // else a third of the time of a draft goes into page faults
    omp_set_max_active_levels(0);  // CHOLMOD starts four threads for loops that are too short for them, and several problems are solved at once
    BoundaryProblem::Input checked;
    checked.mesh = input.surface;
    checked.held = input.held;
    checked.nu = input.nu;
    const auto surface = heldSurface(checked);
    if (!surface) return tl::make_unexpected(surface.error());
    if (input.nu > kLargestNu) return fail("bad-value", "Tetrahedra take a Poisson ratio up to 0.49; choose another solver mesh.");
    if (hasUnheldPart(*input.surface, *surface)) return fail("singular", "The equations of this body have no unique answer; check that every separate part of it has a joint face.");
    auto state = std::make_unique<State>();
    State& s = *state;
    const auto start = Clock::now();
    s.surface = *input.surface;
    s.mesh = input.tetrahedra;
    s.nu = input.nu;
    s.threads = input.threads;
    s.bubbles = input.bubbles;
    s.middles = std::make_unique<QuadraticNodes>(*input.tetrahedra);
    const QuadraticNodes& middles = *s.middles;
    s.heldTriangle.assign(static_cast<std::size_t>(s.surface.triangles.rows()), 0);
    s.place.assign(static_cast<std::size_t>(middles.count()), -1);
    std::vector<Index> heldAt(static_cast<std::size_t>(s.surface.vertices.rows()), -1);
    for (const HeldPatch& patch : input.held) {
        for (const Index v : patch.vertices) {
            heldAt[static_cast<std::size_t>(v)] = static_cast<Index>(s.heldVertices.size());
            s.heldVertices.push_back(v);
        }
        for (const Index t : patch.triangles) s.heldTriangle[static_cast<std::size_t>(t)] = 1;
    }
    for (Index v = 0; v < s.surface.vertices.rows(); ++v)
        if (heldAt[static_cast<std::size_t>(v)] < 0) s.freeVertices.push_back(v);
    constexpr Index kHeldMiddle = -2;
    for (Eigen::Index t = 0; t < s.surface.triangles.rows(); ++t) {
        if (!s.heldTriangle[static_cast<std::size_t>(t)]) continue;
        for (int c = 0; c < 3; ++c) {
            const Index a = s.surface.triangles(t, c), b = s.surface.triangles(t, (c + 1) % 3), node = middles.at(a, b);
            if (node < 0) return fail("bad-value", "The tetrahedra do not fill the surface.");
            if (std::exchange(s.place[static_cast<std::size_t>(node)], kHeldMiddle) != kHeldMiddle)
                s.heldMiddles.push_back({node, heldAt[static_cast<std::size_t>(a)], heldAt[static_cast<std::size_t>(b)]});
        }
    }
    for (const auto& [a, b] : s.bubbles) {
        s.bubbleNode.push_back(middles.at(a, b));
        if (s.bubbleNode.back() < 0) return fail("bad-value", "The tetrahedra do not fill the surface.");
    }
    for (std::size_t node = 0; node < s.place.size(); ++node)
        if (s.place[node] != kHeldMiddle && (node >= heldAt.size() || heldAt[node] < 0)) s.place[node] = s.freeNodes++;
    for (std::size_t i = 0; i < s.heldVertices.size(); ++i) s.place[static_cast<std::size_t>(s.heldVertices[i])] = s.freeNodes + static_cast<Index>(i);
    for (std::size_t i = 0; i < s.heldMiddles.size(); ++i) s.place[static_cast<std::size_t>(s.heldMiddles[i].node)] = s.freeNodes + static_cast<Index>(s.heldVertices.size() + i);
    progress.report("assemble", 0.0);
    if (!s.stiffness.build(*input.tetrahedra, middles, s.place, s.freeNodes, input.nu, input.threads, progress)) return cancelled();
    s.quality.assembleSeconds = secondsSince(start);
    progress.report("factorise", 0.2);
    const auto factorStart = Clock::now();
    const FloatingPointGuard guard;
    if (auto ok = s.factorise(progress); !ok) return tl::make_unexpected(ok.error());
    s.quality.factoriseSeconds = secondsSince(factorStart);
    s.quality.peakBytes = s.common.memory_usage + s.stiffness.bytes();
    return VolumeProblem(std::move(state));
}

Result<VolumeProblem::Solution> VolumeProblem::solve(const Eigen::MatrixXd& held, const BoundaryProblem::Loads& loads, const Progress& progress) {
    State& s = *state_;
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    if (held.rows() != 3 * static_cast<Eigen::Index>(s.heldVertices.size())) return fail("bad-value", "The displacements do not match the held vertices.");
    if (!allFinite(held)) return fail("bad-value", "A prescribed displacement is not finite.");
    if (loads.tractions && (loads.tractions->rows() != s.surface.vertices.rows() || !allFinite(*loads.tractions)))
        return fail("bad-value", "The tractions do not match the vertices, or are not finite.");
    const auto start = Clock::now();
    const Eigen::Index prescribed = held.cols(), k = prescribed + loads.columns(), unknowns = 3 * static_cast<Eigen::Index>(s.freeNodes), all = 3 * static_cast<Eigen::Index>(s.nodeCount());
    NodeValues force = NodeValues::Zero(all, k);
    if (loads.columns() > 0) force.rightCols(loads.columns()) = s.loads(loads);
    NodeValues u = NodeValues::Zero(all, k);
    u.block(unknowns, 0, held.rows(), prescribed) = held;
    for (std::size_t i = 0; i < s.heldMiddles.size(); ++i) {
        const auto& middle = s.heldMiddles[i];
        u.block(unknowns + held.rows() + 3 * static_cast<Eigen::Index>(i), 0, 3, prescribed) = 0.5 * (held.middleRows<3>(3 * middle.from) + held.middleRows<3>(3 * middle.to));
    }
    NodeValues x = (force - s.stiffness.times(u, true, s.threads)).topRows(unknowns);
    // The residual of a combination of all columns: that of each would take as long as solving.
    NodeValues weights(k, 1);
    for (Eigen::Index c = 0; c < k; ++c) weights(c, 0) = c % 2 == 0 ? 1.0 : -0.7;
    const Eigen::VectorXd right = x * weights;
    if (progress.cancelled()) return cancelled();
    {
        const FloatingPointGuard guard;
        if (!s.solveFactor(x, progress)) {
            if (progress.cancelled()) return cancelled();
            return fail("no-memory", "The equations of the tetrahedra do not fit into memory; choose a solver mesh of fewer vertices.");
        }
    }
    if (!allFinite(x)) return fail("singular", "The equations of this body have no unique answer; check that every separate part of it has a joint face.");
    u.topRows(unknowns) = x;
    if (progress.cancelled()) return cancelled();
    const Eigen::VectorXd expected = (force * weights).topRows(unknowns), found = s.stiffness.times(u * weights, false, s.threads).topRows(unknowns);
    const double residual = (found - expected).norm(), size = right.norm();
    const double worst = size > 0.0 ? residual / size : 0.0;
    s.quality.residual = std::max(s.quality.residual, worst);
    if (!(worst <= kLargestResidual))
        return fail("inaccurate", "The equations of this body are too ill-conditioned to be solved accurately; repair thin spikes and nearly coinciding surfaces, or remesh it more evenly.");
    const NodeValues rest = s.stiffness.times(u, true, s.threads).bottomRows(all - unknowns) - force.bottomRows(all - unknowns);  // what holds the held nodes
    Solution out;
    out.displacement.resize(3 * static_cast<Eigen::Index>(s.freeVertices.size()), k);
    for (std::size_t i = 0; i < s.freeVertices.size(); ++i)
        out.displacement.middleRows<3>(3 * static_cast<Eigen::Index>(i)) = u.middleRows<3>(3 * static_cast<Eigen::Index>(s.place[static_cast<std::size_t>(s.freeVertices[i])]));
    out.bubbles.resize(3 * static_cast<Eigen::Index>(s.bubbles.size()), k);
    for (std::size_t b = 0; b < s.bubbles.size(); ++b) {
        const auto at = [&](Index node) { return u.middleRows<3>(3 * static_cast<Eigen::Index>(s.place[static_cast<std::size_t>(node)])); };
        out.bubbles.middleRows<3>(3 * static_cast<Eigen::Index>(b)) = at(s.bubbleNode[b]) - 0.5 * (at(s.bubbles[b][0]) + at(s.bubbles[b][1]));
    }
    out.forces = rest.topRows(held.rows());
    for (std::size_t i = 0; i < s.heldMiddles.size(); ++i) {
        const auto& middle = s.heldMiddles[i];
        const Eigen::MatrixXd half = 0.5 * rest.middleRows<3>(held.rows() + 3 * static_cast<Eigen::Index>(i));
        out.forces.middleRows<3>(3 * middle.from) += half;
        out.forces.middleRows<3>(3 * middle.to) += half;
    }
    if (loads.tractions) out.compliance = force.rightCols(3 * loads.tractions->cols()).transpose() * u.rightCols(3 * loads.tractions->cols());
    s.quality.solveSeconds += secondsSince(start);
    return out;
}

BoundaryProblem::Estimate VolumeProblem::estimate(int nodes, int columns, int threads) {
    BoundaryProblem::Estimate out;
    if (nodes <= 0) return out;
    const MachineRates rates = machineRates();
    const double n = nodes, factor = kFactorEntries * std::pow(n, kFactorExponent), share = std::clamp(threads, 1, hardwareThreads());
    out.seconds = kNodeSeconds * n + kFactorFlops * n * n / (rates.flops * kSparseRate) + 4.0 * factor * columns / (rates.flops * kSparseRate * share) + 4.0 * 8.0 * kBlocksPerNode * 9.0 * n * columns / rates.bytesPerSecond;
    out.bytes = static_cast<std::size_t>(8.0 * factor + 2.0 * kBlocksPerNode * 80.0 * n + 5.0 * 24.0 * n * columns);
    return out;
}

VolumeProblem::VolumeProblem(std::unique_ptr<State> state) : state_(std::move(state)) {}
VolumeProblem::VolumeProblem(VolumeProblem&&) noexcept = default;
VolumeProblem& VolumeProblem::operator=(VolumeProblem&&) noexcept = default;
VolumeProblem::~VolumeProblem() = default;
const std::vector<std::int32_t>& VolumeProblem::freeVertices() const { return state_->freeVertices; }
std::int64_t VolumeProblem::nodes() const { return state_->nodeCount(); }
const SolveQuality& VolumeProblem::quality() const { return state_->quality; }

}  // namespace imomushi
