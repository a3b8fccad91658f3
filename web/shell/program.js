// Downloads and compiles the program, and loads its bindings. There is one program per back end; the second is
// downloaded only if the first can't be used.
import { BACKENDS, likelyBackend } from "./capabilities.js";
import { LOADING_PROGRAM, showProgress } from "./panels.js";
import { programs, request } from "./request.js";

/** @typedef {import("./types.d.ts").Backend} Backend */
/** @typedef {import("./types.d.ts").Bindings} Bindings */

/** Models start to download at this share of the program: browsers read a program only as fast as they compile it. */
const MODELS_START = 0.4;

/** @typedef {{ compiled: Promise<WebAssembly.Module>, abort: () => void }} Download */

/**
 * Each is compiled once for all instances.
 * @type {Partial<Record<Backend, Download>>}
 */
const downloads = {};
let instanceCount = 0;

/** The back ends to try, in this order. Asks for an adapter, because a browser may have WebGPU and none. */
export async function backendsToTry() {
  const adapter = await navigator.gpu?.requestAdapter().catch(() => null);
  if (adapter || !BACKENDS.includes("webgl2")) return BACKENDS;
  downloads.webgpu?.abort();
  delete downloads.webgpu;
  return /** @type {Backend[]} */ (["webgl2"]);
}

/**
 * The files of a program, relative to the page.
 * @param {Backend} backend
 */
export const programFiles = (backend) => [programs[backend].script, programs[backend].wasm];

/**
 * Returns the bindings of a fresh instance.
 * @param {Backend} backend
 * @returns {Promise<Bindings>}
 */
export async function loadProgram(backend) {
  try {
    const script = new URL(programs[backend].script, document.baseURI).href;
    const { compiled } = download(backend);
    instanceCount += 1;
    // A URL of its own makes an instance of its own. Those of blobs have no query.
    const other = `${script}${script.startsWith("blob:") ? "#" : "?"}instance=${instanceCount}`;
    const [{ default: instantiate, ...bindings }, module] = await Promise.all([import(instanceCount === 1 ? script : other), compiled]);
    await instantiate({ module_or_path: module });
    return reportingTraps(bindings);
  } catch (error) {
    // The next attempt downloads it again.
    delete downloads[backend];
    throw error;
  }
}

/**
 * Errors inside the program trap, and end it. Callers catch errors for other reasons, so traps are reported to the window as well.
 * @param {Bindings} bindings
 * @returns {Bindings}
 */
function reportingTraps(bindings) {
  /** @type {(call: (...given: any[]) => unknown) => (...given: any[]) => unknown} */
  const reporting = (call) => (...given) => {
    try {
      return call(...given);
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError) reportError(error);
      throw error;
    }
  };
  return /** @type {any} */ (Object.fromEntries(Object.entries(bindings).map(([name, call]) => [name, reporting(call)])));
}

/**
 * Starts to download a program, unless already started.
 * @param {Backend} backend
 */
function download(backend) {
  const started = downloads[backend];
  if (started !== undefined) return started;
  const early = window.earlyRequest;
  delete window.earlyRequest;
  const { response, abort } = early?.backend === backend ? early : request(backend);
  const compiled = compile(response, programs[backend].bytes);
  // Avoids an unhandled rejection if nobody waits for it.
  compiled.catch(() => {});
  return (downloads[backend] = { compiled, abort });
}

/**
 * Compiles the program while it downloads, and shows the progress.
 * @param {Promise<Response>} requested The server's answer.
 * @param {number} bytes Its length.
 */
async function compile(requested, bytes) {
  const response = await requested;
  if (!response.ok || response.body === null) throw new Error(`${response.url}: the server answered ${response.status}`);
  let received = 0;
  /** @type {TransformStream<Uint8Array<ArrayBuffer>, Uint8Array<ArrayBuffer>>} */
  const counter = new TransformStream({
    transform(chunk, controller) {
      if (received < MODELS_START * bytes && received + chunk.byteLength >= MODELS_START * bytes) dispatchEvent(new CustomEvent("gaitway:part-loaded"));
      received += chunk.byteLength;
      showProgress(LOADING_PROGRAM, received, bytes);
      controller.enqueue(chunk);
    },
  });
  const headers = { "content-type": "application/wasm" };
  return await WebAssembly.compileStreaming(new Response(response.body.pipeThrough(counter), { headers }));
}

// The likely one, before anything else; usually the page's head has requested it already.
if (typeof WebAssembly === "object") download(likelyBackend());
