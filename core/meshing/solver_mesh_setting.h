// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"

namespace imomushi {

/// Which mesh an element is solved on, as the artist asks for it.
struct SolverMeshSetting {
    enum class Kind {
        AsIs,       ///< the body itself
        Refined,    ///< the body bisected to `count` vertices
        Decimated,  ///< a closed surface of about `count` vertices near the body; responses are mapped to the body
        Default,    ///< what serves most characters: accurate as far as that is cheap
        Best,       ///< the most accurate there is, whatever it costs
        Draft,      ///< kDraftVertices, or the body where that is hardly larger: soft in a fraction of a second, until a better answer is there
        Volume      ///< finite elements in a body of about `count` vertices (0: kVolumeVertices) that is filled with tetrahedra; responses are mapped to the body
    };
    Kind kind = Kind::Default;
    int count = 0;  ///< vertices, kFewest...kMax where the kind is Refined or Decimated, 0 or the same where it is Volume, 0 otherwise

    static constexpr int kFewest = 4;         ///< a tetrahedron
    static constexpr int kDraftVertices = 400;
    static constexpr int kVolumeVertices = 2500;
    static constexpr int kMax = 10'000'000;  ///< beyond any memory that could solve it
    bool operator==(const SolverMeshSetting&) const = default;
};

/// "as-is", "refined:N", "decimated:N", "default", "best", "draft", "volume", "volume:N"; N in decimal digits. Errors: "bad-value".
Result<SolverMeshSetting> parseSolverMesh(std::string_view text);

/// What parseSolverMesh() reads back to the same setting.
std::string solverMeshName(const SolverMeshSetting& setting);

}  // namespace imomushi
