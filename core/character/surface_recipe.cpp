// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that are made elsewhere: what they are made from, and catching up when somebody asks for them here.
#include "core/character/surface_recipe.h"

#include <atomic>

#include "core/character/character_state.h"

namespace imomushi {

namespace {

AffineFloat toFloat(const Eigen::Matrix3d& linear, const Vec3& shift) {
    AffineFloat out{};
    for (int i = 0; i < 3; ++i) {
        out.shift[i] = static_cast<float>(shift[i]);
        for (int k = 0; k < 3; ++k) out.linear[3 * i + k] = static_cast<float>(linear(i, k));
    }
    return out;
}

}  // namespace

void Character::State::buildRecipe() {
    static std::atomic<std::uint64_t> made{0};
    recipe = std::make_unique<SurfaceRecipe>();
    recipe->id = ++made;
    recipe->elements.resize(elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const auto& from = elements[e];
        auto& out = recipe->elements[e];
        out.possible = !from.warped && !explicitJoints;
        out.positions = from.positions.data();
        out.vertices = static_cast<int>(from.vertices);
        out.faces = static_cast<int>(from.jointOf.size());
        out.scale = static_cast<float>(from.scale());
        out.blocks = from.blocks.view();
        out.blockCount = from.blocks.count();
        out.free = &from.free;
        out.stencils = from.stencils.data();
        std::vector<int> faceOf(from.vertices, -1);
        for (std::size_t f = 0; f < from.jointOf.size(); ++f)
            for (const auto v : input.elements[e].faces[f].vertices) faceOf[static_cast<std::size_t>(v)] = static_cast<int>(f);
        for (const auto& h : from.held)
            out.held.push_back({h.vertex, faceOf[static_cast<std::size_t>(h.vertex)],
                                (h.rest - joints[static_cast<std::size_t>(h.joint)].restPlace).cast<float>()});
        if (equilibrium) out.shapes = from.heldShapes.cast<float>();
        for (const auto& h : from.hidden) out.hidden.push_back({h.vertex, faceOf[static_cast<std::size_t>(h.vertex)]});
        out.frame.weights.resize(static_cast<std::size_t>(from.blocks.modes()));
        out.frame.joints.resize(from.jointOf.size());
        out.frame.warping.resize(from.jointOf.size() * 3 * static_cast<std::size_t>(out.shapes.rows()));
        out.frame.faceNormals.resize(from.jointOf.size());
        fillRecipe(e);
    }
    for (const auto& s : seams) {
        const auto& rim = elements[static_cast<std::size_t>(s.other)].rim;
        recipe->seams.push_back({s.element, s.other, s.vertex, rim[static_cast<std::size_t>(s.from)].vertex, rim[static_cast<std::size_t>(s.to)].vertex, s.part});
    }
}

void Character::State::fillRecipe(std::size_t e) {
    const auto& from = elements[e];
    auto& out = recipe->elements[e];
    auto& frame = out.frame;
    if (frame.revision == from.moves) return;
    frame.revision = from.moves;
    out.elsewhere = from.madeElsewhere;
    for (std::size_t f = 0; f < from.jointOf.size(); ++f)
        frame.faceNormals[f] = (joints[static_cast<std::size_t>(from.jointOf[f])].map.linear * input.elements[e].faces[f].frame.axes.col(2)).normalized().cast<float>();
    if (!out.elsewhere) return;
    const Weights weights = from.blocks.weights();
    frame.shape = weights.affine;
    frame.placement = from.placement;
    const bool integers = out.blocks.format == ResponseFormat::Int16;
    for (std::size_t c = 0; c < frame.weights.size(); ++c)
        frame.weights[c] = integers ? static_cast<float>(weights.pairs[c]) * weights.groups[c / kColumnGroup] : weights.columns[c];
    const auto shapes = static_cast<std::size_t>(out.shapes.rows());
    for (std::size_t f = 0; f < from.jointOf.size(); ++f) {
        const auto& joint = joints[static_cast<std::size_t>(from.jointOf[f])];
        frame.joints[f] = toFloat(joint.map.linear, joint.map(joint.restPlace));
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::size_t k = 0; k < shapes; ++k)
                frame.warping[(3 * f + axis) * shapes + k] = static_cast<float>(joint.warping(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(k)));
    }
}

void Character::State::catchUp(std::size_t e) {
    if (elements[e].pending) evaluateHere(e);
    for (const auto& s : seams)
        if (s.element == static_cast<int>(e) && elements[static_cast<std::size_t>(s.other)].pending) evaluateHere(static_cast<std::size_t>(s.other));
    for (const auto& s : seams)
        if (s.element == static_cast<int>(e)) closeSeam(s);
    elements[e].seamsOpen = false;
}

void Character::State::evaluateHere(std::size_t e) {
    auto& out = elements[e];
    out.pending = false;
    out.moved = out.seamsOpen = true;
    out.work = out.localShown ? Work::Place : Work::EvaluateAndKeep;
    out.localShown = true;
    const auto mine = [e](const Piece& p) { return p.element == static_cast<int>(e); };
    share(out.blocks.count() * out.blocks.bytesPerBlock(), productPieces, [&](const Piece& p) {
        if (mine(p)) showPositions(out, p.begin, p.end);
    });
    out.work = Work::None;
    holdVertices(out);
    share(out.blocks.count() * out.blocks.bytesPerBlock(), normalPieces, [&](const Piece& p) {
        if (mine(p)) findNormals(out.positions.data(), out.stencils.data(), static_cast<float>(out.scale()), p.begin, p.end, out.normals.data());
    });
    holdNormals(out);
}

const SurfaceRecipe& Character::recipe() {
    if (!state_->recipe) state_->buildRecipe();
    return *state_->recipe;
}

bool Character::showElsewhere(int element, bool elsewhere) {
    auto& e = state_->elements[static_cast<std::size_t>(element)];
    e.elsewhere = elsewhere && !e.warped && !state_->explicitJoints;
    return e.elsewhere;
}

}  // namespace imomushi
