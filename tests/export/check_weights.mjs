// SPDX-License-Identifier: GPL-3.0-or-later
// Poses an exported file by the reference driver, without drawing it:
//   node check_weights.mjs FILE.glb POSE.json DRIVER.js
// POSE.json: {points, rolls, rotations, weights: per element, parts: weights per part of a character}. Prints the largest difference of a weight.
import fs from 'node:fs';

const [path, posePath, driverPath] = process.argv.slice(2);
const { ImomushiDriver } = await import('data:text/javascript;base64,' + Buffer.from(fs.readFileSync(driverPath)).toString('base64'));
const bytes = fs.readFileSync(path);
const file = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());
const pose = JSON.parse(fs.readFileSync(posePath, 'utf8'));

// What the driver wants of a scene graph.
class Node {
    constructor(node) {
        this.userData = node.extras ?? {};
        this.children = [];
        this.position = { set() {} };
        this.quaternion = { set() {} };
        if (node.mesh !== undefined) this.morphTargetInfluences = [...(file.meshes[node.mesh].weights ?? [])];
    }
    traverse(visit) {
        visit(this);
        for (const child of this.children) child.traverse(visit);
    }
}
const nodes = file.nodes.map((node) => new Node(node));
file.nodes.forEach((node, n) => (node.children ?? []).forEach((child) => nodes[n].children.push(nodes[child])));
const scene = new Node({});
scene.children = file.scenes[0].nodes.map((n) => nodes[n]);

const driver = new ImomushiDriver(scene);
driver.setPose(pose.points, pose.rolls, pose.rotations);
driver.update();
let most = 0;
const compare = (weights, shown) => weights.forEach((w, i) => (most = Math.max(most, Math.abs(w - shown.morphTargetInfluences[i]))));
pose.weights.forEach((weights, e) => compare(weights, driver.meshes.get(e)));
(pose.parts ?? []).forEach((weights, part) => compare(weights, driver.parts.get(part)));
console.log(most);
