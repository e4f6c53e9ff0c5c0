// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/character/aligned_buffer.h"
#include "core/character/vertex_kernels.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A' and the rest positions of an element as the frame reads them. What an affine motion of the whole element explains (rigid motions, uniform
/// stretches) is done to their rest positions; the remainder is kept as modes, of which there are fewer than columns: 11 instead of 18 for
/// an element between two parallel faces in the basis "affine". Copies share all this, and have weights of their own.
class ResponseBlocks {
public:
    ResponseBlocks() = default;
    /// free: ascending rows of `vertices` that are evaluated. response: 3 * #free x #columns, m per unit of v. Rest positions are kept about `middle`.
    ResponseBlocks(const Points& vertices, const std::vector<std::int32_t>& free, const Vec3& middle, const Eigen::MatrixXd& response,
                   ResponseFormat format);

    /// Makes weights() those of v. Does not allocate.
    void weigh(const Eigen::VectorXd& v);

    [[nodiscard]] VertexBlocks view() const;
    [[nodiscard]] Weights weights() const { return {affine_, columns_.data(), pairs_.data(), groups_.data()}; }
    [[nodiscard]] int modes() const { return static_cast<int>(table_->scale.size()); }
    [[nodiscard]] std::size_t count() const { return table_->first.size(); }  ///< of blocks
    [[nodiscard]] const std::int32_t* first() const { return table_->first.data(); }
    [[nodiscard]] const AlignedBuffer<float>& rest() const { return table_->rest; }
    [[nodiscard]] std::size_t responseBytes() const { return table_->response.bytes(); }
    [[nodiscard]] std::size_t bytesPerBlock() const { return count() ? (table_->response.bytes() + table_->rest.bytes()) / count() : 0; }
    /// What the format costs: largest error of a displacement relative to the largest displacement, the worst of unit poses (each column
    /// alone, 64 of them at most) and of all columns together, each as strong as the others, with several signs. 0 without columns.
    [[nodiscard]] double error() const { return table_->error; }

private:
    struct Table {
        ResponseFormat format = ResponseFormat::Float;
        AlignedBuffer<std::byte> response;
        AlignedBuffer<float> rest;
        std::vector<std::int32_t> first;
        Eigen::MatrixXd modesOf, affineOf;  // #modes x #columns, 12 x #columns: what v is multiplied with; empty: modes are columns
        std::vector<double> scale;          // per mode: metres per unit of an entry
        double error = 0.0;
    };
    static Eigen::MatrixXd findModes(const Points& rest, const Eigen::MatrixXd& response, Table& table);
    static void pack(const std::vector<std::int32_t>& free, const Eigen::MatrixXd& modes, Table& table);
    [[nodiscard]] double measure(std::size_t vertices, const std::vector<std::int32_t>& free, const Points& rest, const Eigen::MatrixXd& response);

    std::shared_ptr<const Table> table_ = std::make_shared<const Table>();
    Eigen::VectorXd modal_;               // of the last v
    AffineFloat affine_ = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    std::vector<float> columns_, groups_;
    std::vector<std::int16_t> pairs_;
};

}  // namespace imomushi
