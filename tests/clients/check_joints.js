// SPDX-License-Identifier: GPL-3.0-or-later
// Plays clips of imported files and of what was exported of them by three.js in node, and compares where joints of one name are:
//   node check_joints.js JOBS.json
// JOBS.json: [{original, exported, clip, scale, joints: [name, ...], times: [s, ...], tolerance}, ...]; scale: metres per unit of the original; tolerance over the diagonal of its mesh at rest. Names
// that the original does not have are left out. Prints one JSON line: per job how many joints were compared, and the largest distances at rest and while the clip plays, as a take of the export
// ("playing") and as the original has it, on all bones of its skins in the export ("old"); "missing" are names that the export should have and has not. Exit status: 0 all is within tolerance, 1 not.
import fs from 'node:fs';
import * as THREE from 'three';
import { positions } from './compare.js';
import { load } from './load.js';

/// World places of the named nodes at times of a clip; the first is at rest. from: whose clip it is.
function places(gltf, clip, names, times, from = gltf) {
    const read = () => {
        gltf.scene.updateMatrixWorld(true);
        return names.map((name) => gltf.scene.getObjectByName(name).getWorldPosition(new THREE.Vector3()));
    };
    const out = [read()];
    const mixer = new THREE.AnimationMixer(gltf.scene), action = mixer.clipAction(from.animations.find((a) => a.name === clip));
    action.setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
    action.play();
    for (const time of times) {
        mixer.setTime(time);
        out.push(read());
    }
    return out;
}

const checks = [];
for (const job of JSON.parse(fs.readFileSync(process.argv[2]))) {
    const original = await load(job.original), exported = await load(job.exported);
    const names = job.joints.map((name) => THREE.PropertyBinding.sanitizeNodeName(name)).filter((name) => original.scene.getObjectByName(name));
    const missing = names.filter((name) => !exported.scene.getObjectByName(name)), found = names.filter((name) => !missing.includes(name));
    const size = job.scale * new THREE.Box3().setFromPoints(positions(original.scene)).getSize(new THREE.Vector3()).length();
    const farthest = (goal, there) => Math.max(...goal.map((places, k) => Math.max(...places.map((p, i) => p.clone().multiplyScalar(job.scale).distanceTo(there[k][i]) / size))));
    const playing = farthest(places(original, job.clip, found, job.times), places(exported, job.clip, found, job.times));
    // An engine that knows the old skeleton plays its own clips on the new file: all bones, merged ones too, go where they went.
    const bones = [];
    original.scene.traverse((mesh) => mesh.isSkinnedMesh && bones.push(...mesh.skeleton.bones.map((bone) => bone.name)));
    const old = bones.every((name) => exported.scene.getObjectByName(name)) ? farthest(places(await load(job.original), job.clip, bones, job.times), places(await load(job.exported), job.clip, bones, job.times, original)) : Infinity;
    checks.push({ exported: job.exported, clip: job.clip, joints: found.length, bones: bones.length, missing, playing, old, good: missing.length === 0 && playing <= job.tolerance && old <= job.tolerance });
}
console.log(JSON.stringify({ checks }));
process.exit(checks.every((c) => c.good) ? 0 : 1);
