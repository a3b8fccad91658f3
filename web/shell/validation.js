// Runs the Khronos glTF validator (web/validator), a part that is downloaded when the first file is validated.
import { messageOf } from "./dom.js";
import { download, inWorker } from "./parts.js";

/**
 * Validates a glTF file. Resolves to the report as JSON text.
 * @param {(uri?: string) => Uint8Array<ArrayBuffer>} readFile Returns the file, or the one to which it refers by a URI;
 *   throws if there is none.
 * @returns {Promise<string>}
 */
export async function validate(readFile) {
  /** @type {Uint8Array<ArrayBuffer>} */
  let script;
  try {
    script = await download("validator");
  } catch (error) {
    throw new Error(`it can't be loaded. Check the connection and try again. (${messageOf(error)})`, { cause: error });
  }
  const file = readFile();
  const reply = (/** @type {string} */ uri) => {
    try {
      return readFile(uri);
    } catch {
      return undefined;
    }
  };
  return await inWorker(script, file, [file.buffer], reply);
}
