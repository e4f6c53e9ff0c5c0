// SPDX-License-Identifier: GPL-3.0-or-later
// Checks a driver for Godot without Godot:
//   node check_godot.js DRIVER.gd            a line for each place that is no GDScript
//   node check_godot.js DRIVER.gd FILE.glb   moves all points of an exported file to and fro, and compares poses and weights with those of the driver for
//                                            three.js; prints the largest differences (m, 1, 1)
// Exit status 1: something is wrong.
import fs from 'node:fs';
import { ImomushiDriver } from '../../assets/drivers/three.js';
import { compile, mistakes } from './gdscript.js';
import { load } from './load.js';

const kSame = 1e-9;
const kFrames = 20;

const [path, file] = process.argv.slice(2);
const text = fs.readFileSync(path, 'utf8'), wrong = mistakes(text);
for (const { row, text: line } of wrong) console.log(`${path}:${row}: ${line}`);
if (wrong.length > 0) process.exit(1);
if (!file) process.exit(0);

// The scene, as Godot has it: a skeleton, and a mesh per element.
const gltf = await load(file), three = new ImomushiDriver(gltf.scene), { elements } = three.data;
const bones = new Map(), bodies = elements.map((element) => ({ name: element.name, weights: [], set_blend_shape_value(t, weight) { this.weights[t] = weight; } }));
const skeleton = {
    find_bone: (name) => elements.findIndex((element) => element.frame === name),
    set_bone_pose_position: (bone, at) => bones.set(bone, { ...bones.get(bone), at: at.n }),
    set_bone_pose_rotation: (bone, turn) => bones.set(bone, { ...bones.get(bone), turn: turn.n }),
};
const scene = { find_children: (_, type) => (type === 'Skeleton3D' ? [skeleton] : bodies) };
const godot = compile(text)(scene, file);

const out = { places: 0, rotations: 0, weights: 0 }, { Vector3 } = godot.types;
const reach = 0.2 * Math.max(...three.data.bones.map((bone) => bone.length));
for (let i = 1; i <= kFrames; ++i) {
    three.data.points.forEach((point, p) => {
        const at = point.rest.map((x, k) => x + reach * (i / kFrames) * Math.sin(5 * p + 3 * k + 0.5 * i)), roll = 0.05 * i * ((p % 3) - 1);
        three.movePoint(p, at, roll);
        godot.move_point(point.name, new Vector3(...at), roll);
    });
    three.update();
    godot.update();
    elements.forEach((element, e) => {
        const node = three.frames.get(e), bone = bones.get(e), turn = node.quaternion.toArray();
        const apart = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));
        out.places = Math.max(out.places, apart(node.position.toArray(), bone.at));
        out.rotations = Math.max(out.rotations, Math.min(apart(turn, bone.turn), apart(turn, bone.turn.map((x) => -x))));
        three.meshes.get(e)?.traverse((mesh) => mesh.morphTargetInfluences?.forEach((w, t) => (out.weights = Math.max(out.weights, Math.abs(w - bodies[e].weights[t])))));
    });
}
console.log(JSON.stringify(out));
process.exit(Object.values(out).every((x) => x <= kSame) ? 0 : 1);
