// Runs the page's parts in Node, as web/shell/parts.js does in a worker, and their native programs.
// parts/part/src/lib.rs describes the calls.
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { dist } from "./data.mjs";
import { program } from "./gaitway.mjs";

/** The first byte of an answer other than an error. */
const CONVERTED = 1;
/** That byte and the length of the warnings. */
const HEADER_BYTES = 5;

/**
 * Returns a function that runs a part of the built page, in a fresh instance for each input as the page does. It throws
 * the part's message if there is no result.
 * @param {string} part
 */
export async function startPart(part) {
  const folder = path.join(dist, "parts");
  const files = fs.existsSync(folder) ? fs.readdirSync(folder) : [];
  const file = files.find((file) => file.startsWith(`${part}-`) && file.endsWith(".wasm"));
  if (file === undefined) throw new Error(`no part called ${part} in ${folder}: run \`cargo xtask build\``);
  const module = await WebAssembly.compile(fs.readFileSync(path.join(folder, file)));
  return async (/** @type {Uint8Array} */ input) => {
    const { memory, input: place, run, output, output_length: length } = /** @type {any} */ ((await WebAssembly.instantiate(module)).exports);
    // Allocate first: growing the memory replaces its buffer.
    const start = place(input.length);
    new Uint8Array(memory.buffer, start, input.length).set(input);
    run();
    return decode(Buffer.from(memory.buffer, output(), length()));
  };
}

/**
 * Runs a part's native program. Takes and returns the same as a function from {@link startPart}.
 * @param {string} part
 * @param {Uint8Array} input
 */
export function runNatively(part, input) {
  const file = path.join(path.dirname(program), `gaitway-${part}${path.extname(program)}`);
  if (!fs.existsSync(file)) throw new Error(`no ${file}: run \`cargo build --workspace\``);
  return decode(execFileSync(file, { input, maxBuffer: 1 << 30 }));
}

/** @param {Buffer} answer */
function decode(answer) {
  if (answer[0] !== CONVERTED) throw new Error(answer.toString("utf8", 1));
  const end = HEADER_BYTES + answer.readUInt32LE(1);
  const warnings = answer.toString("utf8", HEADER_BYTES, end).split("\0").slice(0, -1);
  return { bytes: answer.subarray(end), warnings };
}
