// Finds the real test files, and tells which of them a reader of the core specification can read. They are not part of
// the repository: `../shared/data` beside it, or the folder that GAITWAY_DATA names.
import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

export const repository = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");

/** Where cargo builds. */
export const targetFolder = path.resolve(repository, process.env.CARGO_TARGET_DIR ?? "target");

/** The built page. */
export const dist = process.env.GAITWAY_DIST ?? path.join(repository, "dist");

/** The data folder, or null without one. */
const dataFolder = (() => {
  const folder = process.env.GAITWAY_DATA ?? path.resolve(repository, "../shared/data");
  return fs.existsSync(folder) ? folder : null;
})();

export const hasData = dataFolder !== null;

/** Why tests that need real files are skipped, or false. With GAITWAY_REQUIRE_DATA=1 they run and fail instead. */
export const skipWithoutData =
  dataFolder === null && process.env.GAITWAY_REQUIRE_DATA !== "1" ? "skipped: no test data folder (GAITWAY_DATA)" : false;

/**
 * Returns the path of a file or folder in the data folder.
 * @param {string} name
 */
export function dataFile(name) {
  if (dataFolder === null) throw new Error("there is no test data folder (GAITWAY_DATA)");
  return path.join(dataFolder, name);
}

/**
 * Returns the names of the data folder's files with this extension, sorted.
 * @param {RegExp} extension
 */
export function dataFiles(extension) {
  const names = fs.readdirSync(dataFile(""), { recursive: true, encoding: "utf8" });
  return names.map((name) => name.replaceAll("\\", "/")).filter((name) => extension.test(name)).sort();
}

/** Extensions that are supported; a file that requires any other is rejected. */
const SUPPORTED = [
  "EXT_meshopt_compression",
  "EXT_texture_avif",
  "EXT_texture_webp",
  "KHR_animation_pointer",
  "KHR_draco_mesh_compression",
  "KHR_lights_punctual",
  "KHR_materials_anisotropy",
  "KHR_materials_clearcoat",
  "KHR_materials_diffuse_transmission",
  "KHR_materials_dispersion",
  "KHR_materials_emissive_strength",
  "KHR_materials_ior",
  "KHR_materials_iridescence",
  "KHR_materials_pbrSpecularGlossiness",
  "KHR_materials_sheen",
  "KHR_materials_specular",
  "KHR_materials_transmission",
  "KHR_materials_unlit",
  "KHR_materials_volume",
  "KHR_mesh_quantization",
  "KHR_node_visibility",
  "KHR_texture_basisu",
  "KHR_texture_transform",
];

/**
 * A glTF of the data folder. `rejected` is null, or the version or extension that it requires and that is not
 * supported.
 * @typedef {{ name: string, file: string, rejected: string | null }} GltfFile
 */

/**
 * Returns every valid glTF of the data folder, sorted by name.
 * @returns {GltfFile[]}
 */
export function gltfFiles() {
  const files = dataFiles(/\.(glb|gltf|vrm|vrma)$/);
  const valid = files.filter((name) => !/^(validator-invalid|khronos\/v1\.0-unsupported|asset-generator\/Negative)\//.test(name));
  return valid.map((name) => {
    const file = dataFile(name);
    const { asset, extensionsRequired = [] } = readGltf(file).json;
    const newer = asset.minVersion !== undefined && asset.minVersion > "2.0" ? asset.minVersion : undefined;
    return { name, file, rejected: newer ?? extensionsRequired.find((extension) => !SUPPORTED.includes(extension)) ?? null };
  });
}

/**
 * Reads a glTF for GLTFLoader, without what only changes its looks.
 * @param {string} file
 */
export function gltfWithoutLooks(file) {
  const { json, binary } = readGltf(file);
  if (binary !== null) json.buffers[0].uri = `data:application/octet-stream;base64,${binary.toString("base64")}`;
  delete json.materials;
  delete json.textures;
  delete json.images;
  for (const mesh of json.meshes ?? []) for (const primitive of mesh.primitives) delete primitive.material;
  return json;
}

/**
 * Reads the document and the BIN chunk, if any, of a GLB or .gltf.
 * @param {string} file
 * @returns {{ json: import("../types.d.ts").GltfJson, binary: Buffer | null }}
 */
export function readGltf(file) {
  const bytes = fs.readFileSync(file);
  if (bytes.toString("latin1", 0, 4) !== "glTF") return { json: JSON.parse(bytes.toString("utf8")), binary: null };
  const jsonLength = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.toString("utf8", 20, 20 + jsonLength));
  const next = 20 + jsonLength;
  const binary = next + 8 <= bytes.length ? bytes.subarray(next + 8, next + 8 + bytes.readUInt32LE(next)) : null;
  return { json, binary };
}
