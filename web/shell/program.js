// Downloads and compiles the program, and loads its bindings.
import { TRY_BROWSER } from "./capabilities.js";
import { messageOf } from "./dom.js";
import { showCannotRun, showProgress } from "./panels.js";

/** @typedef {import("./types.d.ts").Bindings} Bindings */

const meta = /** @type {HTMLMetaElement} */ (document.querySelector('meta[name="gaitway-module"]'));
const moduleUrl = new URL(meta.content, document.baseURI).href;
const wasmUrl = new URL(/** @type {string} */ (meta.dataset.wasm), document.baseURI).href;

/**
 * Compiled once for all instances.
 * @type {WebAssembly.Module | null}
 */
let compiled = null;
let instanceCount = 0;

/**
 * Returns the bindings of a fresh instance.
 * @returns {Promise<Bindings>}
 */
export async function loadProgram() {
  try {
    compiled ??= await compile();
    instanceCount += 1;
    // A URL of its own makes an instance of its own.
    const bindings = await import(instanceCount === 1 ? moduleUrl : `${moduleUrl}?instance=${instanceCount}`);
    await bindings.default({ module_or_path: compiled });
    return bindings;
  } catch (error) {
    showCannotRun([`The program couldn't be loaded: ${messageOf(error)}`], ["Check the connection and reload the page.", TRY_BROWSER]);
    throw error;
  }
}

/** Compiles the program while it downloads, and shows how far it has got. */
async function compile() {
  const response = await fetch(wasmUrl);
  if (!response.ok || response.body === null) throw new Error(`${wasmUrl}: the server answered ${response.status}`);
  // The header may give the compressed length; the build records the other.
  const total = Number(meta.dataset.bytes ?? response.headers.get("content-length") ?? 0);
  let received = 0;
  /** @type {TransformStream<Uint8Array<ArrayBuffer>, Uint8Array<ArrayBuffer>>} */
  const counter = new TransformStream({
    transform(chunk, controller) {
      received += chunk.byteLength;
      showProgress("Loading Gaitway", received, total);
      controller.enqueue(chunk);
    },
  });
  const headers = { "content-type": "application/wasm" };
  return await WebAssembly.compileStreaming(new Response(response.body.pipeThrough(counter), { headers }));
}
