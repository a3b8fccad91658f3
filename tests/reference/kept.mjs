// Keeps what other renderers draw from one run to the next, in cargo's target folder: filtering one environment takes the
// Khronos glTF Sample Renderer minutes without a graphics card. Gaitway's own pictures are drawn in every run.
import crypto from "node:crypto";
import fs from "node:fs";
import path from "node:path";
import { targetFolder } from "../three/data.mjs";

/** Pictures of older versions are deleted after a month. */
const MAX_UNUSED_MS = 30 * 24 * 60 * 60 * 1000;

/** Everything that a picture depends on. @typedef {(string | Buffer)[]} Origin */

/**
 * Returns a function that returns a picture with the given origin, kept or drawn, as a data URL.
 * @param {Origin} shared What all pictures depend on.
 */
export function keptPictures(shared) {
  const folder = path.join(targetFolder, "reference-pictures");
  fs.mkdirSync(folder, { recursive: true });
  for (const file of fs.readdirSync(folder).map((name) => path.join(folder, name)))
    if (Date.now() - fs.statSync(file).mtimeMs > MAX_UNUSED_MS) fs.rmSync(file, { force: true });
  const of = hash(shared);
  /** @type {(origin: Origin, draw: () => Promise<string>) => Promise<string>} */
  return async (origin, draw) => {
    const file = path.join(folder, hash([of, ...origin]));
    if (fs.existsSync(file)) {
      const now = new Date();
      fs.utimesSync(file, now, now);
      return fs.readFileSync(file, "utf8");
    }
    const picture = await draw();
    // Never half a picture, even if the run is stopped.
    const part = `${file}.${process.pid}`;
    fs.writeFileSync(part, picture);
    fs.renameSync(part, file);
    return picture;
  };
}

/**
 * Returns a model's bytes: a .gltf file's with all that lies beside it.
 * @param {string} model
 * @returns {Origin}
 */
export function contentOf(model) {
  if (path.extname(model) !== ".gltf") return [fs.readFileSync(model)];
  const folder = path.dirname(model);
  const files = fs.readdirSync(folder, { recursive: true, encoding: "utf8" }).sort().map((name) => path.join(folder, name));
  return files.filter((file) => fs.statSync(file).isFile()).flatMap((file) => [file.slice(folder.length), fs.readFileSync(file)]);
}

/** @param {Origin} parts */
function hash(parts) {
  const sum = crypto.createHash("sha256");
  for (const part of parts) sum.update(`${part.length} `).update(part);
  return sum.digest("hex");
}
