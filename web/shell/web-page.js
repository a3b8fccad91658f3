// Saves a self-contained page that shows a scene. What does so is downloaded when it is needed first (web/web-page.js).
import { refuse } from "./changes.js";
import { messageOf } from "./dom.js";
import { download, importScript } from "./parts.js";
import { download as save } from "./recording.js";

/**
 * @param {import("./types.d.ts").PageScene} scene
 * @param {import("./types.d.ts").Bindings} bindings
 */
export async function savePage(scene, bindings) {
  try {
    /** @type {typeof import("../web-page.js")} */
    const part = await importScript("web-page");
    const template = async (/** @type {string} */ backend) => new TextDecoder().decode(await download(`standalone-${backend}`));
    await part.showDialog(scene, { template, screenshot: () => bindings.screenshot(), save, notify: (text) => bindings.notify(text) });
  } catch (error) {
    refuse(new Error(`Couldn't save a web page: ${messageOf(error)}`, { cause: error }));
  }
}
