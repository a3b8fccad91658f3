// Where the real test files are, and which of them a glTF reader of the core specification can be asked to read.
// They are not part of the repository: `../shared/data` beside it, or the folder named by GAITWAY_DATA.
import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

export const repository = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");

/** The data folder, or null where there is none. */
export const dataFolder = (() => {
  const folder = process.env.GAITWAY_DATA ?? path.resolve(repository, "../shared/data");
  return fs.existsSync(folder) ? folder : null;
})();

/** A reason to skip tests that need real files, or false. With GAITWAY_REQUIRE_DATA=1 there is no reason: they fail. */
export const skipWithoutData =
  dataFolder === null && process.env.GAITWAY_REQUIRE_DATA !== "1" ? "skipped: no test data folder (GAITWAY_DATA)" : false;

/** What a reader of the core specification also reads; anything else that a file requires is refused. */
const SUPPORTED = [
  "EXT_texture_webp",
  "KHR_lights_punctual",
  "KHR_materials_emissive_strength",
  "KHR_materials_unlit",
  "KHR_mesh_quantization",
  "KHR_texture_transform",
];

/**
 * Every glTF of the folder as `{name, file, refused}`, names relative and sorted; `refused` is null, or the version or
 * extension that the file requires and that is not supported.
 */
export function gltfFiles() {
  if (dataFolder === null) throw new Error("GAITWAY_REQUIRE_DATA=1, but there is no test data folder");
  const files = fs
    .readdirSync(dataFolder, { recursive: true })
    .map((name) => name.replaceAll("\\", "/"))
    .filter((name) => /\.(glb|gltf|vrm|vrma)$/.test(name))
    .filter((name) => !/^(validator-invalid|khronos\/v1\.0-unsupported|asset-generator\/Negative)\//.test(name))
    .sort();
  return files.map((name) => {
    const file = path.join(dataFolder, name);
    const { asset, extensionsRequired = [] } = readGltf(file).json;
    const newer = asset.minVersion > "2.0" ? asset.minVersion : undefined;
    return { name, file, refused: newer ?? extensionsRequired.find((extension) => !SUPPORTED.includes(extension)) ?? null };
  });
}

/** The two parts of a GLB or a .gltf: `{json, binary}`; `binary` is null without a BIN chunk. */
export function readGltf(file) {
  const bytes = fs.readFileSync(file);
  if (bytes.toString("latin1", 0, 4) !== "glTF") return { json: JSON.parse(bytes.toString("utf8")), binary: null };
  const jsonLength = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.toString("utf8", 20, 20 + jsonLength));
  const next = 20 + jsonLength;
  const binary = next + 8 <= bytes.length ? bytes.subarray(next + 8, next + 8 + bytes.readUInt32LE(next)) : null;
  return { json, binary };
}
