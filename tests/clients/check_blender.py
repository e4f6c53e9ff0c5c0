# SPDX-License-Identifier: GPL-3.0-or-later
# Compares exported files, as Blender has them, with the studio:
#   blender --background --factory-startup --python check_blender.py -- JOBS.json
# A job: {"file": .glb, .fbx, .pc2 or .mdd, "object": the .obj beside a cache, "rest": .obj, "fps", "tolerance": of vertices and
#   joints, in diagonals, "frames": [{"frame": from 0 at fps, "positions": .obj, "joints": {bone: [x, y, z]}}],
#   "picture": {"path": .png, "frame", "seen": [names of objects], "size": [w, h]}}
# "object", "joints" and "picture" may be missing. Prints one line "imomushi [...]" with an answer per job: the largest distances of
# vertices and joints per frame, in diagonals, and what the file has. The exit status is 1 where one is farther than the tolerance.
import json
import math
import sys

import numpy

numpy.bool = bool  # the importers of Blender 3.4 are older than Debian's numpy
import bpy
from mathutils import Vector, kdtree

SAMPLES = 16  # of a picture, per pixel


def read_obj(path):
    with open(path) as file:
        return numpy.array([[float(x) for x in line.split()[1:4]] for line in file if line.startswith("v ")])


def to_studio(points):
    # Blender has +Z up.
    return numpy.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)


def meshes(scene):
    # The importer brings a shape for bones.
    return sorted((o for o in scene.objects if o.type == "MESH" and not o.name.startswith("Icosphere")), key=lambda o: o.name)


def positions(scene):
    graph = bpy.context.evaluated_depsgraph_get()
    out = []
    for item in meshes(scene):
        now = item.evaluated_get(graph)
        mesh = now.to_mesh()
        own = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
        mesh.vertices.foreach_get("co", own)
        place = numpy.array(now.matrix_world)
        out.append(own.reshape(-1, 3) @ place[:3, :3].T + place[:3, 3])
        now.to_mesh_clear()
    return to_studio(numpy.concatenate(out))


def joints(scene, names):
    graph = bpy.context.evaluated_depsgraph_get()
    out = {}
    for item in scene.objects:
        if item.type != "ARMATURE":
            continue
        now = item.evaluated_get(graph)
        for bone in now.pose.bones:
            if bone.name in names:
                at = now.matrix_world @ bone.head
                out[bone.name] = numpy.array([at.x, at.z, -at.y])
    return out


def open_file(job, scene):
    path = job["file"]
    if path.endswith(".fbx"):
        bpy.ops.import_scene.fbx(filepath=path, anim_offset=0.0)
    elif path.endswith(".glb"):
        bpy.ops.import_scene.gltf(filepath=path)
    else:
        bpy.ops.wm.obj_import(filepath=job["object"], validate_meshes=False)
        # Turned to Blender's axes by its matrix: vertices themselves are as in the file.
        cache = meshes(scene)[0].modifiers.new("cache", "MESH_CACHE")
        cache.cache_format = path[-3:].upper()
        cache.filepath = bpy.path.abspath(path)
        cache.frame_start = 0.0
        return 0.0
    return min((a.frame_range[0] for a in bpy.data.actions), default=0.0)


def go_to(scene, at):
    scene.frame_set(math.floor(at), subframe=at - math.floor(at))


def draw(job, scene, first):
    wish = job["picture"]
    seen = wish.get("seen")
    for item in meshes(scene):
        item.hide_render = bool(seen) and item.name not in seen
    for item in scene.objects:
        if item.type == "MESH" and item.name.startswith("Icosphere"):
            item.hide_render = True
    go_to(scene, first + wish["frame"])
    points = positions(scene)
    low, high = points.min(axis=0), points.max(axis=0)
    middle, size = (low + high) / 2.0, numpy.linalg.norm(high - low)
    at = Vector((middle[0], -middle[2], middle[1]))
    away = Vector((0.75, -1.0, 0.45)).normalized()
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = at + 2.4 * float(size) * away
    camera.rotation_euler = away.to_track_quat("Z", "Y").to_euler()
    camera.data.lens = 60.0
    camera.data.clip_end = 100.0 * float(size)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 3.0
    sun.rotation_euler = (0.6, 0.2, 0.9)
    for item in (camera, sun):
        scene.collection.objects.link(item)
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.5, 0.55, 0.6, 1.0)
    scene.world = world
    scene.camera = camera
    scene.render.engine = "CYCLES"  # the others need a display
    scene.cycles.samples = SAMPLES
    scene.cycles.use_denoising = False
    scene.render.resolution_x, scene.render.resolution_y = wish.get("size", [320, 240])
    scene.render.filepath = wish["path"]
    bpy.ops.render.render(write_still=True)


def textures():
    # Pictures that colour what is seen.
    def above(socket):
        for link in socket.links:
            if link.from_node.type == "TEX_IMAGE":
                yield link.from_node.image.name
            for own in link.from_node.inputs:
                yield from above(own)

    nodes = [n for m in bpy.data.materials if m.node_tree for n in m.node_tree.nodes if n.type == "BSDF_PRINCIPLED"]
    return len({name for n in nodes for name in above(n.inputs["Base Color"])})


def check(job):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = int(job["fps"])
    rest = read_obj(job["rest"])
    size = float(numpy.linalg.norm(rest.max(axis=0) - rest.min(axis=0)))
    first = open_file(job, scene)
    ordered = "object" in job

    # Which vertex is which: a cache has them in order, others by their places in the first frame that is asked for.
    owners = None
    vertices, bones = [], []
    for wish in job["frames"]:
        goal = read_obj(wish["positions"])
        go_to(scene, first + wish["frame"])
        points = positions(scene)
        if ordered:
            if points.shape != goal.shape:
                return {"file": job["file"], "good": False, "vertices": len(points), "wanted": len(goal)}
            vertices.append(float(numpy.linalg.norm(points - goal, axis=1).max()) / size)
            continue
        if owners is None:
            tree = kdtree.KDTree(len(goal))
            for index, p in enumerate(goal):
                tree.insert(p, index)
            tree.balance()
            owners = [[index for _, index, _ in tree.find_range(p, 1e-4 * size)] or [tree.find(p)[1]] for p in points]
        vertices.append(max(float(numpy.linalg.norm(goal[near] - p, axis=1).min()) for p, near in zip(points, owners)) / size)
        wanted = wish.get("joints", {})
        there = joints(scene, wanted)
        bones.append(max((float(numpy.linalg.norm(there[name] - numpy.array(wanted[name]))) for name in there), default=0.0) / size)
    answer = {
        "file": job["file"],
        "vertices": len(points),
        "textures": textures(),
        "objects": [o.name for o in meshes(scene)],
        "bones": sum(len(o.data.bones) for o in scene.objects if o.type == "ARMATURE"),
        "joints": len(joints(scene, job["frames"][0].get("joints", {}))),
        "distances": vertices,
        "joint_distances": bones,
        "good": max(vertices + bones) <= job["tolerance"],
    }
    if "picture" in job:
        draw(job, scene, first)
    return answer


def main():
    with open(sys.argv[sys.argv.index("--") + 1]) as file:
        answers = [check(job) for job in json.load(file)]
    print("imomushi", json.dumps(answers))
    return 0 if all(answer["good"] for answer in answers) else 1


sys.exit(main())
