// Pictures of links, drawn by `gaitway render`. They are kept in the target folder: what neither the samples nor the code
// that draws has changed is not drawn again, and then the program need not be there.
import { spawnSync } from "node:child_process";
import crypto from "node:crypto";
import fs from "node:fs";
import path from "node:path";
import { samplesOf, valuesOf } from "./samples.mjs";

const TARGET = process.env.CARGO_TARGET_DIR ?? "target";
const CODE = ["shaders", ...["anim", "mesh", "asset", "formats", "retarget", "library", "samples", "state", "frame", "render", "files"].map((module) => `src/${module}`)];

function codeHash() {
  const hash = crypto.createHash("sha256");
  for (const folder of CODE)
    for (const name of fs.readdirSync(folder, { recursive: true }).sort()) {
      const file = path.join(folder, name);
      if (fs.statSync(file).isFile()) hash.update(file).update(fs.readFileSync(file));
    }
  return hash.digest("hex");
}

/** Draws `[{link, size}]`, `size` as `480x300`; gives the paths of the PNG files. */
export function drawPictures(wanted, samples) {
  const code = codeHash();
  const folder = path.join(TARGET, "pictures");
  fs.mkdirSync(folder, { recursive: true });
  const pictures = wanted.map(({ link, size }) => {
    const hash = crypto.createHash("sha256").update(code).update(link).update(size);
    for (const file of samplesOf(link).flatMap((name) => samples[name] ?? [])) hash.update(fs.readFileSync(file));
    return { link, size, file: path.join(folder, `${hash.digest("hex").slice(0, 32)}.png`) };
  });
  const missing = pictures.filter(({ file }) => !fs.existsSync(file));
  if (missing.length > 0) run("cargo", ["build", "--release"]);
  const program = path.join(TARGET, "release", process.platform === "win32" ? "gaitway.exe" : "gaitway");
  for (const { link, size, file } of missing) {
    // A drawing that is broken off leaves nothing that looks like a picture.
    const unfinished = `${file}.part`;
    run(program, ["render", ...valuesOf(link, "model"), "--view", link, "--size", size, "--out", unfinished]);
    fs.renameSync(unfinished, file);
  }
  return pictures.map(({ file }) => file);
}

function run(program, given) {
  const { status, error } = spawnSync(program, given, { stdio: ["ignore", "inherit", "inherit"] });
  if (status === 0) return;
  console.error(`\nThe gallery's pictures could not be drawn: ${error?.message ?? `\`${path.basename(program)} ${given.join(" ")}\` failed, see above`}.`);
  console.error("Drawing takes a graphics device, or a driver in software: mesa-vulkan-drivers on Debian and Ubuntu, which `cargo xtask setup` installs.");
  process.exit(1);
}
