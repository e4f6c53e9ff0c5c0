// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/reference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "core/accuracy/machine.h"
#include "core/base/clock.h"
#include "core/base/decompositions.h"
#include "core/base/try.h"
#include "core/comparison/model_table.h"
#include "core/comparison/previous_model.h"
#include "core/effects/smooth_joints_job.h"
#include "core/mesh/bounds.h"
#include "core/meshing/solved_body.h"
#include "core/reduction/congruence.h"

namespace imomushi {

namespace {

using Kind = SolverMeshSetting::Kind;


/// Rim layers and bubble functions leave a tenth of the error of the plain mesh (solved_body.h: measured on 24 bodies, 0.3 to 2.5 times the estimate).
constexpr double kErrorLeft = 0.1;
/// Motions of joint faces that are smooth.
const BasisChoice kSmooth(BasisKind::Modes, BasisChoice::kMaxModes);

tl::unexpected<Error> referenceCancelled() { return fail(kCancelled, "The study was cancelled."); }

std::vector<ResponseInput> asked(const std::vector<ResponseInput>& elements, const BasisChoice& basis, Kind mesh) {
    auto out = elements;
    for (auto& in : out) {
        in.basis = basis;
        in.solverMesh = {mesh, 0};
        in.loads = BodyLoads::None;
        in.touch = 0;
    }
    return out;
}

/// `shown` and `wanted` are world positions; `frames`: a character in the same pose.
ErrorSum difference(const std::vector<Points>& shown, const std::vector<Points>& wanted, const std::vector<std::vector<char>>& seen, const Character& frames) {
    ErrorSum sum;
    for (std::size_t e = 0; e < wanted.size(); ++e) {
        const Points& rest = frames.input().elements[e].mesh->body.vertices;
        const auto frame = frames.frame(static_cast<int>(e));
        const double diagonal = diagonalOf(rest);
        double largest = 0.0;
        for (Eigen::Index v = 0; v < rest.rows(); ++v) {
            if (!seen[e][static_cast<std::size_t>(v)]) continue;
            const double miss = (shown[e].row(v) - wanted[e].row(v)).squaredNorm();
            sum.wrong += miss;
            sum.all += (wanted[e].row(v).transpose() - frame * Vec3(rest.row(v).transpose())).squaredNorm();
            largest = std::max(largest, miss);
        }
        if (diagonal > 0.0) sum.percent = std::max(sum.percent, 100.0 * std::sqrt(largest) / diagonal);
    }
    return sum;
}

std::vector<Points> shownBy(const Character& character) {
    std::vector<Points> out;
    for (std::size_t e = 0; e < character.input().elements.size(); ++e) {
        const auto surface = character.surface(static_cast<int>(e));
        out.push_back(Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(surface.positions, surface.vertices, 3).cast<double>());
    }
    return out;
}

Result<PreviousModel> fullModel(CharacterInput character, const std::vector<std::shared_ptr<const ElementResponse>>& full, const Progress& progress) {
    for (std::size_t e = 0; e < full.size(); ++e) character.elements[e].response = full[e];
    return PreviousModel::build(std::move(character), progress);
}

/// Displacements of free vertices (3 x #free) that joint parameters `v` of a smooth basis cause, less those of the same motion of face vertices, linear on the triangles
/// of the body in between. Element rest axes.
Eigen::VectorXd bulge(const CharacterInput::Element& element, const ElementResponse& smooth, const ElementResponse& full, const Eigen::VectorXd& v) {
    Eigen::VectorXd u(full.columns());
    for (std::size_t f = 0; f < element.faces.size(); ++f) {
        const FaceBasis& basis = smooth.bases[f];
        const Points local = localVertices(element.mesh->body, element.faces[f]);
        for (Eigen::Index k = 0; k < local.rows(); ++k)
            u.segment<3>(full.firstColumn[f] + 3 * k) = basis.at(local.row(k).transpose()) * v.segment(smooth.firstColumn[f], basis.columns());
    }
    return smooth.response * v - full.response * u;
}

/// The joint parameters of a smooth basis nearest to what the faces of an element do at `positions` (world).
Eigen::VectorXd smoothPart(const CharacterInput::Element& element, const ElementResponse& smooth, const Eigen::Isometry3d& frame, const Points& positions) {
    Eigen::VectorXd v(smooth.columns());
    const Eigen::Isometry3d back = frame.inverse();
    for (std::size_t f = 0; f < element.faces.size(); ++f) {
        const JointFace& face = element.faces[f];
        const FaceBasis& basis = smooth.bases[f];
        const auto count = static_cast<Eigen::Index>(face.vertices.size());
        Eigen::MatrixXd C(3 * count, basis.columns());
        Eigen::VectorXd u(3 * count);
        for (Eigen::Index k = 0; k < count; ++k) {
            const auto vertex = face.vertices[static_cast<std::size_t>(k)];
            const Vec3 rest = element.mesh->body.vertices.row(vertex).transpose();
            C.middleRows<3>(3 * k) = basis.at(face.frame.toLocal(rest));
            u.segment<3>(3 * k) = face.frame.axes.transpose() * (back * Vec3(positions.row(vertex).transpose()) - rest);
        }
        v.segment(smooth.firstColumn[f], basis.columns()) = leastSquares(C, u);
    }
    return v;
}

}  // namespace

void ErrorSum::add(const ErrorSum& other) {
    wrong += other.wrong;
    all += other.all;
    percent = std::max(percent, other.percent);
}

PoseError ErrorSum::error() const { return {all > 0.0 ? std::sqrt(wrong / all) : 0.0, percent}; }

ErrorSum errorOf(const Character& character, const Reference& reference, std::size_t which) {
    return difference(shownBy(character), reference.positions[which], reference.seen, character);
}

ErrorSum errorOf(const Character& frames, const std::vector<Points>& positions, const Reference& reference, std::size_t which) {
    return difference(positions, reference.positions[which], reference.seen, frames);
}

std::vector<std::vector<float>> errorField(const Character& character, const Reference& reference, std::size_t which) {
    const std::vector<Points> shown = shownBy(character);
    std::vector<std::vector<float>> out;
    for (std::size_t e = 0; e < shown.size(); ++e) {
        const Points& rest = character.input().elements[e].mesh->body.vertices;
        const double diagonal = rest.rows() ? diagonalOf(rest) : 1.0;
        auto& field = out.emplace_back(static_cast<std::size_t>(rest.rows()), -1.0f);
        for (Eigen::Index v = 0; v < rest.rows(); ++v)
            if (reference.seen[e][static_cast<std::size_t>(v)])
                field[static_cast<std::size_t>(v)] = static_cast<float>(100.0 * (shown[e].row(v) - reference.positions[which][e].row(v)).norm() / diagonal);
    }
    return out;
}

Result<SolvedElements> solveElements(const std::vector<ResponseInput>& elements, const Progress& progress) {
    SolvedElements out;
    const double count = static_cast<double>(elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        out.responses.push_back(nullptr);
        out.seconds.push_back(0.0);
        if (elements[e].faces.empty()) continue;
        if (progress.cancelled()) return referenceCancelled();
        const auto start = Clock::now();
        Result<ElementResponse> built;
        bool carried = false;
        for (std::size_t k = 0; k < e && !carried; ++k)
            if (out.responses[k])
                if (const auto how = findCongruence(elements[k], elements[e])) built = how->carry(*out.responses[k]), carried = true;
        if (!carried) {
            const double at = static_cast<double>(e);
            built = buildResponse(elements[e], progress.part(at / count, (at + 1.0) / count));
        }
        if (!built) return tl::unexpected(built.error());
        out.responses.back() = std::make_shared<const ElementResponse>(std::move(*built));
        out.seconds.back() = secondsSince(start);
    }
    out.peakBytes = estimateElements(elements).bytes;
    return out;
}

ResponseEstimate estimateElements(const std::vector<ResponseInput>& elements, const Progress& progress) {
    ResponseEstimate sum;
    for (std::size_t e = 0; e < elements.size() && !progress.cancelled(); ++e) {
        if (elements[e].faces.empty()) continue;
        const bool shared = std::any_of(elements.begin(), elements.begin() + static_cast<std::ptrdiff_t>(e), [&](const ResponseInput& other) {
            return !other.faces.empty() && other.mesh->body.vertices.rows() == elements[e].mesh->body.vertices.rows() && findCongruence(other, elements[e]);
        });
        const ResponseEstimate one = estimateResponse(elements[e]);
        if (!shared) sum.seconds += one.seconds;
        sum.bytes = std::max(sum.bytes, one.bytes);
        sum.frameMilliseconds += one.frameMilliseconds;
        sum.columns += one.columns;
    }
    return sum;
}

std::optional<Kind> referenceMesh(const ReferenceInput& input, const Progress& progress) {
    for (const Kind mesh : {Kind::Best, Kind::Default, Kind::AsIs}) {
        const auto elements = asked(input.elements, BasisKind::Full, mesh);
        const ResponseEstimate cost = estimateElements(elements, progress);
        double kept = 0.0;
        for (const auto& e : elements) {
            double m = 0.0;
            for (const auto& face : e.faces) m += 3.0 * static_cast<double>(face.vertices.size());
            kept += (2.0 * sizeof(double) + sizeof(float)) * (3.0 * static_cast<double>(e.mesh->body.vertices.rows()) + m) * m;
        }
        if (static_cast<double>(cost.bytes) + kept > input.bytes || (input.seconds > 0.0 && cost.seconds > input.seconds && mesh != Kind::AsIs)) continue;
        return mesh;
    }
    return std::nullopt;
}

int referenceRank(const std::string& mesh) { return mesh == "best" ? 2 : mesh == "default" ? 1 : 0; }

ContentKey referenceKey(const ReferenceInput& input) {
    ContentHasher hasher;
    const auto vector = [&](const Vec3& v) { hasher.array(std::span<const double>(v.data(), 3)); };
    for (const ResponseInput& in : asked(input.elements, BasisKind::Full, Kind::Default)) {
        const ContentKey key = responseKey(in);
        hasher.number(key.high);
        hasher.number(key.low);
    }
    const CharacterInput& c = input.character;
    for (const auto& e : c.elements) {
        hasher.number(e.stiffness);
        hasher.number(static_cast<int>(e.leadsJointPlanes));
        hasher.array(std::span<const int>(e.bones));
    }
    for (const Vec3& p : c.skeleton.points) vector(p);
    for (const auto& b : c.skeleton.bones) {
        hasher.array(std::span<const int>(std::array{b.start, b.end, b.parent}));
        hasher.array(std::span<const double>(std::array{b.length, b.minStretch, b.maxStretch}));
        if (b.limitsBend() || b.limitsTwist() || b.stiffness != 1.0) hasher.array(std::span<const double>(std::array{b.maxBend, b.maxTwist, b.stiffness}));
    }
    for (const auto& joint : c.joints) {
        hasher.number(joint.point);
        for (const auto& f : joint.faces) hasher.array(std::span<const int>(std::array{f.element, f.face, f.bone}));
        for (const auto& [a, b] : joint.welded) hasher.array(std::span<const std::int32_t>(std::array{a, b}));
    }
    return hasher.key();
}

ResponseEstimate referenceCost(const ReferenceInput& input, const Progress& progress) {
    const std::optional<Kind> finest = referenceMesh(input, progress);
    if (!finest) return {};
    ResponseEstimate out = estimateElements(asked(input.elements, BasisKind::Full, *finest), progress);
    out.seconds += estimateElements(asked(input.elements, kSmooth, *finest), progress).seconds;
    if (*finest != Kind::AsIs) out.seconds += estimateElements(asked(input.elements, BasisKind::Full, Kind::AsIs), progress).seconds;
    out.seconds /= machineShare(input.elements.front().threads);
    return out;
}

/// Joint faces may bulge between their vertices as the smooth part of their motion does: on the triangles of the body alone they are faceted, which is no property of the
/// body. What is left is estimated by doing the same with the motion of the smooth modes in equilibrium.
struct FullSolution::State {
    CharacterInput character;
    std::string mesh, how;
    double relative = -1.0;                ///< where there is no coarser level
    double seconds = 0.0;
    std::vector<std::vector<char>> seen;
    std::vector<std::shared_ptr<const ElementResponse>> full, smooth;
    PreviousModel fine;
    std::optional<PreviousModel> coarse;   ///< on the bodies as they are
    Character equilibrium;                 ///< of the smooth modes; its frames are those of the elements

    Result<void> addPose(const Pose& pose, Reference& out, ErrorSum& coarser, ErrorSum& faces, const Progress& progress);
};

Result<void> FullSolution::State::addPose(const Pose& pose, Reference& out, ErrorSum& coarser, ErrorSum& faces, const Progress& progress) {
    IMOMUSHI_TRY(auto solved, fine.statics(pose, progress));
    equilibrium.update(pose);
    if (coarse) {
        IMOMUSHI_TRY(const auto plain, coarse->statics(pose, progress));
        coarser.add(difference(plain, solved, seen, equilibrium));
    }
    std::vector<Points> other = solved;
    for (std::size_t e = 0; e < smooth.size(); ++e) {
        if (!smooth[e]) continue;
        const auto& element = character.elements[e];
        const auto frame = equilibrium.frame(static_cast<int>(e));
        Points& own = solved[e];
        const Eigen::VectorXd x = bulge(element, *smooth[e], *full[e], smoothPart(element, *smooth[e], frame, own));
        const Eigen::VectorXd y = bulge(element, *smooth[e], *full[e], equilibrium.jointParameters(static_cast<int>(e)));
        for (std::size_t k = 0; k < full[e]->freeVertices.size(); ++k) {
            const auto vertex = full[e]->freeVertices[k];
            own.row(vertex) += (frame.linear() * x.segment<3>(3 * static_cast<Eigen::Index>(k))).transpose();
            other[e].row(vertex) += (frame.linear() * y.segment<3>(3 * static_cast<Eigen::Index>(k))).transpose();
        }
    }
    faces.add(difference(other, solved, seen, equilibrium));
    out.positions.push_back(std::move(solved));
    return {};
}

FullSolution::FullSolution(std::unique_ptr<State> state) : state_(std::move(state)) {}
FullSolution::FullSolution(FullSolution&&) noexcept = default;
FullSolution& FullSolution::operator=(FullSolution&&) noexcept = default;
FullSolution::~FullSolution() = default;

Result<FullSolution> FullSolution::build(const ReferenceInput& input, const Progress& progress) {
    const bool any = std::any_of(input.elements.begin(), input.elements.end(), [](const ResponseInput& e) { return !e.faces.empty(); });
    if (!any) return fail("no-face", "No element has a joint face: there is nothing to compare before faces are added.");
    const std::optional<Kind> finest = referenceMesh(input);
    if (!finest) return fail("no-memory", "The full solution of this character needs more memory than there is for it: errors stay unknown. Use coarser elements.");

    const auto start = Clock::now();
    CharacterInput plain = withoutEffects(input.character);
    for (auto& e : plain.elements) e.response = nullptr;
    IMOMUSHI_TRY(auto full, solveElements(asked(input.elements, BasisKind::Full, *finest), progress.part(0.0, 0.6)));
    IMOMUSHI_TRY(auto fine, fullModel(plain, full.responses, progress));
    std::optional<PreviousModel> coarse;
    double relative = -1.0;
    std::string how;
    if (*finest != Kind::AsIs) {
        IMOMUSHI_TRY(const auto coarser, solveElements(asked(input.elements, BasisKind::Full, Kind::AsIs), progress.part(0.6, 0.7)));
        IMOMUSHI_TRY(auto model, fullModel(plain, coarser.responses, progress));
        coarse.emplace(std::move(model));
        how = "A tenth of the difference from the same solution on the bodies as they are, which is what strips and quadratic displacement leave of the error of a plain mesh.";
    } else {
        bool known = true;
        for (const auto& r : full.responses)
            if (r) known = known && r->quality.error >= 0.0, relative = std::max(relative, r->quality.error);
        if (!known) relative = -1.0;
        how = known ? "Solved on the bodies as they are, since finer meshes would take too long: the error of the worst element against a coarser mesh; its largest "
                      "error at one vertex is unknown."
                    : "Solved on the bodies as they are, since finer meshes would take too long, and there is no coarser mesh to compare with: its error is unknown.";
    }
    IMOMUSHI_TRY(auto smooth, solveElements(asked(input.elements, kSmooth, *finest), progress.part(0.7, 1.0)));
    CharacterInput soft = plain;
    soft.basis = kSmooth;
    soft.effects.set(SmoothJointsEffect{});
    for (std::size_t e = 0; e < smooth.responses.size(); ++e) soft.elements[e].response = smooth.responses[e];
    IMOMUSHI_TRY(auto equilibrium, Character::build(std::move(soft)));
    return FullSolution(std::make_unique<State>(State{std::move(plain), solverMeshName({*finest, 0}), std::move(how), relative, secondsSince(start), seenVertices(input.character),
                                                      std::move(full.responses), std::move(smooth.responses), std::move(fine), std::move(coarse), std::move(equilibrium)}));
}

Result<Reference> FullSolution::in(const std::vector<StandardPose>& poses, const Progress& progress) {
    State& s = *state_;
    const auto start = Clock::now();
    Reference out;
    out.seen = s.seen;
    out.mesh = s.mesh;
    out.how = s.how;
    ErrorSum coarser, faces;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        progress.report("solve", static_cast<double>(i) / static_cast<double>(poses.size()));
        if (progress.cancelled()) return referenceCancelled();
        if (auto ok = s.addPose(poses[i].pose, out, coarser, faces, progress); !ok) return tl::unexpected(ok.error());
    }
    out.relative = s.coarse ? kErrorLeft * coarser.error().relative : s.relative;
    out.percent = s.coarse ? kErrorLeft * coarser.error().percent : -1.0;
    out.faceRelative = faces.error().relative;
    out.facePercent = faces.error().percent;
    out.seconds = s.seconds + secondsSince(start);
    out.solutionSeconds = s.seconds;
    return out;
}

const std::string& FullSolution::mesh() const { return state_->mesh; }
double FullSolution::seconds() const { return state_->seconds; }

std::size_t FullSolution::bytes() const {
    std::size_t sum = state_->fine.matrixBytes() + (state_->coarse ? 3 * state_->coarse->matrixBytes() : 0);  // its responses are kept too, in double precision
    for (const auto* responses : {&state_->full, &state_->smooth})
        for (const auto& r : *responses)
            if (r) sum += r->bytes();
    return sum;
}

Result<Reference> buildReference(const ReferenceInput& input, const Progress& progress) {
    IMOMUSHI_TRY(auto solution, FullSolution::build(input, progress.part(0.0, 0.95)));
    return solution.in(input.poses, progress.part(0.95, 1.0));
}

}  // namespace imomushi
