// Renders scenes with `gaitway render`. Images are cached in the target folder: one is rendered again only when its
// samples or the rendering code have changed, and only then is the program built, unless GAITWAY_CLI names one.
import { spawnSync } from "node:child_process";
import crypto from "node:crypto";
import fs from "node:fs";
import path from "node:path";
import { linkOf, samplesOf } from "./samples.mjs";

/** @typedef {import("./samples.mjs").LinkParts} LinkParts */

const TARGET = process.env.CARGO_TARGET_DIR ?? "target";
const CODE = ["shaders", "crates/core/src", ...["samples", "state", "frame", "render", "files", "editor", "cli"].map((module) => `src/${module}`)];

function codeHash() {
  const hash = crypto.createHash("sha256");
  for (const folder of CODE)
    for (const name of fs.readdirSync(folder, { recursive: true, encoding: "utf8" }).sort()) {
      const file = path.join(folder, name);
      if (fs.statSync(file).isFile()) hash.update(file).update(fs.readFileSync(file));
    }
  return hash.digest("hex");
}

/**
 * Renders scenes and returns the paths of the PNG files.
 * @param {(LinkParts & { size: string })[]} wanted Sizes are written like `480x300`.
 * @param {Record<string, string[]>} samples
 */
export function renderScenes(wanted, samples) {
  const code = codeHash();
  const folder = path.join(TARGET, "pictures");
  fs.mkdirSync(folder, { recursive: true });
  const images = wanted.map((scene) => {
    const link = linkOf(scene);
    const hash = crypto.createHash("sha256").update(code).update(link).update(scene.size);
    for (const file of samplesOf(scene).flatMap((name) => samples[name] ?? [])) hash.update(fs.readFileSync(file));
    return { scene, link, file: path.join(folder, `${hash.digest("hex").slice(0, 32)}.png`) };
  });
  const missing = images.filter(({ file }) => !fs.existsSync(file));
  const given = process.env.GAITWAY_CLI;
  if (missing.length > 0 && given === undefined) run("cargo", ["build", "--workspace", "--bin", "gaitway"]);
  const program = given ?? path.join(TARGET, "debug", process.platform === "win32" ? "gaitway.exe" : "gaitway");
  for (const { scene, link, file } of missing)
    run(program, ["render", scene.model, "--view", link, "--size", scene.size, "--out", file]);
  return images.map(({ file }) => file);
}

/**
 * @param {string} program
 * @param {string[]} args
 */
function run(program, args) {
  const { status, error } = spawnSync(program, args, { stdio: ["ignore", "inherit", "inherit"] });
  if (status === 0) return;
  console.error(`\nCouldn't render the gallery's images: ${error?.message ?? `\`${path.basename(program)} ${args.join(" ")}\` failed, see above`}.`);
  console.error("Rendering needs a graphics device or a software driver: mesa-vulkan-drivers on Debian and Ubuntu, which `cargo xtask setup` installs.");
  process.exit(1);
}
