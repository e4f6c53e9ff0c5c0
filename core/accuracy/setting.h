// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/character/response_format.h"
#include "core/joints/face_basis.h"
#include "core/meshing/solver_mesh_setting.h"

namespace imomushi {

/// Which solver mesh the elements of a character get.
struct MeshChoice {
    bool own = false;    ///< each element the one that the document gives it
    SolverMeshSetting::Kind kind = SolverMeshSetting::Kind::Default;
    double factor = 0.0; ///< of Refined, Decimated and, where it is not 0, Volume: its vertices in those of the body
    /// For an element of so many vertices; `given`: what the document gives it.
    [[nodiscard]] SolverMeshSetting on(int vertices, const SolverMeshSetting& given) const;
    bool operator==(const MeshChoice&) const = default;
};

/// One choice of accuracy for a whole character.
struct AccuracySetting {
    bool previous = false;      ///< the paper's previous model: basis "full", tractions, explicit dynamics of joint faces
    BasisChoice basis;
    bool smoothJoints = false;
    MeshChoice mesh;
    ResponseFormat format = ResponseFormat::Float;
    bool operator==(const AccuracySetting&) const = default;
};

/// For people and as a key of stored figures: "modes:12 + smooth joints, solved on default, float".
std::string settingName(const AccuracySetting& setting);

/// The settings that a study measures, cheap ones that differ much first, `present` before all: bases with and without smooth joints, solver meshes, number
/// formats.
std::vector<AccuracySetting> studiedSettings(const AccuracySetting& present);

}  // namespace imomushi
