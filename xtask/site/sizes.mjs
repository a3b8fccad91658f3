// Writes compressed copies of everything that compresses, for hosts that can send them, and prints what a visitor downloads;
// fails when the page itself exceeds the budget. Samples and images are counted apart, since each is loaded when it is shown.
// Arguments: the folder, and the budget in bytes.
import fs from "node:fs";
import path from "node:path";
import zlib from "node:zlib";

const [folder, budget] = [process.argv[2], Number(process.argv[3])];
const COMPRESSED_ALREADY = [".webp", ".jpg", ".png"];
/** @typedef {{ raw: number, gzip: number, brotli: number }} Size */

/** @param {number} value */
const number = (value) => value.toLocaleString("en").padStart(12);
/** @type {(name: string, size: Size) => void} */
const line = (name, { raw, gzip, brotli }) => console.log(`${name.padEnd(48)}${number(raw)}${number(gzip)}${number(brotli)}`);

/** @type {Record<string, Size>} */
const parts = { page: { raw: 0, gzip: 0, brotli: 0 } };
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
  const part = (parts[name.includes(path.sep) ? name.split(path.sep)[0] : "page"] ??= { raw: 0, gzip: 0, brotli: 0 });
  for (const kind of /** @type {const} */ (["raw", "gzip", "brotli"])) part[kind] += size[kind];
  line(name, size);
}
for (const [part, size] of Object.entries(parts)) line(`all: ${part}`, size);
if (parts.page.brotli > budget) {
  console.error(`the page takes ${parts.page.brotli} bytes with brotli, more than its budget of ${budget}`);
  process.exit(1);
}
