// Opening: files and URLs from a script, a dialog or a drop become items, which the app shows. The files of a model may come
// one after the other. Files that a link waits for complete it.
import { awaited, forgetAwaited, showAwaited } from "./awaited.js";
import { forgetProblem, summarize } from "./changes.js";
import { focusCanvas, frames, messageOf } from "./dom.js";
import { codeOf, coded } from "./errors.js";
import { extensionOf, fileName, heldItems, heldMotionsAndLight, isGltf, isPartOfGltf, itemNamed, nameOf, setWith } from "./held.js";
import { follow } from "./following.js";
import { hideGallery } from "./gallery.js";
import { linkWithFiles } from "./links.js";
import { load } from "./load.js";
import { sayNews, sayProblem } from "./panels.js";
import { refuse, running } from "./session.js";

/** @typedef {import("./types.d.ts").InspectDocument} InspectDocument */
/** @typedef {import("./types.d.ts").Item} Item */
/** @typedef {import("./types.d.ts").Openable} Openable */
/** @typedef {import("./types.d.ts").Role} Role */

/** Files that a message names. */
const MAX_NAMES = 4;

/**
 * What was opened last, if it is a .gltf without all of its files, or such files without their .gltf.
 * @type {Item[]}
 */
let incomplete = [];

/**
 * Opens what a script or the user gives. `isPrivate`: local files among it are the user's own, of which a page around this
 * one learns nothing. `isByHand`: the user opens them, not a script.
 * @param {Openable | Openable[] | FileList} items
 * @param {{ as?: Role, isPrivate?: boolean, isByHand?: boolean }} [options]
 * @returns {Promise<InspectDocument>}
 */
export async function open(items, { as, isPrivate = true, isByHand = false } = {}) {
  const given = toItems(items);
  // The page around this one completes none of the user's models.
  const wanted = isPrivate ? withCompanions(given) : given;
  await running();
  try {
    const { shown, document } = await load(wanted, as, isPrivate, isByHand);
    const lacksImages = shown === "model" && wanted.some(isGltf) && document.warnings.some(({ code }) => code === "image-missing");
    incomplete = lacksImages ? wanted : [];
    forgetProblem();
    await completeLink(wanted, true);
    // In place of the app's notice, which says less.
    announce(shown, summarize(), document);
    return document;
  } catch (error) {
    const lacksFiles = wanted.some(isGltf) && codeOf(error) === "not-found";
    incomplete = lacksFiles || wanted.every(isPartOfGltf) ? wanted : [];
    // A motion may have arrived before its model. What is incomplete can't complete a link yet.
    if (incomplete.length === 0) await completeLink(wanted, false);
    throw error;
  }
}

/**
 * Opens what the user dropped or chose. The app shows errors itself.
 * @param {Openable[]} items
 * @param {{ as?: Role }} [options]
 */
export async function openByHand(items, options) {
  if (items.length === 0) return;
  try {
    await open(items, { ...options, isByHand: true });
    hideGallery();
  } catch (error) {
    // The app learns of it in its next frame and may announce an older error first.
    await frames(2);
    sayProblem(messageOf(error));
  }
  focusCanvas();
}

/**
 * Turns anything that `gaitway.open` takes, alone or in a list, into items.
 * @param {Openable | Openable[] | FileList} items
 * @returns {Item[]}
 */
function toItems(items) {
  const isList = Array.isArray(items) || items instanceof FileList;
  return (isList ? [...items] : [items]).flatMap(/** @returns {Item[]} */ (item) => {
    if (typeof item === "string") return [item];
    if (item instanceof URL) return [item.href];
    if (item instanceof File) return [{ name: item.webkitRelativePath || item.name, content: item }];
    if (isNamedFile(item)) return [item];
    if (item === null || typeof item !== "object") throw coded("malformed", "open: expected URLs, files, or an object with a buffer for each name");
    return Object.entries(item).map(([name, content]) => {
      if (content instanceof Blob || content instanceof ArrayBuffer) return { name, content };
      if (ArrayBuffer.isView(content)) return { name, content: new Uint8Array(/** @type {ArrayBuffer} */ (content.buffer), content.byteOffset, content.byteLength) };
      throw coded("malformed", `open: ${name}: expected an ArrayBuffer`);
    });
  });
}

/**
 * @param {Openable} item
 * @returns {item is import("./types.d.ts").NamedFile}
 */
const isNamedFile = (item) => item !== null && typeof item === "object" && "name" in item && typeof item.name === "string" && "content" in item && item.content instanceof Blob;

/**
 * Adds what was opened before to a .skel or .attach that comes after its .obj, and to the files of a .gltf, whichever of them
 * comes first.
 * @param {Item[]} items
 * @returns {Item[]}
 */
function withCompanions(items) {
  if (items.length === 0) return items;
  if (items.every(isPartOfGltf) || (items.some(isGltf) && incomplete.every(isPartOfGltf))) return joined(incomplete, items);
  if (!items.every((item) => ["skel", "attach"].includes(extensionOf(nameOf(item))))) return items;
  const stem = nameOf(items[0]).replace(/\.[^.]*$/, "");
  const mesh = setWith(`${stem}.obj`);
  if (mesh === undefined) return items;
  const others = ["skel", "attach"].map((extension) => itemNamed(`${stem}.${extension}`)).filter((item) => item !== undefined);
  return joined([...mesh, ...others], items);
}

/**
 * Returns the items of both lists, the later ones of the same name.
 * @param {Item[]} before
 * @param {Item[]} items
 */
const joined = (before, items) => (before.length === 0 ? items : [...new Map([...before, ...items].map((item) => [nameOf(item), item])).values()]);

/**
 * @param {"model" | "motion" | "light" | "map"} shown
 * @param {string} model The name of the active model.
 * @param {InspectDocument} document
 */
function announce(shown, model, { clips, borrowed_clips: borrowed, joints, triangles }) {
  /** @type {(count: number, noun: string) => string} */
  const counted = (count, noun) => `${count.toLocaleString("en")} ${noun}${count === 1 ? "" : "s"}`;
  const texts = {
    model: `Opened ${model}: ${counted(clips.length, "clip")}, ${counted(joints, "joint")}, ${counted(triangles, "triangle")}.`,
    motion: `Borrowed motion: ${counted(borrowed?.length ?? 0, "clip")} available.`,
    light: "The image lights the scene.",
    map: "Joint map applied.",
  };
  sayNews(texts[shown]);
}

/**
 * Adds a set of files to those that a link waits for, and shows the link once all have arrived.
 * @param {Item[]} items
 * @param {boolean} isShown The app shows the set.
 */
async function completeLink(items, isShown) {
  const waiting = awaited();
  if (waiting === null) return;
  waiting.sets.push(items);
  const { marked, wanted, sets } = waiting;
  const found = wanted.map((file) => {
    /** @type {(item: Item) => boolean} */
    const isIt = (item) => fileName(nameOf(item)) === fileName(file.name);
    const set = sets.findLast((items) => items.some(isIt));
    return { file, set, item: set?.find(isIt) };
  });
  const missing = found.filter(({ item }) => item === undefined);
  if (missing.length > 0) {
    const isOther = !found.some(({ set }) => set === items);
    if (isShown && isOther) return passOver(waiting, items);
    waiting.missing = missing.map(({ file }) => file);
    return showAwaited(isOther ? namesOf(items) : undefined);
  }
  const names = found.flatMap(({ item }) => (item === undefined ? [] : [nameOf(item)]));
  const complete = linkWithFiles(marked, names);
  forgetAwaited();
  await follow(complete, { link: complete, items: heldItems(complete), motionItems: heldMotionsAndLight(complete) });
}

/**
 * Something else was opened instead of what a link waits for, on purpose or by mistake: says so, and waits on without asking,
 * but not longer than until the next file.
 * @param {import("./awaited.js").Awaited} waiting
 * @param {Item[]} items
 */
function passOver(waiting, items) {
  // Copies of files that couldn't be loaded are accepted, not asked for.
  if (waiting.isPassedOver || waiting.missing.length === 0) return forgetAwaited();
  waiting.isPassedOver = true;
  const wanted = listOf(waiting.missing.map(({ role, name }) => `${name} (${role})`));
  refuse(`The link asks for ${wanted}, not for ${namesOf(items)}. Drop ${waiting.missing.length === 1 ? "that file" : "those files"} to see the shared view.`);
}

/** @param {Item[]} items */
const namesOf = (items) => listOf(items.map((item) => fileName(nameOf(item))));

/** @param {string[]} names */
const listOf = (names) => (names.length > MAX_NAMES ? [...names.slice(0, MAX_NAMES), `${names.length - MAX_NAMES} more`] : names).join(", ");
