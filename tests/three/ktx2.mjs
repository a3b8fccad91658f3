// Replaces textures of a glTF: by others, or KTX2 by PNG with the reference transcoder that comes with three.js.
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import vm from "node:vm";
import zlib from "node:zlib";
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
export function png(width, height, rgba) {
  /** @type {(name: string, content: Buffer) => Buffer} */
  const chunk = (name, content) => {
    const checked = Buffer.concat([Buffer.from(name), content]);
    const [length, checksum] = [Buffer.alloc(4), Buffer.alloc(4)];
    length.writeUInt32BE(content.length);
    checksum.writeUInt32BE(zlib.crc32(checked));
    return Buffer.concat([length, checked, checksum]);
  };
  const header = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 8, 6, 0, 0, 0]);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  // Each row begins with the number of its filter: none.
  const rows = Array.from({ length: height }, (_, y) => [Buffer.of(0), rgba.subarray(4 * width * y, 4 * width * (y + 1))]);
  const data = zlib.deflateSync(Buffer.concat(rows.flat()));
  return Buffer.concat([Buffer.from("\x89PNG\r\n\x1A\n", "latin1"), chunk("IHDR", header), chunk("IDAT", data), chunk("IEND", Buffer.alloc(0))]);
}

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
  const uris = json.images.map((/** @type {any} */ image) => {
    const { byteOffset = 0, byteLength } = json.bufferViews[image.bufferView];
    const ktx2 = new transcoder.KTX2File(new Uint8Array(binary.subarray(byteOffset, byteOffset + byteLength)));
    ktx2.startTranscoding();
    const pixels = new Uint8Array(ktx2.getImageTranscodedSizeInBytes(0, 0, 0, RGBA32));
    ktx2.transcodeImage(pixels, 0, 0, 0, RGBA32, 0, -1, -1);
    return dataUri("image/png", png(ktx2.getWidth(), ktx2.getHeight(), pixels));
  });
  return withTextures(file, uris);
}
