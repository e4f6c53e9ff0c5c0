// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>

#include "core/base/plane.h"
#include "core/base/try.h"
#include "core/document/command.h"
#include "core/document/document.h"
#include "core/mesh/bounds.h"

namespace imomushi {

/// Whole numbers beyond this are refused: they all fit an int.
inline constexpr std::int64_t kLargestInteger = 1'000'000'000;

/// "a text", "three numbers [x,y,z]", ...
std::string_view typeText(CommandKey::Type type);

/// [x,y,z] of finite numbers within kMaxCoordinate.
inline std::optional<Vec3> vector3(const Json& value) {
    if (!value.is_array() || value.size() != 3) return std::nullopt;
    Vec3 v;
    for (int i = 0; i < 3; ++i) {
        if (!value[static_cast<std::size_t>(i)].is_number()) return std::nullopt;
        v[i] = value[static_cast<std::size_t>(i)].get<double>();
        if (!(std::abs(v[i]) <= kMaxCoordinate)) return std::nullopt;
    }
    return v;
}

inline Json json(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// The value of an optional key.
inline const Json* find(const Json& arguments, const char* key) {
    const auto found = arguments.find(key);
    return found == arguments.end() ? nullptr : &*found;
}

inline const std::string& text(const Json& arguments, const char* key) { return arguments.at(key).get_ref<const std::string&>(); }

/// An integer key, already checked.
inline int integer(const Json& value) { return static_cast<int>(value.get<double>()); }

/// A number within [low, high]. Errors: "bad-value".
Result<double> numberWithin(const Json& value, std::string_view name, double low, double high);

/// Gives `to` what was found, or answers the error.
template <class To, class Found>
Result<void> assign(To& to, Result<Found> found) {
    IMOMUSHI_TRY(to, std::move(found));
    return {};
}

/// numberWithin() of a key that may be left out: `to` stays then.
template <class To>
Result<void> readNumber(const Json& arguments, const char* key, double low, double high, To& to) {
    const Json* given = find(arguments, key);
    return given ? assign(to, numberWithin(*given, key, low, high)) : Result<void>();
}

/// The text of the key "path". Errors: "bad-value".
Result<std::filesystem::path> pathFrom(const Json& arguments);

/// {"origin": [x,y,z], "normal": [x,y,z]}. Errors: "unknown-key", "missing-key", "bad-type", "bad-value".
Result<Plane> planeFrom(const Json& value);

/// Where a command is to write, checked before its work rather than after: the text of a key, with one of these endings (".svg") and in a folder that is there; empty
/// without the key. Errors: "bad-value", "unknown-format", "not-writable".
Result<std::filesystem::path> outputPath(const Json& arguments, const char* key, std::initializer_list<std::string_view> endings);

/// The element or bone of that name. Errors: "no-such-element", "no-such-bone" with the names there are.
Result<std::shared_ptr<const Element>> elementOf(const Document& document, std::string_view name);
Result<std::shared_ptr<const Bone>> boneOf(const Document& document, std::string_view name);

/// The character of that name. Errors: "no-such-character" with the names there are.
Result<std::shared_ptr<const CharacterSource>> characterOf(const Document& document, std::string_view name);
/// The handle of that name, or "element/handle". Errors: "no-such-handle" with the names there are.
Result<FaceRef> handleNamed(const Document& document, std::string_view name);
/// Removes a joint face, or a handle, from everything that knows it; bones that ended at it stay where they are.
void removeFace(Document& document, const FaceRef& face);

/// A joint face that is there.
const JointFace& faceOf(const Document& document, const FaceRef& ref);
/// {"origin", "x", "y", "z"}.
Json json(const FaceFrame& frame);

/// The element that a bone runs through when nobody says: the one that has faces at both ends, or that holds the middle of the bone, or
/// whose face it ends or starts at; 0: none.
PartId elementThrough(const Document& document, const Bone& bone);

/// The take of that name. Errors: "no-such-take" with the names there are.
Result<std::shared_ptr<const Take>> takeOf(const Document& document, std::string_view name);

/// Median, 99th percentile and maximum, by nearest rank.
Json summary(std::vector<double> values);

/// How a script writes a place: "element/face", "bone/end" or [x,y,z].
Json placeJson(const Document& document, const Bone::Place& place);

/// What "open" and others say of characters; of all, or of one.
Json charactersJson(const Document& document);
Json characterJson(const Document& document, const CharacterSource& character);
/// {"skeleton": [bones], "clips": [...]}; empty lists of null.
Json rigJson(const Rig* rig);
/// What was found on a mesh, without its places.
Json issueJson(const MeshIssue& issue);
/// Morph targets: name, weight, weight at rest.
Json morphsJson(const Document& document, const CharacterSource& character);
/// What a VRM file says of its figure: version, licence {field: text}, expressions [{name, morphs}], springs, first_person, look_at. The rig has an avatar.
Json avatarJson(const Rig& rig);
/// A body and how it was made.
Json bodyJson(const Body& body);

/// [x,y,z,w] of any length, as a unit quaternion; `name`: of the key. Errors: "bad-type", "bad-value".
Result<Eigen::Quaterniond> rotationFrom(const Json& value, std::string_view name);

/// Replaces a part by a changed copy: exchangePart(document.elements, id, [&](Element& e) { e.nu = nu; }).
template <class Parts, class Change>
void exchangePart(Parts& parts, PartId id, Change&& change) {
    auto& part = parts.at(id);
    auto copy = std::make_shared<std::remove_const_t<typename Parts::mapped_type::element_type>>(*part);
    change(*copy);
    part = std::move(copy);
}

}  // namespace imomushi
