// Writes compressed copies of everything that compresses, for hosts that can send them, and prints what a visitor
// downloads: the shell and one of the two programs. Fails if that, or a part that some files need, exceeds its budget.
// Samples and images are counted apart, since each is loaded when it is shown. Arguments: the folder, a cache folder for the copies,
// since compressing takes a minute, and `NAME=BYTES` for each program and part.
import crypto from "node:crypto";
import fs from "node:fs";
import path from "node:path";
import zlib from "node:zlib";

const [folder, kept] = process.argv.slice(2);
/** @type {Record<string, number>} */
const BUDGETS = Object.fromEntries(process.argv.slice(4).map((argument) => [argument.split("=")[0], Number(argument.split("=")[1])]));
const COMPRESSED_ALREADY = [".webp", ".jpg", ".png"];
/** @typedef {{ raw: number, gzip: number, brotli: number }} Size */

/** @param {number} value */
const number = (value) => value.toLocaleString("en").padStart(12);
/** @type {(name: string, size: Size) => void} */
const line = (name, { raw, gzip, brotli }) => console.log(`${name.padEnd(48)}${number(raw)}${number(gzip)}${number(brotli)}`);

/** Ways to compress, by the extension of the copy. @type {Record<string, (bytes: Buffer) => Buffer>} */
const COMPRESSIONS = {
  gz: (bytes) => zlib.gzipSync(bytes, { level: 9 }),
  br: (bytes) => zlib.brotliCompressSync(bytes, { params: { [zlib.constants.BROTLI_PARAM_SIZE_HINT]: bytes.length } }),
};

const { brotli, zlib: deflate } = process.versions;
fs.mkdirSync(kept, { recursive: true });
const unused = new Set(fs.readdirSync(kept));
/**
 * Returns a compressed copy: the kept one, if there is one of the same content, compressed in the same way.
 * @param {Buffer} bytes
 * @param {string} extension
 */
function compressed(bytes, extension) {
  const hash = crypto.createHash("sha256").update(`${brotli} ${deflate} ${COMPRESSIONS[extension]}`).update(bytes).digest("hex");
  const name = `${hash}.${extension}`;
  const copy = path.join(kept, name);
  if (unused.delete(name) || fs.existsSync(copy)) return fs.readFileSync(copy);
  const content = COMPRESSIONS[extension](bytes);
  fs.writeFileSync(`${copy}.part`, content);
  fs.renameSync(`${copy}.part`, copy);
  return content;
}

/** @type {Record<string, Size>} */
const parts = {};
/** @param {string} name */
const partOf = (name) => Object.keys(BUDGETS).find((part) => name.startsWith(`${part}-`)) ?? (name.includes("/") ? name.split("/")[0] : "shell");
console.log(`${"bytes".padEnd(48)}${"raw".padStart(12)}${"gzip".padStart(12)}${"brotli".padStart(12)}`);
for (const file of fs.readdirSync(folder, { recursive: true, encoding: "utf8" }).sort().map((name) => path.join(folder, name))) {
  const name = path.relative(folder, file).split(path.sep).join("/");
  if (!fs.statSync(file).isFile()) continue;
  const bytes = fs.readFileSync(file);
  const size = { raw: bytes.length, gzip: bytes.length, brotli: bytes.length };
  if (!COMPRESSED_ALREADY.includes(path.extname(name))) {
    const [gzip, brotli] = ["gz", "br"].map((extension) => {
      const content = compressed(bytes, extension);
      fs.writeFileSync(`${file}.${extension}`, content);
      return content.length;
    });
    Object.assign(size, { gzip, brotli });
  }
  const part = (parts[partOf(name)] ??= { raw: 0, gzip: 0, brotli: 0 });
  for (const kind of /** @type {const} */ (["raw", "gzip", "brotli"])) part[kind] += size[kind];
  line(name, size);
}
for (const name of unused) fs.rmSync(path.join(kept, name));
for (const [part, size] of Object.entries(parts)) line(`all: ${part}`, size);
for (const [part, budget] of Object.entries(BUDGETS)) {
  if (parts[part] === undefined) {
    console.log(`${part}: not built`);
    continue;
  }
  const isProgram = !part.includes("/");
  const brotli = (isProgram ? parts.shell.brotli : 0) + parts[part].brotli;
  console.log(`${isProgram ? "the page with " : ""}${part}: ${brotli.toLocaleString("en")} bytes with brotli`);
  if (brotli > budget) {
    console.error(`that is more than its budget of ${budget.toLocaleString("en")}`);
    process.exitCode = 1;
  }
}
