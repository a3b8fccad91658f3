// Compares the decoder parts with the npm decoders that other viewers use: meshoptimizer, Draco and the Basis Universal
// transcoder, as three.js ships them. All run in Node on the compressed data of a whole file, in the form that the page
// hands to its parts and that npm's decoders take.
import path from "node:path";
import { MeshoptDecoder } from "three/examples/jsm/libs/meshopt_decoder.module.js";
import { dataFile, readGltf } from "../../tests/three/data.mjs";
import { startDracoDecoder } from "../../tests/three/draco.mjs";
import { RGBA32, startTranscoder } from "../../tests/three/ktx2.mjs";
import { startPart } from "../../tests/three/part.mjs";

/** @typedef {{ part: string, file: string, theirs: (file: string) => Promise<() => void> }} Case */

const ROUNDS = 9;

/** @type {Case[]} */
const CASES = [
  { part: "meshopt", file: "compressed/Fox-gltfpack-meshopt.glb", theirs: meshopt },
  { part: "meshopt", file: "compressed/RobotExpressive-gltfpack-meshopt.glb", theirs: meshopt },
  { part: "meshopt", file: "compressed/loaders-gl-meshopt/pirate.glb", theirs: meshopt },
  { part: "meshopt", file: "compressed/Duck-vp-12-vt-12-vn-12.glb", theirs: meshopt },
  { part: "draco", file: "compressed/Fox-gltftransform-draco.glb", theirs: draco },
  { part: "ktx2", file: "compressed/agi-ktx2.glb", theirs: basis },
];

/**
 * Returns the median milliseconds of both for each case.
 * @param {import("playwright-core").Page} page Shows Gaitway.
 */
export async function measureDecoders(page) {
  const results = [];
  for (const { part, file, theirs } of CASES) {
    const [run, inputs, reference] = [await startPart(part), await inputsOf(page, file), await theirs(dataFile(file))];
    const ours = async () => {
      for (const input of inputs) await run(input);
    };
    /** @type {[number[], number[]]} */
    const times = [[], []];
    for (let round = 0; round < ROUNDS; round++) {
      times[0].push(await timed(ours));
      times[1].push(await timed(reference));
    }
    const [part_ms, npm_ms] = times.map((values) => values.sort((a, b) => a - b)[ROUNDS >> 1]);
    results.push({ part, file: path.basename(file), part_ms, npm_ms });
  }
  return results;
}

/** @param {() => void | Promise<void>} work */
async function timed(work) {
  const start = performance.now();
  await work();
  return performance.now() - start;
}

/**
 * Returns what the page hands to the workers of its parts to open a file.
 * @param {import("playwright-core").Page} page
 * @param {string} file
 */
async function inputsOf(page, file) {
  const inputs = await page.evaluate(async (url) => {
    /** @type {number[][]} */
    const inputs = [];
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (/** @type {[any, any]} */ ...message) {
      inputs.push([...message[0].input]);
      post.apply(this, message);
    };
    await window.gaitway.open(url).finally(() => (Worker.prototype.postMessage = post));
    return inputs;
  }, `/data/${file}`);
  return inputs.map((bytes) => Uint8Array.from(bytes));
}

/**
 * @param {any} json
 * @param {Buffer | null} binary
 * @param {{ buffer?: number, byteOffset?: number, byteLength: number }} view
 */
const slice = (json, binary, { byteOffset = 0, byteLength }) => {
  if (binary === null) throw new Error(`expected a binary glTF, found one of ${json.asset.generator}`);
  return new Uint8Array(binary.subarray(byteOffset, byteOffset + byteLength));
};

/** @param {string} file */
async function meshopt(file) {
  await MeshoptDecoder.ready;
  const { json, binary } = /** @type {{ json: any, binary: Buffer }} */ (readGltf(file));
  const compressed = json.bufferViews.map((/** @type {any} */ view) => view.extensions?.EXT_meshopt_compression).filter(Boolean);
  const views = compressed.map((/** @type {any} */ view) => ({ ...view, source: slice(json, binary, view) }));
  return () => {
    for (const { count, byteStride, source, mode, filter } of views) MeshoptDecoder.decodeGltfBuffer(new Uint8Array(count * byteStride), count, byteStride, source, mode, filter);
  };
}

/** @param {string} file */
async function draco(file) {
  const module = await startDracoDecoder();
  const { json, binary } = /** @type {{ json: any, binary: Buffer }} */ (readGltf(file));
  const primitives = json.meshes.flatMap((/** @type {any} */ mesh) => mesh.primitives.map((/** @type {any} */ primitive) => primitive.extensions.KHR_draco_mesh_compression));
  const views = primitives.map((/** @type {any} */ { bufferView }) => slice(json, binary, json.bufferViews[bufferView]));
  return () => {
    for (const bytes of views) {
      const [decoder, mesh] = [new module.Decoder(), new module.Mesh()];
      if (!decoder.DecodeArrayToMesh(new Int8Array(bytes.buffer), bytes.byteLength, mesh).ok()) throw new Error("Draco failed");
      module.destroy(mesh);
      module.destroy(decoder);
    }
  };
}

/** @param {string} file */
function imagesOf(file) {
  const { json, binary } = /** @type {{ json: any, binary: Buffer }} */ (readGltf(file));
  return /** @type {Uint8Array<ArrayBuffer>[]} */ (json.images.map((/** @type {any} */ { bufferView }) => slice(json, binary, json.bufferViews[bufferView])));
}

/** @param {string} file */
async function basis(file) {
  const transcoder = await startTranscoder();
  const images = imagesOf(file);
  return () => {
    for (const image of images) {
      const ktx2 = new transcoder.KTX2File(image);
      ktx2.startTranscoding();
      for (let level = 0; level < ktx2.getLevels(); level++) {
        const pixels = new Uint8Array(ktx2.getImageTranscodedSizeInBytes(level, 0, 0, RGBA32));
        ktx2.transcodeImage(pixels, level, 0, 0, RGBA32, 0, -1, -1);
      }
      ktx2.close();
      ktx2.delete();
    }
  };
}
