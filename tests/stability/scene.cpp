// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/scene.h"

#include "core/base/atomic_file.h"
#include "core/document/command_support.h"
#include "core/mesh/write_mesh.h"

namespace imomushi {
namespace {

std::string meshFile(const HardCase& hard, const HardElement& element) {
    return hard.name + (hard.elements.size() > 1 ? " " + element.name : std::string()) + ".obj";
}

Json placeOf(const std::variant<std::string, Vec3>& place) {
    if (const Vec3* point = std::get_if<Vec3>(&place)) return json(*point);
    return std::get<std::string>(place);
}

}  // namespace

HardScene hardScene(const HardCase& hard, const std::string& solverMesh) {
    HardScene scene;
    const auto make = [&](Json line) { scene.make.push_back(std::move(line)); };
    const auto set = [&](const std::string& target, const char* property, Json value) {
        make({{"do", "set"}, {"target", target}, {"property", property}, {"value", std::move(value)}});
    };
    for (const HardElement& element : hard.elements) {
        make({{"do", "import-element"}, {"path", meshFile(hard, element)}, {"name", element.name}});
        set(element.name, "nu", element.nu);
        if (element.stiffness != 1.0) set(element.name, "stiffness", element.stiffness);
        if (!solverMesh.empty()) set(element.name, "solver-mesh", solverMesh);
        for (const HardFace& face : element.faces) {
            Json line{{"do", "add-joint-face"}, {"element", element.name}, {"name", face.name}};
            if (face.vertices.empty())
                line["plane"] = {{"origin", json(face.origin)}, {"normal", json(face.normal)}};
            else
                line["vertices"] = face.vertices;
            make(std::move(line));
        }
    }
    for (const auto& [a, b] : hard.joins) make({{"do", "join"}, {"a", a}, {"b", b}});
    for (const HardBone& bone : hard.bones)
        make({{"do", "add-bone"}, {"name", bone.name}, {"element", bone.element}, {"from", placeOf(bone.from)}, {"to", placeOf(bone.to)}});
    make({{"do", "precompute"}});

    // Where the endpoint is at rest, from the case itself.
    Vec3 end = Vec3::Zero();
    for (const HardBone& bone : hard.bones) {
        if (bone.name + "/end" != hard.endpoint) continue;
        if (const Vec3* point = std::get_if<Vec3>(&bone.to)) end = *point;
        for (const HardElement& element : hard.elements)
            for (const HardFace& face : element.faces)
                if (placeOf(bone.to) == element.name + "/" + face.name) end = face.origin;
    }
    scene.perform = {{{"do", "pin"}, {"endpoint", hard.bones.front().name + "/start"}},
                     {{"do", "drag"}, {"endpoint", hard.endpoint}, {"to", json(end + hard.drag)}},
                     {{"do", "step"}, {"frames", 3}},
                     {{"do", "measure"}, {"what", "gap"}}};
    return scene;
}

Result<void> writeHardCase(const HardCase& hard, const HardScene& scene, const std::filesystem::path& folder) {
    for (const HardElement& element : hard.elements)
        if (auto written = writeMesh(folder / meshFile(hard, element), element.mesh.vertices, element.mesh.triangles); !written) return written;
    std::string script = "# " + hard.hard + "\n";
    if (!hard.refusal.command.empty())
        script += "# Expected: \"" + hard.refusal.command + "\" is refused with \"" + hard.refusal.code + "\": " + hard.refusal.why + ".\n";
    for (const Json& line : scene.make) script += line.dump() + "\n";
    script += Json{{"do", "save"}, {"path", hard.name + ".imomushi"}}.dump() + "\n";
    for (const Json& line : scene.perform) script += line.dump() + "\n";
    return writeFileAtomically(folder / (hard.name + ".jsonl"), script);
}

}  // namespace imomushi
