// Prints what a visitor downloads; fails when it is more than the budget. Arguments: the folder, the budget in bytes.
import fs from "node:fs";
import path from "node:path";
import zlib from "node:zlib";

const [folder, budget] = [process.argv[1], Number(process.argv[2])];
const number = (value) => value.toLocaleString("en").padStart(12);
const total = { raw: 0, gzip: 0, brotli: 0 };
console.log(`${"bytes".padEnd(40)}${"raw".padStart(12)}${"gzip".padStart(12)}${"brotli".padStart(12)}`);
for (const name of fs.readdirSync(folder, { recursive: true }).sort()) {
  const file = path.join(folder, name);
  if (!fs.statSync(file).isFile()) continue;
  const bytes = fs.readFileSync(file);
  const size = { raw: bytes.length, gzip: zlib.gzipSync(bytes, { level: 9 }).length, brotli: zlib.brotliCompressSync(bytes).length };
  for (const kind in total) total[kind] += size[kind];
  console.log(`${name.padEnd(40)}${number(size.raw)}${number(size.gzip)}${number(size.brotli)}`);
}
console.log(`${"total".padEnd(40)}${number(total.raw)}${number(total.gzip)}${number(total.brotli)}`);
if (total.brotli > budget) {
  console.error(`the download is ${total.brotli} bytes with brotli, more than the ${budget} it may be`);
  process.exit(1);
}
