// SPDX-License-Identifier: GPL-3.0-or-later
// Loads .glb files by three.js in node, where there are no pictures.
import fs from 'node:fs';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

globalThis.self = globalThis;  // which GLTFLoader wants of a browser

/// A loaded .glb file, without its textures.
export function load(path) {
    const bytes = fs.readFileSync(path), length = bytes.readUInt32LE(12);
    const json = JSON.parse(bytes.subarray(20, 20 + length));
    for (const key of ['images', 'textures', 'samplers']) delete json[key];
    for (const material of json.materials ?? []) delete material.pbrMetallicRoughness?.baseColorTexture;
    // What is left is shorter: spaces fill the rest.
    bytes.fill(' ', 20, 20 + length);
    bytes.write(JSON.stringify(json), 20);
    return new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
}
