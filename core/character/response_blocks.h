// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/character/aligned_buffer.h"
#include "core/character/vertex_kernels.h"
#include "core/mesh/mesh.h"

namespace imomushi {

/// A' and the rest positions of an element as the frame reads them.
class ResponseBlocks {
public:
    ResponseBlocks() = default;
    /// free: ascending rows of `vertices` that are evaluated. response: 3 * #free x #columns, m per unit of v. Rest positions are kept about `middle`.
    ResponseBlocks(const Points& vertices, const std::vector<std::int32_t>& free, const Vec3& middle, const Eigen::MatrixXd& response,
                   ResponseFormat format);

    /// Makes weights() those of v. Does not allocate.
    void weigh(const Eigen::VectorXd& v);

    [[nodiscard]] VertexBlocks view() const;
    [[nodiscard]] ColumnWeights weights() const { return {columns_.data(), pairs_.data(), groups_.data()}; }
    [[nodiscard]] std::size_t count() const { return first_.size(); }  ///< of blocks
    [[nodiscard]] const std::int32_t* first() const { return first_.data(); }
    [[nodiscard]] const AlignedBuffer<float>& rest() const { return rest_; }
    [[nodiscard]] std::size_t responseBytes() const { return response_.bytes(); }
    [[nodiscard]] std::size_t bytesPerBlock() const { return count() ? (response_.bytes() + rest_.bytes()) / count() : 0; }
    /// What the format costs: largest error of a displacement relative to the largest displacement, the worst of all unit poses (each column
    /// alone) and of all columns together, each as strong as the others, with several signs. 0 without columns.
    [[nodiscard]] double error() const { return error_; }

private:
    void pack(const std::vector<std::int32_t>& free, const Eigen::MatrixXd& response);
    [[nodiscard]] double measure(std::size_t vertices, const std::vector<std::int32_t>& free, const Eigen::MatrixXd& response);

    ResponseFormat format_ = ResponseFormat::Float;
    AlignedBuffer<std::byte> response_;
    AlignedBuffer<float> rest_;
    std::vector<std::int32_t> first_;
    std::vector<double> scale_;  // per column: metres per unit of an entry and of v
    std::vector<float> columns_, groups_;
    std::vector<std::int16_t> pairs_;
    double error_ = 0.0;
};

}  // namespace imomushi
