// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "core/base/parallel.h"
#include "core/character/character_state.h"
#include "core/character/check_input.h"
#include "core/character/free_end.h"
#include "core/character/lateral_contraction.h"
#include "core/touch/touch_contact.h"

namespace imomushi {

namespace {

// A vertex at the rim of a joined face that has no partner takes the normal of the nearest place on the other rim within this many face sizes.
constexpr double kNearRim = 0.1;

}  // namespace

Result<Character> Character::build(CharacterInput input, std::initializer_list<const Character*> previous) {
    ElementRuntimes known;
    std::vector<const FrameJobs*> former;
    std::vector<const CharacterInput*> checked;
    for (const Character* one : previous) {
        if (!one) continue;
        for (const auto& e : one->state_->frame.elements) known.add(e.runtime);
        former.push_back(&one->state_->jobs);
        checked.push_back(&one->state_->frame.input);
    }
    if (auto ok = checkInput(input, known, checked); !ok) return tl::unexpected(ok.error());
    auto state = std::make_unique<State>(std::move(input));
    state->jobs.setFormer(std::move(former));
    if (auto ok = state->build(known); !ok) return tl::unexpected(ok.error());
    state->jobs.setFormer({});
    return Character(std::move(state));
}

Character::State::State(CharacterInput given) : frame(std::move(given)), kinematics(frame.input.skeleton) {}

Result<void> Character::State::build(const ElementRuntimes& known) {
    const auto& input = frame.input;
    frame.joints.resize(input.joints.size());
    frame.elements.resize(input.elements.size());
    seamOnly.assign(input.elements.size(), 0);
    jointsOf.resize(input.elements.size());
    for (std::size_t e = 0; e < input.elements.size(); ++e) frame.elements[e].jointOf.assign(input.elements[e].faces.size(), -1);
    for (std::size_t j = 0; j < input.joints.size(); ++j)
        for (const auto& f : input.joints[j].faces) {
            frame.elements[static_cast<std::size_t>(f.element)].jointOf[static_cast<std::size_t>(f.face)] = static_cast<int>(j);
            auto& joints = jointsOf[static_cast<std::size_t>(f.element)];
            if (joints.empty() || joints.back() != static_cast<int>(j)) joints.push_back(static_cast<int>(j));
        }
    for (std::size_t e = 0; e < frame.elements.size(); ++e) {
        auto runtime = runtimeOf(e, known);
        if (!runtime) return tl::unexpected(runtime.error());
        frame.elements[e].runtime = std::move(*runtime);
    }
    for (const auto& mesh : input.renderMeshes)
        for (const auto& v : mesh->vertices) frame.elements[static_cast<std::size_t>(v.element)].unseen = true;
    const auto contractions = leastEnergyContractions(input);
    for (std::size_t j = 0; j < input.joints.size(); ++j) buildJoint(j, contractions[j]);
    for (std::size_t e = 0; e < frame.elements.size(); ++e) buildElement(e);
    splitWork();
    buildHandles();
    for (std::size_t j = 0; j < input.joints.size(); ++j) holdFaces(j);
    for (const auto& effect : input.effects)
        if (auto ok = effect->addJob(frame, jobs); !ok) return ok;
    if (auto ok = jobs.validate(); !ok) return ok;
    for (const auto& e : frame.elements) weighs = weighs || e.fades;
    if (!input.renderMeshes.empty()) renderMeshes = &jobs.add<RenderMeshJob>(frame, jobs.former<RenderMeshJob>());
    for (int m = 0; m < static_cast<int>(input.renderMeshes.size()); ++m) frame.morphs.push_back(renderMeshes->restWeights(m));
    frame.askedMorphs = frame.morphs;
    std::vector<std::vector<std::int32_t>> rimOf;
    for (const auto& e : frame.elements) rimOf.emplace_back(e.runtime->vertices, -1);
    for (const auto& joint : input.joints) buildSeam(joint, rimOf);
    const int threads = input.threads > 0 ? input.threads : hardwareThreads();
    std::size_t bytes = jobs.bytes();
    for (const auto& e : frame.elements) bytes += e.blocks.count() * e.blocks.bytesPerBlock() + e.touchBlocks.bytes() + e.dents.bytes();
    if (threads > 1 && bytes >= Frame::kBytesWorthThreads) frame.pool = ThreadPool::shared(threads);
    update(frame.pose, 0.0, false);
    return {};
}

Result<std::shared_ptr<const ElementRuntime>> Character::State::runtimeOf(std::size_t e, const ElementRuntimes& known) {
    const auto& given = frame.input.elements[e];
    ElementRuntime::Input input{given.mesh, given.faces, given.response, {}, frame.input.format, {}, given.nu, given.embedded};
    for (const int j : frame.elements[e].jointOf) input.covered.push_back(frame.input.joints[static_cast<std::size_t>(j)].faces.size() >= 2);
    for (const auto& effect : frame.input.effects)
        if (effect->on(e)) effect->ask(input.tables);
    if (std::exchange(input.tables.freeEnd, false)) {
        frame.elements[e].freeEnd = freeEndOf(frame.input, e);
        if (frame.elements[e].freeEnd) askForLoads(input.tables, {0, 1, 2});
    }
    if (!given.response || given.response->loads.size() == 0) input.tables.loads.clear();
    if (auto found = known.find(input)) return found;
    return ElementRuntime::build(std::move(input), known);
}

void Character::State::buildJoint(std::size_t j, double contraction) {
    const auto& joint = frame.input.joints[j];
    auto& out = frame.joints[j];
    const auto& first = frame.input.elements[joint.faces[0].element].faces[joint.faces[0].face].frame;
    out.restPlace = joint.point >= 0 ? frame.input.skeleton.points[joint.point] : first.origin;
    out.restNormal = first.axes.col(2);
    out.contraction = contraction;
    for (const auto& f : joint.faces) {
        out.led = out.led || frame.input.elements[f.element].leadsJointPlanes;
        if (f.bone >= 0) out.restTangent += frame.tree.rollSign[f.bone] * frame.tree.restDirection[f.bone];
    }
    const double n = out.restTangent.norm();
    out.restTangent = n > 1e-6 ? Vec3(out.restTangent / n) : Vec3(Vec3::Zero());
}

void Character::State::buildElement(std::size_t e) {
    const auto& given = frame.input.elements[e];
    auto& out = frame.elements[e];
    const auto& runtime = *out.runtime;
    for (const int b : given.bones) {
        const auto& bone = frame.input.skeleton.bones[b];
        out.boneLength += bone.length;
        out.restAnchor += 0.5 * bone.length * (frame.input.skeleton.points[bone.start] + frame.input.skeleton.points[bone.end]);
    }
    if (out.boneLength > 0.0) out.restAnchor /= out.boneLength;
    for (const int j : jointsOf[e])
        if (hangsOnItsJoint(given, frame.input.joints[static_cast<std::size_t>(j)])) {
            out.anchorJoint = j;
            out.restAnchor = frame.joints[static_cast<std::size_t>(j)].restPlace;
        }
    const Eigen::Index columns = runtime.columns();
    out.v = Eigen::VectorXd::Zero(columns);
    if (!runtime.input.tables.loads.empty()) {
        out.withLoads = Eigen::VectorXd::Zero(runtime.columnSize.size());
        out.jointForces = Eigen::VectorXd::Zero(columns);
    }
    out.shownWeights = out.weights();
    out.shownJoints.resize(given.faces.size());
    if (given.embedded) out.parts.resize(given.embedded->attached.size());
    if (given.embedded) out.askedTurns = out.turns = out.shownTurns = std::vector<Vec3>(given.embedded->attached.size(), Vec3::Zero());
    out.blocks = runtime.blocks;
    out.local = AlignedBuffer<float>(out.blocks.rest().size());
    const std::size_t padded = (runtime.vertices + kVertexBlock - 1) / kVertexBlock * kVertexBlock + kVertexBlock;
    if (runtime.touch) {
        out.patchForces = out.shownPatchForces = Eigen::VectorXd::Zero(runtime.touch->touch().columns());
        out.dents = AlignedBuffer<float>(3 * kVertexBlock * runtime.bodyBlocks);
        out.touchBlocks = runtime.touchBlocks;
        if (runtime.dents) out.fingerDents = out.shownFingerDents = std::vector<Dent>(TouchContact::kDents);
    }
    out.positions = AlignedBuffer<float>(3 * runtime.paddedVertices());
    out.normals = AlignedBuffer<float>(3 * padded);
}

void Character::State::splitWork() {
    const std::vector<std::vector<char>> seenOf = seenVertices();
    for (std::size_t e = 0; e < frame.elements.size(); ++e) splitWork(e, seenOf[e]);
}

void Character::State::splitWork(std::size_t e, const std::vector<char>& seenVertices) {
    auto& out = frame.elements[e];
    const auto& runtime = *out.runtime;
    // Pieces end where `seen` changes.
    const auto split = [e](std::vector<Piece>& pieces, std::size_t count, std::size_t bytesEach, std::size_t grain, const std::vector<char>& seen) {
        std::size_t each = std::max<std::size_t>(Frame::kBytesPerPiece / std::max<std::size_t>(bytesEach, 1), 1);
        each = (each + grain - 1) / grain * grain;
        for (std::size_t i = 0, end = 0; i < count; i = end) {
            end = std::min(i + each, count);
            for (std::size_t k = i + 1; !seen.empty() && k < end; ++k)
                if (seen[k] != seen[i]) end = k;
            pieces.push_back({static_cast<int>(e), i, end, !seen.empty() && !seen[i]});
        }
    };
    /// Calls take(vertex, block) for each free one; both ascend.
    const auto forFree = [&](const auto& take) {
        std::size_t block = 0;
        for (const auto v : runtime.free) {
            while (block + 1 < runtime.blocks.count() && runtime.blocks.first()[block + 1] <= v) ++block;
            take(static_cast<std::size_t>(v), block);
        }
    };
    std::vector<char> seen;
    if (out.unseen) {
        seen.assign(runtime.blocks.count(), 1);
        std::fill_n(seen.begin(), runtime.bodyBlocks, 0);
        forFree([&](std::size_t v, std::size_t block) {
            if (seenVertices[v]) seen[block] = 1;
        });
    }
    split(productPieces, runtime.blocks.count(), runtime.blocks.bytesPerBlock(), 1, seen);
    split(normalPieces, runtime.vertices, sizeof(NormalStencil) + 6 * sizeof(float), kVertexBlock, {});
    out.evaluatedVertices = static_cast<int>(runtime.free.size());
    if (!out.unseen) return;
    if (runtime.embedded) out.evaluatedVertices += static_cast<int>(runtime.embedded->rows.size());
    forFree([&](std::size_t, std::size_t block) { out.evaluatedVertices -= !seen[block]; });
}

std::vector<std::vector<char>> Character::State::seenVertices() const {
    std::vector<std::vector<char>> seen(frame.elements.size());
    for (std::size_t e = 0; e < seen.size(); ++e)
        if (frame.elements[e].unseen) seen[e].assign(frame.elements[e].runtime->vertices, 0);
    for (const auto& mesh : frame.input.renderMeshes)
        for (const auto& v : mesh->vertices) {
            auto& of = seen[static_cast<std::size_t>(v.element)];
            const auto vertex = static_cast<std::size_t>(elementVertex(v, *frame.elements[static_cast<std::size_t>(v.element)].runtime));
            if (vertex < of.size()) of[vertex] = 1;
        }
    return seen;
}

// Vertices of the second face that are welded to the first one are placed from there: seams are closed by construction.
void Character::State::holdFaces(std::size_t j) {
    const auto& joint = frame.input.joints[j];
    for (std::size_t side = 0; side < joint.faces.size(); ++side) {
        const auto& f = joint.faces[side];
        const auto& given = frame.input.elements[static_cast<std::size_t>(f.element)];
        auto& out = frame.elements[static_cast<std::size_t>(f.element)];
        const std::size_t first = out.held.size();
        for (const auto v : given.faces[static_cast<std::size_t>(f.face)].vertices)
            out.held.push_back({v, static_cast<int>(j), given.mesh->body.vertices.row(v).transpose()});
        if (side != 1) continue;
        const auto& partner = frame.input.elements[static_cast<std::size_t>(joint.faces[0].element)].mesh->body.vertices;
        for (const auto& [a, b] : joint.welded) {
            const auto found = std::lower_bound(out.held.begin() + static_cast<std::ptrdiff_t>(first), out.held.end(), b,
                                                [](const HeldVertex& h, std::int32_t v) { return h.vertex < v; });
            if (found != out.held.end() && found->vertex == b) found->rest = partner.row(a).transpose();
        }
    }
}

void Character::State::buildSeam(const CharacterInput::Joint& joint, std::vector<std::vector<std::int32_t>>& rimOf) {
    if (joint.faces.size() < 2) return;
    const auto& input = frame.input;
    const auto rim = [&](std::size_t i) {
        std::vector<std::int32_t> out;
        const auto& f = joint.faces[i];
        const auto& runtime = *frame.elements[f.element].runtime;
        std::vector<char> hidden(runtime.vertices, 0);
        for (const auto& h : runtime.hidden) hidden[h.vertex] = 1;
        for (const auto v : input.elements[f.element].faces[f.face].vertices)
            if (!hidden[v]) out.push_back(v);
        return out;
    };
    const auto rimIndex = [&](int element, std::int32_t v) {
        auto& all = frame.elements[element].rim;
        auto& index = rimOf[element][v];
        if (index < 0) {
            index = static_cast<std::int32_t>(all.size());
            all.push_back({v});
        }
        return index;
    };
    const auto point = [&](std::size_t i, std::int32_t v) -> Vec3 {
        return input.elements[joint.faces[i].element].mesh->body.vertices.row(v).transpose();
    };
    const auto rims = {rim(0), rim(1)};
    for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t across = 1 - side;
        const auto& other = joint.faces[across];
        const auto& otherTriangles = input.elements[other.element].mesh->body.triangles;
        const auto& otherFace = input.elements[other.element].faces[other.face];
        const auto& otherRim = *(rims.begin() + across);
        std::vector<std::int32_t> partner(frame.elements[joint.faces[side].element].runtime->vertices, -1);
        for (const auto& [a, b] : joint.welded) partner[side == 0 ? a : b] = side == 0 ? b : a;
        std::vector<std::pair<std::int32_t, std::int32_t>> edges;  // of the other rim
        for (const auto t : otherFace.triangles)
            for (int c = 0; c < 3; ++c) {
                const std::int32_t from = otherTriangles(t, c), to = otherTriangles(t, (c + 1) % 3);
                if (std::binary_search(otherRim.begin(), otherRim.end(), from) && std::binary_search(otherRim.begin(), otherRim.end(), to)) edges.emplace_back(from, to);
            }
        for (const auto v : *(rims.begin() + side)) {
            SeamNormal seam{joint.faces[side].element, other.element, v, partner[v], partner[v], -1, 0.0f};
            if (seam.from < 0) {
                double best = kNearRim * otherFace.size;
                const Vec3 p = point(side, v);
                for (const auto& [from, to] : edges) {
                    const Vec3 a = point(across, from), along = point(across, to) - a;
                    const double part = std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
                    const double distance = (a + part * along - p).norm();
                    if (distance >= best) continue;
                    best = distance;
                    seam.from = from, seam.to = to, seam.part = static_cast<float>(part);
                }
            }
            if (seam.from < 0) continue;
            seam.own = rimIndex(seam.element, v);
            seam.from = rimIndex(seam.other, seam.from);
            seam.to = rimIndex(seam.other, seam.to);
            seams.push_back(seam);
        }
    }
}

}  // namespace imomushi
