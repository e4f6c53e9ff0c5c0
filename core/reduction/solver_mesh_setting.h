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
        Best        ///< the most accurate there is, whatever it costs
    };
    Kind kind = Kind::Default;
    int count = 0;  ///< vertices, kFewest...kMost where the kind is Refined or Decimated, 0 otherwise

    static constexpr int kFewest = 4;         ///< a tetrahedron
    static constexpr int kMost = 10'000'000;  ///< beyond any memory that could solve it
    bool operator==(const SolverMeshSetting&) const = default;
};

/// "as-is", "refined:N", "decimated:N", "default", "best"; N in decimal digits. Errors: "bad-value".
Result<SolverMeshSetting> parseSolverMesh(std::string_view text);

/// What parseSolverMesh() reads back to the same setting.
std::string solverMeshName(const SolverMeshSetting& setting);

}  // namespace imomushi
