// Files that were dropped or chosen. The page holds on to them, so that a new instance, back and forward can show them
// again; a link only has their names.
import { linkWithFiles, linkedFiles, publicLink } from "./links.js";

/** @typedef {import("./types.d.ts").Item} Item */
/** @typedef {import("./types.d.ts").LinkedFile} LinkedFile */

const MAX_HELD = 32;

/**
 * Sets of files that were opened together, the most recent last.
 * @type {Item[][]}
 */
const held = [];

/** @param {Item} item */
export const nameOf = (item) => (typeof item === "string" ? item : item.name);

/**
 * Returns the decoded last part of a path or URL, without its query.
 * @param {string} address
 */
export function fileName(address) {
  const name = /** @type {string} */ (address.split(/[?#]/)[0].split("/").pop());
  try {
    return decodeURIComponent(name);
  } catch {
    return name;
  }
}

/** @param {string} name */
export const extensionOf = (name) => /** @type {string} */ (name.split(".").pop()).toLowerCase();

/** @param {Item[]} items */
export function hold(items) {
  release(items);
  held.push(items);
  if (held.length > MAX_HELD) held.shift();
}

/** @param {Item[]} items */
export function release(items) {
  const at = held.indexOf(items);
  if (at >= 0) held.splice(at, 1);
}

/**
 * Holds on to files that couldn't be shown, without hiding files of the same names that are shown.
 * @param {Item[]} items
 */
export function holdLast(items) {
  release(items);
  held.unshift(items);
}

/**
 * Drops sets with a file of this name, which was read from its URL meanwhile.
 * @param {string} name
 */
export function releaseNamed(name) {
  for (let at = held.length - 1; at >= 0; at--) if (held[at].some((item) => nameOf(item) === name)) held.splice(at, 1);
}

/**
 * Returns the most recent set with a file of this name.
 * @param {string} name
 */
export const setWith = (name) => held.findLast((items) => items.some((item) => nameOf(item) === name));

/**
 * Returns the most recent file of this name.
 * @param {string} name
 */
export const itemNamed = (name) => held.flat().findLast((item) => nameOf(item) === name);

/**
 * Returns the sets that hold a link's files.
 * @param {string} link
 * @param {LinkedFile["role"]} role
 */
function setsOf(link, role) {
  const files = linkedFiles(link).filter((file) => file.role === role && !file.isToBring);
  return [...new Set(files.map(({ name }) => setWith(name)))].filter((set) => set !== undefined);
}

/**
 * Returns what a link is opened from, besides URLs.
 * @param {string} link
 * @returns {{ items: Item[], motionItems: Item[] }}
 */
export const heldFor = (link) => ({ items: setsOf(link, "model").flat(), motionItems: motionsAndLight(link) });

/**
 * Returns what a link's motions and its light are opened from, besides the model's own files.
 * @param {string} link
 */
function motionsAndLight(link) {
  const models = setsOf(link, "model");
  const motions = setsOf(link, "motion").filter((set) => !models.includes(set));
  const sets = [...models, ...motions];
  // Not the whole set with the light: it may contain a model that is no longer shown.
  const lights = linkedFiles(link).flatMap(({ role, name, isToBring }) => {
    const item = role === "light" && !isToBring ? itemNamed(name) : undefined;
    return item === undefined || sets.some((set) => set.includes(item)) ? [] : [item];
  });
  return [...motions.flat(), ...lights];
}

/**
 * Whether a local file of this name was opened.
 * @param {string} name
 */
const isLocal = (name) => held.some((items) => items.some((item) => typeof item !== "string" && item.name === name));

/**
 * Returns the files of a link that exist only on this computer.
 * @param {string} link
 */
export const localFiles = (link) => linkedFiles(link).filter(({ name, isToBring }) => !isToBring && isLocal(name));

/**
 * Returns what a link shows with the local files that it asks for and that were opened before, if there are any.
 * @param {string} link
 */
export function withHeldFiles(link) {
  const names = linkedFiles(link).flatMap(({ name, isToBring }) => (isToBring ? [isLocal(name) ? name : ""] : []));
  if (names.every((name) => name === "")) return undefined;
  const known = linkWithFiles(link, names);
  return { link: known, ...heldFor(known) };
}

/**
 * Returns the link to hand to others.
 * @param {string} link
 */
export const shareableLink = (link) => publicLink(link, localFiles(link).map(({ name }) => name));

/**
 * The companion files of a file, which a link doesn't name.
 * @type {Record<string, { words: string, extension: RegExp }>}
 */
const COMPANIONS = {
  gltf: { words: "its .bin and images", extension: /\.(bin|png|jpe?g|webp|avif|ktx2)$/i },
  obj: { words: "its .skel and .attach", extension: /\.(skel|attach|mtl|png|jpe?g)$/i },
};

/**
 * Describes a file's companions, if it has any.
 * @param {string} name
 */
export const companionWords = (name) => COMPANIONS[extensionOf(name)]?.words;

/** @param {Item} item */
export const isGltf = (item) => extensionOf(fileName(nameOf(item))) === "gltf";

/**
 * Whether a .gltf may refer to it, and it can't be opened by itself.
 * @param {Item} item
 */
export const isPartOfGltf = (item) => COMPANIONS.gltf.extension.test(fileName(nameOf(item)));

/**
 * Returns the names of the companions that were opened together with a file.
 * @param {string} name
 */
export function companionsOf(name) {
  const extension = COMPANIONS[extensionOf(name)]?.extension;
  return (setWith(name) ?? []).map(nameOf).filter((other) => extension?.test(other));
}
