// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/mesh/mesh.h"
#include "tests/support/folder.h"

namespace imomushi {

/// A .glb file read as plainly as can be, without anything of the program's own reader: what another program sees of it at a key of a clip.
class ReadGlb {
public:
    using Json = nlohmann::json;

    explicit ReadGlb(const std::filesystem::path& path) : bytes_(readFile(path)) {
        std::uint32_t length = 0;
        std::memcpy(&length, bytes_.data() + 12, 4);
        root = Json::parse(bytes_.substr(20, length));
        binary_ = 20 + length + 8;
    }

    /// Numbers of an accessor, item by item, whole ones as the format says.
    [[nodiscard]] std::vector<double> numbers(const Json& index) const {
        const Json& a = root["accessors"][index.get<std::size_t>()];
        const std::size_t width = widthOf(a), count = a["count"].get<std::size_t>();
        std::vector<double> out(width * count, 0.0);
        if (a.contains("bufferView")) {
            const Json& view = root["bufferViews"][a["bufferView"].get<std::size_t>()];
            const std::size_t stride = view.value("byteStride", width * sizeOf(a));
            for (std::size_t i = 0; i < out.size(); ++i) out[i] = number(a, start(a["bufferView"], a) + i / width * stride + i % width * sizeOf(a));
        }
        if (a.contains("sparse")) {
            const Json &sparse = a["sparse"], &items = sparse["indices"], &values = sparse["values"];
            for (std::size_t i = 0; i < width * sparse["count"].get<std::size_t>(); ++i) {
                const auto item = static_cast<std::size_t>(number(items, start(items["bufferView"], items) + i / width * sizeOf(items)));
                out[width * item + i % width] = number(a, start(values["bufferView"], values) + i * sizeOf(a));
            }
        }
        return out;
    }

    /// -1: there is none.
    [[nodiscard]] int nodeNamed(const std::string& name, bool withMesh = false) const {
        for (std::size_t n = 0; n < root["nodes"].size(); ++n)
            if (root["nodes"][n]["name"] == name && (!withMesh || root["nodes"][n].contains("mesh"))) return static_cast<int>(n);
        return -1;
    }
    [[nodiscard]] const Json& meshOf(int node) const { return root["meshes"][root["nodes"][static_cast<std::size_t>(node)]["mesh"].get<std::size_t>()]; }
    /// Of a primitive.
    [[nodiscard]] std::vector<double> attribute(int node, const char* name, std::size_t primitive = 0) const { return numbers(meshOf(node)["primitives"][primitive]["attributes"][name]); }

    /// Times of the keys of a node's weights in a clip; of its first joint, where it has no weights.
    [[nodiscard]] std::vector<double> times(int node, std::size_t clip) const {
        for (const Json& channel : root["animations"][clip]["channels"])
            if (channel["target"]["node"] == node || channel["target"]["node"] == root["skins"][0]["joints"][0])
                return numbers(root["animations"][clip]["samplers"][channel["sampler"].get<std::size_t>()]["input"]);
        return {};
    }

    /// Where the vertices of a primitive of a skinned node are at a time, m.
    [[nodiscard]] Points positions(int node, std::size_t clip, double time, std::size_t which = 0) const {
        const Json& primitive = meshOf(node)["primitives"][which];
        std::vector<double> at = attribute(node, "POSITION", which);
        if (primitive.contains("targets")) {
            const std::vector<double> weights = sampled(clip, node, "weights", time);
            for (std::size_t t = 0; t < primitive["targets"].size(); ++t) {
                const std::vector<double> moved = numbers(primitive["targets"][t]["POSITION"]);
                for (std::size_t i = 0; i < at.size(); ++i) at[i] += weights.at(t) * moved.at(i);
            }
        }
        const Json& skin = root["skins"][0];
        const std::vector<double> inverse = numbers(skin["inverseBindMatrices"]), joints = attribute(node, "JOINTS_0", which), shares = attribute(node, "WEIGHTS_0", which);
        std::vector<Eigen::Affine3d> moved;
        for (std::size_t j = 0; j < skin["joints"].size(); ++j) {
            const int joint = skin["joints"][j];
            const std::vector<double> q = sampled(clip, joint, "rotation", time), t = sampled(clip, joint, "translation", time);
            Eigen::Affine3d placed = Eigen::Affine3d::Identity();
            placed.linear() = Eigen::Quaterniond(q.data()).normalized().toRotationMatrix();
            placed.translation() = Eigen::Map<const Vec3>(t.data());
            moved.push_back(placed * Eigen::Affine3d(Eigen::Map<const Eigen::Matrix4d>(inverse.data() + 16 * j)));
        }
        Points out(static_cast<Eigen::Index>(at.size() / 3), 3);
        for (Eigen::Index v = 0; v < out.rows(); ++v) {
            Vec3 sum = Vec3::Zero();
            for (std::size_t k = 0; k < 4; ++k)
                sum += shares[4 * static_cast<std::size_t>(v) + k] * (moved[static_cast<std::size_t>(joints[4 * static_cast<std::size_t>(v) + k])] * Vec3(Eigen::Map<const Vec3>(at.data() + 3 * v)));
            out.row(v) = sum.transpose();
        }
        return out;
    }

    Json root;

private:
    [[nodiscard]] static std::size_t widthOf(const Json& a) {
        const std::string type = a["type"];
        return type == "SCALAR" ? 1 : type == "MAT4" ? 16 : static_cast<std::size_t>(type[3] - '0');
    }
    [[nodiscard]] static std::size_t sizeOf(const Json& a) {
        const int type = a["componentType"];
        return type < 5122 ? 1 : type < 5124 ? 2 : 4;
    }
    [[nodiscard]] std::size_t start(const Json& view, const Json& a) const {
        return binary_ + root["bufferViews"][view.get<std::size_t>()].value("byteOffset", std::size_t{0}) + a.value("byteOffset", std::size_t{0});
    }
    template <class T>
    [[nodiscard]] double as(std::size_t at) const {
        T out{};
        std::memcpy(&out, bytes_.data() + at, sizeof out);
        return static_cast<double>(out);
    }
    [[nodiscard]] double number(const Json& a, std::size_t at) const {
        const bool share = a.value("normalized", false);
        switch (a["componentType"].get<int>()) {
            case 5120: return as<std::int8_t>(at) / (share ? 127.0 : 1.0);
            case 5121: return as<std::uint8_t>(at) / (share ? 255.0 : 1.0);
            case 5122: return as<std::int16_t>(at) / (share ? 32767.0 : 1.0);
            case 5123: return as<std::uint16_t>(at) / (share ? 65535.0 : 1.0);
            case 5125: return as<std::uint32_t>(at);
            default: return as<float>(at);
        }
    }
    /// At the key next to a time; as in the node, where nothing moves it.
    [[nodiscard]] std::vector<double> sampled(std::size_t clip, int node, const char* path, double time) const {
        for (const Json& channel : root["animations"][clip]["channels"]) {
            if (channel["target"]["node"] != node || channel["target"]["path"] != path) continue;
            const Json& sampler = root["animations"][clip]["samplers"][channel["sampler"].get<std::size_t>()];
            const std::vector<double> times = numbers(sampler["input"]), values = numbers(sampler["output"]);
            std::size_t key = 0;
            for (std::size_t k = 1; k < times.size(); ++k)
                if (std::abs(times[k] - time) < std::abs(times[key] - time)) key = k;
            const std::size_t width = values.size() / times.size();
            return {values.begin() + static_cast<std::ptrdiff_t>(key * width), values.begin() + static_cast<std::ptrdiff_t>((key + 1) * width)};
        }
        const Json& at = root["nodes"][static_cast<std::size_t>(node)];
        if (std::string(path) == "weights") return std::vector<double>(meshOf(node).value("weights", Json::array()).size(), 0.0);
        return at.value(path, std::string(path) == "rotation" ? std::vector<double>{0, 0, 0, 1} : std::vector<double>{0, 0, 0});
    }

    std::string bytes_;
    std::size_t binary_ = 0;
};

}  // namespace imomushi
