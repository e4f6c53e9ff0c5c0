// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/session/session.h"

namespace imomushi {

/// Positions of an element's body vertices as posed; at rest where there is no live character.
struct PosedBody {
    const float* posed = nullptr;
    const TriangleMesh* rest = nullptr;

    PosedBody(const Session& session, PartId id, const Element& element) : rest(&element.mesh->body) {
        Character* character = session.character();
        const int index = session.elementIndex(id);
        if (!character || index < 0) return;
        const Character::Surface surface = character->surface(index);
        if (surface.vertices == rest->vertices.rows()) posed = surface.positions;
    }
    /// m, world
    [[nodiscard]] Vec3 at(std::int32_t vertex) const {
        if (posed) return {posed[3 * vertex], posed[3 * vertex + 1], posed[3 * vertex + 2]};
        return rest->vertices.row(vertex);
    }
};

}  // namespace imomushi
