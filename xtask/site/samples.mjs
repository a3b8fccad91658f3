// The sample characters and the scenes made of them: what lies in assets/samples, and what gallery.json shows of it.
import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

const FOLDER = fileURLToPath(new URL("../../assets/samples", import.meta.url));
/** Part of every program, the page's too. */
const MADE_IN_CODE = "walker";
const ENDINGS = [".glb", ".bvh", ".obj", ".skel", ".attach"];

/** The files of each sample, by the name after `sample:`. (build.rs finds the same for the programs.) */
export function readSamples() {
  const samples = {};
  for (const file of fs.readdirSync(FOLDER).sort())
    if (ENDINGS.includes(path.extname(file))) (samples[path.parse(file).name] ??= []).push(path.join(FOLDER, file));
  return samples;
}

/** What stands for a key in a link, as often as it does. */
export const valuesOf = (link, key) => new URLSearchParams(link).getAll(key);

/** Names of the samples that a link shows or borrows from. */
export const samplesOf = (link) => [...valuesOf(link, "model"), ...valuesOf(link, "motion")].filter((source) => source.startsWith("sample:")).map((source) => source.slice("sample:".length));

/** The scenes, `{name, title, text, link}`, as far as their samples are there. */
export function readScenes(samples = readSamples()) {
  const scenes = JSON.parse(fs.readFileSync(path.join(FOLDER, "gallery.json"), "utf8"));
  return scenes.filter(({ name, link }) => {
    const missing = samplesOf(link).filter((sample) => !(sample in samples) && sample !== MADE_IN_CODE);
    if (missing.length > 0) console.error(`the scene “${name}” is left out: assets/samples has no ${missing.join(", ")}`);
    return missing.length === 0;
  });
}
