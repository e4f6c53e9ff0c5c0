// SPDX-License-Identifier: GPL-3.0-or-later
// Moves a character that was exported with the layout "rigged" live: joint points in, frames of elements and weights of morph targets out, by the
// steps of Imomushi's own frame (core/export/driver.h describes the data; eq. (5) of Watanabe et al., FIT 2006). Smooth joints, gravity and inflation act as
// in a body at rest; what moves by itself, large motions, fingers and joints of the previous model do not. For three.js:
//
//   import { ImomushiDriver } from './three.js';
//   const gltf = await new GLTFLoader().loadAsync('caterpillar.glb');
//   const driver = new ImomushiDriver(gltf.scene);
//   driver.movePoint('head-bone/end', [1.0, 1.0, 0.25]);   // as often as you like
//   driver.update();                                       // once per frame
//
// It needs nothing but a scene graph of nodes with position, quaternion, userData, and meshes with morphTargetInfluences.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const add = (a, b) => a.map((x, i) => x + b[i]);
const sub = (a, b) => a.map((x, i) => x - b[i]);
const times = (s, a) => a.map((x) => s * x);
const length = (a) => Math.sqrt(dot(a, a));
const unit = (a) => times(1 / Math.sqrt(a.reduce((sum, x) => sum + x * x, 0)), a);

// Quaternions are [x, y, z, w].
function multiply(a, b) {
    const v = add(add(times(a[3], b), times(b[3], a)), [...cross(a, b), 0]);
    return [v[0], v[1], v[2], a[3] * b[3] - dot(a, b)];
}
function turn(q, v) {
    const t = times(2, cross(q, v));
    return add(add(v.slice(0, 3), times(q[3], t)), cross(q, t));
}
const aboutAxis = (angle, axis) => [...times(Math.sin(angle / 2), axis), Math.cos(angle / 2)];
/// The rotation of least angle from one unit vector to another.
function least(from, to) {
    const w = 1 + dot(from, to);
    if (w < 1e-14) {
        const k = [0, 1, 2].reduce((best, i) => (Math.abs(from[i]) < Math.abs(from[best]) ? i : best), 0);
        return [...unit(cross(from, [0, 1, 2].map((i) => (i === k ? 1 : 0)))), 0];
    }
    return unit([...cross(from, to), w]);
}

// Matrices are arrays of nine, column by column.
const times3 = (m, v) => [0, 1, 2].map((i) => m[i] * v[0] + m[3 + i] * v[1] + m[6 + i] * v[2]);
const transposed = (m) => [0, 1, 2, 3, 4, 5, 6, 7, 8].map((i) => m[3 * (i % 3) + Math.floor(i / 3)]);
const product = (a, b) => [0, 3, 6].flatMap((c) => times3(a, b.slice(c, c + 3)));
const matrix = (q) => [[1, 0, 0], [0, 1, 0], [0, 0, 1]].flatMap((axis) => turn(q, axis));

/// Takes out the twist that the basis of the paper cannot say.
function untwist(l) {
    const twist = Math.atan2(l[1] - l[3], l[0] + l[4]), c = Math.cos(twist), s = Math.sin(twist);
    const x = l.slice(0, 3), y = l.slice(3, 6);
    l.splice(0, 6, ...sub(times(c, x), times(s, y)), ...add(times(s, x), times(c, y)));
}

/// x with m x = right, m symmetric and positive, n x n row by row; m becomes its Cholesky factor.
function solve(m, right, n) {
    for (let i = 0; i < n; ++i)
        for (let j = 0; j <= i; ++j) {
            let sum = m[i * n + j];
            for (let k = 0; k < j; ++k) sum -= m[i * n + k] * m[j * n + k];
            m[i * n + j] = i === j ? Math.sqrt(Math.max(sum, 1e-300)) : sum / m[j * n + j];
        }
    const x = Float64Array.from(right);
    for (let i = 0; i < n; ++i) {
        for (let k = 0; k < i; ++k) x[i] -= m[i * n + k] * x[k];
        x[i] /= m[i * n + i];
    }
    for (let i = n - 1; i >= 0; --i) {
        for (let k = i + 1; k < n; ++k) x[i] -= m[k * n + i] * x[k];
        x[i] /= m[i * n + i];
    }
    return x;
}

/// 1 + x near 0, between .3 and 3 everywhere.
function bounded(x) {
    const room = x < 0 ? 0.7 : 2;
    return 1 + room * Math.tanh(x / room);
}

/// x near 0, below `limit` everywhere: x times this.
const boundFactor = (x, limit) => (1 + (x / limit) ** 6) ** (-1 / 6);

/// Weighted mean of rotations; signs across trees of bones are aligned with the first.
function mean(rotations) {
    let sum = [0, 0, 0, 0];
    const first = rotations[0];
    for (const { q, weight, tree } of rotations) {
        const sign = tree !== first.tree && sum.reduce((s, x, i) => s + x * q[i], 0) < 0 ? -1 : 1;
        sum = add(sum, times(sign * weight, q));
    }
    return Math.hypot(...sum) > 1e-6 ? unit(sum) : first.q;
}

export class ImomushiDriver {
    constructor(scene) {
        this.data = null;
        const nodes = new Map(), meshes = new Map(), parts = new Map();
        scene.traverse((node) => {
            if (node.userData?.imomushi) this.data = node.userData.imomushi;
            if (node.userData?.element !== undefined) meshes.set(node.userData.element, node);
            if (node.userData?.part !== undefined) parts.set(node.userData.part, node);
        });
        if (!this.data) throw new Error('The file was not exported with the layout "rigged".');
        scene.traverse((node) => {
            if (node.userData?.imomushi) this.data.elements.forEach((e, i) => nodes.set(i, node.children[i]));
        });
        this.frames = nodes;
        this.meshes = meshes;
        this.parts = parts;
        if (this.data.smooth) this.prepareSmooth();
        this.rest();
    }

    /// The rest pose.
    rest() {
        this.points = this.data.points.map((p) => [...p.rest]);
        this.rolls = this.data.points.map(() => 0);
        this.rotations = this.data.bones.map(() => [0, 0, 0, 1]);
    }

    /// Moves a joint point, "bone/end" or its index, to [x, y, z] (m), turned by `roll` (radians) about its bone. Rotations of bones follow in update().
    movePoint(point, to, roll) {
        const p = typeof point === 'number' ? point : this.data.points.findIndex((known) => known.name === point);
        if (p < 0) throw new Error(`There is no joint point "${point}".`);
        this.points[p] = [...to];
        if (roll !== undefined) this.rolls[p] = roll;
    }

    /// A pose as the studio has it: points (m), rolls (radians) per joint point; rotations [x, y, z, w] per bone where they are known.
    setPose(points, rolls, rotations) {
        this.points = points.map((p) => [...p]);
        this.rolls = [...rolls];
        if (rotations) this.rotations = rotations.map((q) => [...q]);
        this.given = Boolean(rotations);
    }

    /// Places the skeleton and weighs the morph targets.
    update() {
        if (!this.given) this.transport();
        const frames = this.data.elements.map((e) => this.placeElement(e));
        const joints = this.data.joints.map((j) => this.placeJoint(j, frames));
        const values = this.data.elements.map((element, e) => this.measure(element, frames[e], joints));
        if (this.data.smooth) this.relax(frames, joints, values);
        const ofParts = new Map();
        const show = (node, weights) => node?.traverse((mesh) => mesh.morphTargetInfluences && weights.forEach((w, i) => (mesh.morphTargetInfluences[i] = w)));
        this.data.elements.forEach((element, e) => {
            const frame = frames[e], node = this.frames.get(e), place = add(times3(frame.linear, element.middle), frame.shift);
            node.position.set(...place);
            node.quaternion.set(...frame.rotation);
            const weights = this.weigh(element, values[e]);
            show(this.meshes.get(e), weights);
            for (const [part, first] of element.parts ?? []) {
                const all = ofParts.get(part) ?? [];
                weights.forEach((w, i) => (all[first + i] = (all[first + i] ?? 0) + w));
                ofParts.set(part, all);
            }
        });
        ofParts.forEach((weights, part) => show(this.parts.get(part), weights));
    }

    // Each bone hangs on its parent's by the least rotation.
    transport() {
        this.data.bones.forEach((bone, b) => {
            const along = sub(this.points[bone.end], this.points[bone.start]);
            if (length(along) <= 1e-9 * bone.length) return;
            const base = bone.parent < 0 ? this.rotations[b] : this.rotations[bone.parent];
            this.rotations[b] = unit(multiply(least(unit(turn(base, bone.direction)), unit(along)), base));
        });
    }

    placeElement(element) {
        if (element.bones.length === 0) return { rotation: [0, 0, 0, 1], linear: [1, 0, 0, 0, 1, 0, 0, 0, 1], shift: [0, 0, 0] };
        let anchor = [0, 0, 0];
        const rotations = element.bones.map((b) => {
            const bone = this.data.bones[b];
            anchor = add(anchor, times((0.5 * bone.length) / element.boneLength, add(this.points[bone.start], this.points[bone.end])));
            const roll = bone.rollSign * 0.5 * (this.rolls[bone.start] + this.rolls[bone.end]);
            const q = this.rotations[b];
            return { q: multiply(aboutAxis(roll, turn(q, bone.direction)), q), weight: bone.length, tree: bone.tree };
        });
        if (element.anchorJoint >= 0) anchor = this.points[this.data.joints[element.anchorJoint].point];
        const rotation = unit(mean(rotations)), linear = matrix(rotation);
        return { rotation, linear, shift: sub(anchor, times3(linear, element.anchor)) };
    }

    placeJoint(joint, frames) {
        const rotations = [];
        let carried = [0, 0, 0];
        for (const f of joint.faces) {
            const frame = frames[f.element], own = { q: frame.rotation, weight: 1, tree: -1 - f.element };
            carried = add(carried, times(1 / joint.faces.length, add(times3(frame.linear, joint.place), frame.shift)));
            if (joint.led) {
                if (f.leads) rotations.push(f.bone >= 0 ? { ...own, tree: this.data.bones[f.bone].tree } : own);
            } else if (f.bone >= 0 && joint.point >= 0) {
                rotations.push({ q: this.rotations[f.bone], weight: 1, tree: this.data.bones[f.bone].tree });
            } else {
                rotations.push(own);
            }
        }
        const at = joint.point >= 0 ? this.points[joint.point] : carried;
        let outward = 0, shifted = 0;
        for (const f of joint.faces) {
            if (f.bone < 0) continue;
            const frame = frames[f.element], normal = this.data.elements[f.element].faces[f.face].axes.slice(6, 9);
            outward += dot(times3(frame.linear, normal), sub(at, add(times3(frame.linear, joint.place), frame.shift)));
            ++shifted;
        }
        let rotation = mean(rotations);
        if (!joint.led && joint.point >= 0 && this.rolls[joint.point] !== 0 && length(joint.tangent) > 0)
            rotation = multiply(aboutAxis(this.rolls[joint.point], turn(rotation, joint.tangent)), rotation);
        const turned = matrix(unit(rotation));
        if (this.data.smooth) return { rotation: turned, linear: turned, shift: sub(at, times3(turned, joint.place)) };
        const stretch = shifted > 0 ? bounded((joint.shrink * outward) / shifted) : 1, n = joint.normal;
        const swollen = [0, 1, 2].flatMap((c) => [0, 1, 2].map((r) => (r === c ? stretch : 0) + (1 - stretch) * n[r] * n[c]));
        const linear = product(turned, swollen);
        return { linear, shift: sub(at, times3(linear, joint.place)) };
    }

    /// v of eq. (5) in the frame of the element, and what body loads do.
    measure(element, frame, joints) {
        const v = new Array(element.columns).fill(0), toElement = transposed(frame.linear);
        for (const face of element.faces) {
            if (face.column === undefined) continue;
            const joint = joints[face.joint], toFace = transposed(face.axes);
            const l = product(product(toFace, product(toElement, joint.linear)), face.axes);
            const at = sub(add(times3(joint.linear, face.origin), joint.shift), add(times3(frame.linear, face.origin), frame.shift));
            const shift = times3(toFace, times3(toElement, at));
            if (face.basis === 'paper') untwist(l);
            const columns = [l[0] - 1, 0.5 * (l[3] + l[1]), l[4] - 1, l[2], l[5], shift[2]];
            if (face.basis !== 'paper') columns.push(shift[0], shift[1], 0.5 * (l[1] - l[3]));
            if (!face.flat) columns.push(l[6], l[7], l[8] - 1);
            columns.forEach((x, i) => (v[face.column + i] = x));
        }
        const loads = element.loads;
        if (loads) {
            const all = loads.softness === undefined ? [] : times(loads.softness, times3(toElement, this.data.gravity));
            if (loads.pressure !== undefined) all.push(loads.pressure);
            const wanted = all.reduce((sum, x, i) => sum + Math.abs(x) * loads.sizes[i], 0);
            const part = wanted > 0 ? (loads.most * Math.tanh(wanted / loads.most)) / wanted : 0;
            all.forEach((x, i) => (v[loads.column + i] = part * x));
            if (loads.stretch) {
                const { near, end, length: rest, longer, shorter, perMetre } = loads.stretch, along = times3(toElement, sub(this.points[end], this.points[near]));
                const now = length(along), more = now - rest, room = rest * (more < 0 ? shorter : longer);
                if (now > 0) times3(perMetre, along).forEach((x, i) => (v[loads.column + i] += (room * Math.tanh(more / room) * x) / now));
            }
        }
        return v;
    }

    // What is the same in all frames: where the free parameters of a joint are in the system, the stiffness of an element between the tables of its joints.
    prepareSmooth() {
        const smooth = this.data.smooth, size = smooth.entries.length, free = this.data.joints.map(() => false);
        this.links = this.data.elements.map((element) => {
            if (!element.stiffness || element.faces.length === 0) return null;
            const faces = element.faces, g = Math.round(Math.sqrt(element.stiffness.length)), count = (f) => f.spread.length / size;
            faces.forEach((f) => (free[f.joint] = true));
            const pulls = faces.map((f) => {
                const pull = new Float64Array(size * g);
                for (let i = 0; i < count(f); ++i)
                    for (let a = 0; a < size; ++a)
                        if (f.spread[i * size + a] !== 0) for (let c = 0; c < g; ++c) pull[a * g + c] += f.spread[i * size + a] * element.stiffness[(f.column + i) * g + c];
                return pull;
            });
            const between = faces.map((f, i) => faces.slice(0, i + 1).map((h) => {
                const out = new Float64Array(size * size);
                for (let a = 0; a < size; ++a)
                    for (let k = 0; k < count(h); ++k) for (let b = 0; b < size; ++b) out[a * size + b] += pulls[i][a * g + h.column + k] * h.spread[k * size + b];
                return out;
            }));
            const loads = element.loads?.forces ? element.loads.sizes.length : 0;
            return { g, pulls, between, loads, count: faces.map(count) };
        });
        this.first = [];
        this.unknowns = 0;
        free.forEach((is) => {
            this.first.push(is ? this.unknowns : -1);
            if (is) this.unknowns += smooth.parameters;
        });
    }

    // The shapes of all joints that balance their elements: v of rigid joints becomes v of these.
    relax(frames, joints, values) {
        const { entries, parameters, leastStiffness } = this.data.smooth, size = entries.length, n = this.unknowns;
        const matrix = new Float64Array(n * n), right = new Float64Array(n);
        const turns = this.data.elements.map((element, e) => this.links[e] && element.faces.map((face) => {
            const joint = this.data.joints[face.joint], toFace = transposed(face.axes);
            const t = product(product(toFace, product(transposed(frames[e].linear), joints[face.joint].rotation)), face.axes);
            if (face.basis === 'paper') untwist(t);
            return product(t, product(toFace, joint.axes));
        }));
        this.data.elements.forEach((element, e) => {
            const link = this.links[e];
            if (!link) return;
            element.faces.forEach((face, i) => {
                const at = this.first[face.joint], turn = turns[e][i], force = new Float64Array(size);
                for (let a = 0; a < size; ++a) {
                    for (let c = 0; c < link.g; ++c) force[a] += link.pulls[i][a * link.g + c] * values[e][c];
                    for (let l = 0; l < link.loads; ++l)
                        for (let k = 0; k < link.count[i]; ++k)
                            force[a] += face.spread[k * size + a] * element.loads.forces[(face.column + k) * link.loads + l] * values[e][element.loads.column + l];
                }
                for (let a = 0; a < size; a += 3) {
                    const t = times3(transposed(turn), force.slice(a, a + 3));
                    for (let d = 0; d < 3; ++d) for (const [to, share] of entries[a + d]) right[at + to] -= share * t[d];
                }
                for (let j = 0; j <= i; ++j) {
                    const to = this.first[element.faces[j].joint], other = turns[e][j], between = link.between[i][j];
                    for (let a = 0; a < size; a += 3)
                        for (let b = 0; b < size; b += 3) {
                            const block = [0, 1, 2].flatMap((c) => [0, 1, 2].map((r) => between[(a + r) * size + b + c]));
                            const turned = product(transposed(turn), product(block, other));
                            for (let q = 0; q < 3; ++q)
                                for (const [column, columnShare] of entries[b + q])
                                    for (let p = 0; p < 3; ++p)
                                        for (const [row, rowShare] of entries[a + p]) {
                                            const part = rowShare * columnShare * turned[3 * q + p];
                                            matrix[(at + row) * n + to + column] += part;
                                            if (i !== j) matrix[(to + column) * n + at + row] += part;
                                        }
                        }
                }
            });
        });
        for (const first of this.first) {
            if (first < 0) continue;
            let most = 0;
            for (let i = first; i < first + parameters; ++i) most = Math.max(most, matrix[i * n + i]);
            for (let i = first; i < first + parameters; ++i) matrix[i * n + i] += most > 0 ? leastStiffness * most : 1;
        }
        const solution = solve(matrix, right, n);
        const tables = this.data.joints.map((joint, j) => (this.first[j] < 0 ? null : this.table(joint, solution.slice(this.first[j], this.first[j] + parameters))));
        this.data.elements.forEach((element, e) => {
            if (!this.links[e]) return;
            element.faces.forEach((face, i) => {
                const table = tables[face.joint], turned = [];
                for (let a = 0; a < size; a += 3) turned.push(...times3(turns[e][i], table.slice(a, a + 3)));
                for (let k = 0; k < this.links[e].count[i]; ++k) for (let a = 0; a < size; ++a) values[e][face.column + k] += face.spread[k * size + a] * turned[a];
            });
        });
    }

    // The table of a joint: what its free parameters say, within bounds.
    table(joint, q) {
        const { entries, stretch, fold, slope } = this.data.smooth, table = new Array(entries.length).fill(0);
        const middle = 0.5 * (q[0] + q[2]), half = 0.5 * (q[0] - q[2]), radius = Math.hypot(half, q[1]);
        const within = (x) => x * boundFactor(x, x < 0 ? 1 - stretch[0] : stretch[1] - 1);
        const most = within(middle + radius), lowest = within(middle - radius), turn = radius > 0 ? (0.5 * (most - lowest)) / radius : 0, mid = 0.5 * (most + lowest);
        table[0] = mid + turn * half;
        table[1] = table[3] = turn * q[1];
        table[4] = mid - turn * half;
        for (let i = 6; i < table.length; ++i) table[i] = entries[i].reduce((sum, [from, share]) => sum + share * q[from], 0);
        let worst = 0;
        const shapes = table.length / 3 - 2;
        for (const places of joint.slopes) {
            let folded = 0, out = 0;
            for (let axis = 0; axis < 2; ++axis) {
                const g = [0, 0, 0];
                for (let s = 0; s < shapes; ++s) for (let k = 0; k < 3; ++k) g[k] += table[6 + 3 * s + k] * places[axis * shapes + s];
                folded += g[0] * g[0] + g[1] * g[1];
                out += g[2] * g[2];
            }
            worst = Math.max(worst, folded / (fold * (1 + lowest)) ** 2 + out / slope ** 2);
        }
        const part = boundFactor(Math.sqrt(worst), 1);
        for (let i = 6; i < table.length; ++i) table[i] *= part;
        return table;
    }

    /// Weights of the morph targets: v times the matrix of the file.
    weigh(element, v) {
        const weights = [];
        for (let t = 0; t * element.columns < element.matrix.length; ++t)
            weights.push(v.reduce((sum, x, c) => sum + x * element.matrix[t * element.columns + c], 0));
        return weights;
    }
}
