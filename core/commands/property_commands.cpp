// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <optional>

#include "core/base/colour.h"
#include "core/commands/core_commands.h"
#include "core/commands/effect_commands.h"
#include "core/commands/handle_commands.h"
#include "core/document/command_support.h"
#include "core/document/face_references.h"
#include "core/document/input_mapping.h"
#include "core/document/material_preset.h"
#include "core/document/names.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

constexpr double kSmallestRatio = 1e-6, kLargestRatio = 1e6;  // relative stiffness: beyond, joints of both kinds lose all digits
constexpr double kSmallestDensity = 1e-3, kLargestDensity = 1e6;  // kg/m^3: from a near vacuum to more than any matter
constexpr int kMaxThreads = 1024;

Result<Eigen::Vector3f> colour(const Json& value) {
    const auto bad = [] { return fail("bad-value", "\"color\" must be \"#rrggbb\" with six hexadecimal digits."); };
    if (!value.is_string()) return bad();
    const std::string& text = value.get_ref<const std::string&>();
    if (text.size() != 7 || text[0] != '#' || text.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos) return bad();
    Eigen::Vector3f rgb;
    for (int i = 0; i < 3; ++i) rgb[i] = linearFromSrgb(std::stoi(text.substr(static_cast<std::size_t>(1 + 2 * i), 2), nullptr, 16) / 255.0);
    return rgb;
}

Result<bool> boolean(const Json& value, const std::string& property) {
    if (!value.is_boolean()) return fail("bad-type", "\"" + property + "\" must be true or false.");
    return value.get<bool>();
}

Result<std::string> word(const Json& value, const std::string& property) {
    if (!value.is_string()) return fail("bad-type", "\"" + property + "\" must be a text.");
    return value.get<std::string>();
}

Result<void> noSuchProperty(const std::string& what, const std::string& property, const char* known) {
    return fail("no-such-property", what + " has no property \"" + property + "\"; it has " + known + ".");
}

/// "visible" or "locked" of a part; none: it is neither.
template <class Part>
std::optional<Result<void>> setShown(Part& part, const std::string& property, const Json& value) {
    if (property == "visible") return assign(part.visible, boolean(value, property));
    if (property == "locked") return assign(part.locked, boolean(value, property));
    return std::nullopt;
}

Result<void> setElement(Element& element, const std::string& property, const Json& value) {
    const auto number = [&](double& to, double low, double high) { return assign(to, numberWithin(value, property, low, high)); };
    if (property == "nu") return number(element.nu, 0.0, 0.5);
    if (property == "stiffness") return number(element.stiffness, kSmallestRatio, kLargestRatio);
    if (property == "density") return number(element.density, kSmallestDensity, kLargestDensity);
    if (property == "damping") return number(element.damping, 0.0, Element::kMaxDamping);
    if (property == "preset") {
        IMOMUSHI_TRY(const auto given, word(value, property));
        const MaterialPreset* preset = materialPreset(given);
        if (!preset) return fail("bad-value", "There is no preset \"" + given + "\"; there are " + materialPresetNames() + ".");
        preset->apply(element);
        return {};
    }
    if (auto shown = setShown(element, property, value)) return *shown;
    if (property == "color") return assign(element.color, colour(value));
    if (property == "joint-planes") {
        IMOMUSHI_TRY(const auto given, word(value, property));
        if (given == "auto")
            element.jointPlanes = Element::JointPlanes::Auto;
        else if (given == "bisector")
            element.jointPlanes = Element::JointPlanes::Bisector;
        else if (given == "element")
            element.jointPlanes = Element::JointPlanes::Element;
        else
            return fail("bad-value", "\"joint-planes\" must be \"auto\", \"bisector\" or \"element\".");
        return {};
    }
    if (property == "solver-mesh") return assign(element.solverMesh, word(value, property).and_then(parseSolverMesh));
    return noSuchProperty("An element", property, "preset, nu, stiffness, density, damping, solver-mesh, joint-planes, color, visible and locked");
}

Result<void> setBone(Bone& bone, const std::string& property, const Json& value) {
    const auto number = [&](double& to, double low, double high) { return assign(to, numberWithin(value, property, low, high)); };
    if (property == "min-stretch") return number(bone.minStretch, 0.01, 1.0);
    if (property == "max-stretch") return number(bone.maxStretch, 1.0, 100.0);
    if (property == "max-bend") return number(bone.maxBend, 0.0, Skeleton::Bone::kFreeBend);
    if (property == "max-twist") return number(bone.maxTwist, 0.0, Skeleton::Bone::kFreeTwist);
    if (property == "stiffness") return number(bone.stiffness, 1.0 / Bone::kMaxRatio, Bone::kMaxRatio);
    if (property == "weight") return number(bone.weight, 1.0 / Bone::kMaxRatio, Bone::kMaxRatio);
    if (property == "roll") return number(bone.roll, -1e6, 1e6);
    if (auto shown = setShown(bone, property, value)) return *shown;
    return noSuchProperty("A bone", property, "min-stretch, max-stretch, max-bend, max-twist, stiffness, weight, roll, visible and locked");
}

Result<void> setFace(Document& document, const FaceRef& ref, const std::string& property, const Json& value) {
    const bool handle = document.elements.at(ref.element)->handleOf(ref.face);
    if (handle && property != "visible" && property != "locked") return setHandleProperty(document, ref, property, value);
    Result<void> done = noSuchProperty("A joint face", property, "visible and locked");
    exchangePart(document.elements, ref.element, [&](Element& element) {
        if (auto shown = setShown(element.faces[static_cast<std::size_t>(element.faceIndex(ref.face))], property, value)) done = *shown;
    });
    return done;
}

Result<void> setCharacter(CharacterSettings& settings, const std::string& property, const Json& value) {
    if (property == "basis") return assign(settings.basis, word(value, property).and_then(parseBasis));
    if (property == "format") return assign(settings.format, word(value, property).and_then(responseFormat));
    if (property == "threads") {
        IMOMUSHI_TRY(const auto given, numberWithin(value, property, 0, kMaxThreads));
        if (given != std::floor(given)) return fail("bad-value", "\"threads\" must be a whole number (0: all of this machine).");
        settings.threads = static_cast<int>(given);
        return {};
    }
    if (property == "rate") {
        IMOMUSHI_TRY(const auto given, numberWithin(value, property, 1, 1000));
        if (std::ranges::find(CharacterSettings::kRates, given) == CharacterSettings::kRates.end()) return fail("bad-value", "\"rate\" must be 60, 120 or 240 steps per second.");
        settings.rate = static_cast<int>(given);
        return {};
    }
    if (property == "body-follows") return assign(settings.bodyFollows, numberWithin(value, property, 0.0, CharacterSettings::kMostFollow));
    return noSuchProperty("The character", property, "basis, format, threads, rate and body-follows");
}

Result<Json> set(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    const std::string& target = text(arguments, "target");
    const std::string& property = text(arguments, "property");
    const Json& value = arguments.at("value");
    Result<void> done;
    if (const auto effect = effectNamed(target)) {
        done = setEffect(document.effects, *effect, property, value);
    } else if (target == "character") {
        done = setCharacter(document.settings, property, value);
    } else if (const Element* element = document.elementNamed(target)) {
        exchangePart(document.elements, element->id, [&](Element& changed) { done = setElement(changed, property, value); });
    } else if (const Bone* bone = document.boneNamed(target)) {
        exchangePart(document.bones, bone->id, [&](Bone& changed) { done = setBone(changed, property, value); });
    } else if (const auto handle = document.handle(target)) {
        done = setFace(document, *handle, property, value);
    } else if (const auto face = document.face(target)) {
        done = setFace(document, *face, property, value);
    } else if (const CharacterSource* cuts = document.characterOfCut(target)) {
        done = noSuchProperty("A cut", property, "visible and locked");
        exchangePart(document.characters, cuts->id, [&](CharacterSource& changed) {
            if (auto shown = setShown(changed.cuts[static_cast<std::size_t>(changed.cutIndex(target))], property, value)) done = *shown;
        });
    } else {
        done = fail("no-such-target", "There is no element, bone, joint face, handle, cut or effect \"" + target + "\" to set; \"character\" has the settings of all.");
    }
    if (!done) return tl::unexpected(done.error());
    return Json::object();
}

void renameFace(Document& document, const FaceRef& face, const std::string& name) {
    if (document.elements.at(face.element)->handleOf(face.face)) renameMapped(document, "handle", face.face, name);
    renameHandle(document, face, name);
    exchangePart(document.elements, face.element, [&](Element& element) {
        element.faces[static_cast<std::size_t>(element.faceIndex(face.face))].name = name;
        if (CutSide* side = element.sideOf(face.face)) side->face = name;
    });
    replaceFace(document, face, {face.element, name});
}

Result<Json> rename(DocumentEdit& edit, const Json& arguments, const Progress&) {
    Document& document = edit.document;
    const std::string& target = text(arguments, "target");
    const std::string& name = text(arguments, "name");
    const auto handle = document.handle(target);
    if (handle || target.find('/') != std::string::npos) {
        IMOMUSHI_TRY(const auto face, handle ? Result<FaceRef>(*handle) : document.face(target));
        if (name == face.face) return Json::object();
        if (auto ok = handle ? checkNewName(document, name) : checkNameText(name); !ok) return tl::unexpected(ok.error());
        if (document.elements.at(face.element)->faceIndex(name) >= 0)
            return fail("name-taken", "The element has a joint face \"" + name + "\" already: choose another name.");
        renameFace(document, face, name);
        return Json::object();
    }
    const CharacterSource* ofCut = document.characterOfCut(target);
    if (name == target && (document.elementNamed(name) || document.boneNamed(name) || document.characterNamed(name) || ofCut)) return Json::object();
    if (auto ok = checkNewName(document, name); !ok) return tl::unexpected(ok.error());
    if (const Element* element = document.elementNamed(target)) {
        exchangePart(document.elements, element->id, [&](Element& changed) { changed.name = name; });
    } else if (const Bone* bone = document.boneNamed(target)) {
        exchangePart(document.bones, bone->id, [&](Bone& changed) { changed.name = name; });
        renameMapped(document, "bone", target, name);
    } else if (const CharacterSource* character = document.characterNamed(target)) {
        exchangePart(document.characters, character->id, [&](CharacterSource& changed) { changed.name = name; });
        renameMapped(document, "morph", target, name);
    } else if (ofCut) {
        exchangePart(document.characters, ofCut->id, [&](CharacterSource& changed) { changed.cuts[static_cast<std::size_t>(changed.cutIndex(target))].name = name; });
    } else {
        return fail("no-such-target", "There is no element, bone, character or cut \"" + target + "\" to rename.");
    }
    return Json::object();
}

}  // namespace

void addPropertyCommands(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("set",
                       "Sets a property. Element: preset (" + materialPresetNames() + ": sets the four numbers that follow), nu (0 to 0.5), stiffness (relative, 1e-6 to 1e6), density (kg/m^3), damping (0 to 100, times the ratio of joint-dynamics), solver-mesh (\"default\", \"best\", \"as-is\", \"refined:N\", \"decimated:N\", \"draft\", \"volume\", \"volume:N\"; N vertices; \"@T\" after it: the tolerance of solutions of more than 5000 nodes, 1e-6 to 0.01), "
                       "joint-planes (\"auto\", \"bisector\", \"element\": who turns the planes of its joints), color (\"#rrggbb\"). "
                       "All: visible (elements, bones, joint faces, handles and cuts: the viewport shows them), locked (the same: the viewport neither picks nor changes them). "
                       "Handle: radius (metres along the surface), point ([x,y,z] of the surface at rest, its middle), bone (\"bone/end\" that it hangs on, \"\": none). "
                       "Bone: min-stretch (0.01 to 1; a straight chain pushed along its axis squashes to .05 above it, then folds), max-stretch (1 to 100, of the rest length), max-bend (radians from rest against its parent, 0 to pi: no limit), max-twist (radians between its ends, 0 to 20 pi: no limit), "
                       "stiffness (0.001 to 1000, against stretch and bend, relative to other bones: the softer give way), weight (0.001 to 1000, times that of its flesh, in bone dynamics), roll (radians at rest). "
                       "Character: basis (\"paper\", \"affine\", \"modes:1\" to \"modes:36\", \"full\"), format (\"float\", \"half\", \"int16\"), threads (0: all), rate (60, 120 or 240: steps per second where it is performed), body-follows (0 to 10: how much the trunk keeps the direction of rest when a limb is dragged, so that the limb moves first; 0: not at all, 1: as a character that make-soft makes alive)." + effectsHelp(),
                       {{"target", Type::Text, true, "An element, a bone, a handle, \"element/face\", a cut, an effect, or \"character\"."},
                        {"property", Type::Text, true, "The name of the property."},
                        {"value", Type::Any, true, "Its value."}},
                       set);
    registry.addChange("rename",
                       "Gives an element, a bone, a handle, a joint face, a character or a cut another name.",
                       {{"target", Type::Text, true, "An element, a bone, a handle, a character, a cut, or \"element/face\"."},
                        {"name", Type::Text, true, "The new name; for a face without its element."}},
                       rename);
}

}  // namespace imomushi
