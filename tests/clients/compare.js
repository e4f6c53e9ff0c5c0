// SPDX-License-Identifier: GPL-3.0-or-later
// Plays exported files by three.js, or moves them by the reference driver, and compares where their vertices are with the studio: in node as in a browser.
import * as THREE from 'three';
import { ImomushiDriver } from '../../assets/drivers/three.js';

const kSteps = 60;  // of a drag, as a hand makes it

/// Vertices of an .obj file: [[x, y, z], ...].
function readObj(text) {
    const vertices = [];
    for (const line of text.split('\n'))
        if (line.startsWith('v ')) vertices.push(line.slice(2).trim().split(/\s+/).map(Number));
    return vertices;
}

/// Every mesh of a scene with those of its vertices that are drawn.
export function drawnMeshes(scene) {
    const found = [];
    scene.traverse((mesh) => {
        if (!mesh.isMesh) return;
        mesh.geometry.userData.drawn ??= mesh.geometry.index ? [...new Set(mesh.geometry.index.array)] : [...mesh.geometry.attributes.position.array.keys()].slice(0, mesh.geometry.attributes.position.count);
        found.push({ mesh, vertices: mesh.geometry.userData.drawn });
    });
    return found;
}

/// World positions of all drawn vertices, after morph targets and skin, as three.js computes them on the processor.
export function positions(scene) {
    scene.updateMatrixWorld(true);
    const out = [], point = new THREE.Vector3();
    for (const { mesh, vertices } of drawnMeshes(scene)) {
        if (mesh.isSkinnedMesh) mesh.skeleton.update();
        for (const v of vertices) {
            mesh.getVertexPosition(v, point);
            out.push(point.clone().applyMatrix4(mesh.matrixWorld));
        }
    }
    return out;
}

/// For each point the vertices of `rest` that lie at it.
function match(points, rest, room) {
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

function diagonal(rest) {
    const low = [0, 1, 2].map((k) => rest.reduce((m, p) => Math.min(m, p[k]), Infinity)), high = [0, 1, 2].map((k) => rest.reduce((m, p) => Math.max(m, p[k]), -Infinity));
    return Math.hypot(...high.map((h, k) => h - low[k]));
}

/// The farthest that any point is from where `goal` has the vertex that it is at rest; of several in one place the nearest.
function distance(points, owners, goal) {
    let most = 0;
    points.forEach((p, i) => {
        const near = Math.min(...owners[i].map((v) => Math.hypot(goal[v][0] - p.x, goal[v][1] - p.y, goal[v][2] - p.z)));
        if (!(near <= most)) most = near;
    });
    return most;
}

/// Does one job (see check_browser.js) with a loaded file. read: name of a file -> its text; ways: {name: scene -> positions of its drawn vertices}.
/// The answer has the largest distances over the diagonal for each way.
export async function check(gltf, job, read, ways) {
    const obj = async (name) => readObj(await read(name));
    const rest = await obj(job.rest), size = diagonal(rest);
    const owners = match(positions(gltf.scene), rest, 1e-4 * size);
    const out = { file: job.file, lost: owners.filter((o) => o.length === 0).length };
    for (const way in ways) out[way] = [];
    const compare = (goal) => {
        for (const way in ways) out[way].push(distance(ways[way](gltf.scene), owners, goal) / size);
    };
    if (job.times) {
        const mixer = new THREE.AnimationMixer(gltf.scene), action = mixer.clipAction(gltf.animations[0]);
        action.setLoop(THREE.LoopOnce);
        action.clampWhenFinished = true;
        action.play();
        for (const { time, positions: name } of job.times) {
            mixer.setTime(time);
            compare(await obj(name));
        }
    }
    if (job.drag) {
        const driver = new ImomushiDriver(gltf.scene);
        driver.update();
        compare(rest);
        const start = driver.points.map((p) => [...p]);
        for (let i = 1; i <= kSteps; ++i) {
            driver.data.points.forEach((point, p) => {
                const goal = job.drag[point.name];
                if (goal) driver.movePoint(p, start[p].map((x, k) => x + (i / kSteps) * (goal[k] - x)));
            });
            driver.update();
        }
        compare(await obj(job.positions));
    }
    out.good = out.lost === 0 && Object.keys(ways).every((way) => out[way].every((d) => d <= job.tolerance));
    return out;
}
