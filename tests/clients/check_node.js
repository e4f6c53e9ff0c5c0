// SPDX-License-Identifier: GPL-3.0-or-later
// The jobs of check_browser.js without a browser: by three.js in node, which draws nothing and loads no textures. Pictures are left out.
//   node check_node.js JOBS.json
import fs from 'node:fs';
import { check, positions } from './compare.js';
import { load } from './load.js';

const checks = [];
for (const job of JSON.parse(fs.readFileSync(process.argv[2])))
    checks.push(await check(await load(job.file), job, async (name) => fs.readFileSync(name, 'utf8'), { processor: positions }));
console.log(JSON.stringify({ checks }));
process.exit(checks.every((c) => c.good) ? 0 : 1);
