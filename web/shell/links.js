// The text form of links. Only the program reads it (src/state/link); no script splits a link. still.js, which runs
// before the program is there, only searches one.

/** @typedef {import("./types.d.ts").Bindings} Bindings */
/** @typedef {import("./types.d.ts").LinkedFile} LinkedFile */

/** @type {Bindings | null} */
let program = null;

/**
 * Reads links with this instance from now on.
 * @param {Bindings} bindings
 */
export function readLinksWith(bindings) {
  program = bindings;
}

function loaded() {
  if (program === null) throw new Error("a link was read before the program was loaded");
  return program;
}

/**
 * Returns the files that a link names.
 * @param {string} link
 * @returns {LinkedFile[]}
 */
export const linkedFiles = (link) => JSON.parse(loaded().linked_files(link));

/**
 * Returns the same text for any two links that show the same files.
 * @param {string} link
 */
export const shownFiles = (link) => loaded().shown_files(link);

/**
 * Returns the link to hand to others, who have to bring the local files along.
 * @param {string} link
 * @param {string[]} local Names of local files.
 */
export const publicLink = (link, local) => loaded().public_link(link, local);

/**
 * Returns a link for a page embedded in another one.
 * @param {string} link
 */
export const embeddedLink = (link) => loaded().embedded_link(link);

/**
 * Returns the part of a link that can be shown before its missing files arrive.
 * @param {string} link
 */
export const linkWithoutMissing = (link) => loaded().link_without_missing(link);

/**
 * Returns a link with the missing files of the one that asks for them, if it shows what could be shown of that one.
 * @param {string} link
 * @param {string} asking
 */
export const linkWithMissing = (link, asking) => loaded().link_with_missing(link, asking);

/**
 * Returns a link with its missing files under the names they arrived with.
 * @param {string} link
 * @param {string[]} names In the order of the link.
 */
export const linkWithFiles = (link, names) => loaded().link_with_files(link, names);

/**
 * Returns the index of the link that shows the same files in the most similar view, if any.
 * @param {string} link
 * @param {string[]} others
 */
export const mostSimilarLink = (link, others) => loaded().most_similar_link(link, others);
