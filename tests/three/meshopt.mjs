// Replaces the compressed views of a glTF by plain ones, with the decoder that comes with three.js.
import { MeshoptDecoder } from "three/examples/jsm/libs/meshopt_decoder.module.js";
import { readGltf } from "./data.mjs";
import { dataUri } from "./ktx2.mjs";

const EXTENSION = "EXT_meshopt_compression";

/**
 * Returns a .glb with meshopt compression as .gltf without it. Each decoded view gets a buffer of its own.
 * @param {string} file
 */
export async function withoutMeshopt(file) {
  await MeshoptDecoder.ready;
  const { json, binary } = /** @type {{ json: any, binary: Buffer }} */ (readGltf(file));
  json.buffers[0].uri = dataUri("application/octet-stream", binary);
  for (const view of json.bufferViews) {
    const compressed = view.extensions?.[EXTENSION];
    if (compressed === undefined) continue;
    const { byteOffset = 0, byteLength, count, byteStride, mode, filter } = compressed;
    const decoded = Buffer.alloc(count * byteStride);
    MeshoptDecoder.decodeGltfBuffer(decoded, count, byteStride, binary.subarray(byteOffset, byteOffset + byteLength), mode, filter);
    const uri = dataUri("application/octet-stream", decoded);
    Object.assign(view, { buffer: json.buffers.push({ byteLength: decoded.length, uri }) - 1, byteOffset: 0 });
    delete view.extensions;
  }
  for (const key of ["extensionsUsed", "extensionsRequired"]) json[key] = json[key]?.filter((/** @type {string} */ name) => name !== EXTENSION);
  return Buffer.from(JSON.stringify(json));
}
