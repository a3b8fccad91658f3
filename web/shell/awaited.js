// Links that name local files: the page asks for them and meanwhile shows what it can. It also accepts a copy of a
// model that couldn't be loaded, without asking for it.
import { button, byId, dialog, listOf, showDialog, showList } from "./dom.js";
import { companionWords, fileName } from "./held.js";
import { linkedFiles, publicLink } from "./links.js";
import { panel } from "./panels.js";

/** @typedef {import("./types.d.ts").LinkedFile} LinkedFile */

/**
 * A link that waits for files.
 * @typedef {object} Awaited
 * @property {string} link As given.
 * @property {string} marked The link with all of `wanted` marked as local files, and the names of those that have arrived.
 * @property {LinkedFile[]} wanted The files that it waits for.
 * @property {LinkedFile[]} missing Those that the page asks for.
 * @property {boolean} isOwn The files were open in this entry of the history before the page was reloaded.
 */

/**
 * The link whose files the page asks for.
 * @type {Awaited | null}
 */
let current = null;

/**
 * A link that is no longer asked for, since another model was opened instead. Its files complete it until the next model is opened.
 * @type {Awaited | null}
 */
let passedOver = null;

/** The link whose files the page asks for, if any. */
export const awaited = () => current;

/** The link that files complete, if any. */
export const completable = () => current ?? passedOver;

/** Stops waiting. */
export function forgetAwaited() {
  current = passedOver = null;
}

/** Stops asking, since another model was opened. Returns what to tell the user: it may have been the wrong file. */
export function passOver() {
  // Copies of files that couldn't be loaded are accepted, not asked for.
  [current, passedOver] = [null, current !== null && current.missing.length > 0 ? current : null];
  return passedOver === null ? undefined : needOf(passedOver);
}

/**
 * Tells what a link needs.
 * @param {Awaited} asking
 */
export function needOf({ missing, isOwn }) {
  const names = missing.map(({ name }) => fileName(name));
  const files = names.length === 1 ? "a file with that name" : "files with those names";
  return `This link needs ${listOf(names)}. Open ${files} to see the ${isOwn ? "view as it was" : "shared view"}.`;
}

/**
 * Some of a link's files have arrived, but nothing can be shown before its model: asks for the rest.
 * @param {Awaited} waiting
 * @param {string} marked
 * @param {LinkedFile[]} rest What hasn't arrived.
 */
export function askForRest(waiting, marked, rest) {
  const isLeft = (/** @type {LinkedFile} */ file) => rest.some(({ role, name }) => role === file.role && name === file.name);
  current = { ...waiting, marked, wanted: rest, missing: waiting.missing.filter(isLeft) };
}

/**
 * Waits for the files that a link asks for, if it does.
 * @param {string} link
 * @param {boolean} [isOwn]
 */
export function awaitFiles(link, isOwn = isOwnEntry()) {
  dialog("bring").close("link");
  const wanted = filesToBring(link);
  forgetAwaited();
  if (wanted.length > 0) current = { link, marked: link, wanted, missing: wanted, isOwn };
}

/**
 * Also waits for copies of a link's files that couldn't be loaded.
 * @param {string} link
 * @param {string[]} names
 */
export function awaitCopies(link, names) {
  const marked = publicLink(link, names);
  current = { link, marked, wanted: filesToBring(marked), missing: current?.missing ?? [], isOwn: isOwnEntry() };
}

const isOwnEntry = () => history.state?.own === true;

/** @param {string} link */
const filesToBring = (link) => linkedFiles(link).filter(({ isToBring }) => isToBring);

/**
 * Asks for the files that are missing.
 * @param {string} [others] Names of other files, which couldn't be opened.
 */
export function showAwaited(others) {
  if (current === null || current.missing.length === 0 || panel() !== null || dialog("bring").open) return;
  dialog("bring").returnValue = "";
  const lines = current.missing.map(({ role, name }) => {
    const companions = companionWords(name);
    return `${name} (${role})${companions === undefined ? "" : `, with ${companions}`}`;
  });
  showList("bring-files", lines);
  byId("bring-others").hidden = others === undefined;
  byId("bring-others").textContent = others === undefined ? "" : `${others} couldn't be opened.`;
  byId("bring-again").hidden = !current.isOwn;
  byId("bring-sender").hidden = current.isOwn;
  showDialog("bring", button("bring-choose"));
}
