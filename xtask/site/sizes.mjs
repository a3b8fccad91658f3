// Writes compressed copies of everything that compresses, for hosts that can send them, and prints what a visitor downloads:
// the shell and one of the two programs. Fails if that exceeds a budget. Samples and images are counted apart, since each is
// loaded when it is shown. Arguments: the folder, and the budgets in bytes with the WebGPU and with the WebGL2 program.
import fs from "node:fs";
import path from "node:path";
import zlib from "node:zlib";

const folder = process.argv[2];
const [webgpu, webgl2] = process.argv.slice(3).map(Number);
const BUDGETS = { webgpu, webgl2 };
const COMPRESSED_ALREADY = [".webp", ".jpg", ".png"];
/** @typedef {{ raw: number, gzip: number, brotli: number }} Size */

/** @param {number} value */
const number = (value) => value.toLocaleString("en").padStart(12);
/** @type {(name: string, size: Size) => void} */
const line = (name, { raw, gzip, brotli }) => console.log(`${name.padEnd(48)}${number(raw)}${number(gzip)}${number(brotli)}`);

/** @type {Record<string, Size>} */
const parts = {};
/** @param {string} name */
const partOf = (name) => (name.includes(path.sep) ? name.split(path.sep)[0] : (Object.keys(BUDGETS).find((program) => name.startsWith(`${program}-`)) ?? "shell"));
console.log(`${"bytes".padEnd(48)}${"raw".padStart(12)}${"gzip".padStart(12)}${"brotli".padStart(12)}`);
for (const name of fs.readdirSync(folder, { recursive: true, encoding: "utf8" }).sort()) {
  const file = path.join(folder, name);
  if (!fs.statSync(file).isFile()) continue;
  const bytes = fs.readFileSync(file);
  const size = { raw: bytes.length, gzip: bytes.length, brotli: bytes.length };
  if (!COMPRESSED_ALREADY.includes(path.extname(name))) {
    const copies = { gzip: zlib.gzipSync(bytes, { level: 9 }), brotli: zlib.brotliCompressSync(bytes, { params: { [zlib.constants.BROTLI_PARAM_SIZE_HINT]: bytes.length } }) };
    fs.writeFileSync(`${file}.gz`, copies.gzip);
    fs.writeFileSync(`${file}.br`, copies.brotli);
    [size.gzip, size.brotli] = [copies.gzip.length, copies.brotli.length];
  }
  const part = (parts[partOf(name)] ??= { raw: 0, gzip: 0, brotli: 0 });
  for (const kind of /** @type {const} */ (["raw", "gzip", "brotli"])) part[kind] += size[kind];
  line(name, size);
}
for (const [part, size] of Object.entries(parts)) line(`all: ${part}`, size);
for (const [program, budget] of Object.entries(BUDGETS)) {
  const brotli = parts.shell.brotli + parts[program].brotli;
  console.log(`the page with ${program}: ${brotli.toLocaleString("en")} bytes with brotli`);
  if (brotli > budget) {
    console.error(`that is more than its budget of ${budget.toLocaleString("en")}`);
    process.exitCode = 1;
  }
}
