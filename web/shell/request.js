// Requests the program of a back end. The page's head does it before the shell has arrived; see start.js.

/** @typedef {import("./types.d.ts").Backend} Backend */

/**
 * A download that may be given up.
 * @typedef {{ response: Promise<Response>, abort: () => void }} Request
 */

const meta = /** @type {HTMLMetaElement} */ (document.querySelector('meta[name="gaitway-programs"]'));
/**
 * The build records the length, because the header may give the compressed one.
 * @type {Record<Backend, { script: string, wasm: string, bytes: number }>}
 */
export const programs = JSON.parse(meta.content);

/**
 * @param {Backend} backend
 * @returns {Request}
 */
export function request(backend) {
  const controller = new AbortController();
  const response = fetch(new URL(programs[backend].wasm, document.baseURI), { signal: controller.signal });
  // Avoids an unhandled rejection if nobody waits for it.
  response.catch(() => {});
  return { response, abort: () => controller.abort() };
}
