// SPDX-License-Identifier: GPL-3.0-or-later
// Moves an exported character by the reference driver and compares it with the studio:
//   node check_driver.js FILE.glb REST.obj POINTS.json POSITIONS.obj TOLERANCE
// POINTS.json: {"bone/end": [x, y, z], ...}, where the studio has the joint points in the pose of POSITIONS.obj. Prints one JSON line; status 1: too far.
import fs from 'node:fs';
import { ImomushiDriver } from '../../assets/drivers/three.js';
import { diagonal, distance, load, match, positions, readObj } from './check_gltf.js';

const [path, restPath, pointsPath, goalPath, tolerance] = process.argv.slice(2);
const gltf = await load(path);
const rest = readObj(restPath), size = diagonal(rest);
const owners = match(positions(gltf.scene), rest, 1e-4 * size);
const driver = new ImomushiDriver(gltf.scene);
driver.update();
const still = distance(positions(gltf.scene), owners, rest) / size;
// As a hand would, in small steps.
const goal = JSON.parse(fs.readFileSync(pointsPath, 'utf8')), steps = 60;
const start = driver.points.map((p) => [...p]);
for (let i = 1; i <= steps; ++i) {
    driver.data.points.forEach((point, p) => {
        if (goal[point.name]) driver.movePoint(p, start[p].map((x, k) => x + (i / steps) * (goal[point.name][k] - x)));
    });
    driver.update();
}
const out = { file: path, rest: still, distance: distance(positions(gltf.scene), owners, readObj(goalPath)) / size };
console.log(JSON.stringify(out));
process.exit(Math.max(out.rest, out.distance) <= Number(tolerance) ? 0 : 1);
