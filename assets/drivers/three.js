// SPDX-License-Identifier: GPL-3.0-or-later
// Moves a character that was exported with the layout "rigged" live: joint points in, frames of elements and weights of morph targets out, by the
// steps of Imomushi's own frame (core/export/driver.h describes the data; eq. (5) of Watanabe et al., FIT 2006). For three.js:
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

/// 1 + x near 0, between .3 and 3 everywhere.
function bounded(x) {
    const room = x < 0 ? 0.7 : 2;
    return 1 + room * Math.tanh(x / room);
}

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
        const nodes = new Map(), meshes = new Map();
        scene.traverse((node) => {
            if (node.userData?.imomushi) this.data = node.userData.imomushi;
            if (node.userData?.element !== undefined) meshes.set(node.userData.element, node);
        });
        if (!this.data) throw new Error('The file was not exported with the layout "rigged".');
        scene.traverse((node) => {
            if (node.userData?.imomushi) this.data.elements.forEach((e, i) => nodes.set(i, node.children[i]));
        });
        this.frames = nodes;
        this.meshes = meshes;
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
        this.data.elements.forEach((element, e) => {
            const frame = frames[e], node = this.frames.get(e), place = add(times3(frame.linear, element.middle), frame.shift);
            node.position.set(...place);
            node.quaternion.set(...frame.rotation);
            const weights = this.weigh(element, frame, joints);
            this.meshes.get(e)?.traverse((mesh) => mesh.morphTargetInfluences && weights.forEach((w, i) => (mesh.morphTargetInfluences[i] = w)));
        });
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
        const stretch = shifted > 0 ? bounded((joint.shrink * outward) / shifted) : 1, n = joint.normal;
        const swollen = [0, 1, 2].flatMap((c) => [0, 1, 2].map((r) => (r === c ? stretch : 0) + (1 - stretch) * n[r] * n[c]));
        const linear = product(matrix(unit(rotation)), swollen);
        return { linear, shift: sub(at, times3(linear, joint.place)) };
    }

    /// Weights of the morph targets: v of eq. (5), in the frame of the element, times the matrix of the file.
    weigh(element, frame, joints) {
        const v = new Array(element.columns).fill(0), toElement = transposed(frame.linear);
        for (const face of element.faces) {
            if (face.column === undefined) continue;
            const joint = joints[face.joint], toFace = transposed(face.axes);
            const l = product(product(toFace, product(toElement, joint.linear)), face.axes);
            const at = sub(add(times3(joint.linear, face.origin), joint.shift), add(times3(frame.linear, face.origin), frame.shift));
            const shift = times3(toFace, times3(toElement, at));
            if (face.basis === 'paper') {
                // Without the twist that the basis cannot say.
                const twist = Math.atan2(l[1] - l[3], l[0] + l[4]), c = Math.cos(twist), s = Math.sin(twist);
                const x = l.slice(0, 3), y = l.slice(3, 6);
                l.splice(0, 6, ...sub(times(c, x), times(s, y)), ...add(times(s, x), times(c, y)));
            }
            const columns = [l[0] - 1, 0.5 * (l[3] + l[1]), l[4] - 1, l[2], l[5], shift[2]];
            if (face.basis !== 'paper') columns.push(shift[0], shift[1], 0.5 * (l[1] - l[3]));
            if (!face.flat) columns.push(l[6], l[7], l[8] - 1);
            columns.forEach((x, i) => (v[face.column + i] = x));
        }
        const weights = [];
        for (let t = 0; t * element.columns < element.matrix.length; ++t)
            weights.push(v.reduce((sum, x, c) => sum + x * element.matrix[t * element.columns + c], 0));
        return weights;
    }
}
