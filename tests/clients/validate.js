// SPDX-License-Identifier: GPL-3.0-or-later
// Reads exported files by the Khronos validator: node validate.js FILE.glb... Prints one JSON line per file; exit status 1: there are errors or warnings.
import fs from 'node:fs';
import validator from 'gltf-validator';

let good = true;
for (const file of process.argv.slice(2)) {
    const { issues } = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 10 });
    console.log(JSON.stringify({ file, errors: issues.numErrors, warnings: issues.numWarnings, messages: issues.messages.filter((m) => m.severity < 2) }));
    good &&= issues.numErrors === 0 && issues.numWarnings === 0;
}
process.exit(good ? 0 : 1);
