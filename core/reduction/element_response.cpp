// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/element_response.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "core/base/parallel.h"
#include "core/base/try.h"
#include "core/meshing/solved_body.h"
#include "core/reduction/element_statics.h"
#include "core/reduction/held_modes.h"
#include "core/reduction/joint_stiffness.h"
#include "core/reduction/response_loads.h"
#include "core/reduction/touch_patches.h"

namespace imomushi {

namespace {

/// Default is to be within 1 %. Where it says more than this it is wrong by that, or nearly (tests/elasticity/reference_test.cpp): then it is solved as best is, unless that takes more
/// than so many nodes, by the estimate and by the count. Handles stay as they are: what is stated of them is a mean over their motions.
constexpr double kDefaultSays = 0.011;
constexpr int kClimbNodes = 80'000, kClimbNodesCounted = 100'000;

/// Nodes of quadratic displacement: corners and edges. As many edges as Euler's formula gives a ball.
std::int64_t quadraticNodes(const SolvedBody& solved) {
    return 2 * solved.filling->vertices.rows() + solved.filling->tetrahedra.rows() + solved.mesh.mesh.triangles.rows() / 2 - 1;
}

std::vector<FaceBasis> basesOf(const ResponseInput& input, std::vector<int>& firstColumn) {
    std::vector<FaceBasis> bases;
    firstColumn.assign(1, 0);
    for (const JointFace& face : input.faces) {
        bases.push_back(FaceBasis::on(input.mesh->body, face, input.basis));
        firstColumn.push_back(firstColumn.back() + bases.back().columns());
    }
    return bases;
}

/// The motions in which responses are compared, #columns x #motions, by the columns of `bases`: handles move rigidly (Character::Handle), other faces in all their modes. Modes
/// that stretch the flesh under a handle are wrong by ten times as much as those that move and turn it.
Eigen::MatrixXd comparedMotions(const std::vector<JointFace>& faces, const std::vector<FaceBasis>& bases, const std::vector<int>& firstColumn) {
    std::vector<Eigen::VectorXd> motions;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const int columns = bases[f].columns();
        const auto add = [&] { return motions.emplace_back(Eigen::VectorXd::Zero(firstColumn.back())).data() + firstColumn[f]; };
        if (!faces[f].disc || bases[f].kind == BasisKind::Paper) {
            for (int c = 0; c < columns; ++c) add()[c] = 1.0;
            continue;
        }
        for (int axis = 0; axis < 3; ++axis) {
            JointMap move, turn;
            move.shift = Vec3::Unit(axis);
            const int next = (axis + 1) % 3, last = (axis + 2) % 3;
            turn.linear(last, next) = 1.0;
            turn.linear(next, last) = -1.0;
            double lost = 0.0;
            bases[f].coefficients(move, faces[f].size, add(), lost);
            bases[f].coefficients(turn, faces[f].size, add(), lost);
        }
    }
    Eigen::MatrixXd out(firstColumn.back(), static_cast<Eigen::Index>(motions.size()));
    for (std::size_t m = 0; m < motions.size(); ++m) out.col(static_cast<Eigen::Index>(m)) = motions[m];
    return out;
}

/// Discretisation error of `fineResponse` by its difference from a coarser level (see coarserLevel()), relative to the motion of free and held vertices
/// together, the largest over comparedMotions(); where there are handles, their root mean square. Of a full basis the affine motions of its faces are compared, which are the modes of other bases.
/// Negative where there is no coarser level.
Result<double> discretisationError(const TrimmedElement& element, const SolvedBody& solved, const ElementResponse& response, const Eigen::MatrixXd& C,
                                   const Eigen::MatrixXd& fineResponse, const Progress& progress) {
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    const ResponseInput& input = element.input;
    // A draft that is graded towards the outlines of discs has no coarser mesh that is graded alike: it was said to be wrong by 550 % where it was by 33 %.
    if (!solved.filling && !solved.inside.empty() && solved.plain.mesh.vertices.rows() == 0) return -1.0;
    const auto coarser = coarserLevel(input.mesh->body, input.faces, solved, progress);
    if (progress.cancelled()) return cancelled();
    if (!coarser) return -1.0;
    ResponseInput compared = input;
    if (input.basis == BasisKind::Full) compared.basis = BasisKind::Affine;
    std::vector<int> firstColumn;
    const std::vector<FaceBasis> bases = basesOf(compared, firstColumn);
    const HeldModes modes = heldModes(input.mesh->body, compared.faces, coarser->body, bases, firstColumn);
    const Eigen::MatrixXd motions = comparedMotions(compared.faces, bases, firstColumn);
    const auto coarse = solveStatics(element, coarser->body, modes.C * motions, modes.inside * motions, {}, progress);
    if (progress.cancelled()) return cancelled();
    if (!coarse) return -1.0;
    Eigen::MatrixXd held = C, fine = fineResponse.leftCols(response.columns());
    if (input.basis == BasisKind::Full) {
        Eigen::MatrixXd affine = Eigen::MatrixXd::Zero(response.columns(), firstColumn.back());
        for (std::size_t f = 0; f < bases.size(); ++f) {
            const Points rest = localVertices(input.mesh->body, input.faces[f]);
            for (Eigen::Index i = 0; i < rest.rows(); ++i)
                affine.block(response.firstColumn[f] + 3 * i, firstColumn[f], 3, bases[f].columns()) = bases[f].at(rest.row(i).transpose());
        }
        held = (held * affine).eval();
        fine = (fine * affine).eval();
    }
    held = (held * motions).eval();
    fine = (fine * motions).eval();
    double largest = 0.0, sum = 0.0;
    for (Eigen::Index c = 0; c < held.cols(); ++c) {
        const double size = fine.col(c).squaredNorm() / static_cast<double>(fine.rows()) + held.col(c).squaredNorm() / static_cast<double>(held.rows());
        if (!(size > 0.0)) continue;
        const double apart = (fine.col(c) - coarse->response.col(c)).squaredNorm() / static_cast<double>(fine.rows()) / size;
        largest = std::max(largest, apart);
        sum += apart;
    }
    const bool handles = std::any_of(compared.faces.begin(), compared.faces.end(), [](const JointFace& face) { return face.disc.has_value(); });
    return coarser->share * std::sqrt(handles ? sum / static_cast<double>(held.cols()) : largest);
}

/// What is solved in place of an element.
struct Prepared {
    TrimmedElement element;
    SolvedBody solved;
    std::chrono::steady_clock::time_point start;
};

/// `input` has joint faces and outlives what is made of it. `fill`: with tetrahedra, where the setting asks for them; afterwards whether they were there.
Result<Prepared> prepare(const ResponseInput& input, bool& fill, const Progress& progress) {
    const auto start = std::chrono::steady_clock::now();
    IMOMUSHI_TRY(auto element, trimmedElement(input, progress.part(0.0, 0.2)));
    auto solved = solvedBody(element.input.mesh->body, element.input.faces, input.solverMesh, progress.part(0.2, 1.0), fill);
    fill = solved && solved->filling;
    if (!solved) return tl::make_unexpected(solved.error());
    return Prepared{std::move(element), std::move(*solved), start};
}

Result<ElementResponse> finish(const ResponseInput& input, const Prepared& prepared, const Progress& progress) {
    const TrimmedElement* const element = &prepared.element;
    const SolvedBody* const solved = &prepared.solved;
    ElementResponse response;
    response.bases = basesOf(input, response.firstColumn);
    const int g = response.columns();
    const SolverMesh& mesh = solved->mesh;
    const HeldModes modes = heldModes(element->input.mesh->body, element->input.faces, *solved, response.bases, response.firstColumn);
    response.freeVertices = element->wholeFree;
    WantedLoads wanted{&input, false, {}, {}};
    if (input.touch > 0) wanted.patches = touchPatches(*input.mesh, input.faces, input.touch);
    wanted.body = input.loads == BodyLoads::Always || (input.loads == BodyLoads::WhereCheap && (element->body.appendages.empty() || wanted.patches.count() > 0));
    const bool anyLoads = wanted.body || wanted.patches.count() > 0, loadsApart = anyLoads && !element->body.appendages.empty();
    if (anyLoads && !loadsApart) wanted.place(*solved);
    auto solution = solveStatics(*element, *solved, modes.C, modes.inside, anyLoads && !loadsApart ? wanted.columns() : BoundaryProblem::Loads{},
                            progress.part(0.1, loadsApart ? 0.5 : 0.95));
    if (!solution) return tl::make_unexpected(solution.error());
    auto error = discretisationError(*element, *solved, response, modes.C, solution->response, progress.part(0.95, 1.0));
    if (!error) return tl::make_unexpected(error.error());
    const auto cancelled = [] { return fail(kCancelled, "The precompute was cancelled."); };
    response.stiffness = Eigen::SparseMatrix<double>(modes.C.sparseView()).transpose() * solution->forces;
    response.response = std::move(solution->response);
    SolvedLoads loads;
    if (loadsApart) {
        auto whole = solveLoadsOnWhole(input, wanted, modes, response, progress.part(0.5, 0.95));
        if (!whole) return tl::make_unexpected(whole.error());
        loads = std::move(*whole);
    } else if (anyLoads) {
        const Eigen::Index count = wanted.columns().columns();
        loads = {response.response.rightCols(count), response.stiffness.rightCols(count), std::move(solution->compliance), wanted.resultants(mesh, modes)};
        response.response.conservativeResize(Eigen::NoChange, g);
        response.stiffness.conservativeResize(Eigen::NoChange, g);
    }
    if (progress.cancelled()) return cancelled();
    if (input.basis == BasisKind::Full) response.tractions = nodalTractions(input.mesh->body, input.faces, modes, response.firstColumn, response.stiffness);
    if (progress.cancelled()) return cancelled();
    ResponseQuality& quality = response.quality;
    quality.solve = solution->quality;
    quality.solverVertices = static_cast<int>(mesh.mesh.vertices.rows());
    quality.solverNodes = static_cast<int>(solution->nodes);
    quality.tetrahedra = solved->filling ? static_cast<std::int64_t>(solved->filling->tetrahedra.rows()) : 0;
    quality.noFilling = solved->noFilling;
    quality.decimated = solved->decimated;
    quality.error = *error;
    quality.mappingError = solution->mappingError;
    quality.shapeError = solution->shapeError;
    const auto projected = projectStiffness(modes, mesh, loads.resultants, response.stiffness, loads.forces, progress);
    if (!projected) return tl::make_unexpected(projected.error());
    quality.asymmetry = projected->asymmetry;
    quality.negativeEnergy = projected->negativeEnergy;
    if (wanted.body) {
        response.loads = loads.displacement.leftCols(BoundaryEquation::kLoads);
        response.loadForces = loads.forces.leftCols(BoundaryEquation::kLoads);
    }
    if (const Eigen::Index columns = 3 * wanted.patches.count(); columns > 0) {
        response.touch.patches = std::move(wanted.patches);
        response.touch.displacement = loads.displacement.rightCols(columns).cast<float>();
        response.touch.forces = loads.forces.rightCols(columns);
        response.touch.compliance = std::move(loads.compliance);
        if (auto ok = finishTouch(input.mesh->body, input.faces, response.freeVertices, input.nu, input.threads, response.touch, progress); !ok)
            return tl::make_unexpected(ok.error());
    }
    if (input.basis == BasisKind::Full && response.tractions.size() == 0)
        return fail("singular", "A joint face has no area; choose a larger one.");
    response.quality.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - prepared.start).count();
    return response;
}

/// Both; an element without joint faces follows as it is.
Result<ElementResponse> buildWith(const ResponseInput& input, bool& fill, const Progress& progress) {
    if (input.faces.empty()) {
        fill = false;
        ElementResponse response;
        response.bases = basesOf(input, response.firstColumn);
        response.freeVertices = freeVerticesOf(input);
        response.response.resize(3 * static_cast<Eigen::Index>(response.freeVertices.size()), 0);
        response.stiffness.resize(0, 0);
        return response;
    }
    IMOMUSHI_TRY(const auto prepared, prepare(input, fill, progress.part(0.0, 0.1)));
    return finish(input, prepared, progress);
}

/// Only what the input alone decides is a reason to go another way: a tetrahedron is too flat. Too little memory is none.
bool byInput(const Error& error) { return error.code == "singular" || error.code == "inaccurate"; }

}  // namespace

std::size_t ElementResponse::bytes() const {
    return sizeof(double) * static_cast<std::size_t>(response.size() + stiffness.size() + tractions.size() + loads.size() + loadForces.size()) + sizeof(std::int32_t) * freeVertices.size() +
           touch.bytes();
}

Result<ElementResponse> buildResponse(const ResponseInput& input, const Progress& progress) {
    SolverMeshSetting solvedAs;
    return buildResponse(input, solvedAs, progress);
}

Result<ElementResponse> buildResponse(const ResponseInput& input, SolverMeshSetting& solvedAs, const Progress& progress) {
    solvedAs = input.solverMesh;
    if (auto ok = checkInput(input); !ok) return tl::make_unexpected(ok.error());
    bool fill = filled(input);
    auto response = buildWith(input, fill, progress);
    const bool handles = std::any_of(input.faces.begin(), input.faces.end(), [](const JointFace& face) { return face.disc.has_value(); });
    if (response && fill && !handles && input.solverMesh.kind == SolverMeshSetting::Kind::Default && response->quality.error > kDefaultSays) {
        ResponseInput finer = input;
        finer.solverMesh.kind = SolverMeshSetting::Kind::Best;
        if (solvedSize(finer.mesh->body, finer.faces, finer.solverMesh).nodes > kClimbNodes) return response;
        bool filledFiner = true;
        const auto prepared = prepare(finer, filledFiner, progress.part(0.0, 0.1));
        if (!prepared && !byInput(prepared.error())) return tl::make_unexpected(prepared.error());
        if (!prepared || !filledFiner || quadraticNodes(prepared->solved) > kClimbNodesCounted) return response;
        auto better = finish(finer, *prepared, progress);
        if (!better && !byInput(better.error())) return better;
        if (!better) return response;
        better->quality.seconds += response->quality.seconds;
        solvedAs = finer.solverMesh;
        return better;
    }
    if (response || !fill || !byInput(response.error())) return response;
    const std::string why = response.error().message;
    fill = false;
    response = buildWith(input, fill, progress);
    if (response) response->quality.noFilling = why;
    return response;
}

bool solvedBesideOthers(const ResponseInput& input) {
    using Kind = SolverMeshSetting::Kind;
    return filled(input) && (input.solverMesh.kind == Kind::Draft || input.solverMesh.kind == Kind::Default);
}

void buildResponses(std::span<const ResponseInput> inputs, int threads, const std::function<void(std::size_t, Result<ElementResponse>)>& done, const Progress& progress) {
    std::vector<std::size_t> order(inputs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto vertices = [&](std::size_t i) { return inputs[i].mesh ? inputs[i].mesh->body.vertices.rows() : 0; };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return vertices(a) > vertices(b); });
    std::mutex mutex;
    std::atomic<std::size_t> finished{0};
    const auto share = [&] { return static_cast<double>(finished.load()) / static_cast<double>(inputs.size()); };
    parallelFor(threads, inputs.size(), 1, [&](std::size_t k, std::size_t) {
        if (progress.cancelled()) return;
        ResponseInput input = inputs[order[k]];
        const bool alone = inputs.size() == 1;
        input.threads = alone ? threads : 1;
        auto response = buildResponse(input, alone ? progress : progress.part(share(), share()));
        if (progress.cancelled()) return;
        const std::scoped_lock lock(mutex);
        ++finished;
        done(order[k], std::move(response));
    });
}

}  // namespace imomushi
