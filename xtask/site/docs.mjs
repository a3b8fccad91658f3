// Renders the images of README and docs/, which docs/pictures.json lists. They are committed, so run this by hand when
// what they show has changed.
import fs from "node:fs";
import path from "node:path";
import sharp from "sharp";
import { renderScenes } from "./pictures.mjs";
import { readSamples } from "./samples.mjs";

/** @type {(import("./samples.mjs").LinkParts & { file: string, size: string })[]} */
const wanted = JSON.parse(fs.readFileSync("docs/pictures.json", "utf8"));
const rendered = renderScenes(wanted, readSamples());
for (const [index, { file }] of wanted.entries()) {
  const target = path.join("docs", `${file}.webp`);
  fs.mkdirSync(path.dirname(target), { recursive: true });
  await sharp(rendered[index]).webp({ quality: 86, effort: 6 }).toFile(target);
  console.log(`${target}: ${fs.statSync(target).size} bytes`);
}
