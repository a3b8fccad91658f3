// Links that name local files: the page asks for them and meanwhile shows what it can. It also accepts a copy of a
// model that couldn't be loaded, without asking for it.
import { button, byId, dialog, showList } from "./dom.js";
import { companionWords } from "./held.js";
import { linkedFiles, publicLink } from "./links.js";
import { panel } from "./panels.js";

/** @typedef {import("./types.d.ts").Item} Item */
/** @typedef {import("./types.d.ts").LinkedFile} LinkedFile */

/**
 * A link that waits for files.
 * @typedef {object} Awaited
 * @property {string} link As given.
 * @property {string} marked The link with all of `wanted` marked as local files.
 * @property {LinkedFile[]} wanted The files that it waits for.
 * @property {LinkedFile[]} missing Those that the page asks for.
 * @property {Item[][]} sets The sets of files that have arrived meanwhile.
 * @property {boolean} [isPassedOver] Something else was opened instead.
 */

/** @type {Awaited | null} */
let current = null;

export const awaited = () => current;

/** Stops waiting. */
export function forgetAwaited() {
  current = null;
}

/**
 * Waits for the files that a link asks for, if it does.
 * @param {string} link
 */
export function awaitFiles(link) {
  dialog("bring").close();
  const wanted = filesToBring(link);
  current = wanted.length > 0 ? { link, marked: link, wanted, missing: wanted, sets: [] } : null;
}

/**
 * Also waits for copies of a link's files that couldn't be loaded.
 * @param {string} link
 * @param {string[]} names
 */
export function awaitCopies(link, names) {
  const marked = publicLink(link, names);
  current = { link, marked, wanted: filesToBring(marked), missing: current?.missing ?? [], sets: [] };
}

/** @param {string} link */
const filesToBring = (link) => linkedFiles(link).filter(({ isToBring }) => isToBring);

/**
 * Asks for the files that are missing.
 * @param {string} [others] Names of files that were brought instead.
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
  byId("bring-others").textContent = `Brought instead: ${others}.`;
  // They were open in this entry of the history before the page was reloaded.
  const isOwn = history.state?.own === true;
  byId("bring-again").hidden = !isOwn;
  byId("bring-sender").hidden = isOwn;
  dialog("bring").showModal();
  button("bring-choose").focus();
}
