// Files written by `gaitway convert` and `gaitway retarget`: the Khronos validator finds no error that the original
// doesn't have, and nothing of the original is lost. retarget.test.mjs checks how they look.
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, describe, test } from "node:test";
import * as validator from "gltf-validator";
import { dataFile, gltfFiles, readGltf, skipWithoutData } from "./data.mjs";
import { run } from "./gaitway.mjs";

/** Model and motion. */
const PAIRS = [
  ["cosc422/dwarf.glb", "cosc422/original/Dwarf/avatar_walk.bvh"],
  ["cosc422/mannequin.glb", "cosc422/mannequin_run.glb"],
  ["threejs/Xbot.glb", "threejs/Soldier.glb"],
  ["threejs/Soldier.glb", "bvh/cmu_01_01.bvh"],
  ["kaykit/Knight.glb", "mesh2motion/cmu_91_48.glb"],
  ["misc/godot_mannequiny.glb", "vrm/chatvrm_idle_loop.vrma"],
  ["vrm/vrm0_cryptovoxels.vrm", "vrm/three-vrm_test.vrma"],
  ["vrm/vrm0_EmissionMigration_v0.107.0.vrm", "bvh/threejs_pirouette.bvh"],
  ["vrm/vrm1_VRMC_vrm_expressions_isBinary_Overridden.vrm", "vrm/three-vrm_test.vrma"],
  ["khronos/CesiumMan/glTF/CesiumMan.gltf", "khronos/CesiumMan/glTF-Binary/CesiumMan.glb"],
  ["mesh2motion/human-male.glb", "bvh/animateddrawings_fair1_dab.bvh"],
];

/** Members that grow when a clip is added; all others stay unchanged. */
const GROWING = ["accessors", "animations", "bufferViews", "buffers"];

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-written-"));
after(() => fs.rmSync(folder, { recursive: true }));

let written = 0;
const newFile = () => path.join(folder, `${written++}.glb`);

/**
 * Counts the validator's errors by code.
 * @param {string} file
 * @returns {Promise<Record<string, number>>}
 */
async function issues(file, withWarnings = false) {
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    maxIssues: 0,
    externalResourceFunction: async (uri) => new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  /** @type {Record<string, number>} */
  const counts = {};
  for (const { code, severity } of report.issues.messages)
    if (severity === 0 || (withWarnings && severity === 1)) counts[code] = (counts[code] ?? 0) + 1;
  return counts;
}

/**
 * Errors due to rounding by compression; the validator can't see them in the compressed original.
 * @type {Record<string, string[]>}
 */
const ROUNDED = {
  EXT_meshopt_compression: ["ACCESSOR_VECTOR3_NON_UNIT"],
  KHR_draco_mesh_compression: ["ACCESSOR_WEIGHTS_NON_NORMALIZED"],
};

/**
 * @param {string} original
 * @param {string} file
 */
async function noNewErrors(original, file) {
  const [before, found] = await Promise.all([issues(original), issues(file)]);
  const required = readGltf(original).json.extensionsRequired ?? [];
  const rounded = required.flatMap((/** @type {string} */ name) => ROUNDED[name] ?? []);
  for (const [code, count] of Object.entries(found).filter(([code]) => !rounded.includes(code)))
    assert.ok(count <= (before[code] ?? 0), `${code}: ${count} times, but ${before[code] ?? 0} times in the original`);
}

/** @param {...string} args */
async function write(...args) {
  const out = newFile();
  const { status, stderr } = await run(...args, "--out", out);
  assert.equal(status, 0, stderr);
  return out;
}

describe("converted files are valid", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  for (const { name, file } of gltfFiles().filter(({ rejected }) => rejected === null))
    test(name, async () => {
      const out = await write("convert", file);
      await noNewErrors(file, out);
      fs.rmSync(out);
    });
  const motions = fs.readdirSync(dataFile("bvh")).filter((name) => name.endsWith(".bvh"));
  for (const name of motions)
    test(name, async () => {
      const out = await write("convert", dataFile(`bvh/${name}`));
      assert.deepEqual(await issues(out, true), {});
      fs.rmSync(out);
    });
});

describe("models of the skinning exercise are written with all their weights", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  for (const name of ["Model1", "Model2", "Model3", "Model4"])
    test(name, async () => {
      const model = dataFile(`mit6837/${name}.obj`);
      for (const view of [[], ["--view", "v=1&pose=5:-60:0:10,13:0:0:45&names=5:Left thigh"]]) {
        const out = await write("convert", model, ...view);
        assert.deepEqual(await issues(out, true), {});
        const { json } = readGltf(out);
        const { attributes } = json.meshes[0].primitives[0];
        // 13 weights take four sets of four, the 11 of Model3 three.
        assert.equal(Object.keys(attributes).filter((key) => key.startsWith("WEIGHTS_")).length, name === "Model3" ? 3 : 4);
        assert.equal(json.accessors[attributes.POSITION].count, 13336);
        assert.equal(json.nodes[5].name, view.length ? "Left thigh" : "joint 5");
        assert.equal(json.nodes[5].rotation !== undefined, view.length > 0);
      }
    });

  test("materials, pictures and parts", async () => {
    const own = fs.mkdtempSync(path.join(folder, "obj-"));
    const png = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg==";
    fs.writeFileSync(path.join(own, "skin.png"), Buffer.from(png, "base64"));
    fs.writeFileSync(path.join(own, "m.mtl"), "newmtl red\nKd 1 0 0\nd 0.5\nnewmtl skin\nmap_Kd skin.png\nKe 0.1 0 0\n");
    fs.writeFileSync(
      path.join(own, "m.obj"),
      "mtllib m.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n" +
        "g a\nusemtl red\nf 1/1/1 2/2/1 3/3/1\ng b\nusemtl skin\nf 1/1/1 3/3/1 4/2/1\n",
    );
    const out = await write("convert", path.join(own, "m.obj"));
    assert.deepEqual(await issues(out, true), {});
    const { json } = readGltf(out);
    assert.deepEqual(json.meshes[0].primitives.map(({ extras }) => extras?.name), ["a / red", "b / skin"]);
    assert.equal(json.images?.length, 1);
  });
});

describe("borrowed clips are added and nothing is lost", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  for (const pair of PAIRS) {
    const [model, motion] = pair.map(dataFile);
    const name = pair.map((name) => path.basename(name)).join(" ← ");
    test(name, async () => {
      const out = await write("retarget", "--model", model, "--motion", motion);
      await noNewErrors(model, out);
      nothingIsLost(model, out);
    });
    test(`${name}, skeleton and clip alone`, async () => {
      const out = await write("retarget", "--model", model, "--motion", motion, "--clip-only");
      assert.deepEqual(await issues(out), {});
      const { json } = readGltf(out);
      assert.equal(json.animations.length, 1);
      assert.ok(!Object.keys(json).includes("meshes"));
      assert.equal(json.nodes.length, readGltf(model).json.nodes.length);
    });
  }
});

describe("exports with chosen clips are valid", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  for (const pair of PAIRS) {
    const [model, motion] = pair.map(dataFile);
    test(pair.map((name) => path.basename(name)).join(" ← "), async () => {
      // The first clip of the list may be the model's own; the last one is the motion's.
      const count = (readGltf(model).json.animations ?? []).length;
      for (const options of [["--clips", "0"], ["--clips", `${count}`], ["--fewer-keys"]]) {
        const out = await write("export", model, "--motion", motion, ...options);
        await noNewErrors(model, out);
        const clips = options[0] === "--clips" ? 1 : count + 1;
        assert.ok(readGltf(out).json.animations.length >= clips, `${options}`);
        fs.rmSync(out);
      }
    });
  }

  test("a root bone is a joint of the skin", async () => {
    const model = dataFile("threejs/Xbot.glb");
    const out = await write("export", model, "--root-bone");
    await noNewErrors(model, out);
    const { nodes, skins } = readGltf(out).json;
    const root = nodes.findIndex(({ name }) => name === "root");
    assert.equal(root, nodes.length - 1);
    assert.ok(skins?.every(({ joints }) => joints.at(-1) === root));
  });
});

/**
 * @param {string} original
 * @param {string} file
 */
function nothingIsLost(original, file) {
  const [before, after] = [readGltf(original), readGltf(file)];
  if (before.binary === null) return;
  assert.ok(after.binary?.subarray(0, before.binary.length).equals(before.binary), "the buffer's bytes changed");
  // The original's members in their order, then those that the clip added.
  const keys = Object.keys(before.json);
  assert.deepEqual(Object.keys(after.json).slice(0, keys.length), keys);
  const members = new Map(Object.entries(after.json));
  for (const [key, value] of Object.entries(before.json)) {
    if (key === "buffers") assert.equal(after.json.buffers.length, value.length);
    else if (GROWING.includes(key)) assert.deepEqual(members.get(key).slice(0, value.length), value, key);
    else assert.deepEqual(members.get(key), value, key);
  }
  assert.equal(after.json.animations.length, (before.json.animations ?? []).length + 1);
}
