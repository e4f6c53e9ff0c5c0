// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/render/decoded_textures.h"

#include <map>
#include <mutex>
#include <utility>

namespace imomushi::render {
namespace {

/// Of a mesh that is there: it was taken where it has no textures.
struct Kept {
    std::weak_ptr<const ElementMesh> mesh;
    std::optional<DecodedTextures> textures;
};
std::mutex mutex;
std::map<const ElementMesh*, Kept> kept;

/// Null: nobody has asked for textures of this mesh. The mutex is locked.
Kept* keptOf(const std::shared_ptr<const ElementMesh>& mesh) {
    std::erase_if(kept, [](const auto& entry) { return entry.second.mesh.expired(); });
    const auto found = kept.find(mesh.get());
    return found == kept.end() ? nullptr : &found->second;
}

DecodedTextures decode(const ElementMesh& mesh) {
    DecodedTextures textures;
    for (const Texture& texture : mesh.renderMesh.textures) {
        auto image = decodeImage(texture.bytes);
        textures.push_back(image ? std::optional(std::move(*image)) : std::nullopt);
    }
    return textures;
}

}  // namespace

void decodeTextures(const std::shared_ptr<const ElementMesh>& mesh) {
    if (mesh->renderMesh.textures.empty()) return;
    {
        const std::lock_guard lock(mutex);
        if (keptOf(mesh)) return;
    }
    DecodedTextures made = decode(*mesh);
    const std::lock_guard lock(mutex);
    if (!keptOf(mesh)) kept.emplace(mesh.get(), Kept{mesh, std::move(made)});
}

DecodedTextures takeTextures(const std::shared_ptr<const ElementMesh>& mesh) {
    if (mesh->renderMesh.textures.empty()) return {};
    {
        const std::lock_guard lock(mutex);
        if (Kept* known = keptOf(mesh); !known) kept.emplace(mesh.get(), Kept{mesh, std::nullopt});
        else if (auto taken = std::exchange(known->textures, std::nullopt)) return std::move(*taken);
    }
    return decode(*mesh);
}

}  // namespace imomushi::render
