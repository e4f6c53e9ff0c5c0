// SPDX-License-Identifier: GPL-3.0-or-later
// Checks exported .glb files by three.js in headless Chromium (page.js):
//   node check_browser.js JOBS.json
// JOBS.json: [{file, rest, tolerance, times: [{time, positions}], picture?}, ...], or with a drag by the reference driver instead of times:
// {file, rest, tolerance, drag: {"bone/end": [x, y, z], ...}, positions}. Names are of files in the current folder, rest and positions as write-mesh writes them;
// time in s; tolerance over the bounding-box diagonal at rest; drag: where the studio has the joint points in the pose of positions; picture: a .png file to
// write. Prints one JSON line. Exit status: 0 all is within tolerance, 1 not, 77 there is no Chromium.
import { spawn, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const kPatience = 240e3;  // ms, for all jobs on a slow machine
const kTypes = { '.html': 'text/html', '.js': 'text/javascript' };
const root = fileURLToPath(new URL('../..', import.meta.url));

const browser = ['chromium-headless-shell', 'chromium', 'chromium-browser', 'google-chrome'].find((name) => spawnSync(name, ['--version']).status === 0);
if (!browser) process.exit(77);

// The page and what it loads: from the project, but files/ from the current folder.
let finish;
const finished = new Promise((done) => (finish = done));
const server = http.createServer(async (request, response) => {
    const [, folder, ...rest] = decodeURIComponent(request.url).split('/');
    if (request.method === 'POST') {
        const parts = [];
        for await (const part of request) parts.push(part);
        if (folder === 'picture') fs.writeFileSync(path.basename(rest[0]), Buffer.concat(parts));
        response.end();
        if (folder === 'done') finish(JSON.parse(Buffer.concat(parts)));
        return;
    }
    const file = folder === 'jobs' ? process.argv[2] : folder === 'files' ? path.join(...rest) : path.join(root, folder, ...rest);
    fs.readFile(file, (error, bytes) => response.writeHead(error ? 404 : 200, { 'Content-Type': kTypes[path.extname(file)] ?? 'application/octet-stream' }).end(bytes));
});
await new Promise((done) => server.listen(0, '127.0.0.1', done));

const profile = fs.mkdtempSync(path.join(os.tmpdir(), 'imomushi-chromium-'));
// Tests may run as root, where Chromium has no sandbox, and without a graphics card.
const chromium = spawn(browser, ['--headless', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-dev-shm-usage', '--disable-background-networking',
    '--no-first-run', `--user-data-dir=${profile}`, `http://127.0.0.1:${server.address().port}/tests/clients/page.html`], { stdio: ['ignore', 'ignore', 'pipe'], detached: true });
let said = '';
chromium.stderr.on('data', (text) => (said = (said + text).slice(-2000)));
const ended = new Promise((done) => chromium.on('exit', done));
ended.then((status) => finish({ error: `Chromium ended with status ${status}: ${said}` }));
const patience = setTimeout(() => finish({ error: `Chromium gave no answer: ${said}` }), kPatience);

const answer = await finished;
clearTimeout(patience);
try {
    process.kill(-chromium.pid, 'SIGKILL');  // with its helpers
} catch {}  // it had ended
await ended;
fs.rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
console.log(JSON.stringify(answer));
process.exit(!answer.error && answer.checks.every((c) => c.good) ? 0 : 1);
