// World positions and node matrices of `gaitway pose` against three.js (GLTFLoader, AnimationMixer, getVertexPosition),
// for every readable file of the data folder, at several times of every clip, played once and held at the end.
import assert from "node:assert/strict";
import { after, describe, test } from "node:test";
import { boundsOf, largestDifference, largestDistance } from "./compare.mjs";
import { gltfFiles, readGltf, skipWithoutData } from "./data.mjs";
import { exceptions } from "./exceptions.mjs";
import { document, run } from "./gaitway.mjs";
import { loadScene } from "./scene.mjs";

/** Largest distance allowed, in diagonals of the rest bounds. */
const TOLERANCE = 1e-4;
/** Fractions of the duration: first key, two that are on no key, last key, past the end. */
const FRACTIONS = [0, 0.3217, 0.6789, 1, 1.25];
const FRACTIONS_OF_MANY = [0.3217, 0.6789, 1.25];
const MANY_CLIPS = 20;

// GLTFLoader's warnings about the files don't matter here.
console.warn = () => {};

const totals = { files: 0, clips: 0, poses: 0, vertices: 0, worst: 0, worstWhere: "" };

const INSTANCES = "skipped: three.js has no nodes for instances; crates/formats/tests/formats/instancing.rs checks their transforms";

describe("positions agree with three.js", { skip: skipWithoutData, concurrency: 2 }, () => {
  if (skipWithoutData) return;
  for (const file of gltfFiles()) {
    if (hasInstances(file.file)) test(file.name, { skip: INSTANCES });
    else if (file.rejected === null) test(file.name, () => compareFile(file));
    else test(`${file.name} is rejected`, () => checkRejected(file, file.rejected ?? ""));
  }
  after(() => {
    const { files, clips, poses, vertices, worst, worstWhere } = totals;
    console.log(`${files} files, ${clips} clips, ${poses} poses, ${vertices} vertices; worst ${worst.toExponential(2)} diagonals (${worstWhere})`);
  });
});

/** @param {string} file */
function hasInstances(file) {
  return readGltf(file).json.extensionsUsed?.includes("EXT_mesh_gpu_instancing");
}

/**
 * A file that requires something unsupported gives an error that says so.
 * @param {import("./data.mjs").GltfFile} gltf
 * @param {string} required
 */
async function checkRejected({ file }, required) {
  const { status, stderr } = await run("inspect", file);
  assert.equal(status, 1, stderr);
  assert.match(stderr, /^error: /m);
  assert.ok(stderr.includes(required), `the message should name ${required}: ${stderr}`);
}

/** @param {import("./data.mjs").GltfFile} gltf */
async function compareFile({ name, file }) {
  const exception = exceptions.find(({ files }) => files.includes(name));
  const scene = await loadScene(file, exception?.repair);
  const unrepaired = exception === undefined ? null : await loadScene(file);
  const inspected = await document("inspect", file);
  assert.equal(inspected.clips.length, scene.clips.length, "number of clips");

  scene.play(null, 0);
  const rest = scene.meshes().filter(({ positions }) => positions.length > 0);
  const bounds = boundsOf(rest.length > 0 ? rest.map(({ positions }) => positions) : scene.nodes().map(({ world }) => world.slice(12, 15)));
  const diagonal = Math.hypot(...bounds.min.map((low, axis) => bounds.max[axis] - low)) || 1;
  if (rest.length > 0)
    for (const end of /** @type {const} */ (["min", "max"])) {
      const difference = largestDistance(inspected.bounds[end], bounds[end]) / diagonal;
      assert.ok(difference <= TOLERANCE, `bounds.${end} is ${inspected.bounds[end]}, three.js says ${bounds[end]}`);
    }

  let worstUnrepaired = 0;
  /** @type {(clip: number | null, timeSecs: number) => Promise<void>} */
  const compare = async (clip, timeSecs) => {
    const choice = clip === null ? [] : ["--clip", String(clip), "--time", String(timeSecs)];
    const posed = await document("pose", file, ...choice);
    scene.play(clip, timeSecs);
    const { difference, what, vertices } = largestDifference(scene, posed, diagonal);
    totals.vertices += vertices;
    const where = `${name}, ${clip === null ? "rest" : `clip ${clip} (${scene.clips[clip].name}) at ${timeSecs} s`}, ${what}`;
    if (!(difference <= totals.worst)) Object.assign(totals, { worst: difference, worstWhere: where });
    assert.ok(difference <= TOLERANCE, `${where}: off by ${difference} (allowed ${TOLERANCE})`);
    totals.poses++;
    unrepaired?.play(clip, timeSecs);
    if (unrepaired !== null) worstUnrepaired = Math.max(worstUnrepaired, largestDifference(unrepaired, posed, diagonal).difference);
  };
  await compare(null, 0);

  const fractions = scene.clips.length > MANY_CLIPS ? FRACTIONS_OF_MANY : FRACTIONS;
  for (const [clip, { duration }] of scene.clips.entries()) {
    const { duration_secs } = inspected.clips[clip];
    assert.ok(Math.abs(duration_secs - duration) <= 1e-5 * Math.max(1, duration), `clip ${clip}: ${duration_secs} s, three.js says ${duration} s`);
    for (const fraction of fractions) await compare(clip, duration * fraction);
    totals.clips++;
  }
  totals.files++;
  if (unrepaired !== null) assert.ok(worstUnrepaired > TOLERANCE, `no longer needed: ${exception?.because}`);
}
