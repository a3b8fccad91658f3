// Clips that `gaitway retarget` writes alone, in the programs that read them: VRM animations in three-vrm-animation, BVH
// in Blender's importer. Joints are where `gaitway pose` has them in the written model.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import * as vrm from "@pixiv/three-vrm";
import { VRMAnimationLoaderPlugin, createVRMAnimationClip } from "@pixiv/three-vrm-animation";
import * as THREE from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { dataFile, gltfWithoutLooks, repository, skipWithoutData } from "./data.mjs";
import { document, program, run } from "./gaitway.mjs";

/** @type {{ VRMHumanoidLoaderPlugin: new (parser: unknown) => any }} The package's types import a folder, which TypeScript can't resolve. */
const { VRMHumanoidLoaderPlugin } = /** @type {any} */ (vrm);

/** Largest distance allowed, in heights of the character. */
const TOLERANCE = 1e-3;
const FRACTIONS = [0, 0.1234, 0.37, 0.6789, 1];

const AVATARS = ["vrm0_cryptovoxels", "vrm1_VRMC_vrm_expressions_isBinary_Overridden", "vrm1_VRMC_materials_mtoon_UV_Animation_Test"];
const MOTIONS = ["bvh/cosc422_Walk.bvh", "vrm/three-vrm_test.vrma", "threejs/Samba_Dancing.glb"];

// What GLTFLoader needs of a browser.
Object.assign(globalThis, { self: globalThis.self ?? globalThis, ProgressEvent: globalThis.ProgressEvent ?? Event });

/** A Python with Blender's module, or undefined. */
const python = ["GAITWAY_PYTHON" in process.env ? String(process.env.GAITWAY_PYTHON) : "python3"].find(
  (program) => spawnSync(program, ["-c", "import bpy"]).status === 0,
);

/** @type {string} */
let folder;
before(() => (folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-clips-"))));
after(() => fs.rmSync(folder, { recursive: true, force: true }));

/**
 * Loads a file without anything that only changes its looks.
 * @param {string} file
 * @param {(parser: any) => any} plugin
 */
async function load(file, plugin) {
  const json = gltfWithoutLooks(file);
  const loader = new GLTFLoader();
  loader.register(plugin);
  return { json, gltf: await loader.parseAsync(/** @type {string} */ (/** @type {unknown} */ (json)), "") };
}

describe("written VRM animations play in three-vrm", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  for (const avatar of AVATARS)
    for (const motion of MOTIONS) test(`${avatar} ← ${path.basename(motion)}`, () => compareInThreeVrm(dataFile(`vrm/${avatar}.vrm`), dataFile(motion)));
  const edits = ["--mirror", "--turn", "40", "--contacts", "keep", "--pin", "leftHand=at:0.3,1.1,0.3", "--pin", "head=look:1,1,2"];
  test("a mirrored and turned clip with contacts and pins", () => compareInThreeVrm(dataFile(`vrm/${AVATARS[0]}.vrm`), dataFile(MOTIONS[0]), edits));
  test("a clip of a model that is no avatar", async () => {
    const vrma = path.join(folder, "soldier.vrma");
    const { status, stderr } = await run("convert", dataFile("threejs/Soldier.glb"), "--clip", "Run", "--out", vrma);
    assert.equal(status, 0, stderr);
    await compareInThreeVrm(dataFile(`vrm/${AVATARS[0]}.vrm`), vrma);
  });
});

describe("written VRM animations have the expressions of their motion in three-vrm", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  for (const avatar of ["vrm0_EmissionMigration_v0.107.0", "vrm1_VRMC_vrm_expressions_isBinary_Overridden"])
    test(avatar, async () => {
      const motion = dataFile("vrm/three-vrm_test.vrma");
      const out = path.join(folder, `${avatar}.vrma`);
      const { status, stderr } = await run("retarget", "--model", dataFile(`vrm/${avatar}.vrm`), "--motion", motion, "--out", out);
      assert.equal(status, 0, stderr);
      const [expected, found] = await Promise.all([motion, out].map(happiness));
      assert.ok(new Set(expected).size > 5, "the motion's face doesn't move");
      expected.forEach((weight, at) => assert.ok(Math.abs(weight - found[at]) < 1e-5, `${weight}, written as ${found[at]}`));
    });
});

/**
 * Returns the weights of the only expression at fifty moments, as three-vrm reads them.
 * @param {string} file
 * @returns {Promise<number[]>}
 */
async function happiness(file) {
  const { gltf } = await load(file, (parser) => new VRMAnimationLoaderPlugin(parser));
  /** @type {import("@pixiv/three-vrm-animation").VRMAnimation} */
  const { duration, expressionTracks } = gltf.userData.vrmAnimations[0];
  assert.deepEqual([...expressionTracks.preset.keys()], ["happy"]);
  const track = /** @type {any} */ (expressionTracks.preset.get("happy")).createInterpolant();
  return Array.from({ length: 50 }, (_, at) => track.evaluate((duration * at) / 49)[0]);
}

/**
 * @param {string} model
 * @param {string} motion
 * @param {string[]} [edits]
 */
async function compareInThreeVrm(model, motion, edits = []) {
  const [whole, alone] = ["whole.vrm", "alone.vrma"].map((name) => path.join(folder, name));
  for (const out of [whole, alone]) {
    const { status, stderr } = await run("retarget", "--model", model, "--motion", motion, ...edits, "--out", out);
    assert.equal(status, 0, stderr);
  }
  const own = (await document("inspect", model)).clips.length;
  const { json, gltf } = await load(model, (parser) => new VRMHumanoidLoaderPlugin(parser));
  const { gltf: animated } = await load(alone, (parser) => new VRMAnimationLoaderPlugin(parser));
  const humanoid = gltf.userData.vrmHumanoid;
  const metaVersion = "VRM" in (/** @type {any} */ (json).extensions ?? {}) ? "0" : "1";
  const vrm = /** @type {any} */ ({ humanoid, meta: { metaVersion }, expressionManager: null, scene: gltf.scene });
  const clip = createVRMAnimationClip(animated.userData.vrmAnimations[0], vrm);
  gltf.scene.add(humanoid.normalizedHumanBonesRoot);
  const mixer = new THREE.AnimationMixer(gltf.scene);
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce, 1);
  action.clampWhenFinished = true;
  action.play();
  const at = new THREE.Vector3();
  for (const fraction of FRACTIONS) {
    const time = clip.duration * fraction;
    mixer.setTime(time);
    humanoid.update();
    gltf.scene.updateMatrixWorld(true);
    /** @type {import("../../web/shell/types.d.ts").PoseDocument} */
    const posed = await document("pose", whole, "--clip", String(own), "--time", String(time));
    const world = new Map(posed.nodes.map((entry) => [entry.node, entry.world.slice(12, 15)]));
    const heights = [...world.values()].map((position) => position[1]);
    const height = Math.max(...heights) - Math.min(...heights);
    for (const [bone, { node }] of Object.entries(/** @type {Record<string, any>} */ (humanoid.rawHumanBones))) {
      const expected = world.get(gltf.parser.associations.get(node)?.nodes ?? -1) ?? [];
      const distance = at.setFromMatrixPosition(node.matrixWorld).distanceTo(new THREE.Vector3(...expected));
      assert.ok(distance <= TOLERANCE * height, `${bone} at ${time} s: ${distance} m off`);
    }
  }
}

const skipBlender = skipWithoutData || (python === undefined ? "skipped: no Python with bpy (GAITWAY_PYTHON)" : false);

describe("Blender reads written BVH", { skip: skipBlender }, () => {
  if (skipBlender || python === undefined) return;
  const pairs = [
    ["threejs/Soldier.glb", "bvh/cmu_01_01.bvh"],
    ["cosc422/dwarf.glb", "cosc422/original/Dwarf/avatar_walk.bvh"],
    ["vrm/vrm0_cryptovoxels.vrm", "threejs/Samba_Dancing.glb"],
  ].map((pair) => pair.map(dataFile));
  for (const [model, motion] of pairs)
    test(`${path.basename(model)} ← ${path.basename(motion)}`, async () => {
      const [whole, alone] = ["whole.glb", "alone.bvh"].map((name) => path.join(folder, name));
      for (const out of [whole, alone]) {
        const { status, stderr } = await run("retarget", "--model", model, "--motion", motion, "--out", out);
        assert.equal(status, 0, stderr);
      }
      const clip = String((await document("inspect", model)).clips.length);
      const script = path.join(repository, "tests/three/blender.py");
      const printed = execFileSync(python, [script, alone, program, whole, clip], { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] });
      const { compared, worst } = JSON.parse(printed.trim().split("\n").pop() ?? "");
      assert.ok(compared > 50 && worst < 1e-4, `${compared} joints, at most ${worst} m off`);
    });
});
