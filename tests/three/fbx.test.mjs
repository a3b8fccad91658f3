// World positions of an FBX file's nodes in `gaitway pose` against three.js's FBXLoader, at keys of every clip. Between
// keys FBXLoader interpolates quaternions where the file has curves of Euler angles; crates/formats/tests/formats compares those with
// ufbx itself.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { after, describe, test } from "node:test";
import * as THREE from "three";
import { dataFile, dataFiles, skipWithoutData } from "./data.mjs";
import { document, run } from "./gaitway.mjs";

/** Largest distance allowed, in multiples of the farthest node's distance from the origin. */
const TOLERANCE = 1e-4;
/** Which of a clip's keys are compared, as fractions of their number. */
const FRACTIONS = [0, 0.25, 0.5, 0.75, 1];
const MAX_CLIPS = 4;
/** In seconds. Maya's timelines begin at frame 1. */
const ONE_FRAME = 1 / 24;
const CENTIMETRES_PER_METRE = 100;

/**
 * Deviations of FBXLoader from the format. Each must occur in every file that it names, so that the list stays
 * accurate. It excuses differences in `"clips"` alone, in the rest pose as well, or of some nodes by name.
 * @typedef {{ because: string, files: RegExp, excuses: "clips" | "poses" | RegExp }} Fault
 */

/** @type {Fault[]} */
const FAULTS = [
  { because: "turns only files whose Z axis is up", files: /\/axes_(?!nzpy|pypz)/, excuses: "poses" },
  { because: "puts pivots of animated nodes elsewhere", files: /(child|null)_pivots_|_pivot_(offset|scale)_|split_pivot|zero_scale_pivot/, excuses: "clips" },
  { because: "lets every node inherit its parent's scale", files: /maya_(scale|static)_no_inherit_(scale_)?7/, excuses: "poses" },
  { because: "lets every node inherit its parent's animated scale", files: /anim_no_inherit|no_inherit_step|mixed_inherit_mode/, excuses: "clips" },
  { because: "holds the first and last key outside of a curve", files: /maya_anim_extrapolation/, excuses: "clips" },
  { because: "interpolates in constant segments, too", files: /maya_anim_linear/, excuses: "clips" },
  { because: "plays one of a stack's layers", files: /anim_layer_anim/, excuses: "clips" },
  { because: "joins the keys of a rotation's three curves, which are at different times", files: /\/run\.fbx|\/cmu_/, excuses: "clips" },
  { because: "gives a clip the keys of other clips' time ranges", files: /game_sausage_7500_(ascii|binary)_(combined|deform)/, excuses: "clips" },
  { because: "hangs a joint on its HumanIK character instead of its parent", files: /maya_human_ik/, excuses: "poses" },
  { because: "moves a directional light away from its node", files: /blender_293_barbarian|camera_light_axes/, excuses: /^(Sun|forwardLight)$/ },
];

/** FBXLoader reads no keys from layered stacks, and from the other files a clip without keys, which we leave out. */
const OTHER_CLIPS = /maya_anim_layers_|maya_blend_shape_cube_7100|maya_huge_stepped_tangents|Samba_Dancing/;

/** One is damaged, and one has no objects. */
const UNREADABLE = /transparentTest|motionbuilder_actor_7700_binary/;

// What FBXLoader needs of a browser; images never arrive.
const image = { addEventListener() {}, removeEventListener() {} };
Object.assign(globalThis, { self: globalThis, window: globalThis, document: { createElementNS: () => image } });
console.warn = () => {};
const { FBXLoader } = await import("three/examples/jsm/loaders/FBXLoader.js");

const totals = { compared: 0, poses: 0, positions: 0, unread: 0, worst: 0 };

describe("FBX nodes agree with three.js", { skip: skipWithoutData, concurrency: 1 }, () => {
  if (skipWithoutData) return;
  for (const name of dataFiles(/\.fbx$/)) test(name, () => compareFile(name));
  test("each fault of FBXLoader is in a file", () => {
    for (const { because, files } of FAULTS) assert.ok(dataFiles(/\.fbx$/).some((name) => files.test(`/${name}`)), because);
  });
  after(() => {
    const { compared, poses, positions, unread, worst } = totals;
    console.log(`${compared} FBX files, ${poses} poses, ${positions} positions; worst ${worst.toExponential(2)}; FBXLoader reads ${unread} others not at all`);
  });
});

/** @param {string} name */
async function compareFile(name) {
  const file = dataFile(name);
  if (UNREADABLE.test(name)) {
    const { status, stderr } = await run("inspect", file);
    assert.equal(status, 1);
    assert.match(stderr, new RegExp(`^error: ${path.basename(name)}`, "m"));
    return;
  }
  const { clips } = await document("inspect", file);
  const theirs = loadTheirs(file);
  if (theirs === null) {
    totals.unread++;
    return;
  }
  const fault = FAULTS.find(({ files }) => files.test(`/${name}`));
  const compare = comparison(file, theirs, fault);
  const worst = await compare(null, 0, 0);
  if (!OTHER_CLIPS.test(name)) {
    assert.equal(clips.length, theirs.animations.length, "number of clips");
    for (const [clip, { duration_secs }] of clips.slice(0, MAX_CLIPS).entries())
      include(worst, await differenceOfClip(compare, clip, theirs.animations[clip], duration_secs));
  }
  const { value, where, excused } = worst;
  totals.worst = Math.max(totals.worst, value);
  assert.ok(value <= TOLERANCE, `${where}: off by ${value} (allowed ${TOLERANCE})`);
  if (fault !== undefined) assert.ok(excused > TOLERANCE, `no longer seen: FBXLoader ${fault.because}`);
  totals.compared++;
}

/**
 * Returns a file as FBXLoader reads it, or null if it rejects it.
 * @param {string} file
 */
function loadTheirs(file) {
  const bytes = fs.readFileSync(file);
  try {
    return new FBXLoader().parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), "");
  } catch {
    return null;
  }
}

/**
 * The largest difference, without and with what a fault excuses.
 * @typedef {{ value: number, where: string, excused: number }} Difference
 */
/** @typedef {(clip: number | null, theirSecs: number, ourSecs: number) => Promise<Difference>} Compare */

/**
 * Raises the worst difference to another one, field by field.
 * @param {Difference} worst
 * @param {Difference} other
 */
function include(worst, { value, where, excused }) {
  if (!(excused <= worst.excused)) worst.excused = excused;
  if (!(value <= worst.value)) Object.assign(worst, { value, where });
}

/**
 * @param {Fault} fault
 * @param {string} node
 * @param {number | null} clip
 */
function isExcused({ excuses }, node, clip) {
  if (excuses instanceof RegExp) return excuses.test(node);
  return excuses === "poses" || clip !== null;
}

/**
 * Returns a function that compares the uniquely named nodes in a clip at a time.
 * @param {string} file
 * @param {THREE.Group} root
 * @param {Fault | undefined} fault
 * @returns {Compare}
 */
function comparison(file, root, fault) {
  const mixer = new THREE.AnimationMixer(root);
  const metresPerUnit = (root.userData.unitScaleFactor ?? 1) / CENTIMETRES_PER_METRE;
  /** @type {[string, THREE.Object3D][]} */
  const objects = [];
  root.traverse((object) => object !== root && objects.push([object.name, object]));
  const theirs = unique(objects);
  let size = 1e-3;
  return async (clip, theirSecs, ourSecs) => {
    play(mixer, clip, theirSecs);
    const choice = clip === null ? [] : ["--clip", String(clip), "--time", String(Math.max(0, ourSecs))];
    /** @type {import("../../web/shell/types.d.ts").PoseDocument} */
    const { nodes } = await document("pose", file, ...choice);
    const ours = unique(nodes.map(({ name, world }) => [THREE.PropertyBinding.sanitizeNodeName(name), new THREE.Vector3().fromArray(world, 12)]));
    if (clip === null) size = Math.max(size, ...[...ours.values()].map((position) => position.length()));
    const worst = { value: 0, where: "", excused: 0 };
    let compared = 0;
    for (const [name, position] of ours) {
      const object = theirs.get(name);
      if (object === undefined) continue;
      const value = new THREE.Vector3().setFromMatrixPosition(object.matrixWorld).multiplyScalar(metresPerUnit).distanceTo(position) / size;
      totals.positions++;
      compared++;
      const where = `${name}, ${clip === null ? "rest" : `clip ${clip} at ${ourSecs} s`}`;
      const isCounted = fault === undefined || !isExcused(fault, name, clip);
      include(worst, { value: isCounted ? value : 0, where, excused: value });
    }
    assert.ok(compared > 0, "no node of the same name");
    totals.poses++;
    return worst;
  };
}

/**
 * @param {THREE.AnimationMixer} mixer
 * @param {number | null} clip
 * @param {number} timeSecs
 */
function play(mixer, clip, timeSecs) {
  const root = /** @type {THREE.Group} */ (mixer.getRoot());
  mixer.stopAllAction();
  if (clip !== null) {
    const action = mixer.clipAction(root.animations[clip]).setLoop(THREE.LoopOnce, 1);
    action.clampWhenFinished = true;
    action.reset().play();
    mixer.setTime(timeSecs);
  }
  root.updateMatrixWorld(true);
}

/**
 * Returns the largest difference at keys of a clip. FBXLoader keeps the file's times, and ours begin with the stack,
 * whose start FBXLoader doesn't expose, so we try the known starts and take the best fit.
 * @param {Compare} compare
 * @param {number} clip
 * @param {THREE.AnimationClip} theirs
 * @param {number} ourDurationSecs
 */
async function differenceOfClip(compare, clip, theirs, ourDurationSecs) {
  const keys = [...new Set(theirs.tracks.flatMap(({ times }) => [...times]))].sort((a, b) => a - b);
  /** @type {Difference} */
  let best = { value: Infinity, where: "no key inside the clip", excused: Infinity };
  let isFirst = true;
  for (const startSecs of new Set([0, keys[0], theirs.duration - ourDurationSecs, ONE_FRAME])) {
    const inside = keys.filter((time) => time >= startSecs - 1e-4 && time - startSecs <= ourDurationSecs + 1e-4);
    if (inside.length === 0) continue;
    const worst = { value: 0, where: "", excused: 0 };
    for (const fraction of FRACTIONS) {
      const time = inside[Math.round(fraction * (inside.length - 1))];
      include(worst, await compare(clip, time, time - startSecs));
    }
    const isBetter = worst.value < best.value || (worst.value === best.value && worst.excused < best.excused);
    if (isFirst || isBetter) best = worst;
    isFirst = false;
    if (best.excused <= TOLERANCE) break;
  }
  return best;
}

/**
 * Returns the values with unique names, by name.
 * @template T
 * @param {[string, T][]} named
 */
function unique(named) {
  const count = new Map();
  for (const [name] of named) count.set(name, (count.get(name) ?? 0) + 1);
  return new Map(named.filter(([name]) => name !== "" && count.get(name) === 1));
}
