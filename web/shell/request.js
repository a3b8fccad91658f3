// Requests the program of a back end. A script in the page's head (start.js) does so before the shell has arrived.

/** @typedef {import("./types.d.ts").Backend} Backend */
/** @typedef {import("./types.d.ts").ProgramRequest} ProgramRequest */

const meta = /** @type {HTMLMetaElement} */ (document.querySelector('meta[name="gaitway-programs"]'));
/**
 * The build records the length, because the header may give the compressed one. A page that was saved with a scene has one of them.
 * @type {Record<Backend, { script: string, wasm: string, bytes: number }>}
 */
export const programs = JSON.parse(meta.content);

/**
 * @param {Backend} backend
 * @returns {ProgramRequest}
 */
export function request(backend) {
  const controller = new AbortController();
  const response = fetch(new URL(programs[backend].wasm, document.baseURI), { signal: controller.signal });
  // Avoids an unhandled rejection if nobody waits for it.
  response.catch(() => {});
  return { backend, response, abort: () => controller.abort() };
}
