// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/render_mesh_job.h"

#include <algorithm>
#include <span>

#include "core/base/decompositions.h"
#include "core/base/rotation_vector.h"
#include "core/character/frame.h"

namespace imomushi {

namespace {

// Of the work for one thread: points that follow; vertices that are put in order.
constexpr std::size_t kOfPiece = 1024;
constexpr std::int32_t kRunsOfPiece = 8192;

/// Where a vertex of an element is shown.
Eigen::Map<Eigen::Vector3f> shownAt(ElementState& of, std::int32_t vertex) {
    return Eigen::Map<Eigen::Vector3f>(of.positions.data() + 3 * static_cast<std::ptrdiff_t>(vertex));
}

/// Of all rotations the nearest to a gradient.
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& gradient) {
    auto [u, v, values] = singularValuesOf(gradient);
    if (u.determinant() * v.determinant() < 0.0) u.col(2) = -u.col(2);
    return u * v.transpose();
}

/// What an attached part does, from its pivot at rest to the world, by the four vertices of its frame and its turn.
template <class At>
AffineMap partMap(const EmbeddedTables& tables, std::size_t part, const Vec3& turn, const At& at) {
    const std::size_t frame = tables.frameOf(part);
    const Vec3 pivot = at(frame);
    Eigen::Matrix3d gradient;
    for (std::size_t k = 0; k < 3; ++k) gradient.col(static_cast<Eigen::Index>(k)) = (at(frame + k + 1) - pivot) / tables.reach;
    AffineMap map{nearestRotation(gradient), pivot};
    if (!turn.isZero(0.0)) map.linear *= rotationOf(turn).toRotationMatrix();
    return map;
}

/// Where attached points are: place(index of a point, where it is).
template <class At, class Place>
void placeParts(const EmbeddedPoints& points, const EmbeddedTables& tables, const std::vector<Vec3>& turns, const At& at, const Place& place) {
    for (std::size_t a = 0; a < points.attached.size(); ++a) {
        const auto& part = points.attached[a];
        const AffineMap map = partMap(tables, a, turns[a], at);
        for (const auto i : part.points) place(i, Vec3(map.shift + map.linear * (points.rest.row(i).transpose() - part.pivot)));
    }
}

/// What a joint does to the part of an embedded point that is its own, beyond what the frame of the element does. product: how much of the point is a product.
Eigen::Matrix3d jointPart(const Frame& frame, const ElementState& of, int face, double product) {
    const Eigen::Matrix3d& linear = frame.joints[static_cast<std::size_t>(of.jointOf[static_cast<std::size_t>(face)])].map.linear;
    return linear - product * of.frame.linear;
}

}  // namespace

RenderMeshJob::RenderMeshJob(const Frame& frame, std::span<const RenderMeshJob* const> known)
    : FrameJob({}, {{Stage::Weights, {}, {}},
                    {Stage::Placed, FrameData::JointMaps | FrameData::Elements | FrameData::Parameters | FrameData::Local | FrameData::Forces | FrameData::Positions, FrameData::Positions},
                    {Stage::Normals, FrameData::Positions | FrameData::Normals, {}}}) {
    std::vector<std::shared_ptr<const ElementRuntime>> runtimes;
    for (const auto& e : frame.elements) runtimes.push_back(e.runtime);
    for (std::size_t e = 0; e < frame.elements.size(); ++e) {
        const auto& of = frame.elements[e];
        if (!of.runtime->embedded) continue;
        Element made = madeFor(frame, e);
        const bool touched = of.patchForces.size() > 0;
        if (of.runtime->warp || touched) {
            const auto& mapping = made.tables->mapping;
            made.gradients = mapping.gradients();
            carriedBytes_ += mapping.bytes() + sizeof(Eigen::Matrix3d) * (mapping.triangles() + mapping.vertices());
            if (touched) made.dents = AlignedBuffer<float>(3 * of.runtime->vertices);
            const auto split = [&](std::vector<Piece>& pieces, std::size_t count) {
                for (std::size_t i = 0; i < count; i += kOfPiece) pieces.push_back({elements_.size(), i, std::min(i + kOfPiece, count)});
            };
            split(triangles_, mapping.triangles());
            split(vertices_, mapping.vertices());
            split(points_, mapping.size());
        }
        if (made.tables->parts > 0) {
            const auto* first = of.blocks.first();
            made.partBlocks = static_cast<std::size_t>(std::upper_bound(first, first + of.blocks.count(), static_cast<std::int32_t>(made.tables->frameOf(0))) - first) - 1;
            const auto& joints = made.tables->mapping.jointParts();
            const auto frames = static_cast<std::int32_t>(made.tables->rows.size() - EmbeddedTables::kFrameVertices * made.tables->parts);
            made.partJoints = static_cast<std::size_t>(std::find_if(joints.begin(), joints.end(), [frames](const auto& j) { return j.point >= frames; }) - joints.begin());
        }
        elements_.push_back(std::move(made));
    }
    for (const auto& mesh : frame.input.renderMeshes) {
        Mesh made;
        for (const RenderMeshJob* job : known)
            for (const Mesh& other : job->meshes_)
                if (!made.tables && other.tables->fits(mesh, runtimes)) made.tables = other.tables;
        if (!made.tables) made.tables = RenderMeshTables::build(mesh, runtimes);
        const std::size_t padded = (mesh->vertices.size() + kVertexBlock - 1) / kVertexBlock * kVertexBlock + kVertexBlock;
        made.positions = AlignedBuffer<float>(3 * padded);
        made.normals = AlignedBuffer<float>(3 * padded);
        if (made.tables->morphs) {
            made.morphs.emplace(made.tables->morphs);
            made.shownWeights = made.morphs->restWeights();
        }
        for (std::size_t i = 0; i < made.tables->normalPieces.size(); ++i) normals_.push_back({meshes_.size(), i, i + 1});
        const auto& runs = made.tables->runs;
        for (std::size_t begin = 0, end = 0; begin < runs.size(); begin = end) {
            std::int32_t vertices = 0;
            while (end < runs.size() && vertices < kRunsOfPiece) vertices += runs[end++].count;
            runs_.push_back({meshes_.size(), begin, end});
        }
        meshes_.push_back(std::move(made));
    }
}

RenderMeshJob::Element RenderMeshJob::madeFor(const Frame& frame, std::size_t index) {
    const auto& of = frame.elements[index];
    Element made;
    made.index = index;
    made.tables = of.runtime->embedded;
    if (of.runtime->input.response && frame.input.basis != BasisKind::Paper) return made;
    std::vector<std::int32_t> indexOf(of.runtime->vertices, -1);
    for (std::size_t i = 0; i < of.held.size(); ++i) indexOf[static_cast<std::size_t>(of.held[i].vertex)] = static_cast<std::int32_t>(i);
    for (const auto& part : made.tables->mapping.heldParts()) made.heldOf.push_back(indexOf[static_cast<std::size_t>(part.vertex)]);
    const auto held = static_cast<Eigen::Index>(of.held.size());
    made.heldColumns = Eigen::MatrixXd::Zero(3 * held, of.v.size());
    made.heldMoves = Eigen::VectorXd::Zero(3 * held);
    made.missing = Points::Zero(held, 3);
    forHeldVertices(of.runtime->input, [&](std::int32_t v, int column, const Eigen::MatrixXd& block) {
        made.heldColumns.block(3 * indexOf[static_cast<std::size_t>(v)], column, 3, block.cols()) = block;
    });
    return made;
}

void RenderMeshJob::run(Stage stage, Frame& frame) {
    if (stage == Stage::Weights) {
        findMorphed(frame);
    } else if (stage == Stage::Placed) {
        follow(frame);
        gather(frame);
    } else {
        findNormals(frame);
    }
}

void RenderMeshJob::follow(Frame& frame) {
    bool any = false;
    for (auto& e : elements_) {
        const auto& of = frame.elements[e.index];
        e.carry = !of.moved || of.seenPending ? Carry::Nothing : of.warpPart > 0.0 ? Carry::Bodies : of.dented ? Carry::Dents : Carry::Nothing;
        if (e.carry == Carry::Dents) findDents(e, of);
        any = any || e.carry != Carry::Nothing;
    }
    if (any) {
        const auto kind = [](const Element& e) { return e.carry == Carry::Bodies ? EmbeddedMapping::Values::Positions : EmbeddedMapping::Values::Displacements; };
        const auto values = [&frame](const Element& e) { return e.carry == Carry::Bodies ? frame.elements[e.index].positions.data() : e.dents.data(); };
        frame.share(carriedBytes_, triangles_, [&](const Piece& p) {
            auto& e = elements_[p.element];
            if (e.carry != Carry::Nothing) e.tables->mapping.findTriangles(kind(e), values(e), p.begin, p.end, e.gradients);
        });
        frame.share(carriedBytes_, vertices_, [&](const Piece& p) {
            auto& e = elements_[p.element];
            if (e.carry != Carry::Nothing) e.tables->mapping.findVertices(p.begin, p.end, e.gradients);
        });
        frame.share(carriedBytes_, points_, [&](const Piece& p) {
            const auto& e = elements_[p.element];
            auto& of = frame.elements[e.index];
            for (std::size_t i = p.begin; e.carry != Carry::Nothing && i < p.end; ++i) {
                const Vec3 at = e.tables->mapping.at(i, values(e), e.gradients);
                if (e.carry == Carry::Bodies && of.warpPart == 1.0)
                    shownAt(of, e.tables->rows[i]) = at.cast<float>();
                else if (e.carry == Carry::Bodies)
                    shownAt(of, e.tables->rows[i]) += static_cast<float>(of.warpPart) * (at.cast<float>() - shownAt(of, e.tables->rows[i]));
                else
                    shownAt(of, e.tables->rows[i]) += (of.frame.linear * at).cast<float>();
            }
        });
    }
    for (auto& e : elements_) {
        auto& of = frame.elements[e.index];
        if (of.moved && of.seenPending)
            findParts(e, frame, of);
        else if (of.moved)
            finish(e, frame);
    }
}

void RenderMeshJob::finish(Element& e, Frame& frame) {
    auto& of = frame.elements[e.index];
    addJointParts(e, frame, of);
    const double product = productPart(e, of);
    if (!e.heldOf.empty() && product > 0.0) {
        findMissing(e, frame);
        for (std::size_t i = 0; i < e.heldOf.size(); ++i) {
            const auto& part = e.tables->mapping.heldParts()[i];
            shownAt(of, e.tables->rows[static_cast<std::size_t>(part.point)]) += (product * part.weight * e.missing.row(e.heldOf[i]).transpose()).cast<float>();
        }
    }
    placeAttached(e, of);
}

void RenderMeshJob::finish(Frame& frame, std::size_t element) {
    for (auto& e : elements_)
        if (e.index == element) finish(e, frame);
}

void RenderMeshJob::findParts(const Element& e, const Frame& frame, ElementState& of) {
    if (of.parts.empty()) return;
    evaluateAndPlace(of.blocks.view(), of.blocks.weights(), of.placement, e.partBlocks, of.blocks.count(), nullptr, of.positions.data());
    addJointParts(e, frame, of, e.partJoints);
    for (std::size_t a = 0; a < of.parts.size(); ++a) {
        const AffineMap map = partMap(*e.tables, a, of.turns[a], [&of](std::size_t i) -> Vec3 { return shownAt(of, static_cast<std::int32_t>(i)).cast<double>(); });
        of.parts[a] = map.toFloat();
    }
}

void RenderMeshJob::findDents(Element& e, const ElementState& of) {
    const auto vertices = static_cast<std::int32_t>(of.runtime->vertices);
    for (std::size_t k = 0; k < of.runtime->bodyBlocks; ++k) {
        const std::int32_t first = of.blocks.first()[k], count = std::min(kVertexBlock, vertices - first);
        for (int axis = 0; axis < 3; ++axis) {
            const std::ptrdiff_t from = (3 * static_cast<std::ptrdiff_t>(k) + axis) * kVertexBlock;
            const float *dented = of.dented + from, *local = of.local.data() + from;
            float* to = e.dents.data() + 3 * static_cast<std::ptrdiff_t>(first) + axis;
            for (std::int32_t i = 0; i < count; ++i) to[3 * i] = dented[i] - local[i];
        }
    }
}

void RenderMeshJob::findMissing(Element& e, const Frame& frame) {
    const auto& of = frame.elements[e.index];
    const Points& rest = of.runtime->input.mesh->body.vertices;
    e.heldMoves.noalias() = e.heldColumns * of.v;
    for (std::size_t i = 0; i < of.held.size(); ++i) {
        const Vec3 said = rest.row(of.held[i].vertex).transpose() + e.heldMoves.segment<3>(3 * static_cast<Eigen::Index>(i));
        e.missing.row(static_cast<Eigen::Index>(i)) = (frame.heldAt(of, i) - of.frame(said)).transpose();
    }
}

double RenderMeshJob::productPart(const Element& e, const ElementState& of) { return e.carry == Carry::Bodies ? 1.0 - of.warpPart : 1.0; }

void RenderMeshJob::addJointParts(const Element& e, const Frame& frame, ElementState& of, std::size_t first) {
    int face = -1;
    Eigen::Matrix3f motion = Eigen::Matrix3f::Zero();
    for (const auto& part : std::span(e.tables->mapping.jointParts()).subspan(first)) {
        if (part.face != face) {
            face = part.face;
            motion = jointPart(frame, of, face, productPart(e, of)).cast<float>();
        }
        shownAt(of, e.tables->rows[static_cast<std::size_t>(part.point)]) += motion * part.offset.cast<float>();
    }
}

void RenderMeshJob::placeAttached(const Element& e, ElementState& of) {
    const auto first = static_cast<std::int32_t>(e.tables->first);
    placeParts(*of.runtime->input.embedded, *e.tables, of.turns, [&of](std::size_t i) -> Vec3 { return shownAt(of, static_cast<std::int32_t>(i)).cast<double>(); },
               [&of, first](std::int32_t i, const Vec3& p) { shownAt(of, first + i) = p.cast<float>(); });
}

void RenderMeshJob::findMorphed(Frame& frame) {
    for (auto& of : frame.elements) of.wantsHere = false;
    for (std::size_t m = 0; m < meshes_.size(); ++m) {
        auto& mesh = meshes_[m];
        if (!mesh.morphs) continue;
        mesh.others = mesh.shownWeights != frame.morphs[m];
        mesh.wasMorphed = mesh.morphed;
        mesh.morphed = mesh.morphs->active(frame.morphs[m]);
        for (const auto e : mesh.tables->elements) frame.elements[static_cast<std::size_t>(e)].wantsHere = frame.elements[static_cast<std::size_t>(e)].wantsHere || mesh.morphed;
        if (mesh.others) std::copy(frame.morphs[m].begin(), frame.morphs[m].end(), mesh.shownWeights.begin());
    }
}

void RenderMeshJob::gather(Frame& frame) {
    std::size_t bytes = 0;
    for (auto& mesh : meshes_) {
        const auto any = [&](const auto& is) {
            return std::any_of(mesh.tables->elements.begin(), mesh.tables->elements.end(), [&](std::int32_t e) { return is(frame.elements[static_cast<std::size_t>(e)]); });
        };
        const bool moved = any([](const ElementState& of) { return of.moved; }), was = mesh.pending;
        mesh.pending = any([](const ElementState& of) { return of.seenPending; });
        // Morph targets are added to positions without them: all are made anew.
        mesh.all = mesh.others || (moved && (mesh.morphed || mesh.wasMorphed)) || (was && !mesh.pending);
        if (mesh.all || moved) ++mesh.revision;
        bytes += 6 * sizeof(float) * mesh.tables->vertices();
    }
    frame.share(bytes, runs_, [&](const Piece& p) {
        if (!meshes_[p.element].pending) gather(frame, p);
    });
    for (auto& mesh : meshes_)
        if (mesh.all && mesh.morphed) mesh.morphs->add(mesh.shownWeights, mesh.tables->stencils.data(), mesh.positions.data());
}

void RenderMeshJob::gather(const Frame& frame, const Piece& runs) {
    auto& mesh = meshes_[runs.element];
    for (std::size_t i = runs.begin; i < runs.end; ++i) {
        const auto& run = mesh.tables->runs[i];
        const auto& of = frame.elements[static_cast<std::size_t>(run.element)];
        if (mesh.all || of.moved) std::copy_n(of.positions.data() + 3 * static_cast<std::ptrdiff_t>(run.from), 3 * run.count, mesh.positions.data() + 3 * static_cast<std::ptrdiff_t>(run.to));
    }
}

void RenderMeshJob::findNormals(Frame& frame) {
    std::size_t bytes = 0;
    for (const auto& mesh : meshes_) bytes += mesh.tables->vertices() * (sizeof(NormalStencil) + 6 * sizeof(float));
    frame.share(bytes, normals_, [&](const Piece& p) {
        if (!meshes_[p.element].pending) findNormals(frame, p);
    });
}

void RenderMeshJob::findNormals(const Frame& frame, const Piece& normals) {
    auto& mesh = meshes_[normals.element];
    const auto& tables = *mesh.tables;
    const auto& piece = tables.normalPieces[normals.begin];
    if (mesh.all || std::any_of(piece.elements.begin(), piece.elements.end(), [&](std::int32_t e) { return frame.elements[static_cast<std::size_t>(e)].moved; }))
        imomushi::findNormals(mesh.positions.data(), tables.stencils.data(), static_cast<float>(tables.scale), piece.begin, piece.end, mesh.normals.data());
}

void RenderMeshJob::catchUp(Frame& frame, int index) {
    auto& mesh = meshes_[static_cast<std::size_t>(index)];
    mesh.pending = false;
    mesh.all = true;
    const auto mine = [index](const Piece& p) { return p.element == static_cast<std::size_t>(index); };
    const std::size_t bytes = mesh.tables->vertices() * (sizeof(NormalStencil) + 12 * sizeof(float));
    frame.share(bytes, runs_, [&](const Piece& p) {
        if (mine(p)) gather(frame, p);
    });
    frame.share(bytes, normals_, [&](const Piece& p) {
        if (mine(p)) findNormals(frame, p);
    });
}

std::size_t RenderMeshJob::bytes() const {
    std::size_t sum = carriedBytes_;
    for (const auto& mesh : meshes_) sum += mesh.tables->bytes() + (mesh.tables->morphs ? mesh.tables->morphs->bytes() : 0) + mesh.positions.bytes() + mesh.normals.bytes();
    return sum;
}

Character::Surface RenderMeshJob::surface(int mesh) const {
    const auto& m = meshes_[static_cast<std::size_t>(mesh)];
    return {m.positions.data(), m.normals.data(), static_cast<int>(m.tables->vertices()), m.revision};
}

std::vector<double> RenderMeshJob::restWeights(int mesh) const {
    const auto& shapes = meshes_[static_cast<std::size_t>(mesh)].morphs;
    return shapes ? shapes->restWeights() : std::vector<double>();
}

Points RenderMeshJob::elementPositions(const Frame& frame, const Element& element) {
    const auto& of = frame.elements[element.index];
    const auto& runtime = *of.runtime;
    const auto& given = runtime.input;
    const auto& tables = *element.tables;
    const auto count = static_cast<Eigen::Index>(tables.first + tables.count);
    const auto placeAll = [&](Points& out) {
        placeParts(*given.embedded, tables, of.turns, [&](std::size_t i) -> Vec3 { return out.row(static_cast<Eigen::Index>(i)).transpose(); },
                   [&](std::int32_t i, const Vec3& p) { out.row(static_cast<Eigen::Index>(tables.first) + i) = p.transpose(); });
    };
    // What only a frame knows is as precise as it is shown; attached parts keep their shape all the same.
    if (of.warpPart > 0.0 || of.dented) {
        Points out = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(of.positions.data(), count, 3).cast<double>();
        placeAll(out);
        return out;
    }
    const Points& body = given.mesh->body.vertices;
    Eigen::MatrixXd displacement = Eigen::MatrixXd::Zero(3 * body.rows(), 1);
    if (given.response && given.response->columns() > 0) {
        const Points u = deformElement(*given.mesh, given.faces, *given.response, of.v) - body;
        displacement.col(0) = Eigen::Map<const Eigen::VectorXd>(u.data(), u.size());
    }
    for (std::size_t l = 0; l < given.tables.loads.size(); ++l) {
        const auto column = given.response->loads.col(given.tables.loads[l]);
        const double weight = of.withLoads[of.v.size() + static_cast<Eigen::Index>(l)];
        for (std::size_t i = 0; i < runtime.free.size(); ++i) displacement.block<3, 1>(3 * runtime.free[i], 0) += weight * column.segment<3>(3 * static_cast<Eigen::Index>(i));
    }
    const Eigen::MatrixXd followed = tables.mapping.apply(displacement, 1);
    const Points rest = tables.restOf(*given.embedded);
    Points out = Points::Zero(count, 3);
    for (std::size_t i = 0; i < tables.rows.size(); ++i) {
        const Eigen::Index row = tables.rows[i];
        const Vec3 at = rest.row(row - static_cast<Eigen::Index>(tables.first)).transpose() + followed.col(0).segment<3>(3 * static_cast<Eigen::Index>(i));
        out.row(row) = of.frame(at).transpose();
    }
    for (const auto& part : tables.mapping.jointParts())
        out.row(tables.rows[static_cast<std::size_t>(part.point)]) += (jointPart(frame, of, part.face, 1.0) * part.offset).transpose();
    for (std::size_t i = 0; i < element.heldOf.size(); ++i) {
        const auto& part = tables.mapping.heldParts()[i];
        out.row(tables.rows[static_cast<std::size_t>(part.point)]) += part.weight * element.missing.row(element.heldOf[i]);
    }
    placeAll(out);
    return out;
}

Points RenderMeshJob::positions(const Frame& frame, int mesh, const std::vector<Points>& bodies) const {
    const auto& tables = *meshes_[static_cast<std::size_t>(mesh)].tables;
    std::vector<Points> all(frame.elements.size());  // vertices of elements (EmbeddedTables)
    for (const auto& e : elements_)
        if (std::binary_search(tables.elements.begin(), tables.elements.end(), static_cast<std::int32_t>(e.index))) all[e.index] = elementPositions(frame, e);
    Points out(static_cast<Eigen::Index>(tables.vertices()), 3);
    for (const auto& run : tables.runs) {
        const auto e = static_cast<std::size_t>(run.element);
        const bool onBody = run.from < static_cast<std::int32_t>(frame.elements[e].runtime->vertices);
        out.middleRows(run.to, run.count) = (onBody ? bodies[e] : all[e]).middleRows(run.from, run.count);
    }
    if (tables.morphs) {
        MorphShapes shapes(tables.morphs);
        const auto& weights = frame.morphs[static_cast<std::size_t>(mesh)];
        if (shapes.active(weights)) shapes.add(weights, tables.stencils.data(), out.data());
    }
    return out;
}

}  // namespace imomushi
