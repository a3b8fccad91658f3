// What GLTFLoader needs of a DRACOLoader, with the decoder that comes with three.js but without the workers that its
// own loader starts in a browser.
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import vm from "node:vm";
import * as THREE from "three";

const require = createRequire(import.meta.url);

export async function startDracoDecoder() {
  const file = require.resolve("three/examples/jsm/libs/draco/gltf/draco_decoder.js");
  // CommonJS in a package of ES modules, so `require` would not load it.
  const load = vm.compileFunction(fs.readFileSync(file, "utf8"), ["module", "exports", "require", "__filename", "__dirname"]);
  const module = { exports: /** @type {any} */ ({}) };
  load(module, module.exports, require, file, path.dirname(file));
  return module.exports();
}

/** @type {Promise<any>} */
let starting;

/**
 * @param {ArrayBuffer} bytes
 * @param {Record<string, number>} ids Unique ids by attribute.
 * @param {Record<string, string>} types Typed arrays by attribute.
 */
export async function decode(bytes, ids, types) {
  const draco = await (starting ??= startDracoDecoder());
  const [decoder, mesh] = [new draco.Decoder(), new draco.Mesh()];
  const status = decoder.DecodeArrayToMesh(new Int8Array(bytes), bytes.byteLength, mesh);
  if (!status.ok()) throw new Error(status.error_msg());
  /** @type {(byteLength: number, write: (at: number) => void) => ArrayBuffer} */
  const read = (byteLength, write) => {
    const at = draco._malloc(byteLength);
    write(at);
    const copy = draco.HEAPF32.buffer.slice(at, at + byteLength);
    draco._free(at);
    return copy;
  };
  const geometry = new THREE.BufferGeometry();
  const indexBytes = 12 * mesh.num_faces();
  const indices = read(indexBytes, (at) => decoder.GetTrianglesUInt32Array(mesh, indexBytes, at));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(indices), 1));
  for (const [name, type] of Object.entries(types)) {
    const TypedArray = /** @type {any} */ (globalThis)[type];
    const attribute = decoder.GetAttributeByUniqueId(mesh, ids[name]);
    const byteLength = mesh.num_points() * attribute.num_components() * TypedArray.BYTES_PER_ELEMENT;
    const code = draco[`DT_${type.replace("Array", "").toUpperCase()}`];
    const values = read(byteLength, (at) => decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, code, byteLength, at));
    geometry.setAttribute(name, new THREE.BufferAttribute(new TypedArray(values), attribute.num_components()));
  }
  draco.destroy(mesh);
  draco.destroy(decoder);
  return geometry;
}

export const dracoLoader = {
  preload() {},
  /**
   * @type {(bytes: ArrayBuffer, onLoad: (geometry: THREE.BufferGeometry) => void, ids: Record<string, number>, types:
   *   Record<string, string>, colorSpace: string, onError: (error: unknown) => void) => void}
   */
  decodeDracoFile(bytes, onLoad, ids, types, _colorSpace, onError) {
    decode(bytes, ids, types).then(onLoad, onError);
  },
};
