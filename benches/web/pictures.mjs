// Compares pictures of every glTF of the data folder with the Khronos glTF Sample Renderer's and prints a table: mean CIEDE2000 over
// the object, for three.js and for Gaitway. `node benches/web/pictures.mjs [FOLDER]` after `cargo build --release`; with a folder,
// the three pictures of each file are saved there side by side: Gaitway, the sample renderer, three.js. Names after the folder
// choose files.
import fs from "node:fs";
import path from "node:path";
import sharp from "sharp";
import { meanDifference } from "../../tests/reference/colour.mjs";
import { encoded, startReference } from "../../tests/reference/draw.mjs";
import { gltfFiles, readGltf } from "../../tests/three/data.mjs";

const [folder, ...parts] = process.argv.slice(2);
/** Below this share of the picture there is nothing to compare. */
const MIN_SHARE = 0.005;

/** Extensions that change how a surface looks, beyond the core specification. @param {string} file */
const materialExtensions = (file) => (readGltf(file).json.extensionsUsed ?? []).filter((name) => /^KHR_materials_(?!unlit|emissive_strength)/.test(name));

/** @param {number[]} values */
const average = (values) => (values.reduce((sum, value) => sum + value, 0) / values.length).toFixed(2);

/** @type {Record<"core" | "extensions", { ours: number[], theirs: number[] }>} */
const groups = { core: { ours: [], theirs: [] }, extensions: { ours: [], theirs: [] } };
const reference = await startReference();
console.log("| file | three.js | Gaitway | extensions |\n| --- | --- | --- | --- |");
for (const { name, file, rejected } of gltfFiles()) {
  if (rejected !== null || !parts.every((part) => name.includes(part))) continue;
  try {
    const pictures = await reference.draw(file);
    const ours = meanDifference(pictures.gaitway, pictures.khronos);
    if (ours.share < MIN_SHARE) continue;
    const theirs = meanDifference(pictures.three, pictures.khronos);
    const extensions = materialExtensions(file);
    const group = groups[extensions.length === 0 ? "core" : "extensions"];
    group.ours.push(ours.mean);
    group.theirs.push(theirs.mean);
    console.log(`| ${name} | ${theirs.mean.toFixed(2)} | ${ours.mean.toFixed(2)} | ${extensions.map((extension) => extension.slice(14)).join(", ")} |`);
    if (folder !== undefined) await save(path.join(folder, `${name.replaceAll("/", "_")}.png`), pictures);
  } catch (error) {
    // The sample renderer doesn't draw every file that Gaitway does.
    console.log(`| ${name} | – | – | ${String(error).split("\n")[0].slice(0, 120)} |`);
  }
}
await reference.close();
for (const [group, { ours, theirs }] of Object.entries(groups))
  console.log(`${group}: ${ours.length} files, three.js ${average(theirs)}, Gaitway ${average(ours)}, worst ${Math.max(...ours).toFixed(2)}`);

/**
 * @param {string} file
 * @param {Awaited<ReturnType<typeof reference.draw>>} pictures
 */
async function save(file, { gaitway, khronos, three }) {
  const inputs = await Promise.all([gaitway, khronos, three].map(encoded));
  fs.mkdirSync(path.dirname(file), { recursive: true });
  const sheet = { width: 3 * gaitway.width, height: gaitway.height, channels: /** @type {const} */ (3), background: "black" };
  await sharp({ create: sheet }).composite(inputs.map((input, index) => ({ input, left: index * gaitway.width, top: 0 }))).png().toFile(file);
}
