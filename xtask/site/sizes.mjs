// Puts compressed copies beside what a host may send compressed, and prints what a visitor downloads; fails when the page
// itself is more than the budget. Samples and pictures come apart: each is loaded when it is looked at. Arguments: the
// folder, the budget in bytes.
import fs from "node:fs";
import path from "node:path";
import zlib from "node:zlib";

const [folder, budget] = [process.argv[2], Number(process.argv[3])];
const COMPRESSED_ALREADY = [".webp", ".jpg", ".png"];
const number = (value) => value.toLocaleString("en").padStart(12);
const line = (name, { raw, gzip, brotli }) => console.log(`${name.padEnd(48)}${number(raw)}${number(gzip)}${number(brotli)}`);

const parts = { page: { raw: 0, gzip: 0, brotli: 0 } };
console.log(`${"bytes".padEnd(48)}${"raw".padStart(12)}${"gzip".padStart(12)}${"brotli".padStart(12)}`);
for (const name of fs.readdirSync(folder, { recursive: true }).sort()) {
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
  for (const kind in part) part[kind] += size[kind];
  line(name, size);
}
for (const [part, size] of Object.entries(parts)) line(`all: ${part}`, size);
if (parts.page.brotli > budget) {
  console.error(`the page is ${parts.page.brotli} bytes with brotli, more than the ${budget} it may be`);
  process.exit(1);
}
