// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>

#include "core/commands/copied_parts.h"
#include "core/commands/core_commands.h"
#include "core/commands/part_copies.h"
#include "core/commands/take_copies.h"
#include "core/document/command_support.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

/// Room between a part and its copy beside it, of its width.
constexpr double kRoom = 0.1;

/// Beside all that is copied, along x.
Vec3 beside(const Document& document, const std::set<PartId>& elements, const std::set<PartId>& bones) {
    if (elements.empty()) {
        Vec3 least = Vec3::Constant(std::numeric_limits<double>::max()), most = -least;
        for (const PartId id : bones)
            for (const Bone::Place* place : {&document.bones.at(id)->start, &document.bones.at(id)->end})
                if (const auto at = restPosition(document, *place)) least = least.cwiseMin(*at), most = most.cwiseMax(*at);
        return (most.array() < least.array()).any() ? Vec3(Vec3::Zero()) : Vec3(besideBones(least, most), 0.0, 0.0);
    }
    double low = std::numeric_limits<double>::max(), high = -low;
    for (const PartId id : elements) {
        const Points& v = document.elements.at(id)->mesh->body.vertices;
        low = std::min(low, v.col(0).minCoeff());
        high = std::max(high, v.col(0).maxCoeff());
    }
    return Vec3((1.0 + kRoom) * (high - low), 0.0, 0.0);
}

Result<Json> duplicate(DocumentEdit& edit, const Json& arguments, const Progress&) {
    const Document from = edit.document;  // shares all parts
    CopiedParts wanted;
    for (const Json& given : arguments.at("names")) {
        if (!given.is_string()) return fail("bad-type", "\"names\" must be names.");
        const std::string& name = given.get_ref<const std::string&>();
        if (const CharacterSource* character = from.characterNamed(name)) {
            wanted.addCharacter(from, character->id);
        } else if (const Bone* bone = from.boneNamed(name)) {
            wanted.bones.insert(bone->id);
        } else {
            IMOMUSHI_TRY(const auto element, elementOf(from, name));
            wanted.addElement(from, *element);
        }
    }
    if (wanted.elements.empty() && wanted.bones.empty()) return fail("no-element", "There is nothing to duplicate: name elements, characters or bones.");
    wanted.addBones(from);
    PartCopier::Options options;
    const Json* offset = find(arguments, "offset");
    options.placing.shift = offset ? *vector3(*offset) : beside(from, wanted.elements, wanted.bones);
    if (auto ok = checkPlaces(from, wanted, options.placing, "offset"); !ok) return tl::unexpected(ok.error());
    options.response = lastResponses(edit);
    options.within = true;
    PartCopier copier(edit, from, options);
    copier.copyCharacters(wanted.characters, wanted.elements);
    copier.copyElements(wanted.elements, wanted.bones);
    copier.copyJoints();
    copier.copyBones(wanted.bones);
    findElements(edit.document, from, copier);
    IMOMUSHI_TRY(auto performing, performCopies(edit.document, from, copier));
    Json answer = copiesJson(copier);
    answer["takes"] = performing;
    answer["offset"] = json(options.placing.shift);
    return answer;
}

}  // namespace

void addDuplicateCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("duplicate",
                       "Copies elements, characters or bones with their joint faces, handles, cuts, joints among them, the bones through them, their pins and their effects. Results come "
                       "along, so that nothing is solved again, and in takes the copies do what the first ones do, beside them. Characters are copied with all of their elements; names get a number.",
                       {{"names", Type::Array, true, "Names of elements, characters or bones."},
                        {"offset", Type::Vector3, false, "Metres that the copies are shifted by (beside them, along x)."}},
                       duplicate);
}

}  // namespace imomushi
