// The avatars whose pictures are compared with three-vrm's.
import fs from "node:fs";
import path from "node:path";
import { dataFile, readGltf } from "../three/data.mjs";
import { glb } from "./spheres.mjs";
import { toonGrid, toonGrid0 } from "./toon.mjs";

const CUBES = "materials/three-vrm/core/cube.gltf";
/** The head of the cubes. @type {import("./draw.mjs").Bounds} */
const HEAD = { min: [-0.2, 1.4, -0.2], max: [0.2, 1.8, 0.2] };
const EXPRESSIONS = "vrm/vrm1_VRMC_vrm_expressions_isBinary_Overridden.vrm";
const MTOON = "materials/three-vrm/materials-mtoon";
const UV_ANIMATION = "vrm/vrm1_VRMC_materials_mtoon_UV_Animation_Test.vrm";

/** By how much a picture may differ. */
const LIMIT = 2;
/**
 * For rough metal, which is darker towards the bottom of the panels in Gaitway and the Khronos glTF Sample Renderer
 * (0.7 apart), but evenly bright in three.js.
 */
const ROUGH_METAL = 4.5;
/**
 * For emission of VRM 0.x, which three-vrm converts from gamma space. It is linear: MToon_Emission_0.5 must be as bright
 * as Unlit_Linear_0.5.
 */
const EMISSION_0 = 5.5;

/** Files of the data folder. @type {[string, import("./draw.mjs").Shown, limit?: number][]} */
const FILES = [
  ["vrm/vrm0_cryptovoxels.vrm", { yaw: 205 }],
  ["vrm/vrm0_EmissionMigration_v0.107.0.vrm", { yaw: 205 }, EMISSION_0],
  [UV_ANIMATION, { hasKey: true }],
  [EXPRESSIONS, { expressions: { happy: 0.3, blink: 1 } }, ROUGH_METAL],
  [EXPRESSIONS, { expressions: { blink: 1 } }, ROUGH_METAL],
  [CUBES, { bounds: HEAD }],
  [CUBES, { bounds: HEAD, look: [3, 1, 1] }],
  [CUBES, { bounds: HEAD, expressions: { aa: 0.6, blinkLeft: 1 } }],
  [`${MTOON}/cube.gltf`, { hasKey: true }],
  [`${MTOON}/khr-materials-emissive-strength-test.gltf`, { hasKey: true }],
  ["materials/three-vrm/node-constraint/cubes.gltf", {}],
];

/** @typedef {{ name: string, file: string, shown: import("./draw.mjs").Shown, limit: number }} Avatar */

/**
 * Returns the files, how they are shown, and by how much the pictures may differ.
 * @param {string} folder Gets the files that are made in code.
 * @returns {Avatar[]}
 */
export function avatars(folder) {
  /** @type {[string, Buffer, import("./draw.mjs").Shown][]} */
  const made = [
    ["toon.glb", toonGrid(), { hasKey: true }],
    ["toon-0.x.glb", toonGrid0(), { hasKey: true }],
    ["uv-animation.vrm", withStillClip(dataFile(UV_ANIMATION)), { hasKey: true, timeSecs: 0.4 }],
  ];
  const inFolder = made.map(([name, bytes, shown]) => {
    const file = path.join(folder, name);
    fs.writeFileSync(file, bytes);
    return { name, file, shown, limit: LIMIT };
  });
  const real = FILES.map(([name, shown, limit = LIMIT]) => {
    const { expressions, look } = shown;
    const state = [...Object.entries(expressions ?? {}).map((pair) => pair.join(" ")), ...(look ? ["look"] : [])];
    return { name: [name, ...state].join(", "), file: dataFile(name), shown, limit };
  });
  return [...inFolder, ...real];
}

/**
 * Returns a .glb or .vrm with a clip in which nothing moves. Its time moves MToon's texture coordinates.
 * @param {string} file
 */
function withStillClip(file) {
  const { json, binary } = /** @type {{ json: any, binary: Buffer }} */ (readGltf(file));
  const keys = new Float32Array([0, 1, 0, 0, 0, 0, 0, 0]);
  const buffer = 0;
  const byteOffset = json.buffers[buffer].byteLength;
  const view = json.bufferViews.push({ buffer, byteOffset, byteLength: 8 }, { buffer, byteOffset: byteOffset + 8, byteLength: 24 }) - 2;
  const times = { bufferView: view, componentType: 5126, count: 2, type: "SCALAR", min: [0], max: [1] };
  const input = json.accessors.push(times, { bufferView: view + 1, componentType: 5126, count: 2, type: "VEC3" }) - 2;
  const node = json.nodes.push({ name: "still" }) - 1;
  json.scenes[0].nodes.push(node);
  const channels = [{ sampler: 0, target: { node, path: "translation" } }];
  json.animations = [{ channels, samplers: [{ input, output: input + 1 }] }];
  json.buffers[buffer].byteLength += keys.byteLength;
  return glb(json, Buffer.concat([binary.subarray(0, byteOffset), Buffer.from(keys.buffer)]));
}
