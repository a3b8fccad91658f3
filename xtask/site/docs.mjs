// The pictures in README and docs/, each a link of docs/pictures.json drawn by Gaitway itself. They are committed, so this is
// run by hand when what they show has changed.
import fs from "node:fs";
import path from "node:path";
import sharp from "sharp";
import { drawPictures } from "./pictures.mjs";
import { readSamples } from "./samples.mjs";

const wanted = JSON.parse(fs.readFileSync("docs/pictures.json", "utf8"));
const drawn = drawPictures(wanted, readSamples());
for (const [index, { file }] of wanted.entries()) {
  const target = path.join("docs", `${file}.webp`);
  fs.mkdirSync(path.dirname(target), { recursive: true });
  await sharp(drawn[index]).webp({ quality: 86, effort: 6 }).toFile(target);
  console.log(`${target}: ${fs.statSync(target).size} bytes`);
}
