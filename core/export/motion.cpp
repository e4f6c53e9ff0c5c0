// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/motion.h"
#include "core/base/try.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

namespace imomushi {

namespace {

/// Character::build() cannot be cancelled and takes a second for a large character: it runs in a thread of its own, which goes on alone after a cancel.
Result<Character> buildCharacter(const CharacterInput& input, const Progress& progress) {
    struct Work {
        std::mutex mutex;
        std::condition_variable changed;
        std::optional<Result<Character>> made;
        std::exception_ptr thrown;
    };
    const auto work = std::make_shared<Work>();
    std::thread([work, input] {
        std::optional<Result<Character>> made;
        std::exception_ptr thrown;
        try {
            made = Character::build(input);
        } catch (...) {
            thrown = std::current_exception();
        }
        const std::lock_guard lock(work->mutex);
        work->made = std::move(made);
        work->thrown = thrown;
        work->changed.notify_all();
    }).detach();
    std::unique_lock lock(work->mutex);
    while (!work->changed.wait_for(lock, std::chrono::milliseconds(20), [&] { return work->made || work->thrown; }))
        if (progress.cancelled()) return fail(kCancelled, "The export was cancelled.");
    if (work->thrown) std::rethrow_exception(work->thrown);
    return std::move(*work->made);
}

}  // namespace

Result<Motion> Motion::build(const ExportScene& scene, double fps, const Progress& progress) {
    IMOMUSHI_TRY(auto built, buildCharacter(scene.character, progress));
    Motion motion(std::move(built));
    Character& character = motion.character;
    motion.layout = character.shapeLayout();
    const auto size = static_cast<std::size_t>(motion.layout.size());
    motion.restShape.resize(size);
    character.update(restPose(scene.character.skeleton));
    character.shape(motion.restShape.data());
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    bool first = true;
    for (std::size_t e = 0; e < scene.character.elements.size(); ++e) {
        const Points& v = scene.character.elements[e].mesh->body.vertices;
        if (v.rows() == 0) continue;
        const Vec3 l = v.colwise().minCoeff().transpose(), h = v.colwise().maxCoeff().transpose();
        low = first ? l : low.cwiseMin(l);
        high = first ? h : high.cwiseMax(h);
        first = false;
        character.deformExternally(static_cast<int>(e), true);
    }
    if (const double d = (high - low).norm(); d > 0.0) motion.diagonal = d;
    motion.seen.resize(scene.character.elements.size());
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        for (const int e : scene.meshes[m].elements) motion.seen[static_cast<std::size_t>(e)].mesh = static_cast<int>(m);
        auto& vertices = motion.meshVertices.emplace_back();
        for (const auto& vertex : scene.character.renderMeshes[m]->vertices) {
            auto& own = motion.seen[static_cast<std::size_t>(vertex.element)].vertices;
            vertices.push_back({vertex.element, static_cast<std::int32_t>(own.size())});
            own.push_back(static_cast<std::int32_t>(vertices.size() - 1));
        }
    }

    for (std::size_t m = 0, before = 0; m < scene.meshes.size(); ++m) {
        const EmbeddedMesh& mesh = *scene.character.renderMeshes[m];
        motion.morphs_.push_back({static_cast<int>(before), static_cast<int>(mesh.morphs()), mesh.model});
        before += mesh.morphs();
    }
    motion.tree_ = boneTree(scene.character.skeleton);
    std::vector<Vec3> heads;  // of bones of rigs
    for (const ExportedRig& rig : scene.rigs)
        for (const RigBone& bone : rig.rig->bones) heads.push_back(bone.head);
    for (const ExportClip& clip : scene.clips) {
        if (clip.times.empty()) return fail("bad-value", "The clip \"" + clip.name + "\" has no frames.");
        Clip out;
        std::vector<std::vector<double>> shapes(clip.times.size(), std::vector<double>(size));
        if (!heads.empty() && clip.poses.size() != clip.times.size()) return fail("bad-value", "The clip \"" + clip.name + "\" has other poses than frames.");
        for (std::size_t i = 0; i < clip.times.size(); ++i) {
            if (progress.cancelled()) return fail(kCancelled, "The export was cancelled.");
            if (clip.shape) {
                clip.shape(i, shapes[i].data());
                continue;
            }
            character.stop();
            character.update(clip.poses[i]);
            character.shape(shapes[i].data());
        }
        std::vector<std::vector<Eigen::Isometry3d>> bones;
        for (std::size_t i = 0; !heads.empty() && i < shapes.size(); ++i) bones.push_back(motion.rigBones(scene, clip.poses[i], shapes[i].data()));
        if (fps <= 0.0) {
            out.times = clip.times;
            out.shapes = std::move(shapes);
            out.bones = std::move(bones);
        } else {
            const auto frames = static_cast<std::size_t>(std::floor(clip.times.back() * fps + 1e-6)) + 1;
            std::size_t at = 0;
            for (std::size_t k = 0; k < frames; ++k) {
                const double time = std::min(static_cast<double>(k) / fps, clip.times.back());
                while (at + 1 < clip.times.size() && clip.times[at + 1] <= time) ++at;
                out.times.push_back(static_cast<double>(k) / fps);
                auto& shape = out.shapes.emplace_back(shapes[at]);
                if (!bones.empty()) out.bones.push_back(bones[at]);
                if (at + 1 == clip.times.size()) continue;
                const double part = (time - clip.times[at]) / (clip.times[at + 1] - clip.times[at]);
                if (part <= 1e-9) continue;
                character.between(shapes[at].data(), shapes[at + 1].data(), part, shape.data());
                for (std::size_t b = 0; b < heads.size(); ++b) {
                    const Eigen::Isometry3d &from = bones[at][b], &to = bones[at + 1][b];
                    const Eigen::Quaterniond turn = Eigen::Quaterniond(from.linear()).slerp(part, Eigen::Quaterniond(to.linear())).normalized();
                    Eigen::Isometry3d& made = out.bones.back()[b];
                    made.linear() = turn.toRotationMatrix();
                    made.translation() = (1.0 - part) * (from * heads[b]) + part * (to * heads[b]) - made.linear() * heads[b];
                }
            }
        }
        motion.clips.push_back(std::move(out));
    }
    return motion;
}

std::vector<Eigen::Isometry3d> Motion::rigBones(const ExportScene& scene, const Pose& pose, const double* shape) const {
    const Skeleton& skeleton = scene.character.skeleton;
    std::vector<Eigen::Isometry3d> out;
    for (const ExportedRig& rig : scene.rigs)
        for (const ExportedRig::Mover& mover : rig.movers) {
            Eigen::Isometry3d& made = out.emplace_back(Eigen::Isometry3d::Identity());
            if (mover.bone >= 0) {
                // With its roll, as flesh follows it.
                const auto b = static_cast<std::size_t>(mover.bone);
                const auto start = static_cast<std::size_t>(skeleton.bones[b].start);
                const Eigen::Quaterniond& plain = pose.frames[b];
                const Eigen::AngleAxisd roll(boneRoll(skeleton, tree_, pose, mover.bone), (plain * tree_.restDirection[b]).normalized());
                made.linear() = (Eigen::Quaterniond(roll) * plain).normalized().toRotationMatrix();
                made.translation() = pose.points[start] - made.linear() * skeleton.points[start];
            } else if (mover.element >= 0) {
                const double* at = shape + layout.element(static_cast<std::size_t>(mover.element));
                made.linear() = Eigen::Quaterniond(at).normalized().toRotationMatrix();
                made.translation() = Eigen::Map<const Vec3>(at + 4);
            }
        }
    return out;
}

bool Motion::morphsChange(std::size_t clip, int mesh) const {
    for (const auto& shape : clips[clip].shapes)
        for (int t = 0; t < morphs(mesh); ++t)
            if (morphWeight(mesh, t, shape.data()) != morphs_[static_cast<std::size_t>(mesh)].model->morphs[static_cast<std::size_t>(t)].atRest) return true;
    return false;
}

std::vector<double> Motion::withoutMorphs(const double* shape) const {
    std::vector<double> out(shape, shape + layout.size());
    for (const Morphs& of : morphs_)
        for (int t = 0; t < of.count; ++t) out[static_cast<std::size_t>(layout.morph(of.first + t))] = of.model->morphs[static_cast<std::size_t>(t)].atRest;
    return out;
}

void Motion::addMorphs(std::size_t element, const double* shape, Eigen::Ref<Eigen::VectorXd> to) const {
    const int mesh = seen[element].mesh;
    for (int t = 0; mesh >= 0 && t < morphs(mesh); ++t) {
        const MorphTarget& target = morphs_[static_cast<std::size_t>(mesh)].model->morphs[static_cast<std::size_t>(t)];
        const double weight = morphWeight(mesh, t, shape) - target.atRest;
        for (std::size_t i = 0; weight != 0.0 && i < target.vertices.size(); ++i) {
            const MeshVertex& v = meshVertices[static_cast<std::size_t>(mesh)][static_cast<std::size_t>(target.vertices[i])];
            if (v.element == static_cast<std::int32_t>(element)) to.segment<3>(3 * v.row) += weight * target.deltas.row(static_cast<Eigen::Index>(i)).cast<double>().transpose();
        }
    }
}

std::vector<Points> Motion::meshPositions() const {
    std::vector<Points> out;
    for (std::size_t m = 0; m < meshVertices.size(); ++m) out.push_back(character.renderPositions(static_cast<int>(m)));
    return out;
}

Points Motion::seenPositions(std::size_t element, const std::vector<Points>& ofMeshes) const {
    const Seen& own = seen[element];
    return own.mesh < 0 ? character.positions(static_cast<int>(element)) : Points(ofMeshes[static_cast<std::size_t>(own.mesh)](own.vertices, Eigen::indexing::all));
}

Points Motion::seenAtRest(std::size_t element) const {
    const Seen& own = seen[element];
    return own.mesh < 0 ? character.restPositions(static_cast<int>(element)) : Points(character.renderRestPositions(own.mesh)(own.vertices, Eigen::indexing::all));
}

double framesPerSecond(const Motion& motion) {
    for (const auto& clip : motion.clips)
        if (clip.times.size() > 1) return static_cast<double>(clip.times.size() - 1) / clip.times.back();
    return 60.0;
}

std::size_t Motion::affordable(Eigen::Index products) {
    constexpr Eigen::Index kPerSecond = 1'000'000'000;
    return static_cast<std::size_t>(std::max<Eigen::Index>(48, kPerSecond / std::max<Eigen::Index>(products, 1)));
}

std::vector<std::pair<std::size_t, std::size_t>> Motion::sample(std::size_t most) const {
    std::size_t all = 0;
    for (const Clip& clip : clips) all += clip.times.size();
    const std::size_t count = std::min(all, most);
    std::vector<std::pair<std::size_t, std::size_t>> out;
    std::size_t key = 0, taken = 0;
    for (std::size_t c = 0; c < clips.size(); ++c)
        for (std::size_t f = 0; f < clips[c].times.size(); ++f, ++key)
            if (taken < count && key == (count > 1 ? taken * (all - 1) / (count - 1) : 0)) {
                out.emplace_back(c, f);
                ++taken;
            }
    return out;
}

}  // namespace imomushi
