// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/export/fbx.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "core/base/atomic_file.h"

extern char** environ;

namespace imomushi {

namespace {

constexpr const char* kScript = R"py(# SPDX-License-Identifier: GPL-3.0-or-later
import json
import struct
import sys
import numpy
numpy.bool = bool  # the importer of Blender 3.4 is older than the numpy of some systems
import bpy
import io_scene_fbx.export_fbx_bin as writer
import io_scene_fbx.import_fbx as reader

source, target, fps, shown = sys.argv[sys.argv.index("--") + 1:]
with open(source, "rb") as file:
    file.seek(12)
    size = struct.unpack("<I4x", file.read(8))[0]
    takes = [a["name"] for a in json.loads(file.read(size)).get("animations", [])]

def empty():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    rate = float(fps)
    bpy.context.scene.render.fps = max(1, round(rate))
    bpy.context.scene.render.fps_base = max(1, round(rate)) / rate

def positions(frame):
    bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
    graph = bpy.context.evaluated_depsgraph_get()
    out = []
    for item in sorted((o for o in bpy.context.scene.objects if o.type == "MESH" and not o.name.startswith("Icosphere")), key=lambda o: o.name):
        now = item.evaluated_get(graph)
        mesh = now.to_mesh()
        out.append([now.matrix_world @ v.co for v in mesh.vertices])
        now.to_mesh_clear()
    return out

# What moves each object, and the keys of each mesh: an action per take.
def play(take):
    for owner, actions in parts:
        owner.animation_data.action = actions[take]
    ranges = [actions[take].frame_range for _, actions in parts]
    return min(r[0] for r in ranges), max(r[1] for r in ranges)

def complete():
    if any(len(actions) != len(takes) for _, actions in parts):
        sys.exit("takes are missing")

def frames(low, high):
    return [round((high - low) * i / 9) for i in range(10)]

# The importer of Blender connects a bone whose head is exactly where it guesses the tip of its parent, along +Y, and a connected bone
# keeps its length. A head that is beside that by a few rounding errors stays free to stretch.
def loosen():
    for rig in [o for o in bpy.context.scene.objects if o.type == "ARMATURE"]:
        bpy.context.view_layer.objects.active = rig
        bpy.ops.object.mode_set(mode="EDIT")
        for bone in rig.data.edit_bones:
            if not bone.parent:
                continue
            arm = bone.head - bone.parent.head
            sides = [bone.parent.x_axis, bone.parent.z_axis]
            if max(abs(arm.dot(s)) for s in sides) > 1e-4 * arm.length:
                continue
            # Heads are compared coordinate by coordinate, each relative to itself.
            reach, side = min(((abs(bone.head[k] / s[k]), s) for s in sides for k in range(3) if abs(s[k]) > 0.1), key=lambda found: found[0])
            shift = max(4e-6 * reach, 1e-6 * arm.length) * (side if arm.dot(side) >= 0.0 else -side)
            bone.head += shift
            bone.tail += shift
        bpy.ops.object.mode_set(mode="OBJECT")

# The exporter of FBX finds a texture only where nothing is between it and the shader, as the importer of glTF puts vertex colours and factors.
def show_textures():
    def above(socket):
        for link in socket.links:
            if link.from_node.type == "TEX_IMAGE":
                yield link.from_node
            for own in link.from_node.inputs:
                yield from above(own)
    for tree in [m.node_tree for m in bpy.data.materials if m.node_tree]:
        for node in [n for n in tree.nodes if n.type == "BSDF_PRINCIPLED"]:
            color = node.inputs["Base Color"]
            picture = next(above(color), None)
            if picture:
                tree.links.new(picture.outputs["Color"], color)

empty()
# Bones with the axes of their nodes, so that animations of the same skeleton fit.
bpy.ops.import_scene.gltf(filepath=source, bone_heuristic="BLENDER")
loosen()
show_textures()
for item in [o for o in bpy.context.scene.objects if o.name.startswith("Icosphere")]:
    bpy.data.objects.remove(item)
parts = []
for owner in list(bpy.data.objects) + list(bpy.data.shape_keys):
    data = owner.animation_data
    if data and data.action:
        # The first take is active, the others are kept in tracks.
        parts.append((owner, [data.action] + [t.strips[0].action for t in data.nla_tracks if t.strips and t.strips[0].action != data.action]))
complete()
for i, action in enumerate(bpy.data.actions):
    action.name = "part %d" % i
before = []
for take in range(len(takes)):
    low, high = play(take)
    before.append([positions(low + f) for f in frames(low, high)])

# One stack per take with everything in it, which the exporter has no setting for.
def stacks(data):
    out, animated, low, high = [], set(), 0.0, 0.0
    for take, name in enumerate(takes):
        start, end = play(take)
        made = writer.fbx_animations_do(data, bpy.data.actions.new(name), start, end, True, force_keep=True)
        if made is None:
            continue
        out.append(made)
        high = max(high, made[5])
        for key, (_, nodes) in made[1].items():
            animated.update((key, prop) for prop in nodes)
    data.scene.frame_set(data.scene.frame_current, subframe=0.0)
    return out, animated, low, high

writer.fbx_animations = stacks
bpy.ops.export_scene.fbx(filepath=target, object_types={"MESH", "ARMATURE", "EMPTY"}, add_leaf_bones=False, path_mode="COPY", embed_textures=True,
                         bake_anim=True, bake_anim_force_startend_keying=True, bake_anim_simplify_factor=0.0, use_mesh_modifiers=False)
empty()
made, plain = {}, reader.blen_read_animations_action_item

def noted(action, item, *rest):
    owner = item.id_data if isinstance(item, bpy.types.ShapeKey) else item.bl_obj
    of = made.setdefault((owner.bl_rna.identifier, owner.name), (owner, []))[1]
    if action not in of:
        of.append(action)
    return plain(action, item, *rest)

reader.blen_read_animations_action_item = noted
bpy.ops.import_scene.fbx(filepath=target, anim_offset=0.0)
parts = list(made.values())
complete()
worst = 0.0
for take, was in enumerate(before):
    start, end = play(take)
    for f, goal in zip(frames(start, end), was):
        now = positions(start + f)
        if [len(m) for m in now] != [len(m) for m in goal]:
            sys.exit("other vertices came back")
        worst = max([worst] + [(a - b).length for m, n in zip(goal, now) for a, b in zip(m, n)])
open(shown, "w").write(repr(worst))
)py";

constexpr double kUsual = 5.0;  // s, of a small character: then the progress is at two thirds

/// Deletes the files of a conversion at the end of its scope.
struct Folder {
    std::filesystem::path path;
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "imomushi-fbx-XXXXXX").string();
        if (const char* made = ::mkdtemp(name.data())) path = made;
    }
    ~Folder() {
        try {
            std::error_code error;
            if (!path.empty()) std::filesystem::remove_all(path, error);
        } catch (const std::bad_alloc&) {  // the system removes it some day
        }
    }
};

std::string readText(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

Result<double> convertToFbx(const std::filesystem::path& glb, const std::filesystem::path& fbx, double fps, const Progress& progress) {
    const Folder folder;
    if (folder.path.empty()) return fail("not-writable", "There is no room for temporary files: check the disk of " + std::filesystem::temp_directory_path().string() + ".");
    const std::string script = (folder.path / "convert.py").string(), shown = (folder.path / "worst").string(), log = (folder.path / "log").string(),
                      made = (folder.path / "out.fbx").string(), source = glb.string(), rate = std::to_string(fps);
    if (auto written = writeFileAtomically(script, kScript); !written) return tl::unexpected(written.error());
    std::string words[] = {"blender", "--background", "--factory-startup", "--python-exit-code", "3", "--python", script, "--", source, made, rate, shown};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&files, 1, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    ::posix_spawn_file_actions_adddup2(&files, 1, 2);
    pid_t child = 0;
    const int failed = ::posix_spawnp(&child, "blender", &files, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&files);
    if (failed != 0) return fail("needs-blender", "FBX is written by Blender, which is not installed: install Blender, or export .glb.");
    int status = 0;
    const auto start = std::chrono::steady_clock::now();
    while (::waitpid(child, &status, WNOHANG) == 0) {
        // Blender does not say how far it is.
        progress.report("convert", 1.0 - std::exp(-std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / kUsual));
        if (progress.cancelled()) {
            ::kill(child, SIGKILL);
            ::waitpid(child, &status, 0);
            return fail(kCancelled, "The export was cancelled.");
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    double worst = -1.0;
    std::ifstream(shown) >> worst;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !(worst >= 0.0)) {
        // The last error that is not about the script as a whole.
        std::string told = "it ended early";
        std::ifstream lines(log);
        for (std::string line; std::getline(lines, line);)
            if (line.find("rror: ") != std::string::npos && line.find("script failed") == std::string::npos) told = line;
        return fail("not-converted", "Blender could not make the FBX file (" + told + "): export .glb instead.");
    }
    if (auto written = writeFileAtomically(fbx, readText(made)); !written) return tl::unexpected(written.error());
    return worst;
}

}  // namespace imomushi
