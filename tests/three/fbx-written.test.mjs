// FBX files that Gaitway writes, in the programs that read them: three.js's FBXLoader, Blender and assimp. Joints are where `gaitway
// pose` has them in the original, and skinned meshes where GLTFLoader has them.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import * as THREE from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { dataFile, gltfWithoutLooks, repository, skipWithoutData } from "./data.mjs";
import { document, program, run } from "./gaitway.mjs";

/** Largest distance allowed, in multiples of the farthest joint's distance from the origin. */
const TOLERANCE = 1e-4;
const FRACTIONS = [0, 0.1234, 0.37, 0.6789, 1];
const CENTIMETRES_PER_METRE = 100;
const MAX_CLIPS = 3;

/** At most four weights, no scaled joints, no steps, no splines: the rest FBXLoader reads otherwise. */
const CHARACTERS = [
  "threejs/Soldier.glb",
  "threejs/Xbot.glb",
  "cosc422/dwarf.glb",
  "cosc422/ArmyPilot.glb",
  "khronos/CesiumMan/glTF-Binary/CesiumMan.glb",
  "khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb",
  "khronos/Fox/glTF-Binary/Fox.glb",
  "mesh2motion/retarget/m2m-sample-rig.glb",
];

// What the loaders need of a browser; images never arrive.
const image = { addEventListener() {}, removeEventListener() {} };
Object.assign(globalThis, { self: globalThis, window: globalThis, document: { createElementNS: () => image }, ProgressEvent: globalThis.ProgressEvent ?? Event });
console.warn = () => {};
const { FBXLoader } = await import("three/examples/jsm/loaders/FBXLoader.js");

/** @type {string} */
let folder;
before(() => (folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-fbx-"))));
after(() => fs.rmSync(folder, { recursive: true, force: true }));

/**
 * Writes a model as FBX and returns the file.
 * @param {string} model
 * @param {...string} options
 */
async function written(model, ...options) {
  const out = path.join(folder, `${path.basename(model).replace(/\.\w+$/, "")}${options.join("")}.fbx`);
  const { status, stderr } = await run("export", model, "--out", out, ...options);
  assert.equal(status, 0, stderr);
  return out;
}

describe("written FBX plays in three.js", { skip: skipWithoutData, concurrency: 1 }, () => {
  if (skipWithoutData) return;
  for (const name of CHARACTERS) test(name, () => compareInThree(dataFile(name)));
});

/** @param {string} file */
async function compareInThree(file) {
  const bytes = fs.readFileSync(await written(file));
  const ours = new FBXLoader().parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), "");
  const theirs = await original(file);
  const metresPerUnit = (ours.userData.unitScaleFactor ?? 1) / CENTIMETRES_PER_METRE;
  const { clips } = await document("inspect", file);
  assert.equal(ours.animations.length, clips.length);
  const players = [ours, theirs.scene].map((root) => new THREE.AnimationMixer(root));
  let poses = 0;
  for (const [clip, { duration_secs }] of clips.slice(0, MAX_CLIPS).entries())
    for (const fraction of FRACTIONS) {
      const time = fraction * duration_secs;
      play(players[0], ours.animations[clip], time);
      play(players[1], theirs.animations[clip], time);
      /** @type {{ nodes: { name: string, world: number[] }[] }} */
      const { nodes } = await document("pose", file, "--clip", String(clip), "--time", String(time));
      const size = Math.max(...nodes.map((node) => Math.hypot(...node.world.slice(12, 15))));
      const at = new THREE.Vector3();
      for (const { name, world } of nodes) {
        const bone = ours.getObjectByName(THREE.PropertyBinding.sanitizeNodeName(name));
        if (!bone || !(/** @type {any} */ (bone).isBone) || nodes.filter((node) => node.name === name).length > 1) continue;
        const distance = at.setFromMatrixPosition(bone.matrixWorld).multiplyScalar(metresPerUnit).distanceTo(new THREE.Vector3().fromArray(world, 12));
        assert.ok(distance <= TOLERANCE * size, `${name} in clip ${clip} at ${time} s: ${distance} m off`);
      }
      const [box, expected] = [ours, theirs.scene].map((root) => new THREE.Box3().setFromObject(root, true));
      box.min.multiplyScalar(metresPerUnit);
      box.max.multiplyScalar(metresPerUnit);
      const off = Math.max(box.min.distanceTo(expected.min), box.max.distanceTo(expected.max));
      assert.ok(off <= 2 * TOLERANCE * size, `meshes in clip ${clip} at ${time} s: ${off} m off`);
      poses++;
    }
  assert.ok(poses > 0, "no pose compared");
}

/**
 * @param {THREE.AnimationMixer} mixer
 * @param {THREE.AnimationClip} clip
 * @param {number} time
 */
function play(mixer, clip, time) {
  mixer.stopAllAction();
  const action = mixer.clipAction(clip).setLoop(THREE.LoopOnce, 1);
  action.clampWhenFinished = true;
  action.reset().play();
  mixer.setTime(time);
  /** @type {THREE.Object3D} */ (mixer.getRoot()).updateMatrixWorld(true);
}

/**
 * Loads a glTF without what only changes its looks.
 * @param {string} file
 */
async function original(file) {
  const json = gltfWithoutLooks(file);
  return await new GLTFLoader().parseAsync(/** @type {string} */ (/** @type {unknown} */ (json)), "");
}

/**
 * Returns a Python with a module, or undefined.
 * @param {string} name
 */
const withModule = (name) =>
  ["GAITWAY_PYTHON" in process.env ? String(process.env.GAITWAY_PYTHON) : "python3"].find((program) => spawnSync(program, ["-c", `import ${name}`]).status === 0);

/**
 * Runs a script of this folder and returns the document that it prints last.
 * @param {string} python
 * @param {string} script
 * @param {...string} options
 */
function script(python, script, ...options) {
  const file = path.join(repository, "tests/three", script);
  const printed = execFileSync(python, [file, ...options], { encoding: "utf8", stdio: ["ignore", "pipe", "inherit"] });
  return JSON.parse(printed.trim().split("\n").pop() ?? "");
}

const blender = withModule("bpy");
const skipBlender = skipWithoutData || (blender === undefined ? "skipped: no Python with bpy (GAITWAY_PYTHON)" : false);

describe("Blender reads written FBX", { skip: skipBlender }, () => {
  if (skipBlender || blender === undefined) return;
  for (const name of ["threejs/Soldier.glb", "cosc422/dwarf.glb", "mesh2motion/retarget/m2m-sample-rig.glb", "kaykit/Knight.glb"])
    test(name, async () => {
      const file = dataFile(name);
      const { compared, worst, objects } = script(blender, "blender_fbx.py", await written(file, "--for=blender"), program, file);
      assert.ok(compared > 50 && worst < 1e-3, `${compared} joints, at most ${worst} m off`);
      for (const { name, scale } of objects) assert.ok(Math.abs(scale - 1) < 1e-3, `${name}: scale ${scale}`);
    });
});

const assimp = withModule("assimp_py");
const skipAssimp = skipWithoutData || (assimp === undefined ? "skipped: no Python with assimp_py (GAITWAY_PYTHON)" : false);

describe("assimp reads written FBX", { skip: skipAssimp }, () => {
  if (skipAssimp || assimp === undefined) return;
  for (const name of CHARACTERS)
    test(name, async () => {
      const file = dataFile(name);
      const [ours, theirs] = [await written(file), file].map((file) => script(assimp, "assimp_fbx.py", file));
      assert.equal(ours.triangles, theirs.triangles);
      for (const [index, side] of theirs.size.entries()) assert.ok(Math.abs(ours.size[index] / CENTIMETRES_PER_METRE - side) <= 1e-3 * Math.max(...theirs.size), `${ours.size} ${theirs.size}`);
    });
});
