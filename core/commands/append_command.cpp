// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "core/commands/copied_parts.h"
#include "core/commands/core_commands.h"
#include "core/commands/part_copies.h"
#include "core/document/command_support.h"
#include "core/document/names.h"
#include "core/project/project_file.h"
#include "core/session/document_edit.h"

namespace imomushi {

namespace {

/// Numbers of a motion x -> linear * x + shift of a body that stands elsewhere at rest and moves as before there.
void shift(double* at, const Eigen::Matrix3d& linear, const Vec3& offset) {
    Eigen::Map<Vec3> to(at);
    to += offset - linear * offset;
}

void moveTake(Take& take, const Vec3& offset) {
    FrameNumbers poses, shapes;
    std::vector<double> pose(take.poses.width()), shape(take.shapes.width());
    for (std::size_t f = 0; f < take.times.size(); ++f) {
        take.poses.at(f, pose.data());
        for (int p = 0; p < take.points; ++p) Eigen::Map<Vec3>(pose.data() + 3 * p) += offset;
        poses.add(pose);
        take.shapes.at(f, shape.data());
        for (std::size_t e = 0; e < take.layout.elements.size(); ++e) {
            double* at = shape.data() + take.layout.element(e);
            shift(at + 4, Eigen::Map<const Eigen::Quaterniond>(at).toRotationMatrix(), offset);
        }
        for (int j = 0; j < take.layout.joints; ++j) {
            double* at = shape.data() + take.layout.joint(j) + 4;
            shift(at + 9, Eigen::Map<const Eigen::Matrix3d>(at), offset);
        }
        shapes.add(shape);
    }
    poses.finish();
    shapes.finish();
    take.poses = std::move(poses);
    take.shapes = std::move(shapes);
    for (Take::Target& target : take.targets)
        if (target.held) target.to += offset;
}

/// Beside all that is there, along x, with a tenth of their width between.
Vec3 beside(const Document& here, const Document& there, const std::set<PartId>& wanted) {
    constexpr double kRoom = 0.1;
    double end = std::numeric_limits<double>::lowest(), low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (const auto& [id, element] : here.elements) end = std::max(end, element->mesh->body.vertices.col(0).maxCoeff());
    for (const PartId id : wanted) {
        const auto x = there.elements.at(id)->mesh->body.vertices.col(0);
        low = std::min(low, x.minCoeff());
        high = std::max(high, x.maxCoeff());
    }
    return here.elements.empty() ? Vec3(Vec3::Zero()) : Vec3(end + kRoom * (high - low) - low, 0.0, 0.0);
}

Result<Json> append(DocumentEdit& edit, const Json& arguments, const Progress&) {
    IMOMUSHI_TRY(const auto path, pathFrom(arguments));
    IMOMUSHI_TRY(const auto project, openProject(path));
    const Document& there = project.document;
    std::set<PartId> wanted;
    if (const Json* names = find(arguments, "elements")) {
        for (const Json& name : *names) {
            if (!name.is_string()) return fail("bad-type", "\"elements\" must be names.");
            IMOMUSHI_TRY(const auto element, elementOf(there, name.get_ref<const std::string&>()));
            wanted.insert(element->id);
        }
    } else {
        for (const auto& [id, element] : there.elements) wanted.insert(id);
    }
    // Characters come whole: what is seen of one follows all of its elements.
    for (const auto& [id, element] : there.elements)
        if (wanted.contains(id) && element->piece)
            for (const PartId piece : there.elementsOf(element->piece->character)) wanted.insert(piece);
    if (wanted.empty()) return fail("no-element", "There is nothing to append: the other project has no elements, or none was named.");

    Vec3 offset = Vec3::Zero();
    const Json* given = find(arguments, "offset");
    const bool placedBeside = arguments.value("beside", false);
    if (given && placedBeside) return fail("bad-value", "Give either \"offset\" or \"beside\".");
    if (given) offset = *vector3(*given);
    if (placedBeside) offset = beside(edit.document, there, wanted);

    CopiedParts parts;
    parts.elements = wanted;
    for (const auto& [id, character] : there.characters)
        if (wanted.contains(there.elementsOf(id).front())) parts.characters.insert(id);
    for (const auto& [id, bone] : there.bones)
        if (wanted.size() == there.elements.size() || wanted.contains(bone->element)) parts.bones.insert(id);
    PartCopier::Options options;
    options.placing.shift = offset;
    if (auto ok = checkPlaces(there, parts, options.placing, placedBeside ? "beside" : "offset"); !ok) return tl::unexpected(ok.error());
    options.response = [&](PartId id) {
        const auto known = project.responses.find(id);
        return known == project.responses.end() ? nullptr : &known->second;
    };
    PartCopier copier(edit, there, options);
    copier.copyCharacters(parts.characters, wanted);
    copier.copyElements(wanted, parts.bones);
    copier.copyJoints();
    copier.copyBones(parts.bones);

    Document& here = edit.document;
    Json answer{{"offset", json(offset)}, {"elements", Json::array()}, {"bones", Json::array()}, {"handles", Json::array()}, {"takes", Json::array()}, {"renamed", Json::array()}};
    const auto tell = [&](const char* list, const std::string& name, const std::string& wish) {
        if (list) answer[list].push_back(name);
        if (name != wish) answer["renamed"].push_back({{"from", wish}, {"to", name}});
    };
    for (const auto& [name, wish] : copier.characters) tell(nullptr, name, wish);
    for (const auto& [name, wish] : copier.cuts) tell(nullptr, name, wish);
    for (const auto& [name, wish] : copier.elements) tell("elements", name, wish);
    for (const auto& [name, wish] : copier.handles) tell("handles", name, wish);
    for (const auto& [name, wish] : copier.bones) tell("bones", name, wish);
    for (const auto& [id, take] : there.takes) {
        if (wanted.size() != there.elements.size()) break;
        Take made = *take;
        made.id = copier.idOf(id);
        made.name = freeTakeName(here, take->name);
        for (Take::Bone& bone : made.bones) bone.bone = copier.idOf(bone.bone);
        for (PartId& element : made.elements) element = copier.idOf(element);
        for (Take::Target& target : made.targets) target.bone = copier.idOf(target.bone);
        if (offset != Vec3::Zero()) moveTake(made, offset);
        tell("takes", made.name, take->name);
        here.takes.emplace(made.id, std::make_shared<const Take>(std::move(made)));
    }
    return answer;
}

}  // namespace

void addAppendCommand(CommandRegistry& registry) {
    using Type = CommandKey::Type;
    registry.addChange("append",
                       "Adds the elements of another project, with their joint faces, joints, bones and results, where they are there or beside that. Names that are "
                       "taken get a number, which is told. Characters come with all of their elements. Whole projects bring their takes, which show their poses.",
                       {{"path", Type::Text, true, "A .imomushi file."},
                        {"offset", Type::Vector3, false, "Metres that they are shifted by, with their bones and takes ([0,0,0])."},
                        {"beside", Type::Boolean, false, "Beside what is there, along x, instead (false)."},
                        {"elements", Type::Array, false, "Names of these elements alone, with the bones through them (all unless given)."}},
                       append);
}

}  // namespace imomushi
