// SPDX-License-Identifier: GPL-3.0-or-later
// What others deform surfaces with, and catching up when somebody asks for them here.
#include "core/character/deform_input.h"

#include <atomic>

#include "core/character/character_state.h"

namespace imomushi {

namespace {

/// Embedded points: those that are a product, what joints add to them, and attached parts.
void addEmbedded(const ElementState& from, DeformInput::Element& out) {
    const EmbeddedTables& tables = *from.runtime->embedded;
    const EmbeddedPoints& points = *from.runtime->input.embedded;
    const std::size_t count = tables.rows.size() - EmbeddedTables::kFrameVertices * tables.parts;  // the frames of parts are evaluated here
    out.free.insert(out.free.end(), tables.rows.begin(), tables.rows.begin() + static_cast<std::ptrdiff_t>(count));
    for (const auto& part : tables.mapping.jointParts())
        if (const auto point = static_cast<std::size_t>(part.point); point < count) out.jointParts.push_back({tables.rows[point], part.face, part.offset.cast<float>()});
    for (std::size_t a = 0; a < points.attached.size(); ++a)
        for (const auto i : points.attached[a].points)
            out.held.push_back({static_cast<std::int32_t>(tables.first) + i, out.faces + static_cast<int>(a), (points.rest.row(i).transpose() - points.attached[a].pivot).cast<float>()});
    const Eigen::Index known = out.shapes.cols();
    out.shapes.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(out.held.size()));
    out.shapes.rightCols(out.shapes.cols() - known).setZero();
}

}  // namespace

void Character::State::buildDeformInput() {
    static std::atomic<std::uint64_t> made{0};
    deformInput = std::make_unique<DeformInput>();
    deformInput->id = ++made;
    deformInput->elements.resize(frame.elements.size());
    for (std::size_t e = 0; e < frame.elements.size(); ++e) {
        const auto& from = frame.elements[e];
        const auto& runtime = *from.runtime;
        auto& out = deformInput->elements[e];
        out.possible = canDeformExternally(from);
        out.positions = from.positions.data();
        out.vertices = static_cast<int>(runtime.embedded ? runtime.embedded->first + runtime.embedded->count : runtime.vertices);
        out.bodyVertices = static_cast<int>(runtime.vertices);
        out.faces = static_cast<int>(from.jointOf.size());
        out.places = out.faces + static_cast<int>(from.parts.size());
        out.scale = static_cast<float>(runtime.inverseSize());
        out.blocks = from.blocks.view();
        out.free = runtime.free;
        out.stencils = runtime.stencils.data();
        std::vector<int> faceOf(runtime.vertices, -1);
        for (std::size_t f = 0; f < from.jointOf.size(); ++f)
            for (const auto v : frame.input.elements[e].faces[f].vertices) faceOf[static_cast<std::size_t>(v)] = static_cast<int>(f);
        for (const auto& h : from.held)
            out.held.push_back({h.vertex, faceOf[static_cast<std::size_t>(h.vertex)],
                                (h.rest - frame.joints[static_cast<std::size_t>(h.joint)].restPlace).cast<float>()});
        if (frame.smooth) out.shapes = from.heldShapes.cast<float>();
        if (out.possible && runtime.embedded) addEmbedded(from, out);
        for (const auto& h : runtime.hidden) out.hidden.push_back({h.vertex, h.face});
        out.frame.weights.resize(static_cast<std::size_t>(from.blocks.modes()));
        out.frame.joints.resize(static_cast<std::size_t>(out.places));
        out.frame.warping.resize(static_cast<std::size_t>(3 * out.places) * static_cast<std::size_t>(out.shapes.rows()));
        out.frame.faceNormals.resize(from.jointOf.size());
        fillDeformInput(e);
    }
    for (std::size_t m = 0; m < frame.input.renderMeshes.size(); ++m) {
        const RenderMeshTables& tables = renderMeshes->tables(static_cast<int>(m));
        auto& out = deformInput->meshes.emplace_back();
        out.elements = tables.elements;
        out.stencils = tables.stencils.data();
        out.scale = static_cast<float>(tables.scale);
        for (const auto& run : tables.runs)
            for (std::int32_t i = 0; i < run.count; ++i) out.vertices.push_back({run.element, run.from + i});
    }
    for (const auto& s : seams) {
        const auto& rim = frame.elements[static_cast<std::size_t>(s.other)].rim;
        deformInput->seams.push_back({s.element, s.other, s.vertex, rim[static_cast<std::size_t>(s.from)].vertex, rim[static_cast<std::size_t>(s.to)].vertex, s.part});
    }
}

void Character::State::fillDeformInput(std::size_t e) {
    const auto& from = frame.elements[e];
    auto& out = deformInput->elements[e];
    auto& to = out.frame;
    if (to.revision == from.moves) return;
    to.revision = from.moves;
    out.external = from.external;
    for (std::size_t f = 0; f < from.jointOf.size(); ++f)
        to.faceNormals[f] = (frame.joints[static_cast<std::size_t>(from.jointOf[f])].map.linear * frame.input.elements[e].faces[f].frame.axes.col(2)).normalized().cast<float>();
    if (!out.external) return;
    const Weights weights = from.blocks.weights();
    to.shape = weights.affine;
    to.placement = from.placement;
    const bool integers = out.blocks.format == ResponseFormat::Int16;
    for (std::size_t c = 0; c < to.weights.size(); ++c)
        to.weights[c] = integers ? static_cast<float>(weights.pairs[c]) * weights.groups[c / kColumnGroup] : weights.columns[c];
    const auto shapes = static_cast<std::size_t>(out.shapes.rows());
    for (std::size_t f = 0; f < from.jointOf.size(); ++f) {
        const auto& joint = frame.joints[static_cast<std::size_t>(from.jointOf[f])];
        to.joints[f] = AffineMap{joint.map.linear, joint.map(joint.restPlace)}.toFloat();
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::size_t k = 0; k < shapes; ++k)
                to.warping[(3 * f + axis) * shapes + k] = static_cast<float>(joint.warping(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(k)));
    }
    std::copy(from.parts.begin(), from.parts.end(), to.joints.begin() + static_cast<std::ptrdiff_t>(from.jointOf.size()));
}

void Character::State::catchUp(std::size_t e) {
    if (frame.elements[e].pending) evaluateHere(e);
    for (const auto& s : seams)
        if (s.element == static_cast<int>(e) && frame.elements[static_cast<std::size_t>(s.other)].pending) evaluateHere(static_cast<std::size_t>(s.other));
    for (const auto& s : seams)
        if (s.element == static_cast<int>(e)) closeSeam(s);
    frame.elements[e].seamsOpen = false;
}

bool Character::State::canDeformExternally(const ElementState& e) const {
    // Where joints place vertices otherwise than v says, embedded points follow them here.
    const bool followsV = e.runtime->input.response && frame.input.basis != BasisKind::Paper;
    return (!e.runtime->warp || e.fades) && (!e.runtime->embedded || followsV) && frame.offsets.empty();
}

void Character::State::evaluateSeen(std::size_t e) {
    auto& out = frame.elements[e];
    out.seenPending = false;
    out.moved = true;
    out.work = VertexWork::Evaluate;
    frame.share(out.blocks.count() * out.blocks.bytesPerBlock(), productPieces, [&](const Piece& p) {
        if (p.element == static_cast<int>(e) && !p.unseen) showPositions(out, p.begin, p.end);
    });
    out.work = VertexWork::None;
    holdVertices(out);
    renderMeshes->finish(frame, e);
}

void Character::State::catchUpMesh(int mesh) {
    if (!renderMeshes->pending(mesh)) return;
    for (const auto e : renderMeshes->tables(mesh).elements)
        if (frame.elements[static_cast<std::size_t>(e)].seenPending) evaluateSeen(static_cast<std::size_t>(e));
    renderMeshes->catchUp(frame, mesh);
}

void Character::State::evaluateHere(std::size_t e) {
    auto& out = frame.elements[e];
    if (out.unseen && out.seenPending) evaluateSeen(e);
    out.pending = out.seenPending = false;
    out.moved = out.seamsOpen = true;
    if (out.unseen) {
        // Render meshes have what they need.
        out.work = !out.partial ? VertexWork::None : out.localShown ? VertexWork::EvaluateAndKeep : VertexWork::Evaluate;
        out.partial = out.localPart = false;
    } else {
        out.work = out.localShown ? VertexWork::Place : VertexWork::EvaluateAndKeep;
        out.localShown = true;
    }
    const auto mine = [e](const Piece& p) { return p.element == static_cast<int>(e); };
    frame.share(out.blocks.count() * out.blocks.bytesPerBlock(), productPieces, [&](const Piece& p) {
        if (mine(p) && (!out.unseen || p.unseen)) showPositions(out, p.begin, p.end);
    });
    out.work = VertexWork::None;
    holdVertices(out);
    frame.share(out.blocks.count() * out.blocks.bytesPerBlock(), normalPieces, [&](const Piece& p) {
        if (mine(p)) findNormals(out.positions.data(), out.runtime->stencils.data(), static_cast<float>(out.runtime->inverseSize()), p.begin, p.end, out.normals.data());
    });
    holdNormals(out);
}

const DeformInput& Character::deformInput() {
    if (!state_->deformInput) state_->buildDeformInput();
    return *state_->deformInput;
}

bool Character::deformExternally(int element, bool external) {
    auto& e = state_->frame.elements[static_cast<std::size_t>(element)];
    e.wantsExternal = external && state_->canDeformExternally(e);
    return e.wantsExternal;
}

}  // namespace imomushi
