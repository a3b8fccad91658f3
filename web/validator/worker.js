// Validates a glTF file in a worker: a part of the page that is downloaded when the first file is validated. See
// web/shell/validation.js for its messages.
//! Contains the Khronos glTF Validator (Apache-2.0), unmodified; its source code: https://github.com/KhronosGroup/glTF-Validator
import { validate } from "./report.js";

/**
 * Resolvers of the requested files, in the order of the requests.
 * @type {((file: Uint8Array | undefined) => void)[]}
 */
const waiting = [];

onmessage = ({ data }) => {
  const take = waiting.shift();
  if (take !== undefined) return take(data);
  validate(data, read).then(
    (report) => postMessage(JSON.stringify(report)),
    // An error inside a promise doesn't reach the page by itself. The validator rejects with texts.
    (error) => setTimeout(() => {
      throw error instanceof Error ? error : new Error(error);
    }),
  );
};

/** @param {string} uri */
async function read(uri) {
  postMessage({ ask: uri });
  const file = await new Promise((/** @type {typeof waiting[0]} */ resolve) => waiting.push(resolve));
  if (file === undefined) throw new Error("not among the files that were opened");
  return file;
}
