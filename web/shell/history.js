// The address bar and the browser's history: opening other files adds an entry, everything else changes the current
// one. Entries with local files keep them as long as the page lives.
import { awaited } from "./awaited.js";
import { heldFor, shareableLink } from "./held.js";
import { linkWithMissing, shownFiles } from "./links.js";
import { isPrivate } from "./privacy.js";
import { session } from "./session.js";

/** @typedef {import("./types.d.ts").Item} Item */

/**
 * What an entry of the history showed.
 * @typedef {{ link: string, items: Item[], motionItems: Item[] }} Visit
 */

/** What an entry's state holds. Older versions of the page wrote it too, so its keys stay. */
/** @typedef {{ gaitway?: number, own?: boolean } | null} EntryState */

const MAX_VISITS = 16;

/** The current entry: its number, the files it shows, and the link that was typed, kept until something is set. */
const entry = {
  number: /** @type {number} */ (history.state?.gaitway ?? 0),
  files: /** @type {string | null} */ (null),
  typed: /** @type {string | null} */ (null),
};
let lastNumber = entry.number;

/**
 * Entries with local files, by number.
 * @type {Map<number, Visit>}
 */
const visits = new Map();

/** Links being followed now. What the app shows on the way is no entry. */
let followingCount = 0;

/** Returns whether another one is under way. */
export function beginFollowing() {
  followingCount += 1;
  return followingCount > 1;
}

export function endFollowing() {
  followingCount -= 1;
}

/** Writes the current view to the address bar. */
export function recordView() {
  if (followingCount > 0) return;
  // A typed address stays as it is until something is set.
  if (session.link === entry.typed) {
    const asking = askingLink();
    if (asking !== null) remember(asking);
    return;
  }
  entry.typed = null;
  const files = shownFiles(session.link);
  const link = withMissing(session.link);
  const address = `#${shareableLink(link)}`;
  if (files === entry.files) {
    // Files that were open before a reload are still the user's own when they are asked for.
    const own = isPrivate() || awaited()?.isOwn === true;
    history.replaceState({ gaitway: entry.number, own }, "", address);
  } else {
    lastNumber += 1;
    [entry.number, entry.files] = [lastNumber, files];
    history.pushState({ gaitway: entry.number, own: isPrivate() }, "", address);
  }
  remember(link);
}

/** The link of the current entry if files are asked for that it needs, with the names of those that have arrived. */
function askingLink() {
  const asking = awaited();
  return asking !== null && asking.missing.length > 0 && shownFiles(session.link) === entry.files ? asking.link : null;
}

/**
 * Returns a link of the current view with the files that its entry asks for.
 * @param {string} link
 */
export function withMissing(link) {
  const asking = askingLink();
  return asking === null ? link : linkWithMissing(link, asking);
}

/** Keeps the address as it is until something is set. */
export function keepTypedAddress() {
  [entry.files, entry.typed] = [shownFiles(session.link), session.link];
}

/** Does the same, unless a typed address is kept already. */
export function keepTypedAddressOnce() {
  if (entry.files === null) keepTypedAddress();
}

/**
 * Makes the current entry show these files.
 * @param {string} link
 */
export function showInEntry(link) {
  [entry.files, entry.typed] = [shownFiles(link), null];
}

/** @param {string} link */
function remember(link) {
  visits.delete(entry.number);
  const { items, motionItems } = heldFor(link);
  if (items.length + motionItems.length === 0) return;
  // A typed address has no number yet.
  if (history.state?.gaitway !== entry.number) history.replaceState({ ...history.state, gaitway: entry.number }, "");
  visits.set(entry.number, { link, items, motionItems });
  const [oldest] = visits.keys();
  if (visits.size > MAX_VISITS) visits.delete(oldest);
}

/**
 * Moves to the entry that the browser shows now and returns what it showed, if it had local files.
 * @param {EntryState} state
 */
export function moveToEntry(state) {
  // The entry's link lags behind the latest changes.
  const left = visits.get(entry.number);
  if (followingCount === 0 && left !== undefined) left.link = withMissing(session.link);
  if (state?.gaitway === undefined) {
    lastNumber += 1;
    entry.number = lastNumber;
    history.replaceState({ gaitway: entry.number }, "");
  } else {
    entry.number = state.gaitway;
    lastNumber = Math.max(lastNumber, entry.number);
  }
  return visits.get(entry.number);
}
