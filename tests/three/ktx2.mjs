// Replaces textures of a glTF: by others, or KTX2 by PNG with the reference transcoder that comes with three.js.
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import vm from "node:vm";
import sharp from "sharp";
import { readGltf } from "./data.mjs";

const require = createRequire(import.meta.url);
/** The transcoder's number for 32-bit RGBA. */
export const RGBA32 = 13;

export async function startTranscoder() {
  const file = require.resolve("three/examples/jsm/libs/basis/basis_transcoder.js");
  // A script for browsers, which declares a variable.
  const load = vm.compileFunction(`${fs.readFileSync(file, "utf8")}\nreturn BASIS;`, ["require", "__filename", "__dirname"]);
  const module = await load(require, file, path.dirname(file))();
  module.initializeBasis();
  return module;
}

/**
 * Encodes RGBA pixels.
 * @param {number} width
 * @param {number} height
 * @param {Uint8Array} rgba
 */
export const png = (width, height, rgba) => sharp(rgba, { raw: { width, height, channels: 4 } }).png().toBuffer();

/** @type {(type: string, bytes: Buffer) => string} */
export const dataUri = (type, bytes) => `data:${type};base64,${bytes.toString("base64")}`;

/**
 * Returns a .glb as .gltf with other images, all of which need `extension` or none.
 * @param {string} file
 * @param {string[]} uris
 * @param {string} [extension]
 */
export function withTextures(file, uris, extension) {
  const { json, binary } = /** @type {{ json: any, binary: Buffer }} */ (readGltf(file));
  json.buffers[0].uri = dataUri("application/octet-stream", binary);
  json.images = uris.map((uri) => ({ uri }));
  json.textures = json.textures.map((/** @type {any} */ { sampler, source, extensions }) => {
    const image = { source: extensions?.KHR_texture_basisu.source ?? source };
    return extension === undefined ? { sampler, ...image } : { sampler, extensions: { [extension]: image } };
  });
  json.extensionsRequired = extension === undefined ? undefined : [extension];
  return Buffer.from(JSON.stringify(json));
}

/**
 * Returns a .glb with KTX2 textures as .gltf with PNG textures.
 * @param {string} file
 */
export async function withPngTextures(file) {
  const transcoder = await startTranscoder();
  const { json, binary } = /** @type {{ json: any, binary: Buffer }} */ (readGltf(file));
  const pngOf = async (/** @type {any} */ image) => {
    const { byteOffset = 0, byteLength } = json.bufferViews[image.bufferView];
    const ktx2 = new transcoder.KTX2File(new Uint8Array(binary.subarray(byteOffset, byteOffset + byteLength)));
    ktx2.startTranscoding();
    const pixels = new Uint8Array(ktx2.getImageTranscodedSizeInBytes(0, 0, 0, RGBA32));
    ktx2.transcodeImage(pixels, 0, 0, 0, RGBA32, 0, -1, -1);
    return dataUri("image/png", await png(ktx2.getWidth(), ktx2.getHeight(), pixels));
  };
  return withTextures(file, await Promise.all(json.images.map(pngOf)));
}
