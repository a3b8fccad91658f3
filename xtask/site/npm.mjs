// Assembles the npm package from the built page: `node xtask/site/npm.mjs FOLDER` leaves in FOLDER what `npm pack` and `npm publish`
// take. It is laid out as the page is, so that the element finds the program in the same place. What it lacks is only for a site of
// Gaitway's own: the service worker and the manifest of the installed app, the examples, compressed copies.
import fs from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

const ROOT = fileURLToPath(new URL("../..", import.meta.url));
const LEFT_OUT = /^(sw\.js|manifest\.webmanifest|icons\/.*|viewer\/(?!gaitway\.js$).*|.*\.(br|gz))$/;

/**
 * @param {string} dist The built page.
 * @param {string} folder Is replaced.
 */
export function assemble(dist, folder) {
  fs.rmSync(folder, { recursive: true, force: true });
  const copy = (/** @type {string} */ from, /** @type {string} */ to) => {
    fs.mkdirSync(path.dirname(path.join(folder, to)), { recursive: true });
    fs.copyFileSync(from, path.join(folder, to));
  };
  const files = fs.readdirSync(dist, { recursive: true, encoding: "utf8" }).map((file) => file.split(path.sep).join("/"));
  for (const file of files) if (fs.statSync(path.join(dist, file)).isFile() && !LEFT_OUT.test(file)) copy(path.join(dist, file), file);
  for (const file of ["viewer/gaitway.d.ts", "viewer/react.d.ts", "README.md"]) copy(path.join(ROOT, "npm", file), file);
  for (const file of ["LICENSE-MIT", "LICENSE-APACHE"]) copy(path.join(ROOT, file), file);
  const manifest = JSON.parse(fs.readFileSync(path.join(ROOT, "npm/package.json"), "utf8"));
  fs.writeFileSync(path.join(folder, "package.json"), `${JSON.stringify({ ...manifest, version: version() }, null, 2)}\n`);
}

/** Returns the version of all packages. */
function version() {
  const [, version] = /^version = "(.+)"$/m.exec(fs.readFileSync(path.join(ROOT, "Cargo.toml"), "utf8")) ?? [];
  if (version === undefined) throw new Error("Cargo.toml: expected a version");
  return version;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [folder] = process.argv.slice(2);
  if (folder === undefined) throw new Error("expected the folder of the package");
  assemble(path.join(ROOT, "dist"), folder);
}
