// Joins files that are opened one after the other with those they belong to: the files of a .gltf in any order, and the .skel
// and .attach of an .obj after it.
import { extensionOf, fileName, isGltf, isPartOfGltf, itemNamed, nameOf, setWith } from "./held.js";

/** @typedef {import("./types.d.ts").Item} Item */
/** @typedef {import("./types.d.ts").Role} Role */

/**
 * What is opened together, and as what.
 * @typedef {{ items: Item[], as: Role }} Opening
 */

/** @type {Opening} */
const NOTHING = { items: [], as: undefined };

/** The last .gltf with its files, and files opened since that it doesn't need: the next one may. */
let last = NOTHING;
/** @type {Item[]} */
let loose = [];

/** Something else has been opened: what follows doesn't belong to files from before. */
export function forgetCompanions() {
  [last, loose] = [NOTHING, []];
}

/** One opening waits for the other, also while a .gltf is read. */
let turn = Promise.resolve(NOTHING);

/**
 * Adds the files from before that belong to these.
 * @param {Item[]} items
 * @param {Role} as
 */
export const withCompanions = (items, as) => (turn = turn.then(() => joined({ items, as })));

/**
 * @param {Opening} opening
 * @returns {Promise<Opening>}
 */
async function joined(opening) {
  const { items, as } = opening;
  const hasGltf = items.some(isGltf);
  if (!hasGltf && !items.every(isPartOfGltf)) {
    forgetCompanions();
    return { items: withMesh(items), as };
  }
  const main = hasGltf ? opening : last;
  const candidates = hasGltf ? loose : [...loose, ...items];
  const missing = candidates.length > 0 ? await missingFiles(main.items) : new Set();
  const found = candidates.filter((item) => missing.has(keyOf(nameOf(item))));
  if (!hasGltf && found.length === 0) {
    loose = candidates;
    return opening;
  }
  [last, loose] = [{ ...main, items: merged(main.items, found) }, []];
  return last;
}

/**
 * Returns the names of the files that local .gltf files refer to and that are not among the items.
 * @param {Item[]} items
 */
async function missingFiles(items) {
  const missing = new Set();
  for (const item of items) {
    if (typeof item === "string" || !isGltf(item)) continue;
    try {
      const { buffers = [], images = [] } = JSON.parse(await new Blob([item.content]).text());
      for (const { uri } of [...buffers, ...images]) if (uri !== undefined && !uri.startsWith("data:")) missing.add(keyOf(decodeURIComponent(uri)));
    } catch {
      // Opening it reports what is wrong.
    }
  }
  for (const item of items) missing.delete(keyOf(nameOf(item)));
  return missing;
}

/**
 * The program ignores folders and case as well (`FileSet::resolve`).
 * @param {string} path
 */
const keyOf = (path) => fileName(path.replaceAll("\\", "/")).toLowerCase();

/**
 * Adds the .obj to a .skel or .attach, and the other of the two.
 * @param {Item[]} items
 */
function withMesh(items) {
  if (!items.every((item) => ["skel", "attach"].includes(extensionOf(nameOf(item))))) return items;
  const stem = nameOf(items[0]).replace(/\.[^.]*$/, "");
  const mesh = setWith(`${stem}.obj`);
  if (mesh === undefined) return items;
  const others = ["skel", "attach"].map((extension) => itemNamed(`${stem}.${extension}`)).filter((item) => item !== undefined);
  return merged([...mesh, ...others], items);
}

/**
 * Returns the items of both lists, the later ones of the same name.
 * @param {Item[]} before
 * @param {Item[]} items
 */
const merged = (before, items) => [...new Map([...before, ...items].map((item) => [nameOf(item), item])).values()];
