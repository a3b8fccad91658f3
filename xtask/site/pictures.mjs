// Renders the pictures that are committed, with the program that GAITWAY_CLI names: those of README and docs/ (docs/pictures.json),
// the gallery's scenes and the preview of links to the page (assets/gallery). So the page is built without a graphics device.
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import sharp from "sharp";
import { GALLERY, PREVIEW, STILL, linkOf, readScenes, stillOf } from "./samples.mjs";

/** @typedef {import("./samples.mjs").LinkParts} LinkParts */

/** The background of transparent images. */
const STUDIO = "#a3a6ab";

const program = process.env.GAITWAY_CLI ?? fail("GAITWAY_CLI isn't set; run `cargo xtask pictures`");

/** @type {(LinkParts & { file: string, size: string })[]} */
const wanted = JSON.parse(fs.readFileSync("docs/pictures.json", "utf8"));
for (const scene of wanted) await save(path.join("docs", `${scene.file}.webp`), render(scene, scene.size).webp({ quality: 86, effort: 6 }));

fs.rmSync(GALLERY, { recursive: true, force: true });
const scenes = readScenes();
for (const scene of scenes)
  await save(stillOf(scene), render(scene, size(STILL)).flatten({ background: STUDIO }).webp({ quality: 82, effort: 6 }));
// Not every site that shows previews reads WebP.
await save(PREVIEW.file, render(scenes[0], size(PREVIEW)).flatten({ background: STUDIO }).jpeg({ quality: 85, mozjpeg: true }));

/** @type {(area: { width: number, height: number }) => string} */
function size({ width, height }) {
  return `${width}x${height}`;
}

/**
 * @param {LinkParts} scene
 * @param {string} size
 */
function render(scene, size) {
  const file = path.join(os.tmpdir(), `gaitway-picture-${process.pid}.png`);
  const args = ["render", scene.model, "--view", linkOf(scene), "--size", size, "--out", file];
  const { status, error } = spawnSync(program, args, { stdio: ["ignore", "inherit", "inherit"] });
  if (status !== 0) fail(`${error?.message ?? `\`gaitway ${args.join(" ")}\` failed, see above`}. Rendering needs a graphics device or a software driver: mesa-vulkan-drivers on Debian and Ubuntu`);
  const image = sharp(fs.readFileSync(file));
  fs.rmSync(file);
  return image;
}

/**
 * @param {string} file
 * @param {import("sharp").Sharp} image
 */
async function save(file, image) {
  fs.mkdirSync(path.dirname(file), { recursive: true });
  await image.toFile(file);
  console.log(`${file}: ${fs.statSync(file).size} bytes`);
}

/**
 * @param {string} why
 * @returns {never}
 */
function fail(why) {
  console.error(why);
  process.exit(1);
}
