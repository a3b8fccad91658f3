// Compares pictures of every glTF in the data folder with the Khronos glTF Sample Renderer's and prints a table: mean
// CIEDE2000 over the object, for three.js and for Gaitway; then of avatars, with three-vrm's. Run
// `cargo build --release` first, then `node benches/web/pictures.mjs [FOLDER [WORD…]]`. FOLDER gets the pictures of each
// file side by side: Gaitway, the sample renderer, three.js; or Gaitway, three-vrm. With WORDs, only files whose paths
// contain all of them are compared.
import fs from "node:fs";
import path from "node:path";
import sharp from "sharp";
import { avatars } from "../../tests/reference/avatars.mjs";
import { average, meanDifference } from "../../tests/reference/colour.mjs";
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
    await save(name, [pictures.gaitway, pictures.khronos, pictures.three]);
  } catch (error) {
    // The sample renderer doesn't draw every file that Gaitway does.
    console.log(`| ${name} | – | – | ${String(error).split("\n")[0].slice(0, 120)} |`);
  }
}
for (const [group, { ours, theirs }] of Object.entries(groups)) {
  if (ours.length === 0) continue;
  const [three, mean, worst] = [average(theirs), average(ours), Math.max(...ours)].map((value) => value.toFixed(2));
  console.log(`${group}: ${ours.length} files, three.js ${three}, Gaitway ${mean}, worst ${worst}`);
}
await compareAvatars();
await reference.close();

async function compareAvatars() {
  const chosen = avatars(reference.folder).filter(({ name }) => words.every((word) => name.includes(word)));
  if (chosen.length === 0) return;
  console.log("\n| avatar | from three-vrm |\n| --- | --- |");
  const means = [];
  for (const { name, file, shown } of chosen) {
    const { gaitway, vrm } = await reference.drawAvatar(file, shown);
    const { mean } = meanDifference(gaitway, vrm);
    means.push(mean);
    console.log(`| ${name} | ${mean.toFixed(2)} |`);
    await save(name, [gaitway, vrm]);
  }
  console.log(`avatars: ${means.length}, ${average(means).toFixed(2)}, worst ${Math.max(...means).toFixed(2)}`);
}

/**
 * Saves pictures side by side, if there is a folder for them.
 * @param {string} name
 * @param {import("../../tests/reference/draw.mjs").Picture[]} pictures
 */
async function save(name, pictures) {
  if (folder === undefined) return;
  const inputs = await Promise.all(pictures.map(encoded));
  fs.mkdirSync(folder, { recursive: true });
  const { width, height } = pictures[0];
  const sheet = { width: inputs.length * width, height, channels: /** @type {const} */ (3), background: "black" };
  const tiles = inputs.map((input, index) => ({ input, left: index * width, top: 0 }));
  await sharp({ create: sheet }).composite(tiles).png().toFile(path.join(folder, `${name.replaceAll("/", "_")}.png`));
}
