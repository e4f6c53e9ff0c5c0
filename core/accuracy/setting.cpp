// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/accuracy/setting.h"
#include "core/base/formatted.h"

#include <algorithm>
#include <cmath>

namespace imomushi {

namespace {

using Kind = SolverMeshSetting::Kind;

std::string meshName(const MeshChoice& mesh) {
    if (mesh.own) return "own meshes";
    switch (mesh.kind) {
        case Kind::AsIs: return "as-is";
        case Kind::Refined: return "refined x " + formatted("%g", mesh.factor);
        case Kind::Decimated: return "decimated x " + formatted("%g", mesh.factor);
        case Kind::Default: return "default";
        case Kind::Best: return "best";
        case Kind::Draft: return "draft";
        case Kind::Volume: return mesh.factor > 0.0 ? "volume x " + formatted("%g", mesh.factor) : "volume";
    }
    return {};
}

}  // namespace

SolverMeshSetting MeshChoice::on(int vertices, const SolverMeshSetting& given) const {
    if (own) return given;
    const bool counted = kind == Kind::Refined || kind == Kind::Decimated || (kind == Kind::Volume && factor > 0.0);
    const double count = std::clamp(std::round(factor * vertices), double{SolverMeshSetting::kFewest}, double{SolverMeshSetting::kMax});
    return {kind, counted ? static_cast<int>(count) : 0};
}

std::string settingName(const AccuracySetting& s) {
    const std::string tail = ", " + meshName(s.mesh) + ", " + formatName(s.format);
    if (s.previous) return "previous model" + tail;
    return basisName(s.basis) + (s.smoothJoints ? " + smooth joints" : "") + tail;
}

std::vector<AccuracySetting> studiedSettings(const AccuracySetting& present) {
    std::vector<AccuracySetting> out = {present};
    const auto add = [&](const AccuracySetting s) {  // a copy: `out` grows
        if (std::find(out.begin(), out.end(), s) == out.end()) out.push_back(s);
    };
    const MeshChoice usual{}, asIs{false, Kind::AsIs, 0.0};
    const auto basis = [](BasisChoice choice, bool smooth, const MeshChoice& mesh, ResponseFormat format = ResponseFormat::Float) {
        return AccuracySetting{false, choice, smooth, mesh, format};
    };
    const BasisChoice few(BasisKind::Modes, 5), some(BasisKind::Modes, 12), most(BasisKind::Modes, BasisChoice::kMaxModes);
    // Cheap meshes first: they say at once how bases compare.
    for (const MeshChoice& mesh : {asIs, usual}) {
        add(basis(BasisKind::Paper, false, mesh));
        add(basis(BasisKind::Affine, false, mesh));
        add(basis(BasisKind::Affine, true, mesh));
        add(basis(some, true, mesh));
    }
    for (const ResponseFormat format : {ResponseFormat::Int16, ResponseFormat::Half}) {
        add(basis(BasisKind::Paper, false, usual, format));
        add(basis(BasisKind::Affine, false, usual, format));
        add(basis(BasisKind::Affine, true, usual, format));
        add(basis(some, true, usual, format));
    }
    add(basis(BasisKind::Paper, true, usual));
    add(basis(few, true, usual));
    add(basis(BasisChoice(BasisKind::Modes, 24), true, usual));
    add(basis(most, true, usual));
    add(basis(most, true, usual, ResponseFormat::Int16));
    add(basis(some, true, {false, Kind::Decimated, 0.5}));
    add(basis(some, true, {false, Kind::Refined, 2.0}));
    add(basis(some, false, usual));
    add({true, BasisKind::Full, false, usual, ResponseFormat::Float});
    add(basis(BasisKind::Full, true, usual));
    add(basis(some, true, {false, Kind::Volume, 0.0}));
    add(basis(some, true, {false, Kind::Best, 0.0}));
    add(basis(most, true, {false, Kind::Best, 0.0}));
    return out;
}

}  // namespace imomushi
