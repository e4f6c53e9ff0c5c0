# SPDX-License-Identifier: GPL-3.0-or-later
# Compares an exported file, as Blender has it, with the studio:
#   blender --background --python check_blender.py -- FILE.glb|FILE.fbx REST.obj FPS [FRAME POSITIONS.obj TOLERANCE]...
# FRAME counts from 0 at FPS. Prints one line "imomushi {json}"; the exit status is 1 where a vertex is farther than TOLERANCE of the diagonal.
import json
import sys

import numpy

numpy.bool = bool  # the importer of Blender 3.4 is older than Debian's numpy
import bpy
from mathutils import Vector, kdtree


def read_obj(path):
    with open(path) as file:
        return [tuple(float(x) for x in line.split()[1:4]) for line in file if line.startswith("v ")]


def positions(scene):
    graph = bpy.context.evaluated_depsgraph_get()
    out = []
    for item in sorted((o for o in scene.objects if o.type == "MESH"), key=lambda o: o.name):
        if item.name.startswith("Icosphere"):
            continue  # the importer's shape for bones
        now = item.evaluated_get(graph)
        mesh = now.to_mesh()
        # Blender has +Z up.
        out += [((p := now.matrix_world @ v.co).x, p.z, -p.y) for v in mesh.vertices]
        now.to_mesh_clear()
    return out


def main():
    path, rest_path, fps, *frames = sys.argv[sys.argv.index("--") + 1 :]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = int(fps)
    if path.endswith(".fbx"):
        bpy.ops.import_scene.fbx(filepath=path)
    else:
        bpy.ops.import_scene.gltf(filepath=path)
    rest = read_obj(rest_path)
    size = (Vector(max(p[k] for p in rest) for k in range(3)) - Vector(min(p[k] for p in rest) for k in range(3))).length
    first = min((a.frame_range[0] for a in bpy.data.actions), default=0.0)

    # Which vertex is which: by their places in the first frame that is asked for.
    owners = None
    good, distances = True, []
    for i in range(0, len(frames), 3):
        frame, goal, tolerance = float(frames[i]), read_obj(frames[i + 1]), float(frames[i + 2])
        at = first + frame
        scene.frame_set(int(at), subframe=at - int(at))
        points = positions(scene)
        if owners is None:
            tree = kdtree.KDTree(len(goal))
            for index, p in enumerate(goal):
                tree.insert(p, index)
            tree.balance()
            owners = [[index for _, index, _ in tree.find_range(p, 1e-4 * size)] for p in points]
        distance = 0.0
        for p, near in zip(points, owners):
            if not near:
                distance = max(distance, (Vector(tree.find(p)[0]) - Vector(p)).length)
            else:
                distance = max(distance, min((Vector(goal[n]) - Vector(p)).length for n in near))
        distances.append(distance / size)
        good = good and distance <= tolerance * size
    print("imomushi", json.dumps({"file": path, "vertices": len(points), "distances": distances}))
    return 0 if good else 1


sys.exit(main())
