// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace imomushi {

struct RenderModel;

/// A part of a render model, or one of its shells.
struct ModelPart {
    std::int32_t part = 0;    ///< into RenderModel::parts
    std::int32_t shell = -1;  ///< into ModelParts::Part::shells, -1: the whole part
    auto operator<=>(const ModelPart&) const = default;
};

/// The parts of a render model under names of their own. The first part of a name has that name, others with the same name are "name (2)", "name (3)", ... A part that
/// does not hang together has shells, in the order of the file: "name#1", "name#2", ...
struct ModelParts {
    /// A part of more shells than this (hair, scattered triangles) is handled as a whole.
    static constexpr std::size_t kMostShells = 64;

    struct Part {
        std::string name;
        std::vector<std::int32_t> vertices;             ///< ascending; each vertex is of one part: the first that uses it, or that of the vertex before
        std::vector<std::vector<std::int32_t>> shells;  ///< vertices that triangles of the part connect, vertices at one place being one; none: it is one, or too many
    };
    std::vector<Part> parts;  ///< as RenderModel::parts

    static ModelParts of(const RenderModel& model);
    [[nodiscard]] std::optional<ModelPart> find(std::string_view name) const;
    [[nodiscard]] std::string nameOf(const ModelPart& part) const;
    [[nodiscard]] bool contains(const ModelPart& part) const;
    [[nodiscard]] const std::vector<std::int32_t>& verticesOf(const ModelPart& part) const;
};

}  // namespace imomushi
