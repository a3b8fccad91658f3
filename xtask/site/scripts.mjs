// Minifies the scripts that trunk left in dist/, and bundles the page's modules into one file, so that they take one request.
// Trunk's own minifier gives up on syntax it doesn't know. Argument: the folder.
import fs from "node:fs";
import path from "node:path";
import { build, transform } from "esbuild";

/** What every browser with WebAssembly SIMD understands. */
const TARGET = "es2022";

const dist = process.argv[2];
for (const name of fs.readdirSync(dist).filter((name) => name.endsWith(".js"))) {
  const file = path.join(dist, name);
  if (/^shell-[0-9a-f]+\.js$/.test(name)) {
    await build({ entryPoints: ["web/shell.js"], outfile: file, allowOverwrite: true, bundle: true, format: "esm", minify: true, target: TARGET, logLevel: "warning" });
  } else {
    const { code } = await transform(fs.readFileSync(file, "utf8"), { minify: true, target: TARGET });
    fs.writeFileSync(file, code);
  }
}
