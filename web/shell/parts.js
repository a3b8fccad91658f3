// Parts of Gaitway that few visits need. Most are WebAssembly modules that convert something into plain glTF (parts/ in
// the sources): the program downloads one when a file needs it; here it runs, in a worker that ends with the
// conversion. The others are scripts that encode videos (recording.js), validate glTF files
// (validation.js) and save pages (web-page.js), and the templates of those pages.
import { keepOffline } from "./offline.js";

const meta = /** @type {HTMLMetaElement | null} */ (document.querySelector('meta[name="gaitway-parts"]'));
/**
 * URLs relative to the page, by name.
 * @type {Record<string, string | undefined>}
 */
const files = JSON.parse(meta?.content ?? "{}");

const MAX_SECS = 60;
/** A part's URL ends with the beginning of its SHA-256 and the extension. */
const HASHED = /-([0-9a-f]+)\.\w+$/;
/** The first byte of an answer other than an error. */
const CONVERTED = 1;
/** That byte and the length of the warnings. */
const HEADER_BYTES = 5;

/**
 * The whole script of a worker, so it uses nothing from outside. See parts/part/src/lib.rs for the module's exports.
 * @param {MessageEvent<{ module: BufferSource, input: Uint8Array }>} event
 */
async function work({ data: { module, input } }) {
  const { instance } = await WebAssembly.instantiate(module);
  const { memory, input: place, run, output, output_length: length } = /** @type {any} */ (instance.exports);
  // Allocate first: growing the memory replaces its buffer.
  const start = place(input.length);
  new Uint8Array(memory.buffer, start, input.length).set(input);
  const answer = () => new Uint8Array(memory.buffer, output(), length()).slice();
  try {
    run();
  } catch (trap) {
    const reason = new TextDecoder().decode(answer());
    throw reason === "" ? trap : new Error(reason);
  }
  postMessage(answer());
}

/** The error's name if a part isn't the one that the page was built with; then nothing is wrong with the file. */
const CHANGED = "ChangedPart";

/**
 * Throws if a part isn't the one that the page was built with: cut short, changed on its way, or damaged in a cache.
 * @param {string} file
 * @param {Uint8Array<ArrayBuffer>} content
 */
async function check(file, content) {
  const expected = HASHED.exec(file)?.[1];
  // Browsers compute no hashes for pages without HTTPS.
  if (expected === undefined || crypto.subtle === undefined) return;
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", content));
  const found = Array.from(digest, (byte) => byte.toString(16).padStart(2, "0")).join("").slice(0, expected.length);
  if (found === expected) return;
  const hint = "reload the page, and if that doesn't help, clear this site's data in the browser first";
  const error = new Error(`expected a download whose SHA-256 begins with ${expected}, found ${found}; ${hint}`);
  error.name = CHANGED;
  throw error;
}

/**
 * @param {string} name
 * @param {AbortSignal} [signal]
 */
async function fetched(name, signal) {
  const response = await fetch(new URL(files[name] ?? name, document.baseURI), { signal });
  if (!response.ok) throw new Error(`${response.url}: the server answered ${response.status}`);
  return new Uint8Array(await response.arrayBuffer());
}

/**
 * Keeps a part that was downloaded, unless it is damaged.
 * @param {string} name
 * @param {Uint8Array<ArrayBuffer>} content
 */
async function accept(name, content) {
  const file = files[name];
  if (file === undefined) return;
  await check(file, content);
  keepOffline([file]);
}

/**
 * Downloads a part, for as long as one may run.
 * @param {string} name
 */
export async function download(name) {
  const content = await fetched(name, AbortSignal.timeout(1000 * MAX_SECS));
  await accept(name, content);
  return content;
}

/**
 * Number of failed attempts to load a script.
 * @type {Record<string, number>}
 */
const failures = {};

/**
 * Downloads a part that is a script, and returns its module.
 * @param {string} name
 */
export async function importScript(name) {
  const file = files[name];
  if (file === undefined) throw new Error("this page was built without it");
  // Some browsers remember that a module couldn't be loaded, so another try needs another address.
  const { href } = new URL(name in failures ? `${file}?${failures[name]}` : file, document.baseURI);
  try {
    const module = await import(href);
    keepOffline([file]);
    return module;
  } catch (error) {
    failures[name] = (failures[name] ?? 0) + 1;
    throw error;
  }
}

/**
 * Runs a script in a worker that ends with its answer. Rejects if it fails or takes too long.
 * @param {BlobPart} script
 * @param {unknown} input
 * @param {Transferable[]} transfer
 * @param {(request: string) => unknown} [reply] Answers what the worker asks for as `{ ask }`.
 */
export async function inWorker(script, input, transfer, reply) {
  // A sandboxed frame may start a worker from a blob, but not from a file.
  const url = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
  const worker = new Worker(url);
  let timer = 0;
  try {
    return await new Promise((resolve, reject) => {
      timer = window.setTimeout(() => reject(new Error(`it took longer than ${MAX_SECS} seconds`)), 1000 * MAX_SECS);
      worker.onmessage = ({ data }) => (data.ask === undefined ? resolve(data) : worker.postMessage(reply?.(data.ask)));
      worker.onerror = (event) => {
        event.preventDefault();
        reject(new Error(event.message.replace(/^Uncaught (Error: )?/, "")));
      };
      worker.postMessage(input, transfer);
    });
  } finally {
    clearTimeout(timer);
    worker.terminate();
    URL.revokeObjectURL(url);
  }
}

export const parts = {
  /** @param {string} name */
  url: (name) => files[name],

  /**
   * Downloads a part, runs it and returns the data of its answer. Otherwise rejects with the part's message.
   * @param {string} name
   * @param {Uint8Array<ArrayBuffer>} input
   */
  async convert(name, input) {
    const answer = await parts.answer(name, input);
    if (answer[0] !== CONVERTED) throw new Error(new TextDecoder().decode(answer.subarray(1)));
    const warnings = new DataView(answer.buffer, answer.byteOffset).getUint32(1, true);
    return answer.subarray(HEADER_BYTES + warnings);
  },

  /**
   * Downloads a part, runs it and returns its encoded answer, with warnings.
   * @param {string} name
   * @param {Uint8Array<ArrayBuffer>} input
   */
  async answer(name, input) {
    if (files[name] === undefined) throw new Error("this page was built without it");
    return await parts.run(name, await fetched(name), input);
  },

  /**
   * Returns the module's answer, encoded as in parts/part/src/lib.rs. Rejects if the module is damaged, traps or takes
   * too long.
   * @param {string} name
   * @param {Uint8Array<ArrayBuffer>} module
   * @param {Uint8Array<ArrayBuffer>} input
   * @returns {Promise<Uint8Array>}
   */
  async run(name, module, input) {
    await accept(name, module);
    // An error inside the promise doesn't reach `onerror` by itself.
    const script = `onmessage = (event) => (${work})(event).catch((error) => setTimeout(() => { throw error; }));`;
    return await inWorker(script, { module, input }, [module.buffer, input.buffer]);
  },
};
