// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/io/bytes.h"
#include "tests/support/folder.h"

namespace imomushi::io_test {

/// A GLB file that is made piece by piece: accessors here, nodes and meshes in `json` as the test wants them.
class Glb {
public:
    nlohmann::json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"buffers", nlohmann::json::array()}, {"bufferViews", nlohmann::json::array()}, {"accessors", nlohmann::json::array()}};

    /// The number of a new accessor. `type`: "VEC3", ...; `width`: of that type.
    int floats(const std::vector<float>& values, const char* type, std::size_t width) { return add(values, 5126, type, width); }
    int bytes(const std::vector<std::uint8_t>& values, const char* type, std::size_t width) { return add(values, 5121, type, width); }
    int indices(const std::vector<std::uint16_t>& values) { return add(values, 5123, "SCALAR", 1); }

    [[nodiscard]] std::string file() const {
        nlohmann::json whole = json;
        whole["buffers"] = {{{"byteLength", buffer_.size()}}};
        std::string text = whole.dump();
        while (text.size() % 4) text += ' ';
        std::string glb = "glTF";
        put(glb, std::uint32_t{2});
        put(glb, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + buffer_.size()));
        put(glb, static_cast<std::uint32_t>(text.size()));
        put(glb, std::uint32_t{0x4E4F534A});
        glb += text;
        put(glb, static_cast<std::uint32_t>(buffer_.size()));
        put(glb, std::uint32_t{0x004E4942});
        return glb + buffer_;
    }

private:
    template <class T>
    int add(const std::vector<T>& values, int component, const char* type, std::size_t width) {
        const std::size_t offset = buffer_.size();
        for (const T& v : values) put(buffer_, v);
        json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", buffer_.size() - offset}});
        while (buffer_.size() % 4) buffer_ += '\0';
        json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1}, {"componentType", component}, {"count", values.size() / width}, {"type", type}});
        return static_cast<int>(json["accessors"].size()) - 1;
    }

    std::string buffer_;
};

/// A GLB file with what `change` does to its JSON.
inline std::string changedGlb(const std::filesystem::path& path, const std::function<void(nlohmann::json&)>& change) {
    const std::string bytes = readFile(path);
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    auto json = nlohmann::json::parse(bytes.substr(20, length));
    change(json);
    std::string text = json.dump();
    while (text.size() % 4) text += ' ';
    const std::string rest = bytes.substr(20 + length);
    std::string out = "glTF";
    put(out, std::uint32_t{2});
    put(out, static_cast<std::uint32_t>(20 + text.size() + rest.size()));
    put(out, static_cast<std::uint32_t>(text.size()));
    put(out, std::uint32_t{0x4E4F534A});
    return out + text + rest;
}

}  // namespace imomushi::io_test
