// Borrowed clips in exported files: three.js and `gaitway pose` agree on the file, and the file agrees with the pair.
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import { boundsOf, largestDifference } from "./compare.mjs";
import { dataFile, skipWithoutData } from "./data.mjs";
import { document, run } from "./gaitway.mjs";
import { loadScene } from "./scene.mjs";

/** Largest distance allowed, in diagonals of the rest bounds. */
const TOLERANCE = 1e-4;
const FRACTIONS = [0, 0.3217, 0.6789, 1];

const PAIRS = [
  ["threejs/Soldier.glb", "threejs/Xbot.glb", "--clip", "walk"],
  ["threejs/Xbot.glb", "threejs/Soldier.glb", "--clip", "Run", "--horizontal", "in-place"],
  ["threejs/RobotExpressive.glb", "bvh/cosc422_Walk.bvh"],
  ["kaykit/Knight.glb", "mesh2motion/cmu_91_48.glb", "--feet", "plant"],
  ["cosc422/mannequin.glb", "cosc422/mannequin_run.glb"],
  ["cosc422/dwarf.glb", "cosc422/original/Dwarf/avatar_walk.bvh", "--unmapped", "0"],
  ["cosc422/ArmyPilot.glb", "threejs/Soldier.glb", "--clip", "Walk", "--feet", "plant", "--yaw", "freeze"],
  ["khronos/CesiumMan/glTF/CesiumMan.gltf", "vrm/chatvrm_idle_loop.vrma"],
  ["mesh2motion/human-male.glb", "bvh/cmu_01_01.bvh", "--extract-root"],
  ["vrm/vrm0_cryptovoxels.vrm", "threejs/Samba_Dancing.glb"],
];

console.warn = () => {};

describe("exported borrowed clips agree with three.js", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  /** @type {string} */
  let folder;
  before(() => (folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-"))));
  after(() => fs.rmSync(folder, { recursive: true, force: true }));

  for (const [at, [model, motion, ...options]] of PAIRS.entries()) {
    const name = [path.basename(model), "←", path.basename(motion), ...options].join(" ");
    const [modelFile, motionFile] = [model, motion].map((file) => dataFile(file));
    test(name, async () => {
      const out = path.join(folder, `${at}.glb`);
      /** @type {import("../types.d.ts").RetargetReport} */
      const report = await document("retarget", "--model", modelFile, "--motion", motionFile, ...options, "--out", out);
      assert.ok(report.figures.orientation_error_degrees_mean < 0.5, JSON.stringify(report.figures));
      const own = (await document("inspect", modelFile)).clips.length;
      const written = await document("inspect", out);
      assert.equal(written.clips.length, own + 1, "one clip more");
      assert.equal(written.clips[own].name, report.clip);
      const scene = await loadScene(out);
      scene.play(null, 0);
      const bounds = boundsOf(scene.meshes().map(({ positions }) => positions));
      const diagonal = Math.hypot(...bounds.min.map((low, axis) => bounds.max[axis] - low));
      for (const fraction of FRACTIONS) {
        const time = report.duration_secs * fraction;
        scene.play(own, time);
        const { difference, what } = largestDifference(scene, await document("pose", out, "--clip", String(own), "--time", String(time)), diagonal);
        assert.ok(difference <= TOLERANCE, `at ${time} s, ${what}: off by ${difference}`);
      }
    });
    test(`${name}: skeleton and clip alone`, async () => {
      const [out, whole] = [`${at}-clip.glb`, `${at}.glb`].map((file) => path.join(folder, file));
      const { status, stderr } = await run("retarget", "--model", modelFile, "--motion", motionFile, ...options, "--clip-only", "--out", out);
      assert.equal(status, 0, stderr);
      const clips = (await document("inspect", whole)).clips;
      /** @type {import("../../web/shell/types.d.ts").PoseDocument[]} */
      const [alone, inModel] = [await document("pose", out, "--clip", "0", "--time", "0.3"), await document("pose", whole, "--clip", String(clips.length - 1), "--time", "0.3")];
      const world = new Map(inModel.nodes.map((entry) => [entry.node, entry.world]));
      // A node's matrix may be written as translation, rotation and scale, which changes the last digit.
      for (const { node, world: found } of alone.nodes) {
        const wanted = world.get(node) ?? [];
        const size = Math.max(...wanted.map(Math.abs));
        found.forEach((number, index) => assert.ok(Math.abs(number - wanted[index]) <= 1e-5 * size, `node ${node}: ${found}, in the model ${wanted}`));
      }
      assert.deepEqual(alone.meshes, []);
    });
  }

  test("without options the pair itself is posed the same", async () => {
    const [model, motion] = [PAIRS[0][0], PAIRS[0][1]].map((file) => dataFile(file));
    const live = await document("pose", model, "--motion", motion, "--clip", "walk", "--time", "0.4");
    const own = (await document("inspect", model)).clips.length;
    const written = await document("pose", path.join(folder, "0.glb"), "--clip", String(own), "--time", "0.4");
    assert.deepEqual(written.nodes, live.nodes);
  });
});
