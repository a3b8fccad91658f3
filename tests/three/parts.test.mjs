// The decoders of compressed glTF, and the readers of FBX, .x and .npz: the page's modules and the native programs give the
// same bytes. The decoders also give the same bytes as those that three.js ships: meshoptimizer, Draco and Basis
// Universal.
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, describe, test } from "node:test";
import { MeshoptDecoder } from "three/examples/jsm/libs/meshopt_decoder.module.js";
import { dataFile, dataFiles, gltfFiles, readGltf, repository, skipWithoutData } from "./data.mjs";
import { decode as decodeDraco } from "./draco.mjs";
import { run } from "./gaitway.mjs";
import { RGBA32, startTranscoder } from "./ktx2.mjs";
import { walkingPerson, walkingPositions } from "./npz.mjs";
import { runNatively, startPart } from "./part.mjs";

const MESHOPT = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
const DRACO = "KHR_draco_mesh_compression";
/** Both in the order of parts/meshopt's numbers. */
const MODES = ["ATTRIBUTES", "TRIANGLES", "INDICES"];
const FILTERS = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"];

/** Typed arrays by component type, and components by accessor type. */
const ARRAYS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const COMPONENTS = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };

/**
 * A glTF with its buffers. `json` has everything, and its types would only repeat the specification.
 * @typedef {{ json: any, buffers: Uint8Array[] }} Model
 */

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-parts-"));
after(() => fs.rmSync(folder, { recursive: true }));

/** @param {string} file */
async function converted(file) {
  const out = path.join(folder, "out.glb");
  fs.rmSync(out, { force: true });
  return { ...(await run("convert", file, "--out", out)), out };
}

/**
 * @param {string} file
 * @returns {Model}
 */
function readModel(file) {
  const { json, binary } = readGltf(file);
  const buffers = json.buffers.map(({ uri }, index) => {
    if (uri !== undefined) return fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)));
    return (index === 0 ? binary : null) ?? new Uint8Array();
  });
  return { json, buffers };
}

/** @type {(model: Model, range: { buffer: number, byteOffset?: number, byteLength: number }) => Uint8Array} */
const slice = ({ buffers }, { buffer, byteOffset = 0, byteLength }) => buffers[buffer].subarray(byteOffset, byteOffset + byteLength);

/**
 * Returns an accessor's components.
 * @param {Model} model
 * @param {number} index
 * @param {Uint8Array} [view] Its buffer view, if the file's own is compressed.
 */
function components({ json, buffers }, index, view) {
  const { bufferView, byteOffset = 0, componentType, type, count } = json.accessors[index];
  const TypedArray = ARRAYS[/** @type {keyof typeof ARRAYS} */ (componentType)];
  const width = COMPONENTS[/** @type {keyof typeof COMPONENTS} */ (type)];
  const bytes = width * TypedArray.BYTES_PER_ELEMENT;
  const { byteStride = bytes } = json.bufferViews[bufferView];
  const source = view ?? slice({ json, buffers }, json.bufferViews[bufferView]);
  const values = new TypedArray(width * count);
  const target = new Uint8Array(values.buffer);
  for (let at = 0; at < count; at++) target.set(source.subarray(byteOffset + at * byteStride, byteOffset + at * byteStride + bytes), at * bytes);
  return values;
}

/** @param {number[]} values Of 32 bits, unsigned. */
const words = (...values) => new Uint8Array(Uint32Array.from(values).buffer);

/** @param {string} extension */
const filesWith = (extension) => gltfFiles().filter(({ file }) => JSON.stringify(readGltf(file).json).includes(`"${extension}"`));

describe("the FBX reader gives the same bytes as a module", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  const starting = startPart("fbx");
  for (const name of dataFiles(/\.fbx$/))
    test(name, async () => {
      const native = await converted(dataFile(name));
      const module = await starting;
      const answer = await module(fs.readFileSync(dataFile(name))).catch((/** @type {Error} */ { message }) => message);
      if (typeof answer === "string") {
        assert.equal(native.status, 1);
        assert.ok(native.stderr.includes(answer), `${answer} / ${native.stderr}`);
        return;
      }
      assert.equal(native.status, 0, native.stderr);
      assert.ok(fs.readFileSync(native.out).equals(answer.bytes), "the files differ");
      for (const warning of answer.warnings) assert.ok(native.stderr.includes(warning), `${warning} / ${native.stderr}`);
    });
});

// `gaitway convert` also embeds the textures beside these files, so the reader runs on its own here.
describe("the .x reader gives the same bytes as a module", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  const starting = startPart("x");
  for (const name of dataFiles(/\.x$/))
    test(name, async () => {
      const file = fs.readFileSync(dataFile(name));
      const [module, native] = [await (await starting)(file), runNatively("x", file)];
      assert.ok(native.bytes.equals(module.bytes), "the files differ");
      assert.deepEqual(native.warnings, module.warnings);
    });
});

test("the .npz reader gives the same bytes as a module", async () => {
  const module = await startPart("npz");
  for (const joints of [22, 55]) {
    const file = walkingPerson(joints);
    const [answer, native] = [await module(file), runNatively("npz", file)];
    assert.ok(native.bytes.equals(answer.bytes), `${joints} joints: the files differ`);
    assert.deepEqual([native.warnings, answer.warnings], [[], []]);
  }
  const [answer, native] = [await module(walkingPositions()), runNatively("npz", walkingPositions())];
  assert.ok(native.bytes.equals(answer.bytes), "positions: the files differ");
  assert.match(answer.warnings.join(), /^The file has no frame rate .*20 frames per second are assumed/);
});

describe("meshopt views are decoded as by meshoptimizer", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  const totals = { components: 0, rounded: 0 };
  const starting = startPart("meshopt");
  for (const { name, file } of MESHOPT.flatMap(filesWith))
    test(name, async () => {
      const { status, stderr, out } = await converted(file);
      assert.equal(status, 0, stderr);
      const [source, native, module] = [readModel(file), readModel(out), await starting];
      await MeshoptDecoder.ready;
      const views = new Map();
      for (const [index, { extensions }] of source.json.bufferViews.entries()) {
        const compressed = MESHOPT.map((name) => extensions?.[name]).find(Boolean);
        if (compressed === undefined) continue;
        const { count, byteStride, mode, filter = "NONE" } = compressed;
        const data = Uint8Array.from(slice(source, compressed));
        const header = [MODES.indexOf(mode), FILTERS.indexOf(filter), byteStride & 0xff, byteStride >> 8];
        const { bytes } = await module(Buffer.concat([Buffer.from(header), words(count, data.length), data]));
        assert.ok(bytes.equals(slice(native, native.json.bufferViews[index])), `view ${index} differs in the module`);
        const decoded = new Uint8Array(count * byteStride);
        MeshoptDecoder.decodeGltfBuffer(decoded, count, byteStride, data, mode, filter);
        views.set(index, { decoded, isRounded: filter !== "NONE" });
      }
      assert.ok(views.size > 0);
      for (const [index, { bufferView, componentType }] of source.json.accessors.entries()) {
        const { decoded, isRounded = false } = views.get(bufferView) ?? {};
        const [expected, found] = [components(source, index, decoded), components(native, index)];
        // The filters compute with floats. Both round them, and not every platform's result is the same in the last
        // bit.
        const allowed = isRounded && [5122, 5123].includes(componentType) ? 1 : 0;
        assert.equal(found.length, expected.length);
        const differences = Array.from(found, (value, at) => Math.abs(value - expected[at]));
        assert.ok(differences.every((difference) => difference <= allowed), `accessor ${index} is off by ${Math.max(...differences)}`);
        totals.components += found.length;
        totals.rounded += differences.filter((difference) => difference > 0).length;
      }
    });
  after(() => console.log(`${totals.components} components decoded by meshopt, ${totals.rounded} of them rounded differently`));
});

describe("Draco meshes are decoded as by Google's decoder", { skip: skipWithoutData }, () => {
  if (skipWithoutData) return;
  const starting = startPart("draco");
  for (const { name, file } of filesWith(DRACO))
    test(name, async () => {
      const { status, stderr, out } = await converted(file);
      assert.equal(status, 0, stderr);
      const [source, native] = [readModel(file), readModel(out)];
      const decoded = new Set();
      for (const { attributes, indices, extensions } of source.json.meshes.flatMap((/** @type {any} */ { primitives }) => primitives)) {
        const { bufferView, attributes: ids } = extensions[DRACO];
        const data = Uint8Array.from(slice(source, source.json.bufferViews[bufferView]));
        const used = Object.entries(attributes).filter(([semantic]) => ids[semantic] !== undefined);
        const values = used.map(([, index]) => components(native, index));
        const types = Object.fromEntries(used.map(([semantic], at) => [semantic, values[at].constructor.name]));
        const expected = await decodeDraco(data.buffer, ids, types);
        for (const [at, [semantic, index]] of used.entries()) {
          assert.deepEqual(values[at], expected.getAttribute(semantic).array, semantic);
          decoded.add(index);
        }
        assert.deepEqual([...components(native, indices)], [.../** @type {any} */ (expected.index).array], "indices");
        decoded.add(indices);
        await sameInModule({ module: await starting, source, native, used, ids, indices, data });
      }
      assert.ok(decoded.size > 0);
      for (const index of source.json.accessors.keys()) if (!decoded.has(index)) assert.deepEqual(components(native, index), components(source, index));
    });
});

/**
 * Compares one mesh; parts/draco/src/wire.rs describes the module's input and answer.
 * @param {{ module: Awaited<ReturnType<typeof startPart>>, source: Model, native: Model, used: [string, number][], ids:
 *   Record<string, number>, indices: number, data: Uint8Array }} mesh
 */
async function sameInModule({ module, source, native, used, ids, indices, data }) {
  const declared = used.map(([semantic, index]) => {
    const { componentType, type } = source.json.accessors[index];
    return { id: ids[semantic], componentType, width: COMPONENTS[/** @type {keyof typeof COMPONENTS} */ (type)] };
  });
  const header = words(1 << 30, 1 << 20, used.length, data.length, ...declared.flatMap(({ id, componentType, width }) => [id, componentType, width]));
  const { bytes } = await module(Buffer.concat([header, data]));
  const { accessors, bufferViews } = native.json;
  assert.deepEqual([bytes.readUInt32LE(0), bytes.readUInt32LE(4)], [accessors[used[0][1]].count, accessors[indices].count]);
  // Two numbers, the bounds of each attribute, then the data: indices and attributes.
  let at = 8 + declared.reduce((sum, { width }) => sum + 8 * width, 0);
  for (const index of [indices, ...used.map(([, index]) => index)]) {
    const view = slice(native, bufferViews[accessors[index].bufferView]);
    assert.ok(bytes.subarray(at, at + view.length).equals(view), `accessor ${index} differs in the module`);
    at += Math.ceil(view.length / 4) * 4;
  }
  assert.equal(at, bytes.length);
}

/**
 * What a device has besides RGBA, as bits, and what the module then answers: formats by its numbers, with the
 * transcoder's. ETC1S becomes ETC2 on every device that has ASTC, and UASTC becomes RGBA on one with nothing but ETC2.
 * @type {{ device: string, formats: number, answers: Record<number, number> }[]}
 */
const KTX2_FORMATS = [
  { device: "nothing", formats: 0, answers: { 0: RGBA32 } },
  { device: "BC7", formats: 1, answers: { 0: RGBA32, 1: 6 } },
  { device: "ETC2", formats: 2, answers: { 0: RGBA32, 2: 0, 3: 1 } },
  { device: "ASTC", formats: 4, answers: { 0: RGBA32, 4: 10 } },
];

// `gaitway convert` writes KTX2 images as they are, so the transcoder runs on its own here.
describe("KTX2 images are transcoded as by Basis Universal", () => {
  const starting = Promise.all([startPart("ktx2"), startTranscoder()]);
  const own = path.join(repository, "tests/support/ktx2");
  const images = fs.readdirSync(own).map((name) => ({ name, bytes: fs.readFileSync(path.join(own, name)) }));
  if (!skipWithoutData) {
    const model = readModel(dataFile("compressed/agi-ktx2.glb"));
    for (const [index, { bufferView }] of model.json.images.entries())
      images.push({ name: `agi-ktx2.glb, image ${index}`, bytes: Buffer.from(slice(model, model.json.bufferViews[bufferView])) });
  }
  for (const { name, bytes } of images)
    for (const { device, formats, answers } of KTX2_FORMATS)
      test(`${name} for a device with ${device}`, async () => {
        const [module, transcoder] = await starting;
        const request = Buffer.concat([words(formats, 1 << 14), bytes]);
        const { bytes: answer } = await module(request);
        assert.ok(runNatively("ktx2", request).bytes.equals(answer), "the native transcoder gives other bytes");
        const [format, width, height, levels] = [0, 4, 8, 12].map((at) => answer.readUInt32LE(at));
        const reference = answers[format];
        assert.ok(reference !== undefined, `format ${format}`);
        const ktx2 = new transcoder.KTX2File(new Uint8Array(bytes));
        assert.ok(ktx2.startTranscoding());
        assert.deepEqual([width, height, levels], [ktx2.getWidth(), ktx2.getHeight(), ktx2.getLevels()]);
        let at = 16;
        for (let level = 0; level < levels; level++) {
          const expected = Buffer.alloc(ktx2.getImageTranscodedSizeInBytes(level, 0, 0, reference));
          assert.ok(ktx2.transcodeImage(expected, level, 0, 0, reference, 0, -1, -1));
          const found = answer.subarray(at, at + expected.length);
          assert.ok(found.equals(expected), `level ${level} differs`);
          at += expected.length;
        }
        assert.equal(at, answer.length);
        ktx2.close();
        ktx2.delete();
      });
});
