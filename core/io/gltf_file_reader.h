// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/raw_scene.h"

namespace imomushi {

/// A glTF 2.0 file (text or GLB) as JSON, buffers and accessors, of which nothing is believed. Source: "glTF 2.0 Specification", Khronos. Our own reader on a JSON
/// library: assimp drops triangles with bad indices without a word, misreads skin weights and welds nothing exactly; tinygltf leaves the accessors, which are
/// most of the work and of the checks, to its user.
class GltfFileReader {
public:
    using Json = nlohmann::json;

    /// What every function here throws; readGltf() makes a Result of it.
    struct Refused {
        Error error;
    };

    explicit GltfFileReader(const SourceFile& file);

    [[nodiscard]] const SourceFile& file() const { return file_; }
    [[nodiscard]] const Json& root() const { return json_; }
    [[nodiscard]] bool isBinary() const { return binaryFile_; }  ///< GLB

    /// "bad-file": "'horse.glb' <what>".
    [[noreturn]] void refuse(const std::string& what) const;
    [[noreturn]] void refuseAsTooLarge() const;
    [[noreturn]] void refuseAsOld(const std::string& what) const;  ///< "old-gltf"

    /// A member of an object, null where there is none.
    static const Json& member(const Json& object, const char* key);
    /// `value` as an array, empty where it is null.
    const Json& array(const Json& value) const;
    /// An array of the root.
    const Json& list(const char* key) const;
    /// Empty where it is no string.
    static std::string text(const Json& value);
    /// A whole number >= 0; `otherwise` where it is null.
    std::uint64_t number(const Json& value, const char* what, std::optional<std::uint64_t> otherwise = {}) const;
    /// The same below `count`.
    std::size_t index(const Json& value, std::size_t count, const char* what, std::optional<std::uint64_t> otherwise = {}) const;
    /// `n` finite numbers, or `otherwise` where there are none.
    std::vector<double> numbers(const Json& value, std::size_t n, std::vector<double> otherwise, const char* what) const;
    /// A finite number, else `otherwise`.
    double number(const Json& value, double otherwise) const;

    /// The bytes of buffer view i, decompressed where they are compressed. `stride`: as the file says, 0: packed.
    std::string_view bufferView(std::size_t i, std::size_t* stride = nullptr);
    /// The bytes of a "data:" URI in base64.
    std::string decodeData(const std::string& uri) const;
    /// A URI without its %xx escapes.
    static std::string decodePercent(const std::string& uri);

    /// The numbers of an accessor, sparse ones included; normalised integers as numbers in [-1, 1].
    struct Values {
        std::size_t count = 0, width = 0;
        std::vector<double> at;  ///< count x width
    };
    /// `reference`: index of the accessor. `what` it holds, for messages.
    Values accessor(const Json& reference, const char* what);
    /// The same of numbers that lie packed elsewhere: the accessor says how many of them there are and whether they are normalised.
    Values accessor(const Json& reference, std::string_view packed, std::size_t width, std::uint64_t componentType, const char* what);
    /// An accessor says where its numbers are; without that they are zeros, or in what an extension compressed.
    [[nodiscard]] bool hasNumbers(const Json& reference) const;

private:
    void openContainer();
    void checkExtensions() const;
    std::string_view buffer(std::size_t i);
    /// The bytes of a view that meshoptimizer compressed; nothing where the view says nothing of that, or where it cannot be read and plain bytes are there too.
    std::optional<std::string_view> decompressed(std::size_t i, std::size_t* stride);
    /// The part of a buffer view with `count` items of `size` bytes.
    std::string_view slice(const Json& view, std::uint64_t offset, std::uint64_t count, std::size_t size, std::size_t& stride, const char* what);

    const SourceFile& file_;
    Json json_;
    bool binaryFile_ = false;
    std::optional<std::string_view> binary_;  // the first chunk of a GLB file after its JSON
    std::vector<std::optional<std::string_view>> buffers_;
    std::vector<std::unique_ptr<std::string>> owned_;  // buffers that are not part of the file's bytes
    std::map<std::size_t, std::string_view> decompressed_;
    std::size_t decompressedBytes_ = 0;
};

}  // namespace imomushi
