// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/attachments.h"

#include <algorithm>

#include "core/document/command_support.h"
#include "core/mesh/bounds.h"

namespace imomushi {

namespace {

Json partJson(const Document& document, const CharacterSource& character, const ModelPart& part) {
    const ModelParts& parts = character.model->namedParts();
    Json line;
    if (part.shell < 0) line["name"] = character.model->parts[static_cast<std::size_t>(part.part)];
    line["vertices"] = parts.verticesOf(part).size();
    line["part"] = parts.nameOf(part);
    const auto own = character.attachments.find(part);
    const Attachment* attachment = own == character.attachments.end() ? nullptr : &own->second;
    line["mode"] = nameOf(attachment);
    if (attachment && document.elements.contains(attachment->element)) line["element"] = document.elements.at(attachment->element)->name;
    if (!isRigid(character, part)) return line;
    line["pivot"] = json(pivotOf(character, part));
    const auto turn = document.turns.find({character.id, part});
    const Eigen::Quaterniond target = turn == document.turns.end() ? Eigen::Quaterniond::Identity() : turn->second.target;
    line["rotation"] = Json::array({target.x(), target.y(), target.z(), target.w()});
    return line;
}

}  // namespace

std::string_view nameOf(const Attachment* attachment) { return !attachment ? "auto" : attachment->mode == Attachment::Mode::Rigid ? "rigid" : "flesh"; }

std::vector<std::int32_t> attachedVertices(const CharacterSource& character, const ModelPart& part) {
    const ModelParts& parts = character.model->namedParts();
    std::vector<std::int32_t> vertices = parts.verticesOf(part);
    if (part.shell >= 0) return vertices;
    std::vector<std::int32_t> others;
    for (auto own = character.attachments.upper_bound(part); own != character.attachments.end() && own->first.part == part.part; ++own) {
        const auto& shell = parts.verticesOf(own->first);
        others.insert(others.end(), shell.begin(), shell.end());
    }
    std::sort(others.begin(), others.end());
    std::erase_if(vertices, [&others](std::int32_t v) { return std::binary_search(others.begin(), others.end(), v); });
    return vertices;
}

Vec3 pivotOf(const CharacterSource& character, const ModelPart& part) {
    const auto own = character.attachments.find(part);
    if (own != character.attachments.end() && own->second.pivot) return *own->second.pivot;
    const Points& model = character.model->mesh.body.vertices;
    const auto vertices = attachedVertices(character, part);
    if (vertices.empty()) return Vec3::Zero();
    Vec3 low = model.row(vertices.front()), high = low;
    for (const std::int32_t v : vertices) {
        low = low.cwiseMin(model.row(v).transpose());
        high = high.cwiseMax(model.row(v).transpose());
    }
    return low + 0.5 * (high - low);
}

Result<ModelPart> modelPartNamed(const CharacterSource& character, std::string_view name) {
    constexpr std::size_t kNamesTold = 20;
    const ModelParts& parts = character.model->namedParts();
    if (const auto found = parts.find(name)) return *found;
    std::string known;
    std::size_t count = 0;
    for (std::int32_t p = 0; p < static_cast<std::int32_t>(parts.parts.size()); ++p)
        for (std::int32_t s = -1; s < static_cast<std::int32_t>(parts.parts[static_cast<std::size_t>(p)].shells.size()); ++s, ++count)
            if (count < kNamesTold) known += (known.empty() ? "\"" : ", \"") + parts.nameOf({p, s}) + "\"";
    if (count > kNamesTold) known += ", ... (" + std::to_string(count) + " in all)";
    return fail("no-such-part", "The character \"" + character.name + "\" has no part \"" + std::string(name) + "\"; it has " + known + ".");
}

bool isRigid(const CharacterSource& character, const ModelPart& part) {
    const auto own = character.attachments.find(part);
    return own != character.attachments.end() && own->second.mode == Attachment::Mode::Rigid && !attachedVertices(character, part).empty();
}

Json partsJson(const Document& document, const CharacterSource& character) {
    const ModelParts& parts = character.model->namedParts();
    Json lines = Json::array();
    for (std::int32_t p = 0; p < static_cast<std::int32_t>(parts.parts.size()); ++p) {
        Json line = partJson(document, character, {p, -1});
        const auto shells = static_cast<std::int32_t>(parts.parts[static_cast<std::size_t>(p)].shells.size());
        if (shells > 0) line["shells"] = Json::array();
        for (std::int32_t s = 0; s < shells; ++s) line["shells"].push_back(partJson(document, character, {p, s}));
        lines.push_back(std::move(line));
    }
    return lines;
}

}  // namespace imomushi
