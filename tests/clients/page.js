// SPDX-License-Identifier: GPL-3.0-or-later
// Runs in the browser that check_browser.js starts: does its jobs by three.js, on the processor and by WebGL, and sends back what came out.
import * as THREE from 'three';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { check, drawnMeshes, positions } from './compare.js';

const kWide = 1024;  // pixels of a row of positions

const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });

const placing = new WeakMap();  // materials of drawnPositions(), whose programs take longer to compile than to run

/// Moves vertices as any material of three.js does, but draws each into a pixel of its own: its world position.
function placingMaterial(mesh) {
    if (!placing.has(mesh))
        placing.set(mesh, new THREE.ShaderMaterial({
            uniforms: { first: { value: 0 }, size: { value: new THREE.Vector2() } },
            blending: THREE.NoBlending, depthTest: false, depthWrite: false,
            vertexShader: `
                #include <common>
                #include <morphtarget_pars_vertex>
                #include <skinning_pars_vertex>
                uniform int first;
                uniform vec2 size;
                flat varying vec3 place;
                void main() {
                    #include <skinbase_vertex>
                    #include <begin_vertex>
                    #include <morphtarget_vertex>
                    #include <skinning_vertex>
                    place = (modelMatrix * vec4(transformed, 1.0)).xyz;
                    int pixel = first + gl_VertexID;
                    gl_Position = vec4((vec2(pixel % ${kWide}, pixel / ${kWide}) + 0.5) / size * 2.0 - 1.0, 0.0, 1.0);
                    gl_PointSize = 1.0;
                }`,
            fragmentShader: `
                flat varying vec3 place;
                void main() { gl_FragColor = vec4(place, 1.0); }`,
        }));
    return placing.get(mesh);
}

/// World positions of all drawn vertices, in the order of positions(), as WebGL has them.
function drawnPositions(scene) {
    const list = drawnMeshes(scene);
    const total = list.reduce((sum, { mesh }) => sum + mesh.geometry.attributes.position.count, 0);
    const target = new THREE.WebGLRenderTarget(kWide, Math.ceil(total / kWide), {
        type: THREE.FloatType, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter, depthBuffer: false,
    });
    let first = 0;
    const kept = list.map(({ mesh }) => {
        const was = { first, material: mesh.material, frustumCulled: mesh.frustumCulled }, material = placingMaterial(mesh);
        material.uniforms.first.value = first;
        material.uniforms.size.value.set(target.width, target.height);
        // Drawn as points; for everything else it stays a mesh with its targets and its skin.
        Object.assign(mesh, { material, frustumCulled: false, isMesh: false, isPoints: true });
        first += mesh.geometry.attributes.position.count;
        return was;
    });
    renderer.setRenderTarget(target);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(scene, new THREE.Camera());
    const pixels = new Float32Array(4 * target.width * target.height);
    renderer.readRenderTargetPixels(target, 0, 0, target.width, target.height, pixels);
    renderer.setRenderTarget(null);
    target.dispose();
    return list.flatMap(({ mesh, vertices }, m) => {
        const { first: begin, material, frustumCulled } = kept[m];
        Object.assign(mesh, { material, frustumCulled, isMesh: true, isPoints: false });
        return vertices.map((v) => {
            const at = 4 * (begin + v), drawn = pixels[at + 3] === 1;
            return drawn ? new THREE.Vector3(pixels[at], pixels[at + 1], pixels[at + 2]) : new THREE.Vector3(NaN, NaN, NaN);
        });
    });
}

/// Sends a picture of the scene as it is, lit and textured. Answers how much of it the scene covers, how many colours it has, and how many textures.
async function takePicture(gltf, name) {
    const [wide, high] = [800, 600], half = (15 * Math.PI) / 180;
    const scene = new THREE.Scene();
    scene.background = new THREE.Color(0x2b3038);
    scene.add(gltf.scene, new THREE.HemisphereLight(0xffffff, 0x667755, 1.6));
    const sun = new THREE.DirectionalLight(0xffffff, 2.4);
    sun.position.set(1, 2, 1.5);
    scene.add(sun);
    const ball = new THREE.Box3().setFromPoints(positions(gltf.scene)).getBoundingSphere(new THREE.Sphere());
    const camera = new THREE.PerspectiveCamera((2 * half * 180) / Math.PI, wide / high, 0.01 * ball.radius, 100 * ball.radius);
    camera.position.copy(ball.center).addScaledVector(new THREE.Vector3(0.8, 0.45, 1).normalize(), (0.8 * ball.radius) / Math.sin(half));
    camera.lookAt(ball.center);
    renderer.setSize(wide, high);
    renderer.render(scene, camera);
    const gl = renderer.getContext(), pixels = new Uint8Array(4 * wide * high);
    gl.readPixels(0, 0, wide, high, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const words = new Uint32Array(pixels.buffer), textures = new Set();
    for (const { mesh } of drawnMeshes(gltf.scene)) if (mesh.material.map?.image?.width > 0) textures.add(mesh.material.map.source);
    await fetch('/picture/' + name, { method: 'POST', body: await new Promise((done) => renderer.domElement.toBlob(done)) });
    return { covered: words.filter((word) => word !== words[0]).length / words.length, colors: new Set(words).size, textures: textures.size };
}

const read = async (name) => (await fetch('/files/' + name)).text();

let answer;
try {
    const gl = renderer.getContext(), info = gl.getExtension('WEBGL_debug_renderer_info');
    if (!gl.getExtension('EXT_color_buffer_float')) throw new Error('WebGL draws no floating point numbers here.');
    answer = { renderer: gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER), checks: [] };
    for (const job of await (await fetch('/jobs')).json()) {
        const gltf = await new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).loadAsync('/files/' + job.file);
        const out = await check(gltf, job, read, { processor: positions, drawn: drawnPositions });
        if (job.picture) out.picture = await takePicture(gltf, job.picture);
        answer.checks.push(out);
    }
} catch (error) {
    answer = { error: String(error.stack ?? error) };
}
await fetch('/done', { method: 'POST', body: JSON.stringify(answer) });
