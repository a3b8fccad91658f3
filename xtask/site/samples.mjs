// The samples in assets/samples, and scenes made of them: those of the gallery (gallery.json) and of the documentation
// (docs/pictures.json).
import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

const FOLDER = fileURLToPath(new URL("../../assets/samples", import.meta.url));
/** Their pictures, which xtask/site/pictures.mjs renders. */
export const GALLERY = "assets/gallery";
/** A scene as it covers the loading page. */
export const STILL = { width: 640, height: 480 };
/** The preview of links to the page. */
export const PREVIEW = { file: `${GALLERY}/preview.jpg`, width: 1200, height: 630 };
/** Generated in code, so part of every program and of the page. */
const GENERATED = "walker";
const EXTENSIONS = [".glb", ".bvh", ".obj", ".skel", ".attach"];

/**
 * What a link consists of: its model, a motion to borrow, and the rest of it.
 * @typedef {{ model: string, motion?: string, view: string }} LinkParts
 */

/** @typedef {LinkParts & { name: string, title: string, text: string }} Scene */

/**
 * Returns the files of each sample by the name after `sample:`; build.rs embeds the same ones in the programs.
 * @returns {Record<string, string[]>}
 */
export function readSamples() {
  /** @type {Record<string, string[]>} */
  const samples = {};
  for (const file of fs.readdirSync(FOLDER).sort())
    if (EXTENSIONS.includes(path.extname(file))) (samples[path.parse(file).name] ??= []).push(path.join(FOLDER, file));
  return samples;
}

/** @param {LinkParts} parts */
export const linkOf = ({ model, motion, view }) => `v=2&model=${model}${motion === undefined ? "" : `&motion=${motion}`}&${view}`;

/**
 * Returns the file of a scene's picture.
 * @param {Scene} scene
 */
export const stillOf = ({ name }) => `${GALLERY}/${name}.webp`;

/**
 * Returns the scenes that the documentation shows, with their pictures there.
 * @returns {(Scene & { still: string })[]}
 */
export function readDocScenes() {
  /** @type {(LinkParts & { file: string, title: string, text: string })[]} */
  const scenes = JSON.parse(fs.readFileSync("docs/pictures.json", "utf8"));
  return scenes.map((scene) => ({ ...scene, name: `docs-${path.basename(scene.file)}`, still: `docs/${scene.file}.webp` }));
}

/**
 * Returns the names of the samples that a scene uses.
 * @param {LinkParts} parts
 */
export const samplesOf = ({ model, motion }) => [model, motion ?? ""].filter((source) => source.startsWith("sample:")).map((source) => source.slice("sample:".length));

/**
 * Returns the gallery's scenes, leaving out those whose samples are missing.
 * @returns {Scene[]}
 */
export function readScenes(samples = readSamples()) {
  /** @type {Scene[]} */
  const scenes = JSON.parse(fs.readFileSync(path.join(FOLDER, "gallery.json"), "utf8"));
  return scenes.filter((scene) => {
    const missing = samplesOf(scene).filter((sample) => !(sample in samples) && sample !== GENERATED);
    if (missing.length > 0) console.error(`skipping the scene “${scene.name}”: assets/samples has no ${missing.join(", ")}`);
    return missing.length === 0;
  });
}
