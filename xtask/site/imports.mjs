// Gives the program's imports names that compress: wasm-bindgen ends each with a hash, which stands in the program and in
// its script. Numbers as long as the hashes take their place, so nothing in the program moves. Arguments: program, script.
import fs from "node:fs";

const [program, script] = process.argv.slice(2);
const NAME = /__wb[a-z]*_[A-Za-z0-9_]*?_([0-9a-f]{16})(?![0-9a-f])/g;

const text = fs.readFileSync(script, "utf8");
/** How many names there are with the same beginning. */
const counts = new Map();
const names = new Map();
for (const [name, hash] of text.matchAll(NAME)) {
  if (names.has(name)) continue;
  const beginning = name.slice(0, -hash.length);
  const count = counts.get(beginning) ?? 0;
  counts.set(beginning, count + 1);
  names.set(name, beginning + String(count).padStart(hash.length, "0"));
}
const renamed = (text) => text.replace(NAME, (name) => names.get(name) ?? name);
const taken = [...names.values()].filter((name) => text.includes(name) && !names.has(name));
if (names.size === 0 || taken.length > 0) throw new Error(`${script}: expected names of imports with hashes, found ${names.size}; already there: ${taken.join(", ")}`);
// Byte for byte: a program is no text.
const before = fs.readFileSync(program, "latin1");
const after = renamed(before);
if (after.length !== before.length) throw new Error(`${program}: the names of imports have other lengths`);
fs.writeFileSync(program, after, "latin1");
fs.writeFileSync(script, renamed(text));
console.log(`${names.size} imports renamed`);
