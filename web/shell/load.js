// Gets files into the app: reads them, hands them over and holds on to them.
import { messageOf } from "./dom.js";
import { coded } from "./errors.js";
import { hold, holdLast, releaseNamed } from "./held.js";
import { arePrivate, beginPrivate, endPrivate, forgetRejected, rememberRejected } from "./privacy.js";
import { running, unlessStopped } from "./session.js";

/** @typedef {import("./types.d.ts").InspectDocument} InspectDocument */
/** @typedef {import("./types.d.ts").Item} Item */
/** @typedef {import("./types.d.ts").ReadItem} ReadItem */
/** @typedef {import("./types.d.ts").Role} Role */

/**
 * Reads items into the form that the app takes.
 * @param {Item[]} items
 * @returns {Promise<ReadItem[]>}
 */
export const read = (items) => Promise.all(items.map(readItem));

/**
 * @param {Item} item
 * @returns {Promise<ReadItem>}
 */
async function readItem(item) {
  if (typeof item === "string") return item;
  try {
    return [item.name, new Uint8Array(item.content instanceof Blob ? await item.content.arrayBuffer() : item.content)];
  } catch {
    throw coded("not-found", `${item.name}: the browser can't read it; it may have been moved or changed, or it isn't a file`);
  }
}

/** @param {Item[]} items */
const areLocal = (items) => items.some((item) => typeof item !== "string");

/**
 * Reads and shows items, and holds on to local ones.
 * @param {Item[]} items
 * @param {Role} as
 * @param {boolean} isPrivate The local files among them are the user's own. Files that were so once always are.
 * @param {boolean} [isByHand] The user opens them, not a link or a script.
 * @returns {Promise<{ shown: "model" | "motion" | "light" | "map", document: InspectDocument }>}
 */
export async function load(items, as, isPrivate, isByHand = false) {
  // A link has URLs in full; other files have to be held.
  const isLocal = areLocal(items);
  const isPrivateNow = isLocal && (isPrivate || arePrivate(items));
  if (isPrivateNow) beginPrivate(items);
  if (isLocal) hold(items);
  try {
    const app = await running();
    const { shown, document } = JSON.parse(await unlessStopped(app, (async () => await app.open(await read(items), as, isPrivateNow, isByHand))()));
    forgetRejected();
    return { shown, document };
  } catch (error) {
    // Undo or a link's missing files may still show it.
    if (isLocal) holdLast(items);
    if (isPrivateNow) rememberRejected();
    throw error;
  } finally {
    if (isPrivateNow) endPrivate();
  }
}

/**
 * Holds on to files of the user's that can't be shown before others arrive.
 * @param {Item[]} items
 */
export function keep(items) {
  if (!areLocal(items)) return;
  beginPrivate(items);
  holdLast(items);
  rememberRejected();
  endPrivate();
}

/**
 * Parses the app's report on a followed link or an applied state. Files read from URLs replace held ones of the same
 * names.
 * @param {string} answer
 * @returns {{ loaded: string[], problems: string[] }}
 */
export function takeNews(answer) {
  const news = JSON.parse(answer);
  news.loaded.forEach(releaseNamed);
  if (news.loaded.length > 0) forgetRejected();
  return news;
}

/**
 * Reads held files for a new instance; one that can't be read any more is announced and left out.
 * @param {Item[]} items
 * @param {(message: string) => void} report
 */
export async function readOrReport(items, report) {
  const results = await Promise.allSettled(items.map(readItem));
  const problems = results.flatMap((result) => (result.status === "rejected" ? [messageOf(result.reason)] : []));
  if (problems.length > 0) report(problems.join(" "));
  return results.flatMap((result) => (result.status === "fulfilled" ? [result.value] : []));
}
