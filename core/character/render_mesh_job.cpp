// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/character/render_mesh_job.h"

#include <Eigen/SVD>
#include <algorithm>

#include "core/character/frame.h"

namespace imomushi {

namespace {

constexpr std::size_t kOfPiece = 1024;

/// The rotation of a gradient: of all, the nearest to it.
Eigen::Matrix3d rotationOf(const Eigen::Matrix3d& gradient) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(gradient, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d u = svd.matrixU();
    if (u.determinant() * svd.matrixV().determinant() < 0.0) u.col(2) = -u.col(2);
    return u * svd.matrixV().transpose();
}

/// Where attached points are, by the four vertices of their part's frame: place(index of a point, where it is).
template <class At, class Place>
void placeParts(const EmbeddedPoints& points, const EmbeddedTables& tables, const At& at, const Place& place) {
    for (std::size_t a = 0; a < points.attached.size(); ++a) {
        const auto& part = points.attached[a];
        const std::size_t frame = tables.frameOf(a);
        const Vec3 pivot = at(frame);
        Eigen::Matrix3d gradient;
        for (std::size_t k = 0; k < 3; ++k) gradient.col(static_cast<Eigen::Index>(k)) = (at(frame + k + 1) - pivot) / tables.reach;
        const Eigen::Matrix3d rotation = rotationOf(gradient);
        for (const auto i : part.points) place(i, Vec3(pivot + rotation * (points.rest.row(i).transpose() - part.pivot)));
    }
}

/// What a joint does to the part of an embedded point that is its own, beyond what the frame of the element does.
Eigen::Matrix3d jointPart(const Frame& frame, const ElementFrame& of, int face, bool carried) {
    const Eigen::Matrix3d& linear = frame.joints[static_cast<std::size_t>(of.jointOf[static_cast<std::size_t>(face)])].map.linear;
    return carried ? linear : Eigen::Matrix3d(linear - of.frame.linear);
}

}  // namespace

RenderMeshJob::RenderMeshJob(const Frame& frame, const RenderMeshJob* known) : FrameJob({}, {Stage::Placed, Stage::Normals}) {
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
        elements_.push_back(std::move(made));
    }
    for (const auto& mesh : frame.input.renderMeshes) {
        Mesh made;
        for (std::size_t i = 0; known && i < known->meshes_.size(); ++i)
            if (known->meshes_[i].tables->fits(mesh, runtimes)) made.tables = known->meshes_[i].tables;
        if (!made.tables) made.tables = RenderMeshTables::build(mesh, runtimes);
        const std::size_t padded = (mesh->vertices.size() + kVertexBlock - 1) / kVertexBlock * kVertexBlock + kVertexBlock;
        made.positions = AlignedBuffer<float>(3 * padded);
        made.normals = AlignedBuffer<float>(3 * padded);
        for (std::size_t i = 0; i < made.tables->normalPieces.size(); ++i) normals_.push_back({meshes_.size(), i, i + 1});
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
    if (stage == Stage::Placed) {
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
        e.carry = !of.moved ? Carry::Nothing : of.runtime->warp ? Carry::Bodies : of.dented ? Carry::Dents : Carry::Nothing;
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
                Eigen::Map<Eigen::Vector3f> to(of.positions.data() + 3 * static_cast<std::ptrdiff_t>(e.tables->rows[i]));
                if (e.carry == Carry::Bodies)
                    to = at.cast<float>();
                else
                    to += (of.frame.linear * at).cast<float>();
            }
        });
    }
    for (auto& e : elements_) {
        auto& of = frame.elements[e.index];
        if (!of.moved) continue;
        addJointParts(e, frame, of);
        if (!e.heldOf.empty() && e.carry != Carry::Bodies) {
            findMissing(e, frame);
            for (std::size_t i = 0; i < e.heldOf.size(); ++i) {
                const auto& part = e.tables->mapping.heldParts()[i];
                Eigen::Map<Eigen::Vector3f>(of.positions.data() + 3 * static_cast<std::ptrdiff_t>(e.tables->rows[static_cast<std::size_t>(part.point)])) +=
                    (part.weight * e.missing.row(e.heldOf[i]).transpose()).cast<float>();
            }
        }
        placeAttached(e, of);
    }
}

void RenderMeshJob::findDents(Element& e, const ElementFrame& of) {
    const auto vertices = static_cast<std::int32_t>(of.runtime->vertices);
    for (std::size_t k = 0; k < of.runtime->bodyBlocks; ++k) {
        const std::int32_t first = of.blocks.first()[k], count = std::min(kVertexBlock, vertices - first);
        for (int axis = 0; axis < 3; ++axis) {
            const std::size_t from = (3 * k + static_cast<std::size_t>(axis)) * kVertexBlock;
            for (std::int32_t i = 0; i < count; ++i)
                e.dents[3 * static_cast<std::size_t>(first + i) + static_cast<std::size_t>(axis)] = of.dented[from + static_cast<std::size_t>(i)] - of.local[from + static_cast<std::size_t>(i)];
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

void RenderMeshJob::addJointParts(const Element& e, const Frame& frame, ElementFrame& of) {
    int face = -1;
    Eigen::Matrix3f motion = Eigen::Matrix3f::Zero();
    for (const auto& part : e.tables->mapping.jointParts()) {
        if (part.face != face) {
            face = part.face;
            motion = jointPart(frame, of, face, e.carry == Carry::Bodies).cast<float>();
        }
        Eigen::Map<Eigen::Vector3f>(of.positions.data() + 3 * static_cast<std::ptrdiff_t>(e.tables->rows[static_cast<std::size_t>(part.point)])) += motion * part.offset.cast<float>();
    }
}

void RenderMeshJob::placeAttached(const Element& e, ElementFrame& of) {
    const auto at = [&](std::size_t i) -> Eigen::Map<Eigen::Vector3f> { return Eigen::Map<Eigen::Vector3f>(of.positions.data() + 3 * i); };
    placeParts(*of.runtime->input.embedded, *e.tables, [&](std::size_t i) -> Vec3 { return at(i).cast<double>(); },
               [&](std::int32_t i, const Vec3& p) { at(e.tables->first + static_cast<std::size_t>(i)) = p.cast<float>(); });
}

void RenderMeshJob::gather(Frame& frame) {
    for (auto& mesh : meshes_) {
        bool moved = false;
        for (const auto e : mesh.tables->elements) moved = moved || frame.elements[static_cast<std::size_t>(e)].moved;
        if (!moved) continue;
        ++mesh.revision;
        for (const auto& run : mesh.tables->runs) {
            const auto& of = frame.elements[static_cast<std::size_t>(run.element)];
            if (of.moved) std::copy_n(of.positions.data() + 3 * static_cast<std::size_t>(run.from), 3 * run.count, mesh.positions.data() + 3 * static_cast<std::size_t>(run.to));
        }
    }
}

void RenderMeshJob::findNormals(Frame& frame) {
    std::size_t bytes = 0;
    for (const auto& mesh : meshes_) bytes += mesh.tables->vertices() * (sizeof(NormalStencil) + 6 * sizeof(float));
    frame.share(bytes, normals_, [&](const Piece& p) {
        auto& mesh = meshes_[p.element];
        const auto& piece = mesh.tables->normalPieces[p.begin];
        if (std::any_of(piece.elements.begin(), piece.elements.end(), [&](std::int32_t e) { return frame.elements[static_cast<std::size_t>(e)].moved; }))
            imomushi::findNormals(mesh.positions.data(), mesh.tables->stencils.data(), static_cast<float>(mesh.tables->scale), piece.begin, piece.end, mesh.normals.data());
    });
}

std::size_t RenderMeshJob::bytes() const {
    std::size_t sum = carriedBytes_;
    for (const auto& mesh : meshes_) sum += mesh.tables->bytes() + mesh.positions.bytes() + mesh.normals.bytes();
    return sum;
}

Character::Surface RenderMeshJob::surface(int mesh) const {
    const auto& m = meshes_[static_cast<std::size_t>(mesh)];
    return {m.positions.data(), m.normals.data(), static_cast<int>(m.tables->vertices()), m.revision};
}

Points RenderMeshJob::positions(const Frame& frame, int mesh, const std::vector<Points>& bodies) const {
    const auto& tables = *meshes_[static_cast<std::size_t>(mesh)].tables;
    std::vector<Points> all(frame.elements.size());  // vertices of elements (EmbeddedTables)
    for (const auto index : tables.elements) {
        const auto e = static_cast<std::size_t>(index);
        const auto& of = frame.elements[e];
        const auto& runtime = *of.runtime;
        if (!runtime.embedded) continue;
        const auto& embedded = *runtime.embedded;
        Points& out = all[e] = Points::Zero(static_cast<Eigen::Index>(embedded.first + embedded.count), 3);
        // What only a frame knows is as precise as it is shown.
        if (runtime.warp || of.dented) {
            out = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(of.positions.data(), out.rows(), 3).cast<double>();
            continue;
        }
        const auto& given = runtime.input;
        const Points& rest = given.mesh->body.vertices;
        Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(3 * rest.rows(), 1);
        if (given.response && given.response->columns() > 0) {
            const Points u = deformElement(*given.mesh, given.faces, *given.response, of.v) - rest;
            moved.col(0) = Eigen::Map<const Eigen::VectorXd>(u.data(), u.size());
        }
        for (std::size_t l = 0; l < given.tables.loads.size(); ++l)
            for (std::size_t i = 0; i < runtime.free.size(); ++i)
                moved.block<3, 1>(3 * runtime.free[i], 0) += given.response->loads.block<3, 1>(3 * static_cast<Eigen::Index>(i), given.tables.loads[l]) * of.withLoads[of.v.size() + static_cast<Eigen::Index>(l)];
        const Eigen::MatrixXd followed = embedded.mapping.apply(moved, 1);
        const auto restOf = [&](std::size_t vertex) -> Vec3 {
            const std::size_t i = vertex - embedded.first;
            if (i < static_cast<std::size_t>(given.embedded->rest.rows())) return given.embedded->rest.row(static_cast<Eigen::Index>(i)).transpose();
            const std::size_t k = (vertex - embedded.frameOf(0)) % EmbeddedTables::kFrameVertices;
            Vec3 p = given.embedded->attached[(vertex - embedded.frameOf(0)) / EmbeddedTables::kFrameVertices].pivot;
            if (k > 0) p[static_cast<Eigen::Index>(k) - 1] += embedded.reach;
            return p;
        };
        for (std::size_t i = 0; i < embedded.rows.size(); ++i)
            out.row(embedded.rows[i]) = of.frame(restOf(static_cast<std::size_t>(embedded.rows[i])) + followed.col(0).segment<3>(3 * static_cast<Eigen::Index>(i))).transpose();
        for (const auto& part : embedded.mapping.jointParts())
            out.row(embedded.rows[static_cast<std::size_t>(part.point)]) += (jointPart(frame, of, part.face, false) * part.offset).transpose();
        const auto own = std::find_if(elements_.begin(), elements_.end(), [e](const Element& known) { return known.index == e; });
        for (std::size_t i = 0; i < own->heldOf.size(); ++i) {
            const auto& part = embedded.mapping.heldParts()[i];
            out.row(embedded.rows[static_cast<std::size_t>(part.point)]) += part.weight * own->missing.row(own->heldOf[i]);
        }
        placeParts(*given.embedded, embedded, [&](std::size_t i) -> Vec3 { return out.row(static_cast<Eigen::Index>(i)).transpose(); },
                   [&](std::int32_t i, const Vec3& p) { out.row(static_cast<Eigen::Index>(embedded.first) + i) = p.transpose(); });
    }
    Points out(static_cast<Eigen::Index>(tables.vertices()), 3);
    for (const auto& run : tables.runs) {
        const auto e = static_cast<std::size_t>(run.element);
        const bool onBody = run.from < static_cast<std::int32_t>(frame.elements[e].runtime->vertices);
        out.middleRows(run.to, run.count) = (onBody ? bodies[e] : all[e]).middleRows(run.from, run.count);
    }
    return out;
}

}  // namespace imomushi
