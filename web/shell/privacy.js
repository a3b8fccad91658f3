// What a page around this one must not learn: anything about files that the user dropped or chose.
import { session } from "./session.js";

/** @typedef {import("./types.d.ts").Item} Item */

/** @type {WeakSet<object>} */
const privateFiles = new WeakSet();

/** Private state beyond what the app shows: rejected files, and a visit that showed private ones. */
const beyondApp = { rejected: false, visited: history.state?.own === true };
/** Private files that are being opened. */
let openingCount = 0;
/** How often private files were opened so far: reveals any that came and went. */
let seenCount = 0;
/** The app's last answer, valid while it cannot be asked. */
let wasPrivate = false;

/** @param {Item[]} items */
export const arePrivate = (items) => items.some((item) => typeof item !== "string" && privateFiles.has(item));

/**
 * Marks files as private while they are opened, and from then on.
 * @param {Item[]} items
 */
export function beginPrivate(items) {
  openingCount += 1;
  seenCount += 1;
  for (const item of items) if (typeof item !== "string") privateFiles.add(item);
}

export function endPrivate() {
  openingCount -= 1;
}

/** Files were opened: what was rejected before is no longer on screen. */
export function forgetRejected() {
  beyondApp.rejected = false;
}

export function rememberRejected() {
  beyondApp.rejected = true;
}

export function rememberPrivateVisit() {
  beyondApp.visited = true;
}

export const seenPrivate = () => seenCount;

/** Whether a page around this one must not learn what is shown. */
export function isPrivate() {
  try {
    wasPrivate = session.app?.is_private() ?? wasPrivate;
  } catch {
    wasPrivate = true;
  }
  return wasPrivate || beyondApp.rejected || beyondApp.visited || openingCount > 0;
}
