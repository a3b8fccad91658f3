// Joins files that are opened one after the other with those they belong to: the files of a .gltf in any order, and the .skel
// and .attach of an .obj after it.
import { extensionOf, isGltf, isPartOfGltf, itemNamed, nameOf, setWith } from "./held.js";
import { readOrReport } from "./load.js";
import { running } from "./session.js";

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
export function withCompanions(items, as) {
  const next = () => joined({ items, as });
  // Whatever became of the one before.
  turn = turn.then(next, next);
  return turn;
}

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
  const app = await running();
  // Of the others, the names are enough.
  const described = items.map((item) => (typeof item === "string" || isGltf(item) ? item : { name: item.name, content: new ArrayBuffer(0) }));
  // Opening them reports what is wrong.
  const read = await readOrReport(described, () => {});
  return new Set(app.missing_files(read).map(keyOf));
}

/**
 * The program ignores folders and case as well (`FileSet::resolve`).
 * @param {string} path
 */
const keyOf = (path) => path.split(/[/\\]/).at(-1)?.toLowerCase();

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
 * Returns the items of both lists, the later ones of the same name. The .gltf comes last: a failure is titled by the last file that
 * was read.
 * @param {Item[]} before
 * @param {Item[]} items
 */
function merged(before, items) {
  const all = [...new Map([...before, ...items].map((item) => [nameOf(item), item])).values()];
  return all.sort((one, other) => Number(isGltf(one)) - Number(isGltf(other)));
}
