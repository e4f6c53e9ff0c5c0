// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/command_support.h"

#include <algorithm>

#include "core/base/formatted.h"
#include "core/document/names.h"

namespace imomushi {

namespace {

template <class Parts>
Result<typename Parts::mapped_type> partNamed(const Parts& parts, std::string_view name, const char* code, const char* kind) {
    std::vector<std::string> names;
    for (const auto& [id, part] : parts) {
        if (part->name == name) return part;
        names.push_back(part->name);
    }
    return fail(code, std::string("There is no ") + kind + " \"" + std::string(name) + "\"; " + listNames(names) + ".");
}

}  // namespace

Result<double> numberWithin(const Json& value, std::string_view name, double low, double high) {
    if (!value.is_number()) return fail("bad-type", "\"" + std::string(name) + "\" must be a number.");
    const double number = value.get<double>();
    if (!(number >= low && number <= high))
        return fail("bad-value", "\"" + std::string(name) + "\" must lie within " + formatted("%g and %g, not %g.", low, high, number));
    return number;
}

Result<Eigen::Quaterniond> rotationFrom(const Json& value, std::string_view name) {
    /// A quaternion shorter than this has no direction that rounding leaves it.
    constexpr double kShortestQuaternion = 1e-6;
    const std::string key = "\"" + std::string(name) + "\"";
    const auto bad = [&key] { return fail("bad-type", key + " must be a quaternion [x,y,z,w], the turn from rest."); };
    if (!value.is_array() || value.size() != 4) return bad();
    Eigen::Quaterniond turn;
    for (std::size_t i = 0; i < 4; ++i) {
        if (!value[i].is_number()) return bad();
        const double x = value[i].get<double>();
        if (!(std::abs(x) <= kMaxCoordinate)) return bad();
        turn.coeffs()[static_cast<Eigen::Index>(i)] = x;
    }
    if (!(turn.norm() >= kShortestQuaternion)) return fail("bad-value", key + " is zero: no turn is [0,0,0,1].");
    return turn.normalized();
}

Result<std::filesystem::path> pathFrom(const Json& arguments) {
    const std::string& path = text(arguments, "path");
    if (path.empty() || path.find('\0') != std::string::npos) return fail("bad-value", "\"path\" is empty or holds a zero byte.");
    return std::filesystem::path(path);
}

Result<Plane> planeFrom(const Json& value) {
    for (const auto& item : value.items())
        if (item.key() != "origin" && item.key() != "normal")
            return fail("unknown-key", "\"plane\" has no key \"" + item.key() + "\"; it has origin and normal.");
    const Json* origin = find(value, "origin");
    const Json* normal = find(value, "normal");
    if (!origin || !normal) return fail("missing-key", "\"plane\" needs origin and normal.");
    const auto o = vector3(*origin), n = vector3(*normal);
    if (!o || !n) return fail("bad-type", "\"origin\" and \"normal\" of \"plane\" must be three numbers, each within 1e9.");
    return Plane::through(*o, *n);
}

Result<std::filesystem::path> outputPath(const Json& arguments, const char* key, std::initializer_list<std::string_view> endings) {
    const Json* given = find(arguments, key);
    if (!given) return std::filesystem::path();
    const auto& name = given->get_ref<const std::string&>();
    const std::string quoted = std::string("\"") + key + "\"";
    if (name.empty() || name.find('\0') != std::string::npos) return fail("bad-value", quoted + " is empty or holds a zero byte.");
    const std::filesystem::path path(name);
    if (std::find(endings.begin(), endings.end(), path.extension().string()) == endings.end()) {
        std::string known;
        for (const auto& ending : endings) known += (known.empty() ? "" : &ending == endings.end() - 1 ? " or " : ", ") + std::string(ending);
        return fail("unknown-format", quoted + " must end in " + known + ".");
    }
    const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) return fail("not-writable", "There is no folder \"" + folder.string() + "\": choose one that is there.");
    return path;
}

Result<std::shared_ptr<const Element>> elementOf(const Document& document, std::string_view name) {
    return partNamed(document.elements, name, "no-such-element", "element");
}

Result<std::shared_ptr<const Bone>> boneOf(const Document& document, std::string_view name) {
    return partNamed(document.bones, name, "no-such-bone", "bone");
}

Result<std::shared_ptr<const CharacterSource>> characterOf(const Document& document, std::string_view name) {
    return partNamed(document.characters, name, "no-such-character", "character");
}

Result<FaceRef> handleNamed(const Document& document, std::string_view name) {
    if (const auto handle = document.handle(name)) return *handle;
    std::vector<std::string> names;
    for (const auto& [id, element] : document.elements)
        for (const Handle& handle : element->handles) names.push_back(handle.face);
    return fail("no-such-handle", "There is no handle \"" + std::string(name) + "\"; " + listNames(names) + ".");
}

const JointFace& faceOf(const Document& document, const FaceRef& ref) {
    const Element& element = *document.elements.at(ref.element);
    return element.faces[static_cast<std::size_t>(element.faceIndex(ref.face))];
}

Json json(const FaceFrame& frame) {
    return Json{{"origin", json(frame.origin)}, {"x", json(frame.axes.col(0))}, {"y", json(frame.axes.col(1))}, {"z", json(frame.axes.col(2))}};
}

Result<std::shared_ptr<const Take>> takeOf(const Document& document, std::string_view name) {
    return partNamed(document.takes, name, "no-such-take", "take");
}

Json summary(std::vector<double> values) {
    if (values.empty()) values.push_back(0.0);
    std::sort(values.begin(), values.end());
    const auto rank = [&](double part) {
        const auto n = static_cast<std::size_t>(std::ceil(part * static_cast<double>(values.size())));
        return values[std::clamp<std::size_t>(n, 1, values.size()) - 1];
    };
    Json out{{"median", rank(0.5)}, {"p99", rank(0.99)}};
    if (values.size() >= 1000) out["p999"] = rank(0.999);
    out["max"] = values.back();
    return out;
}

Json placeJson(const Document& document, const Bone::Place& place) {
    if (const auto* face = std::get_if<FaceRef>(&place)) return faceText(document, *face);
    if (const auto* end = std::get_if<EndpointRef>(&place)) return endpointText(document, *end);
    return json(std::get<Vec3>(place));
}

}  // namespace imomushi
