// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/skin_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/parallel.h"
#include "core/base/try.h"
#include "core/character/standard_poses.h"
#include "core/character/welded_surface.h"
#include "core/export/body_frames.h"
#include "core/export/skin_rig.h"

namespace imomushi {

namespace {

// Weight of all standard poses in the least squares, relative to all frames of the clips: a regularisation for bones that the clips do not move.
constexpr double kStandard = 0.01;
// Ridge term, relative to the diagonal of the normal equations: joints with the same motion then share a vertex evenly.
constexpr double kRidge = 1e-6;
// Alternations between weights and bind positions, where loads deform the body at rest.
constexpr int kRounds = 4;
// More joints than this are never near one vertex: the farthest are left out.
constexpr int kMaxCandidates = 24;
constexpr std::size_t kPiece = 32768, kBetweenReports = 16;  // vertices times frames that are worked on at once; such pieces

using Motions = std::vector<Eigen::Isometry3d>;  // of the joints of the skin, rest to world
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxCandidates, kMaxCandidates>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxCandidates, 1>;

Eigen::Isometry3d isometry(const Eigen::Quaterniond& rotation, const Vec3& rest, const Vec3& now) {
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = rotation.toRotationMatrix();
    out.translation() = now - out.linear() * rest;
    return out;
}

/// Weights w >= 0 of sum 1 with the least w^T normal w, over a few candidates: negative ones leave one by one, then the weakest beyond kMax.
SmallVector solveWeights(const Small& normal) {
    const auto n = static_cast<int>(normal.rows());
    std::array<int, kMaxCandidates> active{};
    for (int i = 0; i < n; ++i) active[static_cast<std::size_t>(i)] = i;
    for (int count = n;; --count) {
        Small m(count, count);
        for (int i = 0; i < count; ++i)
            for (int k = 0; k < count; ++k) m(i, k) = normal(active[static_cast<std::size_t>(i)], active[static_cast<std::size_t>(k)]);
        SmallVector solved = SmallVector::Ones(count);
        if (count > 1) {
            solved = m.ldlt().solve(SmallVector(SmallVector::Ones(count)));
            solved /= solved.sum();
            int least = 0;
            for (int i = 1; i < count; ++i)
                if (!(solved[i] >= solved[least])) least = i;
            if (!(solved[least] >= 0.0) || count > FittedSkin::kMax) {
                std::copy(active.begin() + least + 1, active.begin() + count, active.begin() + least);
                continue;
            }
        }
        SmallVector w = SmallVector::Zero(n);
        for (int i = 0; i < count; ++i) w[active[static_cast<std::size_t>(i)]] = solved[i];
        return w;
    }
}

/// The rigid motion that best fits the deformation of an element by body loads: linear in the weights of its shape, in its own axes.
struct LoadMotion {
    Vec3 middle = Vec3::Zero();  // m, at rest
    Eigen::Matrix3Xd shift, rotation;  // m and radians per weight; no columns: there are no loads
};

/// Least squares, each vertex weighted by how far loads move it.
LoadMotion loadMotionOf(const CharacterInput::Element& element, const std::vector<int>& loads) {
    LoadMotion out;
    if (loads.empty()) return out;
    const auto& r = *element.response;
    const Points& rest = element.mesh->body.vertices;
    const Eigen::Index columns = r.columns(), all = columns + static_cast<Eigen::Index>(loads.size()), count = static_cast<Eigen::Index>(r.freeVertices.size());
    Eigen::VectorXd mass = Eigen::VectorXd::Zero(count);
    double sum = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) {
        for (const int load : loads) mass[i] += r.loads.col(load).segment<3>(3 * i).squaredNorm();
        sum += mass[i];
        out.middle += mass[i] * rest.row(r.freeVertices[static_cast<std::size_t>(i)]).transpose();
    }
    if (!(sum > 0.0)) return LoadMotion{};
    out.middle /= sum;
    out.shift = out.rotation = Eigen::Matrix3Xd::Zero(3, all);
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (Eigen::Index i = 0; i < count; ++i) {
        const Vec3 d = rest.row(r.freeVertices[static_cast<std::size_t>(i)]).transpose() - out.middle;
        inertia += mass[i] * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
    }
    for (Eigen::Index c = 0; c < all; ++c) {
        const auto from = c < columns ? r.response.col(c) : r.loads.col(loads[static_cast<std::size_t>(c - columns)]);
        Vec3 moved = Vec3::Zero(), turned = Vec3::Zero();
        for (Eigen::Index i = 0; i < count; ++i) {
            const Vec3 u = from.segment<3>(3 * i), d = rest.row(r.freeVertices[static_cast<std::size_t>(i)]).transpose() - out.middle;
            moved += mass[i] * u;
            turned += mass[i] * d.cross(u);
        }
        out.shift.col(c) = moved / sum;
        out.rotation.col(c) = turned;
    }
    inertia.diagonal().array() += 1e-12 * std::max(inertia.trace(), 1e-300);
    out.rotation = inertia.ldlt().solve(out.rotation).eval();
    return out;
}

/// The joints of the skin in the axes of one element, in all frames: 3 x 4 per frame and joint.
struct LocalMotions {
    std::vector<int> joints;                      // of the skin, that vertices of the element may follow
    std::vector<Eigen::Matrix<double, 3, 4>> at;  // frame by frame
};

/// The least squares problem of one vertex.
struct VertexFit {
    const LocalMotions& motions;
    const std::vector<int>& follows;  // places in motions.joints
    const Eigen::MatrixXd& goals;     // 3 #vertices x #frames
    Eigen::Index row;                 // of the vertex
    const std::vector<double>& importance;  // of frames
    double floor;                     // m^2

    [[nodiscard]] const Eigen::Matrix<double, 3, 4>& motion(std::size_t k, std::size_t i) const { return motions.at[k * motions.joints.size() + static_cast<std::size_t>(follows[i])]; }
    [[nodiscard]] Vec3 goal(std::size_t k) const { return goals.col(static_cast<Eigen::Index>(k)).segment<3>(row); }

    [[nodiscard]] SmallVector weights(const Vec3& bind) const {
        const auto n = static_cast<Eigen::Index>(follows.size());
        Small normal = Small::Zero(n, n);
        Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxCandidates> off(3, n);
        for (std::size_t k = 0; k < importance.size(); ++k) {
            if (importance[k] == 0.0) continue;
            const Vec3 to = goal(k);
            for (std::size_t i = 0; i < follows.size(); ++i) {
                const auto& m = motion(k, i);
                off.col(static_cast<Eigen::Index>(i)) = m.leftCols<3>() * bind + m.col(3) - to;
            }
            for (Eigen::Index i = 0; i < n; ++i)
                for (Eigen::Index j = 0; j <= i; ++j) normal(i, j) += importance[k] * off.col(i).dot(off.col(j));
        }
        for (Eigen::Index i = 0; i < n; ++i)
            for (Eigen::Index j = 0; j < i; ++j) normal(j, i) = normal(i, j);
        normal.diagonal().array() += kRidge * std::max(normal.trace(), floor);
        return solveWeights(normal);
    }

    /// Where the vertex must be at rest for these weights; `known`: where it stays if they do not say.
    [[nodiscard]] Vec3 place(const SmallVector& w, const Vec3& known) const {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Vec3 right = Vec3::Zero();
        double all = 0.0;
        for (std::size_t k = 0; k < importance.size(); ++k) {
            if (importance[k] == 0.0) continue;
            Eigen::Matrix<double, 3, 4> m = Eigen::Matrix<double, 3, 4>::Zero();
            for (std::size_t i = 0; i < follows.size(); ++i) m += w[static_cast<Eigen::Index>(i)] * motion(k, i);
            normal += importance[k] * m.leftCols<3>().transpose() * m.leftCols<3>();
            right += importance[k] * m.leftCols<3>().transpose() * (goal(k) - m.col(3));
            all += importance[k];
        }
        normal.diagonal().array() += kRidge * all;
        right += kRidge * all * known;
        return normal.ldlt().solve(right);
    }
};

FittedSkin::Vertex vertexOf(const SmallVector& w, const std::vector<int>& follows, const std::vector<int>& joints) {
    std::vector<std::pair<double, int>> order;
    for (std::size_t i = 0; i < follows.size(); ++i)
        if (w[static_cast<Eigen::Index>(i)] > 0.0) order.emplace_back(-w[static_cast<Eigen::Index>(i)], joints[static_cast<std::size_t>(follows[i])]);
    std::sort(order.begin(), order.end());
    FittedSkin::Vertex out;
    for (std::size_t i = 0; i < order.size(); ++i) out.joint[i] = order[i].second, out.weight[i] = static_cast<float>(-order[i].first);
    return out;
}

/// What goes out of all elements, one after another.
struct SeenSurface {
    Points vertices;                 // at rest, m
    std::vector<int> first;          // per element, one more
    std::vector<std::int32_t> same;  // per vertex: the lowest of those welded to it, itself included
};

/// Vertices of meshes of the scene are whole: each is of one element.
SeenSurface seenSurface(const Motion& motion, const CharacterInput& input) {
    const WeldedSurface bodies = weldedSurface(input, false);
    if (motion.meshVertices.empty()) return {bodies.vertices, bodies.first, bodies.same};
    SeenSurface out;
    std::vector<Points> rest;
    std::vector<std::int32_t> lowest(bodies.same.size(), -1);
    out.first.push_back(0);
    for (std::size_t e = 0; e < motion.seen.size(); ++e) {
        const bool ofMesh = motion.seen[e].mesh >= 0;
        rest.push_back(ofMesh ? motion.seenAtRest(e) : Points(bodies.vertices.middleRows(bodies.first[e], bodies.first[e + 1] - bodies.first[e])));
        for (int i = 0; i < static_cast<int>(rest.back().rows()); ++i) {
            const std::int32_t v = out.first[e] + i;
            if (ofMesh) {
                out.same.push_back(v);
                continue;
            }
            auto& known = lowest[static_cast<std::size_t>(bodies.same[static_cast<std::size_t>(bodies.first[e] + i)])];
            if (known < 0) known = v;
            out.same.push_back(known);
        }
        out.first.push_back(out.first[e] + static_cast<int>(rest.back().rows()));
    }
    out.vertices.resize(out.first.back(), 3);
    for (std::size_t e = 0; e < rest.size(); ++e) out.vertices.middleRows(out.first[e], rest[e].rows()) = rest[e];
    return out;
}

}  // namespace

Result<FittedSkin> fitSkin(Motion& motion, const ExportScene& scene, const Progress& progress) {
    const CharacterInput& input = scene.character;
    const std::size_t elements = input.elements.size(), joints = input.joints.size();
    Character& character = motion.character;
    const ShapeLayout& layout = motion.layout;
    const auto cancelled = [] { return fail(kCancelled, "The export was cancelled."); };
    FittedSkin skin;
    const std::vector<int> leadBone = leadingJoints(scene, 0);
    for (std::size_t e = 0; e < elements; ++e) {
        const Points& v = input.elements[e].mesh->body.vertices;
        skin.joints.push_back({scene.elements[e] + " frame", v.rows() > 0 ? Vec3(0.5 * (v.colwise().minCoeff() + v.colwise().maxCoeff()).transpose()) : Vec3(Vec3::Zero()), -1, leadBone[e]});
    }
    std::vector<int> jointOf(joints, -1);
    std::vector<char> handle(joints, 0);  // of elements under meshes
    for (const auto& h : input.handles) {
        const auto j = static_cast<std::size_t>(h.joint);
        handle[j] = motion.seen[static_cast<std::size_t>(input.joints[j].faces[0].element)].mesh >= 0;
    }
    for (std::size_t j = 0; j < joints; ++j) {
        const auto& joint = input.joints[j];
        if (joint.faces.size() < 2 && !handle[j]) continue;
        jointOf[j] = static_cast<int>(skin.joints.size());
        const auto& f = joint.faces[0];
        const auto& face = input.elements[static_cast<std::size_t>(f.element)].faces[static_cast<std::size_t>(f.face)];
        skin.joints.push_back({scene.elements[static_cast<std::size_t>(f.element)] + " " + face.name + " frame",
                               joint.point >= 0 ? input.skeleton.points[static_cast<std::size_t>(joint.point)] : face.frame.origin, -1, leadBone[static_cast<std::size_t>(f.element)]});
    }
    // The rigid motion by body loads has a joint of its own.
    std::vector<LoadMotion> loadMotions;
    std::vector<int> loadJoint(elements, -1);
    for (std::size_t e = 0; e < elements; ++e) {
        loadMotions.push_back(loadMotionOf(input.elements[e], character.loadColumns(static_cast<int>(e))));
        if (loadMotions[e].shift.cols() == 0) continue;
        loadJoint[e] = static_cast<int>(skin.joints.size());
        skin.joints.push_back({scene.elements[e] + " flesh frame", loadMotions[e].middle, -1, leadBone[e]});
    }
    const auto firstBone = static_cast<int>(skin.joints.size());
    for (const ExportedRig& rig : scene.rigs)
        for (const RigBone& bone : rig.rig->bones) skin.joints.push_back({bone.name, bone.head, static_cast<int>(skin.joints.size()) - firstBone, -1});
    const std::vector<int> lead = leadingJoints(scene, firstBone);
    const auto rotationOf = [&](const double* shape, std::size_t j) { return Eigen::Quaterniond(shape + layout.joint(static_cast<int>(j))); };
    const auto placeOf = [&](const double* shape, std::size_t j) -> Vec3 {
        const double* at = shape + layout.joint(static_cast<int>(j)) + 4;
        return Eigen::Map<const Eigen::Matrix3d>(at) * skin.joints[static_cast<std::size_t>(jointOf[j])].origin + Eigen::Map<const Vec3>(at + 9);
    };
    const auto motionsOf = [&](const double* shape, const std::vector<Eigen::Isometry3d>& bones) {
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
        for (std::size_t e = 0; e < elements; ++e) {
            if (loadJoint[e] < 0) continue;
            const Eigen::Map<const Eigen::VectorXd> weights(shape + layout.element(e) + ShapeLayout::kFrame, loadMotions[e].shift.cols());
            const Vec3 turn = loadMotions[e].rotation * weights, place = loadMotions[e].middle + loadMotions[e].shift * weights;
            const double angle = turn.norm();
            const Eigen::Quaterniond rotation(angle > 0.0 ? Eigen::AngleAxisd(angle, turn / angle) : Eigen::AngleAxisd::Identity());
            out.push_back(out[e] * isometry(rotation, loadMotions[e].middle, place));
        }
        out.insert(out.end(), bones.begin(), bones.end());
        return out;
    };

    // Candidates of an element: its frame, its load joint, its joint planes, and the frames of the elements across them. The frame of an element with one bone is that bone, but for its
    // stretch, which the bones and planes at its ends say better.
    const auto addFrame = [&](int e, std::vector<int>& list) {
        const auto add = [&list](int joint) {
            if (std::find(list.begin(), list.end(), joint) == list.end()) list.push_back(joint);
        };
        const int bone = lead[static_cast<std::size_t>(e)];
        if (bone >= 0) add(bone);
        if (bone < 0 || input.elements[static_cast<std::size_t>(e)].bones.size() > 1) add(e);
    };
    std::vector<std::vector<int>> candidates(elements);
    for (std::size_t e = 0; e < elements; ++e) {
        auto& list = candidates[e];
        addFrame(static_cast<int>(e), list);
        if (loadJoint[e] >= 0) list.push_back(loadJoint[e]);
        for (std::size_t j = 0; j < joints; ++j) {
            if (jointOf[j] < 0) continue;
            const auto& faces = input.joints[j].faces;
            if (std::none_of(faces.begin(), faces.end(), [&](const auto& f) { return f.element == static_cast<int>(e); })) continue;
            list.push_back(jointOf[j]);
            for (const auto& f : faces) addFrame(f.element, list);
        }
    }
    const SeenSurface body = seenSurface(motion, input);
    const auto vertices = static_cast<std::size_t>(body.vertices.rows());
    std::vector<int> elementOf(vertices);
    for (std::size_t e = 0; e < elements; ++e)
        std::fill(elementOf.begin() + body.first[e], elementOf.begin() + body.first[e + 1], static_cast<int>(e));
    // Welded vertices have the candidates of all their elements.
    std::vector<std::vector<int>> welded(vertices);  // per lowest vertex: elements beside its own
    for (std::size_t v = 0; v < vertices; ++v)
        if (const auto lowest = static_cast<std::size_t>(body.same[v]); lowest != v) welded[lowest].push_back(elementOf[v]);

    // Frames: of the clips, as many as are affordable; then standard poses and the rest pose.
    const auto keys = motion.sample(Motion::affordable(200 * static_cast<Eigen::Index>(vertices)));
    std::vector<const double*> shapes;
    std::vector<std::vector<Eigen::Isometry3d>> bones;  // per shape
    std::vector<double> importance;
    const auto bonesOf = [&](std::size_t clip, std::size_t key) { return scene.rigs.empty() ? std::vector<Eigen::Isometry3d>() : motion.clips[clip].bones[key]; };
    for (const auto& key : keys) {
        bones.push_back(bonesOf(key.first, key.second));
        shapes.push_back(motion.clips[key.first].shapes[key.second].data());
        importance.push_back(1.0 / static_cast<double>(keys.size()));
    }
    std::vector<std::vector<double>> posed;
    for (const StandardPose& pose : standardPoses(input.skeleton)) {
        if (progress.cancelled()) return cancelled();
        character.stop();
        character.update(pose.pose);
        character.shape(posed.emplace_back(motion.restShape.size()).data());
        bones.push_back(motion.rigBones(scene, pose.pose, posed.back().data()));
    }
    bones.push_back(motion.rigBones(scene, restPose(input.skeleton), motion.restShape.data()));
    for (const auto& shape : posed) shapes.push_back(shape.data());
    shapes.push_back(motion.restShape.data());
    importance.resize(shapes.size(), kStandard);
    // The weights of morph targets are no matter of the skin, which comes after them.
    std::vector<std::vector<double>> plain;
    for (std::size_t k = 0; layout.morphs > 0 && k < shapes.size(); ++k) plain.push_back(motion.withoutMorphs(shapes[k]));
    for (std::size_t k = 0; k < plain.size(); ++k) shapes[k] = plain[k].data();
    IMOMUSHI_TRY(const auto frames, BodyFrames::build(motion, shapes, progress));
    std::vector<Motions> motions;
    for (std::size_t k = 0; k < shapes.size(); ++k) motions.push_back(motionsOf(shapes[k], bones[k]));
    for (std::size_t e = 0; e < elements; ++e) skin.settled = skin.settled || !character.loadColumns(static_cast<int>(e)).empty();

    const int threads = hardwareThreads();
    const double floor = 1e-12 * motion.diagonal * motion.diagonal;
    const std::size_t piece = std::clamp<std::size_t>(kPiece / shapes.size(), 16, 512);
    std::vector<FittedSkin::Vertex> fitted(vertices);
    std::vector<Vec3> places(skin.settled ? vertices : 0);
    double largest = 0.0, squares = 0.0;
    for (std::size_t e = 0; e < elements; ++e) {
        // One list of candidates for the vertices of the element alone, one for each set of elements that some are welded to.
        LocalMotions local;
        std::map<std::vector<int>, std::vector<int>> followed;
        const auto first = static_cast<std::size_t>(body.first[e]), last = static_cast<std::size_t>(body.first[e + 1]);
        for (std::size_t v = first; v < last; ++v) {
            if (body.same[v] != static_cast<std::int32_t>(v)) continue;
            auto& list = followed[welded[v]];
            if (!list.empty()) continue;
            std::vector<int> all = candidates[e];
            for (const int other : welded[v])
                for (const int c : candidates[static_cast<std::size_t>(other)])
                    if (std::find(all.begin(), all.end(), c) == all.end()) all.push_back(c);
            for (const int c : all) {
                const auto known = std::find(local.joints.begin(), local.joints.end(), c);
                list.push_back(static_cast<int>(known - local.joints.begin()));
                if (known == local.joints.end()) local.joints.push_back(c);
            }
        }
        for (std::size_t k = 0; k < shapes.size(); ++k) {
            const Eigen::Isometry3d back = motions[k][e].inverse();
            for (const int c : local.joints) local.at.push_back((back * motions[k][static_cast<std::size_t>(c)]).matrix().topRows<3>());
        }
        for (std::size_t begun = first; begun < last; begun += kBetweenReports * piece) {
            if (progress.cancelled()) return cancelled();
            progress.report("fit", static_cast<double>(begun) / static_cast<double>(vertices));
            const std::size_t here = std::min(kBetweenReports * piece, last - begun);
            std::vector<std::pair<double, double>> missed((here + piece - 1) / piece);
            parallelFor(threads, here, piece, [&](std::size_t begin, std::size_t end) {
                if (progress.cancelled()) return;
                std::vector<std::int32_t> own;
                for (std::size_t v = begun + begin; v < begun + end; ++v)
                    if (body.same[v] == static_cast<std::int32_t>(v)) own.push_back(static_cast<std::int32_t>(v - first));
                Eigen::MatrixXd goals;
                frames.at(e, own, goals);
                auto& miss = missed[begin / piece];
                for (std::size_t i = 0; i < own.size(); ++i) {
                    const std::size_t v = first + static_cast<std::size_t>(own[i]);
                    const Vec3 rest = body.vertices.row(static_cast<Eigen::Index>(v)).transpose();
                    const auto& list = followed.at(welded[v]);
                    std::vector<int> near;
                    if (list.size() > kMaxCandidates) {
                        near = list;
                        const auto distance = [&](int c) { return (skin.joints[static_cast<std::size_t>(local.joints[static_cast<std::size_t>(c)])].origin - rest).squaredNorm(); };
                        std::stable_sort(near.begin() + 1, near.end(), [&](int a, int b) { return distance(a) < distance(b); });
                        near.resize(kMaxCandidates);
                    }
                    const VertexFit fit{local, near.empty() ? list : near, goals, 3 * static_cast<Eigen::Index>(i), importance, floor};
                    Vec3 place = rest;
                    SmallVector w;
                    if (skin.settled) {
                        const Vec3 known = fit.goal(shapes.size() - 1);
                        place = known;
                        for (int round = 0; round < kRounds; ++round) {
                            w = fit.weights(place);
                            place = fit.place(w, known);
                        }
                        places[v] = place;
                    } else {
                        w = fit.weights(place);
                    }
                    fitted[v] = vertexOf(w, fit.follows, local.joints);
                    for (std::size_t k = 0; k < keys.size(); ++k) {
                        Vec3 p = -fit.goal(k);
                        for (std::size_t c = 0; c < fit.follows.size(); ++c)
                            if (const double part = w[static_cast<Eigen::Index>(c)]; part > 0.0) p += part * (fit.motion(k, c).leftCols<3>() * place + fit.motion(k, c).col(3));
                        miss.first = std::max(miss.first, p.squaredNorm());
                        miss.second += p.squaredNorm();
                    }
                }
            });
            for (const auto& [most, sum] : missed) largest = std::max(largest, most), squares += sum;
        }
    }
    if (progress.cancelled()) return cancelled();
    std::size_t counted = 0;
    for (std::size_t v = 0; v < vertices; ++v) counted += body.same[v] == static_cast<std::int32_t>(v);
    skin.error = {std::sqrt(largest) / motion.diagonal, std::sqrt(squares / std::max<double>(1.0, static_cast<double>(counted * keys.size()))) / motion.diagonal};
    for (std::size_t e = 0; e < elements; ++e) {
        auto& out = skin.elements.emplace_back();
        Points& bind = skin.bind.emplace_back(body.vertices.middleRows(body.first[e], body.first[e + 1] - body.first[e]));
        for (int v = body.first[e]; v < body.first[e + 1]; ++v) {
            const auto lowest = static_cast<std::size_t>(body.same[static_cast<std::size_t>(v)]);
            out.push_back(fitted[lowest]);
            if (skin.settled) bind.row(v - body.first[e]) = places[lowest].transpose();
        }
    }

    for (std::size_t c = 0; c < motion.clips.size(); ++c) {
        const auto& clip = motion.clips[c];
        auto& tracks = skin.tracks.emplace_back(skin.joints.size());
        const auto count = static_cast<Eigen::Index>(clip.times.size());
        for (auto& track : tracks) track.rotations.resize(4, count), track.places.resize(3, count);
        for (Eigen::Index k = 0; k < count; ++k) {
            const Motions now = motionsOf(clip.shapes[static_cast<std::size_t>(k)].data(), bonesOf(c, static_cast<std::size_t>(k)));
            for (std::size_t j = 0; j < now.size(); ++j) {
                tracks[j].rotations.col(k) = Eigen::Quaterniond(now[j].linear()).coeffs();
                if (k > 0 && tracks[j].rotations.col(k).dot(tracks[j].rotations.col(k - 1)) < 0.0) tracks[j].rotations.col(k) *= -1.0;
                tracks[j].places.col(k) = now[j] * skin.joints[j].origin;
            }
        }
    }
    if (scene.rigs.empty()) return skin;
    shareAmongMerged(scene, motion, firstBone, skin);
    orderJoints(firstBone, skin);
    return skin;
}

}  // namespace imomushi
