// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/comparison/model_table.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>

#include "core/base/try.h"
#include "core/character/response_blocks.h"
#include "core/character/standard_poses.h"
#include "core/comparison/previous_model.h"
#include "core/comparison/test_motion.h"
#include "core/comparison/timing.h"
#include "core/mesh/bounds.h"

namespace imomushi {

namespace {

constexpr int kRounds = 300;
constexpr double kSeconds = 2.0;  // for each of two measurements: a hundred rounds of a large character

tl::unexpected<Error> cancelled() { return fail(kCancelled, "The comparison was cancelled."); }

}  // namespace

CharacterInput withoutEffects(const CharacterInput& given) {
    CharacterInput out;
    out.skeleton = given.skeleton;
    for (const auto& e : given.elements) {
        auto& to = out.elements.emplace_back();
        to.mesh = e.mesh;
        to.faces = e.faces;
        to.response = e.response;
        to.stiffness = e.stiffness;
        to.bones = e.bones;
        to.leadsJointPlanes = e.leadsJointPlanes;
    }
    out.joints = given.joints;
    out.basis = BasisKind::Paper;
    return out;
}

std::vector<std::vector<char>> seenVertices(const CharacterInput& input) {
    std::vector<std::vector<char>> seen, covered;
    for (const auto& e : input.elements) {
        seen.emplace_back(static_cast<std::size_t>(e.mesh->body.vertices.rows()), 0);
        covered.emplace_back(static_cast<std::size_t>(e.mesh->body.triangles.rows()), 0);
    }
    for (const auto& joint : input.joints)
        if (joint.faces.size() >= 2)
            for (const auto& f : joint.faces)
                for (const auto t : input.elements[f.element].faces[f.face].triangles) covered[f.element][t] = 1;
    for (std::size_t e = 0; e < seen.size(); ++e)
        for (std::size_t t = 0; t < covered[e].size(); ++t)
            for (int c = 0; c < 3 && !covered[e][t]; ++c) seen[e][input.elements[e].mesh->body.triangles(static_cast<Eigen::Index>(t), c)] = 1;
    return seen;
}

Result<ModelTable> compareModels(const ComparedModels& models, const Progress& progress) {
    const CharacterInput& given = models.input;
    if (given.skeleton.bones.empty()) return fail("no-bone", "There is no bone to move the character by: add bones first.");
    CharacterInput input = withoutEffects(given);
    CharacterInput old = input;
    ModelTable table;
    auto &proposed = table.proposed, &previous = table.previous;
    proposed.model = "proposed", previous.model = "previous";
    std::vector<ResponseBlocks> blocks;
    std::vector<std::size_t> first;
    std::size_t vertices = 0;
    for (std::size_t e = 0; e < input.elements.size(); ++e) {
        const auto& element = input.elements[e];
        old.elements[e].response = models.full[e];
        vertices += static_cast<std::size_t>(element.mesh->body.vertices.rows());
        if (!element.response) continue;
        const auto& r = *element.response;
        blocks.emplace_back(element.mesh->body.vertices, r.freeVertices, Vec3::Zero(), r.response, ResponseFormat::Float);
        first.push_back(3 * (vertices - static_cast<std::size_t>(element.mesh->body.vertices.rows())));
        proposed.columns += r.columns();
        proposed.bytes += sizeof(float) * static_cast<std::size_t>(r.response.size());
        proposed.frameBytes += blocks.back().responseBytes();
    }
    if (blocks.empty()) return fail("no-face", "No element has a joint face: there is nothing to compare before faces are added.");
    proposed.elements = previous.elements = static_cast<int>(input.elements.size());
    proposed.vertices = previous.vertices = static_cast<int>(vertices);

    IMOMUSHI_TRY(auto character, Character::build(std::move(input)));
    IMOMUSHI_TRY(auto baseline, PreviousModel::build(std::move(old), progress.part(0.0, 0.1)));
    previous.columns = baseline.columns();
    previous.bytes = previous.frameBytes = baseline.matrixBytes();

    // Errors come first: they leave both models in the last random pose, in which the products are then timed.
    const auto seen = seenVertices(given);
    const auto poses = standardPoses(given.skeleton);
    std::vector<Eigen::VectorXd> v;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        progress.report("compare", 0.1 + 0.5 * static_cast<double>(i) / static_cast<double>(poses.size()));
        character.update(poses[i].pose);
        IMOMUSHI_TRY(const auto wanted, baseline.statics(poses[i].pose, progress));
        ModelTable::PoseError error{poses[i].name};
        error.beyondBasis = (character.stats().warnings & static_cast<unsigned>(FrameWarning::BasisLosesTwist)) != 0;
        double wrong = 0.0, all = 0.0;
        for (std::size_t e = 0; e < given.elements.size(); ++e) {
            const auto& rest = given.elements[e].mesh->body.vertices;
            const auto frame = character.frame(static_cast<int>(e));
            const Points shown = character.positions(static_cast<int>(e));
            const double diagonal = diagonalOf(rest);
            for (Eigen::Index p = 0; p < rest.rows(); ++p) {
                if (!seen[e][static_cast<std::size_t>(p)]) continue;
                const double miss = (shown.row(p) - wanted[e].row(p)).squaredNorm();
                wrong += miss;
                all += (wanted[e].row(p).transpose() - frame * Vec3(rest.row(p).transpose())).squaredNorm();
                if (diagonal > 0.0) error.percent = std::max(error.percent, 100.0 * std::sqrt(miss) / diagonal);
            }
        }
        error.relative = all > 0.0 ? std::sqrt(wrong / all) : 0.0;
        table.errors.push_back(error);
    }
    for (std::size_t e = 0; e < given.elements.size(); ++e)
        if (given.elements[e].response) v.push_back(character.jointParameters(static_cast<int>(e)));

    progress.report("measure", 0.6);
    TestMotion motion(given.skeleton);
    Pose oldPose = restPose(given.skeleton), pose = oldPose;
    double at = 0.0;
    const auto performed = [&](Character& of, Pose& as) {
        motion.move(at += 0.013);
        of.solvePose(motion.goals, as);
        of.update(as, PreviousModel::kFrame);
    };
    const auto frames = mediansInTurn(kRounds, kSeconds,
                                      {[&] { performed(character, pose); },
                                       [&] {
                                           performed(baseline.character(), oldPose);
                                           table.diverged = (baseline.character().stats().warnings & static_cast<unsigned>(FrameWarning::Diverged)) != 0 || table.diverged;
                                       }},
                                      progress.part(0.6, 0.8));
    proposed.frameMs = frames[0];
    previous.frameMs = frames[1];

    progress.report("measure", 0.8);
    // The previous model's product alone: its n x m matrices as they are in the paper, by the BLAS.
    std::vector<Eigen::MatrixXf> whole;
    std::vector<Eigen::VectorXf> x, y;
    for (const auto& r : models.full) {
        if (!r || r->columns() == 0) continue;
        Eigen::MatrixXf& matrix = whole.emplace_back(r->response.rows() + r->tractions.rows(), r->columns());
        matrix << r->response.cast<float>(), r->tractions.cast<float>();
        x.push_back(Eigen::VectorXf::Ones(matrix.cols()));
        y.push_back(Eigen::VectorXf::Zero(matrix.rows()));
    }
    openblas_set_num_threads(1);
    AlignedBuffer<float> positions(3 * (vertices + kVertexBlock));
    const AffineFloat placement = {{0, -1, 0, 1, 0, 0, 0, 0, 1}, {0.1f, 0.2f, 0.3f}};
    const auto products = mediansInTurn(kRounds, kSeconds,
                                        {[&] {
                                             for (std::size_t b = 0; b < blocks.size(); ++b) {
                                                 blocks[b].weigh(v[b]);
                                                 evaluateAndPlace(blocks[b].view(), blocks[b].weights(), placement, 0, blocks[b].count(), nullptr,
                                                                  positions.data() + first[b]);
                                             }
                                         },
                                         [&] {
                                             for (std::size_t b = 0; b < whole.size(); ++b)
                                                 cblas_sgemv(CblasColMajor, CblasNoTrans, static_cast<int>(whole[b].rows()), static_cast<int>(whole[b].cols()), 1.0f, whole[b].data(),
                                                             static_cast<int>(whole[b].rows()), x[b].data(), 1, 0.0f, y[b].data(), 1);
                                         }},
                                        progress.part(0.8, 1.0));
    if (progress.cancelled()) return cancelled();
    proposed.productMs = products[0];
    previous.productMs = products[1];
    return table;
}

}  // namespace imomushi
