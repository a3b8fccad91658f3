// Opening: files and URLs from a script, a dialog or a drop become items, which the app shows. Files that a link waits for
// complete it.
import { askForRest, awaited, completable, forgetAwaited, passOver, showAwaited } from "./awaited.js";
import { forgetProblem, summarize, summarizeSoon } from "./changes.js";
import { withCompanions } from "./companions.js";
import { byId, focusCanvas, frames, listOf, messageOf } from "./dom.js";
import { codeOf, coded } from "./errors.js";
import { fileName, heldFor, holdLast, isGltf, isPartOfGltf, nameOf } from "./held.js";
import { follow } from "./following.js";
import { hideGallery } from "./gallery.js";
import { beginFollowing, endFollowing } from "./history.js";
import { linkWithFiles } from "./links.js";
import { keep, load } from "./load.js";
import { sayNews, sayProblem } from "./panels.js";
import { running, session } from "./session.js";

/** @typedef {import("./types.d.ts").InspectDocument} InspectDocument */
/** @typedef {import("./types.d.ts").Item} Item */
/** @typedef {import("./types.d.ts").Openable} Openable */
/** @typedef {import("./types.d.ts").Role} Role */

/**
 * Opens what a script or the user gives. `isPrivate`: local files among it are the user's own, of which a page around this
 * one learns nothing. `isByHand`: the user opens them, not a script.
 * @param {Openable | Openable[] | FileList} items
 * @param {{ as?: Role, isPrivate?: boolean, isByHand?: boolean }} [options]
 * @returns {Promise<InspectDocument>}
 */
export async function open(items, { as, isPrivate = true, isByHand = false } = {}) {
  const given = asAwaited(toItems(items));
  // The page around this one completes none of the user's models.
  const { items: wanted, as: role } = isPrivate ? await withCompanions(given, as) : { items: given, as };
  await running();
  // What a link waits for is shown as the link says, in the link's entry of the history.
  const isAwaited = completable()?.wanted.some((file) => fileAmong(wanted, file) !== undefined) ?? false;
  const isInEntry = isAwaited && awaited() !== null;
  if (isInEntry) beginFollowing();
  const { motions, others } = splitAwaited(wanted);
  // They follow once the link's model is there.
  if (motions.length > 0 && others.length > 0) (isPrivate ? keep : holdLast)(motions);
  try {
    const isMotion = others.length === 0;
    const { shown, document } = await load(isMotion ? motions : others, isMotion ? "motion" : role, isPrivate, isByHand && !isAwaited);
    forgetProblem();
    const hint = await completeLink(wanted, shown);
    announce(shown, summarize(), document);
    if (isByHand && hint !== undefined) session.app?.notify(hint);
    return document;
  } catch (error) {
    const code = codeOf(error);
    // A motion may have arrived before its model. Without all of its files, nothing completes a link.
    if (code === "not-found") showAwaited(namesOf(wanted));
    else if (code !== "cancelled") await completeLink(wanted);
    throw error;
  } finally {
    if (isInEntry) {
      endFollowing();
      summarizeSoon();
    }
  }
}

/** How often the user has opened something. */
let openedCount = 0;

/** Resolves once what the user opened last is there or has failed. */
let lastOpened = Promise.resolve();

/**
 * Whether it has a motion and never a model.
 * @param {Item} item
 */
const isMotion = (item) => /\.(bvh|vrma|npz)$/i.test(bareName(item));

/**
 * Opens what the user dropped or chose. The app shows errors itself.
 * @param {Openable[]} items
 * @param {{ as?: Role }} [options]
 */
export async function openByHand(items, options) {
  if (items.length === 0) return;
  const link = ownLink(items);
  if (link !== undefined && options?.as !== "motion") {
    location.hash = link;
    return hideGallery();
  }
  if (options?.as === "motion" || toItems(items).every(isMotion)) {
    // It is for the model that is on its way, and others may be opened meanwhile.
    let awaitedOpening;
    while (awaitedOpening !== lastOpened) {
      awaitedOpening = lastOpened;
      await awaitedOpening;
    }
  }
  lastOpened = openNow(items, options);
  await lastOpened;
  // The dialog has given the focus back to the control that opened it, if that is still there.
  if (!byId("stage").contains(document.activeElement)) focusCanvas();
}

/**
 * Opens what the user gives, without waiting for what is being opened.
 * @param {Openable[]} items
 * @param {{ as?: Role }} [options]
 */
async function openNow(items, options) {
  openedCount += 1;
  const number = openedCount;
  try {
    if (!(await keptForModel(asAwaited(toItems(items))))) await open(items, { ...options, isByHand: true });
    hideGallery();
  } catch (error) {
    // The app learns of it in its next frame and may announce an older error first.
    await frames(2);
    // What was opened since has its own result; that this wasn't opened is told as well.
    if (number === openedCount) sayProblem(messageOf(error));
    else if (codeOf(error) === "cancelled") session.app?.notify(`${messageOf(error)}.`);
  }
}

/**
 * Returns the link if the user gives a URL of this page, such as a card of the gallery.
 * @param {Openable[]} items
 */
function ownLink([item]) {
  if (typeof item !== "string" || !URL.canParse(item)) return undefined;
  const { origin, pathname, hash } = new URL(item);
  return origin === location.origin && pathname === location.pathname && hash !== "" ? hash : undefined;
}

/**
 * Keeps what a link needs besides its model until the model arrives: nothing can be shown of it before. Returns whether that is so.
 * @param {Item[]} items
 */
async function keptForModel(items) {
  const missing = awaited()?.missing ?? [];
  const roles = missing.filter((file) => fileAmong(items, file) !== undefined).map(({ role }) => role);
  if (roles.length === 0 || roles.includes("model") || !missing.some(({ role }) => role === "model")) return false;
  keep(items);
  await completeLink(items);
  return true;
}

/**
 * Gives copies of files that a link waits for the names that it knows them by: clips may be named after their file.
 * @param {Item[]} items
 * @returns {Item[]}
 */
function asAwaited(items) {
  const names = (completable()?.wanted ?? []).map(({ name }) => fileName(name));
  const missing = names.filter((name) => items.every((item) => bareName(item) !== name));
  return items.map((item) => {
    const at = missing.findIndex((name) => withoutCopy(name) === withoutCopy(bareName(item)));
    if (at < 0 || typeof item === "string") return item;
    const [name] = missing.splice(at, 1);
    return { ...item, name: item.name.slice(0, item.name.lastIndexOf("/") + 1) + name };
  });
}

/**
 * Separates what a link waits for as a motion, with its files: a character, opened together with the link's own, would be another model.
 * @param {Item[]} items
 * @returns {{ motions: Item[], others: Item[] }}
 */
function splitAwaited(items) {
  const files = completable()?.wanted ?? [];
  const [models, lent] = ["model", "motion"].map((wanted) => files.flatMap((file) => (file.role === wanted ? [fileAmong(items, file)] : [])));
  const motions = items.filter((item) => lent.includes(item) && !models.includes(item));
  if (motions.length === 0) return { motions, others: items };
  const others = items.filter((item) => !motions.includes(item));
  const parts = motions.some(isGltf) ? others.filter(isPartOfGltf) : [];
  return { motions: [...motions, ...parts], others: others.length > parts.length ? others : [] };
}

/**
 * Returns a file of a link among items, by its bare name.
 * @param {Item[]} items
 * @param {import("./types.d.ts").LinkedFile} file
 */
const fileAmong = (items, { name }) => items.find((item) => bareName(item) === fileName(name));

/** @param {Item} item */
const bareName = (item) => fileName(nameOf(item));

/**
 * Removes what browsers and systems add to the names of copies: “walk (1).bvh”, “walk copy.bvh”, “walk - Copy (2).bvh”.
 * @param {string} name
 */
const withoutCopy = (name) => name.replace(/(?: - Copy| copy(?: \d+)?)?(?: ?\(\d+\))?(?=\.[^.]*$)/, "");

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
 * Tells screen readers what the app says about what was opened, and what can be seen of it.
 * @param {"model" | "motion" | "light" | "map"} shown
 * @param {{ model: string, notice: string | null }} summary
 * @param {InspectDocument} document
 */
function announce(shown, { model, notice }, { clips, borrowed_clips: borrowed, joints, triangles }) {
  /** @type {(count: number, noun: string) => string} */
  const counted = (count, noun) => `${count.toLocaleString("en")} ${noun}${count === 1 ? "" : "s"}`;
  // None where a motion shows its own skeleton.
  const lent = borrowed?.length ?? 0;
  const texts = {
    model: [`Opened ${model}.`, `${counted(clips.length, "clip")}, ${counted(joints, "joint")}, ${counted(triangles, "triangle")}.`],
    motion: ["Borrowed the motion.", `${lent > 0 ? counted(lent, "borrowed clip") : counted(clips.length, "clip")}.`],
    light: ["The image lights the scene."],
    map: ["Joint map applied."],
  };
  const [opened, ...contents] = texts[shown];
  sayNews([notice ?? opened, ...contents].join(" "));
}

/**
 * Shows a link with files that it waits for among these, as far as that is possible without the rest, which the page goes on
 * asking for. Returns what to tell the user who opened another model instead.
 * @param {Item[]} items
 * @param {"model" | "motion" | "light" | "map"} [shown] What it was, unless it couldn't be opened.
 */
async function completeLink(items, shown) {
  const waiting = completable();
  if (waiting === null) return;
  const arrived = waiting.wanted.map((file) => fileAmong(items, file));
  if (arrived.every((item) => item === undefined)) {
    if (shown === "model") return passOver();
    return void showAwaited(shown === undefined ? namesOf(items) : undefined);
  }
  const link = linkWithFiles(waiting.marked, arrived.map((item) => (item === undefined ? "" : nameOf(item))));
  const rest = waiting.wanted.filter((_, index) => arrived[index] === undefined);
  if (rest.some(({ role }) => role === "model")) {
    askForRest(waiting, link, rest);
    return void showAwaited();
  }
  // They are still awaited: one of them is damaged.
  if (shown === undefined) return void showAwaited(namesOf(items));
  forgetAwaited();
  await follow(link, { link, ...heldFor(link), isOwn: waiting.isOwn });
}

/** @param {Item[]} items */
const namesOf = (items) => listOf(items.map(bareName));
