// SPDX-License-Identifier: GPL-3.0-or-later
// The jobs of check_browser.js without a browser: by three.js in node, which draws nothing and loads no textures. Pictures are left out.
//   node check_node.js JOBS.json
import fs from 'node:fs';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { check, positions } from './compare.js';

globalThis.self = globalThis;  // which GLTFLoader wants of a browser

/// A loaded .glb file, without its textures.
function load(path) {
    const bytes = fs.readFileSync(path), length = bytes.readUInt32LE(12);
    const json = JSON.parse(bytes.subarray(20, 20 + length));
    for (const key of ['images', 'textures', 'samplers']) delete json[key];
    for (const material of json.materials ?? []) delete material.pbrMetallicRoughness?.baseColorTexture;
    // What is left is shorter: spaces fill the rest.
    bytes.fill(' ', 20, 20 + length);
    bytes.write(JSON.stringify(json), 20);
    return new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
}

const checks = [];
for (const job of JSON.parse(fs.readFileSync(process.argv[2])))
    checks.push(await check(await load(job.file), job, async (name) => fs.readFileSync(name, 'utf8'), { processor: positions }));
console.log(JSON.stringify({ checks }));
process.exit(checks.every((c) => c.good) ? 0 : 1);
