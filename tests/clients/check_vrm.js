// SPDX-License-Identifier: GPL-3.0-or-later
// Loads .vrm files by three-vrm in node, without pictures: node check_vrm.js FILE.vrm... Prints a JSON line per file: where the humanoid bones are, what the expressions move, the licence.
import { VRMLoaderPlugin } from '@pixiv/three-vrm';
import fs from 'node:fs';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { Vector3 } from 'three';

globalThis.self = globalThis;

for (const file of process.argv.slice(2)) {
    const bytes = fs.readFileSync(file), length = bytes.readUInt32LE(12), json = JSON.parse(bytes.subarray(20, 20 + length));
    for (const key of ['images', 'textures', 'samplers']) delete json[key];
    for (const material of json.materials ?? []) delete material.pbrMetallicRoughness?.baseColorTexture;
    bytes.fill(' ', 20, 20 + length);
    bytes.write(JSON.stringify(json), 20);
    const loader = new GLTFLoader();
    loader.register((parser) => new VRMLoaderPlugin(parser));
    const gltf = await loader.parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
    const vrm = gltf.userData.vrm;
    gltf.scene.updateMatrixWorld(true);
    const bones = {}, expressions = {};
    for (const [role, bone] of Object.entries(vrm.humanoid.rawHumanBones)) bones[role] = bone.node.getWorldPosition(new Vector3()).toArray();
    for (const expression of vrm.expressionManager?.expressions ?? []) expressions[expression.expressionName] = expression.binds?.length ?? expression._binds?.length ?? 0;
    console.log(JSON.stringify({ file, bones, expressions, meta: vrm.meta, springs: vrm.springBoneManager?.joints.size ?? 0, lookAt: !!vrm.lookAt, firstPerson: vrm.firstPerson?.meshAnnotations.length ?? 0 }));
}
