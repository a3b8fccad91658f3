// What came with the page itself: in a page that was saved with a scene (web/standalone), the link that shows it and its files.
// Elsewhere nothing.

/** @typedef {import("./types.d.ts").NamedFile} NamedFile */

/** @type {{ link: string | null, sets: NamedFile[][] }} */
export const enclosed = { link: null, sets: [] };

/** Whether this page was saved with a scene. */
export const isEnclosed = () => enclosed.link !== null;
