// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/reduction/element_statics.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/elasticity/volume_problem.h"
#include "core/reduction/display_mapping.h"
#include "core/reduction/held_modes.h"
#include "core/reduction/touch_response.h"

namespace imomushi {

namespace {

BoundaryProblem::Input problemOf(const ResponseInput& input) {
    BoundaryProblem::Input problem;
    problem.mesh = &input.mesh->body;
    for (const JointFace& face : input.faces) problem.held.push_back({face.vertices, face.triangles});
    problem.nu = input.nu;
    problem.threads = input.threads;
    return problem;
}

BoundaryProblem::Input problemOf(const ResponseInput& input, const SolverMesh& mesh) {
    BoundaryProblem::Input problem;
    problem.mesh = &mesh.mesh;
    for (const SolverMesh::Patch& face : mesh.faces) problem.held.push_back({face.vertices, face.triangles});
    problem.bubbles = mesh.bubbles;
    problem.nu = input.nu;
    problem.threads = input.threads;
    return problem;
}

/// A solution on the surface, whoever found it.
struct SurfaceSolution {
    Eigen::MatrixXd displacement, bubbles;    ///< see BoundaryProblem::Solution
    Eigen::MatrixXd forces, compliance;       ///< see StaticSolution
    std::vector<std::int32_t> freeVertices;
    SolveQuality quality;
    std::int64_t nodes = 0;
};

Result<SurfaceSolution> solveByBoundary(const ResponseInput& input, const SolverMesh& mesh, const Eigen::MatrixXd& held, const BoundaryProblem::Loads& loads, const Progress& progress) {
    auto problem = BoundaryProblem::build(problemOf(input, mesh), progress.part(0.0, 0.9));
    if (!problem) return tl::make_unexpected(problem.error());
    auto solution = problem->solve(held, loads, progress.part(0.9, 1.0));
    if (!solution) return tl::make_unexpected(solution.error());
    SurfaceSolution out;
    if (loads.tractions) out.compliance = patchCompliance(mesh, *loads.tractions, problem->freeVertices(), *solution);
    out.forces = faceMass(mesh, solution->traction);
    out.displacement = std::move(solution->displacement);
    out.bubbles = std::move(solution->bubbles);
    out.freeVertices = problem->freeVertices();
    out.quality = problem->quality();
    out.nodes = mesh.mesh.vertices.rows() + static_cast<Eigen::Index>(mesh.bubbles.size());
    return out;
}

Result<SurfaceSolution> solveByVolume(const ResponseInput& input, const SolvedBody& solved, const Eigen::MatrixXd& held, const BoundaryProblem::Loads& loads, const Progress& progress) {
    VolumeProblem::Input in;
    in.surface = &solved.mesh.mesh;
    in.tetrahedra = solved.filling.get();
    for (const SolverMesh::Patch& face : solved.mesh.faces) in.held.push_back({face.vertices, face.triangles});
    in.bubbles = solved.mesh.bubbles;
    in.nu = input.nu;
    in.threads = input.threads;
    auto problem = VolumeProblem::build(in, progress.part(0.0, 0.7));
    if (!problem) return tl::make_unexpected(problem.error());
    auto solution = problem->solve(held, loads, progress.part(0.7, 1.0));
    if (!solution) return tl::make_unexpected(solution.error());
    return SurfaceSolution{std::move(solution->displacement), std::move(solution->bubbles), std::move(solution->forces), std::move(solution->compliance),
                           problem->freeVertices(), problem->quality(), problem->nodes()};
}

/// Displacement of halvedAtBubbles(mesh): at the vertices of the solver mesh, then at the middles of its bubbles' edges.
Eigen::MatrixXd nodalDisplacement(const SolverMesh& mesh, const Eigen::MatrixXd& held, const SurfaceSolution& solution) {
    const Eigen::Index vertices = mesh.mesh.vertices.rows(), bubbles = static_cast<Eigen::Index>(mesh.bubbles.size());
    const Eigen::Index loads = solution.displacement.cols() - held.cols();  // with the faces at rest
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * (vertices + bubbles), held.cols() + loads);
    for (std::size_t i = 0; i < solution.freeVertices.size(); ++i)
        out.middleRows(3 * solution.freeVertices[i], 3) = solution.displacement.middleRows(3 * static_cast<Eigen::Index>(i), 3);
    Eigen::Index row = 0;
    for (const SolverMesh::Patch& face : mesh.faces)
        for (const std::int32_t v : face.vertices) {
            out.block(3 * v, 0, 3, held.cols()) = held.middleRows(row, 3);
            row += 3;
        }
    for (Eigen::Index b = 0; b < bubbles; ++b) {
        const auto& [from, to] = mesh.bubbles[static_cast<std::size_t>(b)];
        out.middleRows(3 * (vertices + b), 3) =
            0.5 * (out.middleRows(3 * from, 3) + out.middleRows(3 * to, 3)) + solution.bubbles.middleRows(3 * b, 3);
    }
    return out;
}

/// The rows of all `freeVertices`, from those of what no disc holds and those of what lies in one; what is more than `inside` has are loads, under which discs rest.
Eigen::MatrixXd withInside(const std::vector<std::int32_t>& freeVertices, const SolvedBody& solved, const Eigen::MatrixXd& free, const Eigen::MatrixXd& inside) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(freeVertices.size()), free.cols());
    Eigen::Index in = 0, other = 0;  // all lists ascend
    for (std::size_t i = 0; i < freeVertices.size(); ++i) {
        const auto row = 3 * static_cast<Eigen::Index>(i);
        if (in < static_cast<Eigen::Index>(solved.inside.size()) && solved.inside[static_cast<std::size_t>(in)].vertex == freeVertices[i])
            out.block(row, 0, 3, inside.cols()) = inside.middleRows<3>(3 * in++);
        else
            out.middleRows<3>(row) = free.middleRows<3>(3 * other++);
    }
    return out;
}

/// Displacement of the free vertices of the whole body, 3 * #wholeFree x k, from that of the trimmed one.
Eigen::MatrixXd onWhole(const TrimmedElement& element, Eigen::MatrixXd displacement) {
    if (element.body.appendages.empty()) return displacement;
    Eigen::MatrixXd solved = Eigen::MatrixXd::Zero(element.body.mesh.vertices.size(), displacement.cols());
    for (std::size_t i = 0; i < element.freeVertices.size(); ++i) solved.middleRows<3>(3 * element.freeVertices[i]) = displacement.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    const Eigen::MatrixXd all = element.body.onBody(element.whole->mesh->body.vertices, solved);
    displacement.resize(3 * static_cast<Eigen::Index>(element.wholeFree.size()), displacement.cols());
    for (std::size_t i = 0; i < element.wholeFree.size(); ++i) displacement.middleRows<3>(3 * static_cast<Eigen::Index>(i)) = all.middleRows<3>(3 * element.wholeFree[i]);
    return displacement;
}

}  // namespace

bool filled(const ResponseInput& input) { return input.nu <= VolumeProblem::kLargestNu; }

Result<void> checkInput(const ResponseInput& input) {
    if (!input.mesh) return fail("bad-value", "The element has no mesh.");
    if (input.touch < 0 || input.touch > ResponseInput::kMaxTouch) return fail("bad-value", "The number of touch patches must lie between 0 and 1024.");
    for (const JointFace& face : input.faces)
        for (const std::int32_t v : face.vertices)
            if (v < 0 || v >= input.mesh->body.vertices.rows())
                return fail("bad-value", "The joint face \"" + face.name + "\" names a vertex that does not exist; choose it again.");
    if (!input.faces.empty()) return BoundaryProblem::check(problemOf(input));
    return {};
}

std::vector<std::int32_t> freeVerticesOf(const ResponseInput& input) {
    std::vector<char> held(static_cast<std::size_t>(input.mesh->body.vertices.rows()));
    for (const JointFace& face : input.faces)
        for (const std::int32_t v : face.vertices) held[static_cast<std::size_t>(v)] = 1;
    std::vector<std::int32_t> out;
    for (std::size_t v = 0; v < held.size(); ++v)
        if (!held[v]) out.push_back(static_cast<std::int32_t>(v));
    return out;
}

Result<TrimmedElement> trimmedElement(const ResponseInput& whole, const Progress& progress) {
    auto body = withoutAppendages(*whole.mesh, whole.faces, progress);
    if (!body) return tl::make_unexpected(body.error());
    TrimmedElement out{&whole, whole, std::move(*body), {}, freeVerticesOf(whole)};
    // A full basis moves each vertex of a face by itself, and an outline is between them.
    if (whole.basis == BasisKind::Full)
        for (std::vector<JointFace>* faces : {&out.input.faces, &out.body.faces})
            for (JointFace& face : *faces) face.disc.reset();
    if (!out.body.appendages.empty()) {
        out.input.mesh = std::make_shared<ElementMesh>(ElementMesh{out.body.mesh, {}});
        out.input.faces = out.body.faces;
    }
    out.freeVertices = freeVerticesOf(out.input);
    return out;
}

Result<StaticSolution> solveStatics(const TrimmedElement& element, const SolvedBody& solved, const Eigen::MatrixXd& held, const Eigen::MatrixXd& inside,
                                    const BoundaryProblem::Loads& loads, const Progress& progress) {
    const ResponseInput& input = element.input;
    // What lies in a disc moves with its handle.
    std::vector<std::int32_t> bodyFree = element.freeVertices;
    for (const DiscMesh::Inside& in : solved.inside) bodyFree.erase(std::lower_bound(bodyFree.begin(), bodyFree.end(), in.vertex));
    auto solution = solved.filling ? solveByVolume(input, solved, held, loads, progress.part(0.0, 0.98)) : solveByBoundary(input, solved.mesh, held, loads, progress.part(0.0, 0.98));
    if (!solution) return tl::make_unexpected(solution.error());
    StaticSolution out;
    out.compliance = std::move(solution->compliance);
    out.quality = solution->quality;
    out.nodes = solution->nodes;
    if (!solved.decimated) {
        // The solver mesh begins with the body's vertices, and both lists ascend.
        out.response = solution->displacement.topRows(3 * static_cast<Eigen::Index>(bodyFree.size()));
    } else {
        const SolverMesh halved = halvedAtBubbles(solved.mesh);
        std::vector<char> leaveOut(static_cast<std::size_t>(input.mesh->body.vertices.rows()), 1);
        for (const std::int32_t v : bodyFree) leaveOut[static_cast<std::size_t>(v)] = 0;
        std::vector<std::int32_t> heldTriangles;
        for (const SolverMesh::Patch& face : halved.faces) heldTriangles.insert(heldTriangles.end(), face.triangles.begin(), face.triangles.end());
        auto map = DisplayMapping::build({&input.mesh->body, leaveOut, &halved.mesh, heldTriangles, input.threads}, progress);
        if (!map) return tl::make_unexpected(map.error());
        auto mapped = map->apply(nodalDisplacement(solved.mesh, held, *solution), input.nu, input.threads, progress);
        if (!mapped) return tl::make_unexpected(mapped.error());
        out.response = std::move(mapped->displacement);
        if (mapped->error.size() > 0) out.mappingError = mapped->error.norm() / std::sqrt(static_cast<double>(mapped->error.size()));
        out.shapeError = map->distance().shape;
    }
    if (!solved.inside.empty()) out.response = withInside(element.freeVertices, solved, out.response, inside);
    out.response = onWhole(element, std::move(out.response));
    out.forces = std::move(solution->forces);
    return out;
}

Result<Points> solveFull(const ResponseInput& input, const std::vector<Points>& faceDisplacement, const Progress& progress) {
    if (auto ok = checkInput(input); !ok) return tl::make_unexpected(ok.error());
    if (faceDisplacement.size() != input.faces.size()) return fail("bad-value", "Give the displacements of every joint face.");
    for (std::size_t f = 0; f < input.faces.size(); ++f)
        if (faceDisplacement[f].rows() != static_cast<Eigen::Index>(input.faces[f].vertices.size()))
            return fail("bad-value", "The displacements of a joint face do not match its vertices.");
    SolverMeshSetting setting = input.solverMesh;
    if (setting.kind == SolverMeshSetting::Kind::Default) {  // the response says how finely
        ResponseInput alone = input;
        alone.touch = 0;
        alone.loads = BodyLoads::None;
        if (auto response = buildResponse(alone, setting, progress.part(0.0, 0.4)); !response) return tl::make_unexpected(response.error());
    }
    auto element = trimmedElement(input, progress.part(0.4, 0.42));
    if (!element) return tl::make_unexpected(element.error());
    for (JointFace& face : element->input.faces) face.disc.reset();  // displacements are given at the vertices of faces
    auto solved = solvedBody(element->input.mesh->body, element->input.faces, setting, progress.part(0.42, 0.5), filled(input));
    if (!solved) return tl::make_unexpected(solved.error());
    Points out = Points::Zero(input.mesh->body.vertices.rows(), 3), prescribed = Points::Zero(element->input.mesh->body.vertices.rows(), 3);
    for (std::size_t f = 0; f < input.faces.size(); ++f)
        for (std::size_t i = 0; i < input.faces[f].vertices.size(); ++i) {
            const auto u = faceDisplacement[f].row(static_cast<Eigen::Index>(i));
            out.row(input.faces[f].vertices[i]) = u;
            prescribed.row(element->input.faces[f].vertices[i]) = u;
        }
    auto level = solveStatics(*element, *solved, heldDisplacement(*solved, prescribed), {}, {}, progress.part(0.5, 1.0));
    if (!level) return tl::make_unexpected(level.error());
    for (std::size_t i = 0; i < element->wholeFree.size(); ++i)
        out.row(element->wholeFree[i]) = level->response.block<3, 1>(3 * static_cast<Eigen::Index>(i), 0).transpose();
    return out;
}

}  // namespace imomushi
