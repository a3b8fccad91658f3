// Links that name local files: the page asks for them and meanwhile shows what it can.
import { button, dialog, showList } from "./dom.js";
import { companionWords } from "./held.js";
import { linkedFiles } from "./links.js";
import { panel } from "./panels.js";

/** @typedef {import("./types.d.ts").Item} Item */
/** @typedef {import("./types.d.ts").LinkedFile} LinkedFile */

/**
 * A link whose files are waited for, those that are missing still, and the sets that arrived meanwhile.
 * @typedef {{ link: string, wanted: LinkedFile[], missing: LinkedFile[], sets: Item[][] }} Awaited
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
  const wanted = linkedFiles(link).filter(({ isToBring }) => isToBring);
  current = wanted.length > 0 ? { link, wanted, missing: wanted, sets: [] } : null;
}

/** Asks for the files that are missing. */
export function showAwaited() {
  if (current === null || panel() !== null || dialog("bring").open) return;
  dialog("bring").returnValue = "";
  const lines = current.missing.map(({ role, name }) => {
    const companions = companionWords(name);
    return `${name} (${role})${companions === undefined ? "" : `, with ${companions}`}`;
  });
  showList("bring-files", lines);
  dialog("bring").showModal();
  button("bring-choose").focus();
}
