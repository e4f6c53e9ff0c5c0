// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/character_state.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "core/character/shrink.h"

namespace imomushi {

using Eigen::Matrix3d;
using Eigen::Quaterniond;

namespace {

// A vertex at the rim of a joined face that has no partner takes the normal of the nearest place on the other rim within this many face sizes.
constexpr double kNearRim = 0.1;

}  // namespace

Character::State::State(CharacterInput given)
    : input(std::move(given)), tree(boneTree(input.skeleton)), kinematics(input.skeleton), pose(restPose(input.skeleton)) {
    const auto shrinks = leastEnergyShrink(input);
    for (std::size_t j = 0; j < input.joints.size(); ++j) joints.push_back(buildJoint(input.joints[j], shrinks[j]));
    elements.resize(input.elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) buildElement(static_cast<int>(e));
    // The previous model shapes joints itself.
    if (input.smoothJoints && !effects.previousModel) buildEquilibrium();
    for (std::size_t e = 0; e < elements.size() && !failure; ++e) buildWarpAndTouch(e);
    for (std::size_t j = 0; effects.jointDynamics && j < joints.size() && !failure; ++j) {
        auto jiggle = JointJiggle::build(input, input.joints[j], *effects.jointDynamics);
        if (jiggle)
            joints[j].jiggle = std::move(*jiggle);
        else
            failure = jiggle.error();
    }
    if (effects.previousModel && input.basis == BasisKind::Full && !failure) buildExplicitJoints();
    if (failure) return;
    for (std::size_t j = 0; j < input.joints.size(); ++j) buildSeam(input.joints[j]);
    const int threads = input.threads > 0 ? input.threads : hardwareThreads();
    std::size_t bytes = 0;
    for (const auto& e : elements) {
        bytes += e.blocks.count() * e.blocks.bytesPerBlock();
        if (e.warped) bytes += e.warped->warp.cost().bytes;
    }
    bent.reserve(elements.size());
    if (threads > 1 && bytes >= kBytesWorthThreads) pool = ThreadPool::shared(threads);
    update(pose, 0.0);
}

void Character::State::buildExplicitJoints() {
    for (const auto& e : input.elements)
        if (!e.faces.empty() && (!e.response || e.response->tractions.size() == 0)) return;
    auto made = ExplicitJoints::build(input, *effects.previousModel);
    if (!made) {
        failure = made.error();
        return;
    }
    explicitJoints.emplace(std::move(*made));
    for (std::size_t e = 0; e < elements.size(); ++e)
        for (std::size_t f = 0; f < input.elements[e].faces.size(); ++f)
            for (std::size_t i = 0; i < input.elements[e].faces[f].vertices.size(); ++i)
                for (auto& h : elements[e].held)
                    if (h.vertex == input.elements[e].faces[f].vertices[i]) {
                        h.node = explicitJoints->nodeOf(static_cast<int>(e), static_cast<int>(f), i);
                        shownOffsets.resize(std::max(shownOffsets.size(), static_cast<std::size_t>(h.node) + 1), Vec3::Zero());
                    }
}

void Character::State::buildWarpAndTouch(std::size_t e) {
    const auto& given = input.elements[e];
    auto& out = elements[e];
    if (!given.response || given.faces.empty()) return;
    if (given.warped) {
        out.sameTree.resize(given.faces.size());
        for (std::size_t f = 0; f < given.faces.size(); ++f) {
            auto& joint = joints[static_cast<std::size_t>(out.jointOf[f])];
            joint.warped = true;
            joint.nu = given.nu;
            const int bone = input.joints[static_cast<std::size_t>(out.jointOf[f])].faces[0].bone;
            out.sameTree[f] = !given.bones.empty() && bone >= 0 && tree.tree[bone] == tree.tree[given.bones[0]];
        }
        auto warp = BendWarp::build(given.mesh->body, given.faces, *given.response, given.nu, {out.blocks.first(), out.blocks.count()}, out.middle, {});
        if (!warp) {
            failure = warp.error();
            return;
        }
        const auto& held = warp->heldVertices();
        Warped made{std::move(*warp), std::vector<FaceMotion>(given.faces.size()), Eigen::VectorXd::Zero(given.response->columns()),
                    Points(static_cast<Eigen::Index>(held.size()), 3), {}, AlignedBuffer<float>(out.loads ? out.local.size() : 0)};
        for (const auto v : made.warp.heldVertices())
            made.heldOf.push_back(static_cast<std::size_t>(
                std::find_if(out.held.begin(), out.held.end(), [v](const HeldVertex& h) { return h.vertex == v; }) - out.held.begin()));
        out.warped = std::move(made);
    }
    if (given.touched && effects.touch && given.response->touch.columns() > 0) {
        auto contact = TouchContact::build(given.mesh->body, given.faces, given.response, *effects.touch);
        if (!contact) {
            failure = contact.error();
            return;
        }
        out.touched = Touched{std::move(*contact), TouchBlocks(*given.response, {out.blocks.first(), out.blocks.count()}), {}, AlignedBuffer<float>(out.local.size())};
        out.touched->shownForces = Eigen::VectorXd::Zero(out.touched->contact.patchForces().size());
    }
}

void Character::State::buildEquilibrium() {
    equilibrium = std::make_unique<JointEquilibrium>(input);
    const int shapes = equilibrium->warpingShapes();
    for (auto& j : joints) j.warping = Eigen::Matrix3Xd::Zero(3, shapes);
    for (auto& e : elements) {
        e.shownWarping.assign(e.jointOf.size(), Eigen::Matrix3Xd::Zero(3, shapes));
        e.heldShapes.resize(shapes, static_cast<Eigen::Index>(e.held.size()));
        for (std::size_t i = 0; i < e.held.size(); ++i)
            equilibrium->shapes(e.held[i].joint, e.held[i].rest, e.heldShapes.col(static_cast<Eigen::Index>(i)).data());
    }
}

Character::State::JointState Character::State::buildJoint(const CharacterInput::Joint& joint, double shrink) const {
    JointState out;
    const auto& first = input.elements[joint.faces[0].element].faces[joint.faces[0].face].frame;
    out.restPlace = joint.point >= 0 ? input.skeleton.points[joint.point] : first.origin;
    out.restNormal = first.axes.col(2);
    out.shrink = shrink;
    for (const auto& f : joint.faces) {
        out.led = out.led || input.elements[f.element].leadsJointPlanes;
        if (f.bone >= 0) out.restTangent += tree.rollSign[f.bone] * tree.restDirection[f.bone];
    }
    const double n = out.restTangent.norm();
    out.restTangent = n > 1e-6 ? Vec3(out.restTangent / n) : Vec3(Vec3::Zero());
    return out;
}

void Character::State::buildElement(int e) {
    const auto& given = input.elements[e];
    const auto& body = given.mesh->body;
    auto& out = elements[e];
    out.vertices = static_cast<std::size_t>(body.vertices.rows());
    if (out.vertices > 0) {
        const Vec3 low = body.vertices.colwise().minCoeff().transpose(), high = body.vertices.colwise().maxCoeff().transpose();
        out.middle = 0.5 * (low + high);
        out.size = (high - low).norm();
    }
    for (const int b : given.bones) {
        const auto& bone = input.skeleton.bones[b];
        out.boneLength += bone.length;
        out.restAnchor += 0.5 * bone.length * (input.skeleton.points[bone.start] + input.skeleton.points[bone.end]);
    }
    if (out.boneLength > 0.0) out.restAnchor /= out.boneLength;

    std::vector<char> onFace(out.vertices, 0), covered(body.triangles.rows(), 0);
    out.jointOf.assign(given.faces.size(), -1);
    out.shownJoints.resize(given.faces.size());
    for (std::size_t j = 0; j < input.joints.size(); ++j) {
        const auto& joint = input.joints[j];
        for (const auto& f : joint.faces) {
            if (f.element != e) continue;
            out.jointOf[f.face] = static_cast<int>(j);
            if (hangsOnItsJoint(given, joint)) {
                out.anchorJoint = static_cast<int>(j);
                out.restAnchor = joints[j].restPlace;
            }
            for (const auto v : given.faces[f.face].vertices) {
                onFace[v] = 1;
                Vec3 rest = body.vertices.row(v).transpose();
                if (&f == joint.faces.data() + 1)
                    for (const auto& [a, b] : joint.welded)
                        if (b == v) rest = input.elements[joint.faces[0].element].mesh->body.vertices.row(a).transpose();
                out.held.push_back({v, static_cast<int>(j), rest});
            }
            if (joint.faces.size() >= 2)
                for (const auto t : given.faces[f.face].triangles) covered[t] = 1;
        }
    }

    const int columns = given.response ? given.response->columns() : 0;
    out.v = Eigen::VectorXd::Zero(columns);
    out.columnSize = Eigen::VectorXd::Constant(columns, out.size);
    for (std::size_t f = 0; columns > 0 && f < given.faces.size(); ++f) {
        const int first = given.response->firstColumn[f];
        const FaceBasis& basis = given.response->bases[f];
        out.restOfFace.push_back(localVertices(body, given.faces[f]));
        // Shifts are in metres already.
        if (basis.kind == BasisKind::Full) {
            out.columnSize.segment(first, basis.columns()).setOnes();
            continue;
        }
        out.columnSize[first + 5] = 1.0;
        if (basis.kind != BasisKind::Paper) out.columnSize[first + 6] = out.columnSize[first + 7] = 1.0;
    }

    std::vector<char> visible(out.vertices, 0);
    for (Eigen::Index t = 0; t < body.triangles.rows(); ++t) {
        if (covered[t]) continue;
        for (int c = 0; c < 3; ++c) {
            out.triangles.push_back(body.triangles(t, c));
            visible[body.triangles(t, c)] = 1;
        }
    }
    for (std::size_t f = 0; f < given.faces.size(); ++f)
        for (const auto v : given.faces[f].vertices)
            if (!visible[v]) out.hidden.push_back({v, out.jointOf[f], given.faces[f].frame.axes.col(2)});

    if (given.response)
        out.free = given.response->freeVertices;
    else
        for (std::size_t v = 0; v < out.vertices; ++v)
            if (!onFace[v]) out.free.push_back(static_cast<std::int32_t>(v));
    Eigen::MatrixXd response = given.response ? given.response->response : Eigen::MatrixXd(3 * out.free.size(), 0);
    addLoads(given, out, response);
    out.shownV = out.weights();
    out.blocks = ResponseBlocks(body.vertices, out.free, out.middle, response, input.format);
    out.local = AlignedBuffer<float>(out.blocks.rest().size());
    const std::size_t padded = (out.vertices + kVertexBlock - 1) / kVertexBlock * kVertexBlock + kVertexBlock;
    out.positions = AlignedBuffer<float>(3 * padded);
    out.normals = AlignedBuffer<float>(3 * padded);
    out.stencils = normalStencils(body.vertices, out.triangles, out.scale());

    const auto split = [e](std::vector<Piece>& pieces, std::size_t count, std::size_t bytesEach, std::size_t grain) {
        std::size_t each = std::max<std::size_t>(kBytesPerPiece / std::max<std::size_t>(bytesEach, 1), 1);
        each = (each + grain - 1) / grain * grain;
        for (std::size_t i = 0; i < count; i += each) pieces.push_back({e, i, std::min(i + each, count)});
    };
    split(productPieces, out.blocks.count(), out.blocks.bytesPerBlock(), 1);
    split(normalPieces, out.vertices, sizeof(NormalStencil) + 6 * sizeof(float), kVertexBlock);
}

void Character::State::addLoads(const CharacterInput::Element& given, ElementState& out, Eigen::MatrixXd& response) const {
    if (!given.response || given.response->loads.size() == 0) return;
    BodyLoads loads;
    loads.gravity = effects.gravity && given.heavy;
    loads.inflated = effects.inflate && given.inflated;
    if (!loads.gravity && !loads.inflated) return;
    std::vector<Eigen::Index> columns;
    if (loads.gravity) columns = {0, 1, 2};
    if (loads.inflated) columns.push_back(3);
    const Eigen::Index first = response.cols(), count = static_cast<Eigen::Index>(columns.size());
    response.conservativeResize(Eigen::NoChange, first + count);
    out.columnSize.conservativeResize(first + count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto column = given.response->loads.col(columns[static_cast<std::size_t>(i)]);
        response.col(first + i) = column;
        double largest = 0.0;
        for (Eigen::Index p = 0; p < column.size(); p += 3) largest = std::max(largest, column.segment<3>(p).norm());
        out.columnSize[first + i] = largest;
    }
    loads.all = Eigen::VectorXd::Zero(first + count);
    loads.forces = Eigen::VectorXd::Zero(first);
    loads.felt.reset(out.middle);
    out.loads = std::move(loads);
}

void Character::State::buildSeam(const CharacterInput::Joint& joint) {
    if (joint.faces.size() < 2) return;
    const auto rim = [&](std::size_t i) {
        std::vector<std::int32_t> out;
        const auto& f = joint.faces[i];
        std::vector<char> hidden(elements[f.element].vertices, 0);
        for (const auto& h : elements[f.element].hidden) hidden[h.vertex] = 1;
        for (const auto v : input.elements[f.element].faces[f.face].vertices)
            if (!hidden[v]) out.push_back(v);
        return out;
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
        for (const auto v : *(rims.begin() + side)) {
            SeamNormal seam{joint.faces[side].element, other.element, v, -1, -1, -1, 0.0f};
            for (const auto& [a, b] : joint.welded)
                if ((side == 0 ? a : b) == v) seam.from = seam.to = side == 0 ? b : a;
            double best = seam.from >= 0 ? -1.0 : kNearRim * otherFace.size;
            const Vec3 p = point(side, v);
            for (const auto t : otherFace.triangles)
                for (int c = 0; c < 3 && best >= 0.0; ++c) {
                    const std::int32_t from = otherTriangles(t, c), to = otherTriangles(t, (c + 1) % 3);
                    if (!std::binary_search(otherRim.begin(), otherRim.end(), from) || !std::binary_search(otherRim.begin(), otherRim.end(), to))
                        continue;
                    const Vec3 a = point(across, from), along = point(across, to) - a;
                    const double part = std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
                    const double distance = (a + part * along - p).norm();
                    if (distance >= best) continue;
                    best = distance;
                    seam.from = from, seam.to = to, seam.part = static_cast<float>(part);
                }
            if (seam.from < 0) continue;
            seam.own = rimIndex(seam.element, v);
            seam.from = rimIndex(seam.other, seam.from);
            seam.to = rimIndex(seam.other, seam.to);
            seams.push_back(seam);
        }
    }
}

std::int32_t Character::State::rimIndex(int element, std::int32_t v) {
    auto& all = elements[element].rim;
    const auto found = std::find_if(all.begin(), all.end(), [v](const RimNormal& r) { return r.vertex == v; });
    if (found != all.end()) return static_cast<std::int32_t>(found - all.begin());
    all.push_back({v});
    return static_cast<std::int32_t>(all.size() - 1);
}

}  // namespace imomushi
