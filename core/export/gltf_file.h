// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace imomushi {

/// The parts of a glTF 2.0 file that are the same for everything in it: one binary buffer, its views and accessors.
class GltfFile {
public:
    using Json = nlohmann::ordered_json;
    enum class Target { None = 0, Vertices = 34962, Indices = 34963 };
    static constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;

    Json root;

    /// Adds to an array of the root, and answers its index.
    int add(const char* array, Json item);
    int view(const void* bytes, std::size_t size, Target target, int stride = 0);
    /// width: numbers per item. bounds: with "min" and "max", as the format wants for positions and times.
    int accessor(const std::vector<float>& numbers, int width, Target target, bool bounds);
    /// Three numbers per item as normalised integers, over `unit`, padded to four bytes: KHR_mesh_quantization. wide: 16 bits, else 8.
    int quantised(const std::vector<float>& numbers, float unit, bool wide);
    /// Three numbers per item, many of which are 0: only the others are written, where that is shorter. With a unit as quantised() with 16 bits, else as accessor() with bounds.
    int mostlyZero(const std::vector<float>& numbers, float unit);
    int indices(const std::vector<std::uint32_t>& triangles, std::size_t vertices);
    /// Four per item; `narrow`: in a byte each.
    int joints(const std::vector<std::uint16_t>& numbers, bool narrow);
    /// Four per item of sum 1, as normalised 16-bit integers of exactly that sum.
    int quantisedWeights(const std::vector<float>& numbers);

    /// The whole file. Empty: larger than the format allows (4 GiB).
    [[nodiscard]] std::string glb() { return glb(std::move(binary_), 0); }
    /// The same with these bytes. `unpacked`: the size of a second buffer, which the file does not have, for what EXT_meshopt_compression unpacks; 0: none.
    [[nodiscard]] std::string glb(std::string binary, std::size_t unpacked);

private:
    template <class T>
    static void addBounds(Json& item, const T* numbers, std::size_t count, int width, std::size_t step);
    template <class T>
    int describe(const T* numbers, std::size_t count, int width, int type, bool normalised, Target target, bool bounds, int stride);
    std::string binary_;
};

}  // namespace imomushi
