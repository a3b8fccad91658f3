// Gives the program's imports names that compress: wasm-bindgen ends each with a hash, in the program and in its script.
// Numbers of the same length replace the hashes, so nothing in the program moves. Arguments: program, script.
import fs from "node:fs";

const [program, script] = process.argv.slice(2);
const NAME = /__wb[a-z]*_[A-Za-z0-9_]*?_([0-9a-f]{16})(?![0-9a-f])/g;

const text = fs.readFileSync(script, "utf8");
/**
 * How many names share a beginning.
 * @type {Map<string, number>}
 */
const counts = new Map();
/** @type {Map<string, string>} */
const names = new Map();
for (const [name, hash] of text.matchAll(NAME)) {
  if (names.has(name)) continue;
  const beginning = name.slice(0, -hash.length);
  const count = counts.get(beginning) ?? 0;
  counts.set(beginning, count + 1);
  names.set(name, beginning + String(count).padStart(hash.length, "0"));
}
/** @param {string} text */
const renamed = (text) => text.replace(NAME, (name) => names.get(name) ?? name);
const taken = [...names.values()].filter((name) => text.includes(name) && !names.has(name));
if (names.size === 0 || taken.length > 0) throw new Error(`${script}: expected import names with hashes, found ${names.size}; already taken: ${taken.join(", ")}`);
// Latin-1 keeps every byte of the program.
const before = fs.readFileSync(program, "latin1");
const after = renamed(before);
if (after.length !== before.length) throw new Error(`${program}: import names changed their lengths`);
fs.writeFileSync(program, after, "latin1");
fs.writeFileSync(script, renamed(text));
console.log(`${names.size} imports renamed`);
