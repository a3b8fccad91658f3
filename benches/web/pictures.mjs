// Compares pictures of every glTF in the data folder with the Khronos glTF Sample Renderer's and prints a table: mean
// CIEDE2000 over the object, for three.js and for Gaitway. Run `cargo build --release` first, then
// `node benches/web/pictures.mjs [FOLDER [WORD…]]`. FOLDER gets the three pictures of each file side by side: Gaitway,
// the sample renderer, three.js. With WORDs, only files whose paths contain all of them are compared.
import fs from "node:fs";
import path from "node:path";
import sharp from "sharp";
import { meanDifference } from "../../tests/reference/colour.mjs";
import { encoded, startReference } from "../../tests/reference/draw.mjs";
import { gltfFiles, readGltf } from "../../tests/three/data.mjs";

const [folder, ...words] = process.argv.slice(2);
/** Files that cover less of the picture are skipped. */
const MIN_SHARE = 0.005;

/** Material extensions that go beyond the core's lighting model. @param {string} file */
function materialExtensions(file) {
  const used = readGltf(file).json.extensionsUsed ?? [];
  return used.filter((name) => /^KHR_materials_(?!unlit|emissive_strength)/.test(name));
}

/** @param {number[]} values */
const average = (values) => (values.reduce((sum, value) => sum + value, 0) / values.length).toFixed(2);

/** @type {Record<"core" | "extensions", { ours: number[], theirs: number[] }>} */
const groups = { core: { ours: [], theirs: [] }, extensions: { ours: [], theirs: [] } };
const reference = await startReference();
console.log("| file | three.js | Gaitway | extensions |\n| --- | --- | --- | --- |");
for (const { name, file, rejected } of gltfFiles()) {
  if (rejected !== null || !words.every((word) => name.includes(word))) continue;
  try {
    const pictures = await reference.draw(file);
    const ours = meanDifference(pictures.gaitway, pictures.khronos);
    if (ours.share < MIN_SHARE) continue;
    const theirs = meanDifference(pictures.three, pictures.khronos);
    const extensions = materialExtensions(file);
    const group = groups[extensions.length === 0 ? "core" : "extensions"];
    group.ours.push(ours.mean);
    group.theirs.push(theirs.mean);
    const names = extensions.map((extension) => extension.slice("KHR_materials_".length)).join(", ");
    console.log(`| ${name} | ${theirs.mean.toFixed(2)} | ${ours.mean.toFixed(2)} | ${names} |`);
    if (folder !== undefined) await save(path.join(folder, `${name.replaceAll("/", "_")}.png`), pictures);
  } catch (error) {
    // The sample renderer doesn't draw every file that Gaitway does.
    console.log(`| ${name} | – | – | ${String(error).split("\n")[0].slice(0, 120)} |`);
  }
}
await reference.close();
for (const [group, { ours, theirs }] of Object.entries(groups)) {
  const worst = Math.max(...ours).toFixed(2);
  console.log(`${group}: ${ours.length} files, three.js ${average(theirs)}, Gaitway ${average(ours)}, worst ${worst}`);
}

/**
 * Saves the three pictures side by side.
 * @param {string} file
 * @param {Awaited<ReturnType<typeof reference.draw>>} pictures
 */
async function save(file, { gaitway, khronos, three }) {
  const inputs = await Promise.all([gaitway, khronos, three].map(encoded));
  fs.mkdirSync(path.dirname(file), { recursive: true });
  const { width, height } = gaitway;
  const sheet = { width: 3 * width, height, channels: /** @type {const} */ (3), background: "black" };
  const tiles = inputs.map((input, index) => ({ input, left: index * width, top: 0 }));
  await sharp({ create: sheet }).composite(tiles).png().toFile(file);
}
