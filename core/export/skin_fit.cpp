// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/skin_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/comparison/skin_body.h"
#include "core/comparison/standard_poses.h"

namespace imomushi {

namespace {

constexpr std::size_t kClipFrames = 48;
// Joints that say the same share a vertex: this part of the diagonal of the normal equations keeps them from fighting.
constexpr double kRidge = 1e-6;

using Motions = std::vector<Eigen::Isometry3d>;  // of the joints of the skin, rest to world

Eigen::Isometry3d isometry(const Eigen::Quaterniond& rotation, const Vec3& rest, const Vec3& now) {
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = rotation.toRotationMatrix();
    out.translation() = now - out.linear() * rest;
    return out;
}

/// Weights that minimise |A w - b| with sum 1 and w >= 0, over a few candidates: negative ones leave one by one, then the weakest beyond kMost.
Eigen::VectorXd solveWeights(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right) {
    const Eigen::Index n = normal.rows();
    std::vector<Eigen::Index> active;
    for (Eigen::Index i = 0; i < n; ++i) active.push_back(i);
    Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
    while (true) {
        const auto count = static_cast<Eigen::Index>(active.size());
        Eigen::MatrixXd m(count, count);
        Eigen::VectorXd r(count);
        for (Eigen::Index i = 0; i < count; ++i) {
            r[i] = right[active[static_cast<std::size_t>(i)]];
            for (Eigen::Index k = 0; k < count; ++k) m(i, k) = normal(active[static_cast<std::size_t>(i)], active[static_cast<std::size_t>(k)]);
        }
        const Eigen::LDLT<Eigen::MatrixXd> factor(m);
        const Eigen::VectorXd free = factor.solve(r), one = factor.solve(Eigen::VectorXd::Ones(count));
        const Eigen::VectorXd solved = free + (1.0 - free.sum()) / one.sum() * one;
        Eigen::Index least = 0;
        const double smallest = solved.minCoeff(&least);
        if (count > 1 && (smallest < 0.0 || count > FittedSkin::kMost)) {
            active.erase(active.begin() + least);
            continue;
        }
        w.setZero();
        for (Eigen::Index i = 0; i < count; ++i) w[active[static_cast<std::size_t>(i)]] = count == 1 ? 1.0 : solved[i];
        return w;
    }
}

}  // namespace

Result<FittedSkin> fitSkin(Motion& motion, const ExportScene& scene, const Progress& progress) {
    const CharacterInput& input = scene.character;
    const std::size_t elements = input.elements.size(), joints = input.joints.size();
    Character& character = motion.character;
    const ShapeLayout& layout = motion.layout;
    FittedSkin skin;
    for (std::size_t e = 0; e < elements; ++e) {
        const Points& v = input.elements[e].mesh->body.vertices;
        skin.joints.push_back({scene.elements[e], v.rows() > 0 ? Vec3(0.5 * (v.colwise().minCoeff() + v.colwise().maxCoeff()).transpose()) : Vec3(Vec3::Zero())});
    }
    std::vector<int> jointOf(joints, -1);
    for (std::size_t j = 0; j < joints; ++j) {
        const auto& joint = input.joints[j];
        if (joint.faces.size() < 2) continue;
        jointOf[j] = static_cast<int>(skin.joints.size());
        const auto& f = joint.faces[0];
        const auto& face = input.elements[static_cast<std::size_t>(f.element)].faces[static_cast<std::size_t>(f.face)];
        skin.joints.push_back({scene.elements[static_cast<std::size_t>(f.element)] + " " + face.name,
                               joint.point >= 0 ? input.skeleton.points[static_cast<std::size_t>(joint.point)] : face.frame.origin});
    }
    const auto rotationOf = [&](const double* shape, std::size_t j) { return Eigen::Quaterniond(shape + layout.joint(static_cast<int>(j))); };
    const auto placeOf = [&](const double* shape, std::size_t j) -> Vec3 {
        const double* at = shape + layout.joint(static_cast<int>(j)) + 4;
        return Eigen::Map<const Eigen::Matrix3d>(at) * skin.joints[static_cast<std::size_t>(jointOf[j])].origin + Eigen::Map<const Vec3>(at + 9);
    };
    const auto motionsOf = [&](const double* shape) {
        Motions out;
        for (std::size_t e = 0; e < elements; ++e) {
            const double* at = shape + layout.element(e);
            Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
            frame.linear() = Eigen::Quaterniond(at).toRotationMatrix();
            frame.translation() = Eigen::Map<const Vec3>(at + 4);
            out.push_back(frame);
        }
        for (std::size_t j = 0; j < joints; ++j)
            if (jointOf[j] >= 0) out.push_back(isometry(rotationOf(shape, j), skin.joints[static_cast<std::size_t>(jointOf[j])].origin, placeOf(shape, j)));
        return out;
    };

    // Candidates of an element: itself, its planes, the elements across them and their other planes.
    std::vector<std::vector<int>> candidates(elements);
    for (std::size_t e = 0; e < elements; ++e) {
        auto& list = candidates[e];
        list.push_back(static_cast<int>(e));
        for (std::size_t j = 0; j < joints; ++j) {
            if (jointOf[j] < 0) continue;
            const auto& faces = input.joints[j].faces;
            if (std::none_of(faces.begin(), faces.end(), [&](const auto& f) { return f.element == static_cast<int>(e); })) continue;
            list.push_back(jointOf[j]);
            for (const auto& f : faces)
                if (std::find(list.begin(), list.end(), f.element) == list.end()) list.push_back(f.element);
        }
    }
    const SkinBody body = skinBody(input);
    const auto vertices = static_cast<std::size_t>(body.vertices.rows());
    std::vector<int> elementOf(vertices);
    for (std::size_t e = 0; e < elements; ++e)
        std::fill(elementOf.begin() + body.first[e], elementOf.begin() + body.first[e + 1], static_cast<int>(e));
    std::vector<std::vector<int>> list(vertices);  // per lowest vertex, of all that are welded to it
    for (std::size_t v = 0; v < vertices; ++v)
        for (const int c : candidates[static_cast<std::size_t>(elementOf[v])]) {
            auto& of = list[static_cast<std::size_t>(body.same[v])];
            if (std::find(of.begin(), of.end(), c) == of.end()) of.push_back(c);
        }

    // Normal equations, frame by frame. Standard poses count little: they keep weights sensible where the clips say nothing.
    std::vector<Eigen::MatrixXd> normal(vertices);
    std::vector<Eigen::VectorXd> right(vertices);
    for (std::size_t v = 0; v < vertices; ++v) {
        const auto n = static_cast<Eigen::Index>(list[v].size());
        normal[v] = Eigen::MatrixXd::Zero(n, n);
        right[v] = Eigen::VectorXd::Zero(n);
    }
    const int threads = hardwareThreads();
    const auto positions = [&] {
        Points all(static_cast<Eigen::Index>(vertices), 3);
        for (std::size_t e = 0; e < elements; ++e) all.middleRows(body.first[e], body.first[e + 1] - body.first[e]) = character.positions(static_cast<int>(e));
        return all;
    };
    const auto add = [&](const Points& at, const Motions& motions, double weight) {
        parallelFor(threads, vertices, 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                if (body.same[v] != static_cast<std::int32_t>(v)) continue;
                const Vec3 rest = body.vertices.row(static_cast<Eigen::Index>(v)).transpose(), goal = at.row(static_cast<Eigen::Index>(v)).transpose();
                Eigen::Matrix3Xd moved(3, static_cast<Eigen::Index>(list[v].size()));
                for (std::size_t i = 0; i < list[v].size(); ++i) moved.col(static_cast<Eigen::Index>(i)) = motions[static_cast<std::size_t>(list[v][i])] * rest - goal;
                normal[v].noalias() += weight * (moved.transpose() * moved);
            }
        });
    };
    const auto sample = motion.sample(kClipFrames);
    for (std::size_t s = 0; s < sample.size(); ++s) {
        if (progress.cancelled()) return fail(kCancelled, "The export was cancelled.");
        progress.report("fit", 0.5 * static_cast<double>(s) / static_cast<double>(sample.size()));
        const auto& shape = motion.clips[sample[s].first].shapes[sample[s].second];
        character.show(shape.data());
        add(positions(), motionsOf(shape.data()), 1.0 / static_cast<double>(sample.size()));
    }
    std::vector<double> shape(motion.restShape.size());
    for (const StandardPose& pose : standardPoses(input.skeleton)) {
        if (progress.cancelled()) return fail(kCancelled, "The export was cancelled.");
        character.stop();
        character.update(pose.pose);
        character.shape(shape.data());
        add(positions(), motionsOf(shape.data()), 0.01);
    }
    std::vector<FittedSkin::Vertex> fitted(vertices);
    parallelFor(threads, vertices, 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            if (body.same[v] != static_cast<std::int32_t>(v)) continue;
            auto& m = normal[v];
            m.diagonal().array() += kRidge * std::max(m.trace(), 1e-12 * motion.diagonal * motion.diagonal);
            // The goal is at the origin of these rows: with sum 1 the right side is zero.
            const Eigen::VectorXd w = solveWeights(m, right[v]);
            std::vector<std::pair<double, int>> order;
            for (std::size_t i = 0; i < list[v].size(); ++i)
                if (w[static_cast<Eigen::Index>(i)] > 0.0) order.emplace_back(-w[static_cast<Eigen::Index>(i)], list[v][i]);
            std::sort(order.begin(), order.end());
            double sum = 0.0;
            for (const auto& [weight, joint] : order) sum -= weight;
            for (std::size_t i = 0; i < std::min<std::size_t>(order.size(), FittedSkin::kMost); ++i)
                fitted[v].joint[i] = order[i].second, fitted[v].weight[i] = static_cast<float>(-order[i].first / sum);
        }
    });
    for (std::size_t e = 0; e < elements; ++e) {
        auto& out = skin.elements.emplace_back();
        for (int v = body.first[e]; v < body.first[e + 1]; ++v) out.push_back(fitted[static_cast<std::size_t>(body.same[static_cast<std::size_t>(v)])]);
    }

    for (const auto& clip : motion.clips) {
        auto& tracks = skin.tracks.emplace_back(skin.joints.size());
        const auto keys = static_cast<Eigen::Index>(clip.times.size());
        for (auto& track : tracks) track.rotations.resize(4, keys), track.places.resize(3, keys);
        for (Eigen::Index k = 0; k < keys; ++k) {
            const Motions motions = motionsOf(clip.shapes[static_cast<std::size_t>(k)].data());
            for (std::size_t j = 0; j < motions.size(); ++j) {
                tracks[j].rotations.col(k) = Eigen::Quaterniond(motions[j].linear()).coeffs();
                if (k > 0 && tracks[j].rotations.col(k).dot(tracks[j].rotations.col(k - 1)) < 0.0) tracks[j].rotations.col(k) *= -1.0;
                tracks[j].places.col(k) = motions[j] * skin.joints[j].origin;
            }
        }
    }
    double largest = 0.0, squares = 0.0;
    const auto keys = motion.sample(Motion::affordable(100 * static_cast<Eigen::Index>(vertices)));
    for (const auto& key : keys) {
        const auto& at = motion.clips[key.first].shapes[key.second];
        character.show(at.data());
        const Points goal = positions();
        const Motions motions = motionsOf(at.data());
        for (std::size_t v = 0; v < vertices; ++v) {
            Vec3 p = Vec3::Zero();
            const auto& f = fitted[static_cast<std::size_t>(body.same[v])];
            for (int i = 0; i < FittedSkin::kMost; ++i)
                p += static_cast<double>(f.weight[static_cast<std::size_t>(i)]) *
                     (motions[static_cast<std::size_t>(f.joint[static_cast<std::size_t>(i)])] * Vec3(body.vertices.row(static_cast<Eigen::Index>(v)).transpose()));
            const double d = (p - goal.row(static_cast<Eigen::Index>(v)).transpose()).squaredNorm();
            largest = std::max(largest, d);
            squares += d;
        }
    }
    skin.error = {std::sqrt(largest) / motion.diagonal, std::sqrt(squares / std::max<double>(1.0, static_cast<double>(vertices * keys.size()))) / motion.diagonal};
    return skin;
}

}  // namespace imomushi
