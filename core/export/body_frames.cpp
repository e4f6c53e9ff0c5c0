// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/body_frames.h"

#include <Eigen/Geometry>

namespace imomushi {

Result<BodyFrames> BodyFrames::build(Motion& motion, std::vector<const double*> shapes, const Progress& progress) {
    Character& character = motion.character;
    BodyFrames out;
    out.shapes_ = std::move(shapes);
    out.layout_ = motion.layout;
    const auto frames = static_cast<Eigen::Index>(out.shapes_.size());
    const auto& elements = character.input().elements;
    out.parts_.resize(elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        Part& part = out.parts_[e];
        const int index = static_cast<int>(e);
        const auto& layout = out.layout_.elements[e];
        part.given = &elements[e];
        part.loads = character.loadColumns(index);
        part.weights.resize(layout.weights, frames);
        bool touched = false;
        for (Eigen::Index k = 0; k < frames; ++k) {
            const double* numbers = out.shapes_[static_cast<std::size_t>(k)] + out.layout_.element(e) + ShapeLayout::kFrame;
            part.weights.col(k) = Eigen::Map<const Eigen::VectorXd>(numbers, layout.weights);
            touched = touched || (Eigen::Map<const Eigen::ArrayXd>(numbers + layout.weights, layout.forces) != 0.0).any();
        }
        const bool ofMesh = motion.seen[e].mesh >= 0;
        const Eigen::Index vertices = ofMesh ? static_cast<Eigen::Index>(motion.seen[e].vertices.size()) : elements[e].mesh->body.vertices.rows();
        part.isWhole = ofMesh || touched || character.isWarped(index);
        if (part.isWhole) {
            part.whole.resize(3 * vertices, frames);
            continue;
        }
        part.row.assign(static_cast<std::size_t>(vertices), 0);
        if (elements[e].response)
            for (std::size_t i = 0; i < elements[e].response->freeVertices.size(); ++i)
                part.row[static_cast<std::size_t>(elements[e].response->freeVertices[i])] = static_cast<std::int32_t>(i);
        const auto held = character.heldVertices(index);
        for (std::size_t i = 0; i < held.size(); ++i) part.row[static_cast<std::size_t>(held[i])] = -1 - static_cast<std::int32_t>(i);
        part.held.resize(3 * static_cast<Eigen::Index>(held.size()), frames);
    }
    for (Eigen::Index k = 0; k < frames; ++k) {
        if (progress.cancelled()) return fail(kCancelled, "The export was cancelled.");
        character.show(out.shapes_[static_cast<std::size_t>(k)]);
        const std::vector<Points> ofMeshes = motion.meshPositions();
        for (std::size_t e = 0; e < elements.size(); ++e) {
            Part& part = out.parts_[e];
            const Eigen::Isometry3d back = out.frame(e, static_cast<std::size_t>(k)).inverse();
            const Points at = part.isWhole ? motion.seenPositions(e, ofMeshes) : character.heldPositions(static_cast<int>(e));
            for (Eigen::Index i = 0; i < at.rows(); ++i) {
                const Vec3 local = back * Vec3(at.row(i).transpose());
                if (part.isWhole)
                    part.whole.col(k).segment<3>(3 * i) = local.cast<float>();
                else
                    part.held.col(k).segment<3>(3 * i) = local;
            }
        }
    }
    return out;
}

Eigen::Isometry3d BodyFrames::frame(std::size_t element, std::size_t k) const {
    const double* numbers = shapes_[k] + layout_.element(element);
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = Eigen::Map<const Eigen::Quaterniond>(numbers).toRotationMatrix();
    out.translation() = Eigen::Map<const Vec3>(numbers + 4);
    return out;
}

void BodyFrames::at(std::size_t element, std::span<const std::int32_t> vertices, Eigen::MatrixXd& out) const {
    const Part& part = parts_[element];
    const auto count = static_cast<Eigen::Index>(vertices.size()), frames = static_cast<Eigen::Index>(shapes_.size());
    out.resize(3 * count, frames);
    if (part.isWhole) {
        for (Eigen::Index i = 0; i < count; ++i)
            for (Eigen::Index k = 0; k < frames; ++k) out.col(k).segment<3>(3 * i) = part.whole.col(k).segment<3>(3 * vertices[static_cast<std::size_t>(i)]).cast<double>();
        return;
    }
    const Points& rest = part.given->mesh->body.vertices;
    const Eigen::Index columns = part.given->response ? part.given->response->columns() : 0, all = part.weights.rows();
    if (all > 0) {
        const auto& response = *part.given->response;
        Eigen::MatrixXd rows(3 * count, all);
        for (Eigen::Index c = 0; c < all; ++c) {
            const auto from = c < columns ? response.response.col(c) : response.loads.col(part.loads[static_cast<std::size_t>(c - columns)]);
            for (Eigen::Index i = 0; i < count; ++i)
                if (const std::int32_t row = part.row[static_cast<std::size_t>(vertices[static_cast<std::size_t>(i)])]; row >= 0)
                    rows.col(c).segment<3>(3 * i) = from.segment<3>(3 * row);
                else
                    rows.col(c).segment<3>(3 * i).setZero();
        }
        out.noalias() = rows * part.weights;
    } else {
        out.setZero();
    }
    for (Eigen::Index i = 0; i < count; ++i) {
        const std::int32_t v = vertices[static_cast<std::size_t>(i)], row = part.row[static_cast<std::size_t>(v)];
        if (row < 0)
            out.middleRows<3>(3 * i) = part.held.middleRows<3>(3 * (-1 - row));
        else
            out.middleRows<3>(3 * i).colwise() += rest.row(v).transpose();
    }
}

}  // namespace imomushi
