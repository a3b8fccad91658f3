// Files in the text of a page: packed, in base64, in elements that browsers don't run. xtask/site/standalone.mjs, web/web-page.js and
// src/files/web_page.rs write them.
import { unpackLzma } from "./lzma.js";

/** @typedef {{ name: string, role: string, bytes: Uint8Array<ArrayBuffer> }} Block */

/** @type {Record<string, (packed: Uint8Array<ArrayBuffer>) => Uint8Array<ArrayBuffer> | Promise<Uint8Array<ArrayBuffer>>>} */
const UNPACK = { lzma: unpackLzma, deflate: inflated };

/** @param {Uint8Array<ArrayBuffer>} packed */
async function inflated(packed) {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * Takes the files out of the page.
 * @returns {Promise<Block[]>}
 */
export async function takeBlocks() {
  const elements = /** @type {NodeListOf<HTMLScriptElement>} */ (document.querySelectorAll("script[data-role]"));
  return await Promise.all(
    Array.from(elements, async (element) => {
      const { name = "", role = "", coding = "" } = element.dataset;
      const packed = Uint8Array.from(atob(element.text), (letter) => letter.charCodeAt(0));
      element.remove();
      return { name, role, bytes: await UNPACK[coding](packed) };
    }),
  );
}
