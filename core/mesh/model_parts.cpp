// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/mesh/model_parts.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/base/index.h"
#include "core/base/union_find.h"
#include "core/mesh/render_model.h"
#include "core/mesh/weld.h"

namespace imomushi {

namespace {

std::vector<std::string> ownNames(const std::vector<std::string>& given) {
    std::set<std::string> taken(given.begin(), given.end()), once;
    std::vector<std::string> names;
    for (const std::string& wish : given) {
        std::string name = wish;
        if (!once.insert(wish).second)
            for (int n = 2; !taken.insert(name).second; ++n) name = wish + " (" + std::to_string(n) + ")";
        names.push_back(std::move(name));
    }
    return names;
}

}  // namespace

ModelParts ModelParts::of(const RenderModel& model) {
    ModelParts out;
    for (std::string& name : ownNames(model.parts)) out.parts.push_back({std::move(name), {}, {}});
    if (out.parts.empty()) return out;
    const TriangleMesh& mesh = model.mesh.body;
    const auto partOf = [&model](Eigen::Index t) { return model.part.empty() ? 0 : model.part[static_cast<std::size_t>(t)]; };
    const auto count = static_cast<std::size_t>(mesh.vertices.rows());
    std::vector<std::int32_t> part(count, -1);
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) {
            auto& of = part[at(mesh.triangles(t, k))];
            of = of < 0 ? partOf(t) : std::min(of, partOf(t));
        }
    std::vector<char> used(count, 0);
    std::int32_t last = 0;
    for (std::size_t v = 0; v < count; ++v) {
        used[v] = part[v] >= 0;
        if (used[v]) last = part[v];
        part[v] = last;
        out.parts[at(last)].vertices.push_back(static_cast<std::int32_t>(v));
    }

    const std::vector<std::int32_t> first = weldExact(mesh.vertices, used, part);
    UnionFind sets(count);
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        std::int32_t known = -1;
        for (int k = 0; k < 3; ++k) {
            const std::int32_t v = mesh.triangles(t, k);
            if (part[at(v)] != partOf(t)) continue;
            if (known >= 0) sets.unite(first[at(known)], first[at(v)]);
            known = v;
        }
    }
    for (Part& of : out.parts) {
        std::map<std::int32_t, std::size_t> shellOf;  // by the lowest vertex of the set
        for (const std::int32_t v : of.vertices) {
            if (!used[at(v)]) continue;
            const auto [shell, isNew] = shellOf.try_emplace(sets.find(first[at(v)]), shellOf.size());
            if (shellOf.size() > kMostShells) break;
            if (isNew) of.shells.emplace_back();
            of.shells[shell->second].push_back(v);
        }
        if (shellOf.size() < 2 || shellOf.size() > kMostShells) of.shells.clear();
    }
    return out;
}

std::optional<ModelPart> ModelParts::find(std::string_view name) const {
    for (std::size_t p = 0; p < parts.size(); ++p)
        if (parts[p].name == name) return ModelPart{static_cast<std::int32_t>(p), -1};
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (std::size_t s = 0; s < parts[p].shells.size(); ++s)
            if (const ModelPart shell{static_cast<std::int32_t>(p), static_cast<std::int32_t>(s)}; nameOf(shell) == name) return shell;
    return std::nullopt;
}

std::string ModelParts::nameOf(const ModelPart& part) const {
    const std::string& name = parts[at(part.part)].name;
    return part.shell < 0 ? name : name + "#" + std::to_string(part.shell + 1);
}

bool ModelParts::contains(const ModelPart& part) const {
    return part.part >= 0 && at(part.part) < parts.size() && part.shell >= -1 && part.shell < static_cast<std::int32_t>(parts[at(part.part)].shells.size());
}

const std::vector<std::int32_t>& ModelParts::verticesOf(const ModelPart& part) const {
    const Part& of = parts[at(part.part)];
    return part.shell < 0 ? of.vertices : of.shells[at(part.shell)];
}

const ModelParts& RenderModel::namedParts() const {
    auto kept = parts_.kept.load(std::memory_order_acquire);
    if (!kept) {
        auto made = std::make_shared<const ModelParts>(ModelParts::of(*this));
        if (parts_.kept.compare_exchange_strong(kept, made, std::memory_order_acq_rel)) kept = std::move(made);
    }
    return *kept;
}

}  // namespace imomushi
