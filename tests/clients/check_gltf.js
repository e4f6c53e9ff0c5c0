// SPDX-License-Identifier: GPL-3.0-or-later
// Checks an exported .glb file by two programs that are not ours:
//   node check_gltf.js FILE.glb REST.obj [TIME POSITIONS.obj TOLERANCE]...
// The Khronos validator finds neither errors nor warnings; three.js has the vertices of the first animation at each TIME (s) where POSITIONS.obj, written by
// write-mesh, has them, within TOLERANCE of the bounding-box diagonal of REST.obj. Prints one JSON line; the exit status is 1 where anything is wrong.
import fs from 'node:fs';
import { createRequire } from 'node:module';
import * as THREE from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

const validator = createRequire(import.meta.url)('gltf-validator');

// What GLTFLoader wants of a browser; no picture is decoded.
globalThis.self = globalThis;
globalThis.createImageBitmap = undefined;

export function readObj(path) {
    const vertices = [];
    for (const line of fs.readFileSync(path, 'utf8').split('\n'))
        if (line.startsWith('v ')) vertices.push(line.slice(2).trim().split(/\s+/).map(Number));
    return vertices;
}

/// The scene of a file, without its textures.
export async function load(path) {
    const bytes = fs.readFileSync(path);
    const text = bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString();
    const json = JSON.parse(text);
    for (const key of ['images', 'textures', 'samplers']) delete json[key];
    for (const material of json.materials ?? []) delete material.pbrMetallicRoughness?.baseColorTexture;
    let plain = Buffer.from(JSON.stringify(json));
    plain = Buffer.concat([plain, Buffer.alloc((4 - plain.length % 4) % 4, 0x20)]);
    const binary = bytes.subarray(20 + bytes.readUInt32LE(12));
    const head = Buffer.alloc(20);
    head.writeUInt32LE(0x46546C67, 0);
    head.writeUInt32LE(2, 4);
    head.writeUInt32LE(20 + plain.length + binary.length, 8);
    head.writeUInt32LE(plain.length, 12);
    head.writeUInt32LE(0x4E4F534A, 16);
    const whole = Buffer.concat([head, plain, binary]);
    return new GLTFLoader().parseAsync(whole.buffer.slice(whole.byteOffset, whole.byteOffset + whole.length), '');
}

/// World positions of every mesh, after morph targets and skin.
export function positions(scene) {
    scene.updateMatrixWorld(true);
    const out = [], point = new THREE.Vector3();
    scene.traverse((mesh) => {
        if (!mesh.isMesh) return;
        if (mesh.isSkinnedMesh) mesh.skeleton.update();
        const used = new Set(mesh.geometry.index.array);
        for (const v of used) {
            mesh.getVertexPosition(v, point);
            out.push(point.clone().applyMatrix4(mesh.matrixWorld));
        }
    });
    return out;
}

/// For each point the vertices of `rest` that lie at it.
export function match(points, rest, room) {
    const cells = new Map(), key = (x, y, z) => `${x},${y},${z}`, cell = (c) => Math.round(c / room);
    rest.forEach((p, i) => {
        const k = key(...p.map(cell));
        if (!cells.has(k)) cells.set(k, []);
        cells.get(k).push(i);
    });
    return points.map((p) => {
        const at = [p.x, p.y, p.z], c = at.map(cell);
        const near = [];
        for (let x = -1; x <= 1; ++x)
            for (let y = -1; y <= 1; ++y)
                for (let z = -1; z <= 1; ++z) near.push(...(cells.get(key(c[0] + x, c[1] + y, c[2] + z)) ?? []));
        return near.filter((i) => Math.hypot(...rest[i].map((v, k) => v - at[k])) < room);
    });
}

export function diagonal(rest) {
    const low = [0, 1, 2].map((k) => rest.reduce((m, p) => Math.min(m, p[k]), Infinity)), high = [0, 1, 2].map((k) => rest.reduce((m, p) => Math.max(m, p[k]), -Infinity));
    return Math.hypot(...high.map((h, k) => h - low[k]));
}

/// The farthest that any point is from where `goal` has the vertex that it is at rest; of several in one place the nearest.
export function distance(points, owners, goal) {
    let most = 0;
    points.forEach((p, i) => {
        const near = Math.min(...owners[i].map((v) => Math.hypot(goal[v][0] - p.x, goal[v][1] - p.y, goal[v][2] - p.z)));
        if (!(near <= most)) most = near;
    });
    return most;
}

async function main([path, restPath, ...frames]) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(path)), { maxIssues: 10 });
    const out = { file: path, errors: report.issues.numErrors, warnings: report.issues.numWarnings, issues: report.issues.messages.filter((m) => m.severity < 2), distances: [] };
    let good = out.errors === 0 && out.warnings === 0;
    const gltf = await load(path);
    const rest = readObj(restPath), size = diagonal(rest);
    const owners = match(positions(gltf.scene), rest, 1e-4 * size);
    out.lost = owners.filter((o) => o.length === 0).length;
    good &&= out.lost === 0;
    if (frames.length > 0) {
        const mixer = new THREE.AnimationMixer(gltf.scene);
        const action = mixer.clipAction(gltf.animations[0]);
        action.setLoop(THREE.LoopOnce);
        action.clampWhenFinished = true;
        action.play();
        for (let i = 0; i < frames.length; i += 3) {
            mixer.setTime(Number(frames[i]));
            const d = distance(positions(gltf.scene), owners, readObj(frames[i + 1])) / size;
            out.distances.push(d);
            good &&= d <= Number(frames[i + 2]);
        }
    }
    console.log(JSON.stringify(out));
    process.exit(good ? 0 : 1);
}

if (process.argv[1]?.endsWith('check_gltf.js')) await main(process.argv.slice(2));
