// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/gltf_file.h"

#include <algorithm>
#include <cmath>

namespace imomushi {

int GltfFile::add(const char* array, Json item) {
    Json& list = root[array];
    list.push_back(std::move(item));
    return static_cast<int>(list.size()) - 1;
}

int GltfFile::view(const void* bytes, std::size_t size, Target target, int stride) {
    binary_.resize((binary_.size() + 3) / 4 * 4, '\0');
    Json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", size}};
    if (stride > 0) view["byteStride"] = stride;
    if (target != Target::None) view["target"] = static_cast<int>(target);
    binary_.append(static_cast<const char*>(bytes), size);
    return add("bufferViews", std::move(view));
}

template <class T>
void GltfFile::addBounds(Json& item, const T* numbers, std::size_t count, int width, std::size_t step) {
    Json low = Json::array(), high = Json::array();
    for (int k = 0; k < width; ++k) {
        T least = numbers[k], most = numbers[k];
        for (std::size_t i = 1; i < count; ++i) {
            const T value = numbers[i * step + static_cast<std::size_t>(k)];
            least = std::min(least, value);
            most = std::max(most, value);
        }
        low.push_back(least);
        high.push_back(most);
    }
    item["min"] = std::move(low);
    item["max"] = std::move(high);
}

template <class T>
int GltfFile::describe(const T* numbers, std::size_t count, int width, int type, bool normalised, Target target, bool bounds, int stride) {
    static const char* const kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    const auto step = stride > 0 ? static_cast<std::size_t>(stride) / sizeof(T) : static_cast<std::size_t>(width);
    Json item{{"bufferView", view(numbers, count * step * sizeof(T), target, stride)}, {"componentType", type}, {"count", count}, {"type", width == 16 ? "MAT4" : kTypes[width]}};
    if (normalised) item["normalized"] = true;
    if (bounds) addBounds(item, numbers, count, width, step);
    return add("accessors", std::move(item));
}

int GltfFile::accessor(const std::vector<float>& numbers, int width, Target target, bool bounds) {
    return describe(numbers.data(), numbers.size() / static_cast<std::size_t>(width), width, kFloat, false, target, bounds, 0);
}

int GltfFile::quantised(const std::vector<float>& numbers, float unit, bool wide) {
    const std::size_t count = numbers.size() / 3;
    const auto whole = [&](std::size_t i, float most) { return std::clamp(std::round(numbers[i] / unit * most), -most, most); };
    if (wide) {
        std::vector<std::int16_t> out(4 * count, 0);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t k = 0; k < 3; ++k) out[4 * i + k] = static_cast<std::int16_t>(whole(3 * i + k, 32767.0f));
        return describe(out.data(), count, 3, kShort, true, Target::Vertices, true, 8);
    }
    std::vector<std::int8_t> out(4 * count, 0);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 3; ++k) out[4 * i + k] = static_cast<std::int8_t>(whole(3 * i + k, 127.0f));
    return describe(out.data(), count, 3, kByte, true, Target::Vertices, false, 4);
}

int GltfFile::mostlyZero(const std::vector<float>& numbers, float unit) {
    const std::size_t count = numbers.size() / 3;
    std::vector<std::uint32_t> items;
    for (std::size_t i = 0; i < count; ++i)
        if (numbers[3 * i] != 0.0f || numbers[3 * i + 1] != 0.0f || numbers[3 * i + 2] != 0.0f) items.push_back(static_cast<std::uint32_t>(i));
    if (items.empty()) items.push_back(0);
    // An index takes as much as a number.
    if (4 * items.size() > 3 * count) return unit > 0.0f ? quantised(numbers, unit, true) : accessor(numbers, 3, Target::Vertices, true);
    std::vector<float> values;
    std::vector<std::int16_t> whole;
    for (const std::uint32_t i : items)
        for (std::size_t k = 0; k < 3; ++k) {
            values.push_back(numbers[3 * i + k]);
            if (unit > 0.0f) whole.push_back(static_cast<std::int16_t>(std::clamp(std::round(numbers[3 * i + k] / unit * 32767.0f), -32767.0f, 32767.0f)));
        }
    Json item{{"componentType", unit > 0.0f ? kShort : kFloat}, {"count", count}, {"type", "VEC3"}};
    if (unit > 0.0f) item["normalized"] = true;
    // All that is not said is 0.
    values.resize(values.size() + 3, 0.0f);
    whole.resize(whole.size() + 3, 0);
    const std::size_t bounded = items.size() + (items.size() < count ? 1 : 0);
    if (unit > 0.0f)
        addBounds(item, whole.data(), bounded, 3, 3);
    else
        addBounds(item, values.data(), bounded, 3, 3);
    const int where = view(items.data(), 4 * items.size(), Target::None);
    const int what = unit > 0.0f ? view(whole.data(), 6 * items.size(), Target::None) : view(values.data(), 12 * items.size(), Target::None);
    item["sparse"] = {{"count", items.size()}, {"indices", {{"bufferView", where}, {"componentType", kUnsignedInt}}}, {"values", {{"bufferView", what}}}};
    return add("accessors", std::move(item));
}

int GltfFile::indices(const std::vector<std::uint32_t>& triangles, std::size_t vertices) {
    // 65535 restarts primitives.
    if (vertices > 65535) return describe(triangles.data(), triangles.size(), 1, kUnsignedInt, false, Target::Indices, false, 0);
    std::vector<std::uint16_t> small(triangles.begin(), triangles.end());
    return describe(small.data(), small.size(), 1, kUnsignedShort, false, Target::Indices, false, 0);
}

int GltfFile::joints(const std::vector<std::uint16_t>& numbers, bool narrow) {
    if (narrow) {
        const std::vector<std::uint8_t> small(numbers.begin(), numbers.end());
        return describe(small.data(), small.size() / 4, 4, kUnsignedByte, false, Target::Vertices, false, 0);
    }
    return describe(numbers.data(), numbers.size() / 4, 4, kUnsignedShort, false, Target::Vertices, false, 0);
}

int GltfFile::quantisedWeights(const std::vector<float>& numbers) {
    constexpr int kOne = 65535;
    std::vector<std::uint16_t> out(numbers.size());
    for (std::size_t i = 0; i < out.size(); i += 4) {
        // The largest takes what rounding leaves over.
        std::size_t largest = i;
        int left = kOne;
        for (std::size_t k = i; k < i + 4; ++k) {
            out[k] = static_cast<std::uint16_t>(std::clamp(std::lround(numbers[k] * static_cast<float>(kOne)), 0L, static_cast<long>(kOne)));
            left -= out[k];
            if (numbers[k] > numbers[largest]) largest = k;
        }
        out[largest] = static_cast<std::uint16_t>(out[largest] + left);
    }
    return describe(out.data(), out.size() / 4, 4, kUnsignedShort, true, Target::Vertices, false, 0);
}

std::string GltfFile::glb(std::string binary, std::size_t unpacked) {
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    root["buffers"] = Json::array({{{"byteLength", binary.size()}}});
    if (unpacked > 0) root["buffers"].push_back({{"byteLength", unpacked}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
    std::string text = root.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::size_t whole = 12 + 8 + text.size() + 8 + binary.size();
    if (whole > 0xffffffffu) return {};
    std::string out;
    out.reserve(whole);
    const auto put = [&](std::size_t number) {
        const auto value = static_cast<std::uint32_t>(number);
        for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<char>(value >> shift & 0xff));
    };
    put(0x46546C67);
    put(2);
    put(whole);
    put(text.size());
    put(0x4E4F534A);
    out += text;
    put(binary.size());
    put(0x004E4942);
    out += binary;
    return out;
}

}  // namespace imomushi
