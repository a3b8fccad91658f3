// What this browser can do, and what to try if it cannot do enough.
import { programs } from "./request.js";

/** @typedef {import("./types.d.ts").Backend} Backend */

/** @type {Record<Backend, string>} */
export const BACKEND_NAMES = { webgpu: "WebGPU", webgl2: "WebGL2" };

export const TRY_BROWSER = "Open this page in a current version of Chrome, Edge, Firefox or Safari.";
export const TRY_DOWNLOAD = ["Check the connection and reload the page.", TRY_BROWSER];
export const TRY_GRAPHICS = [
  "Turn on graphics (hardware) acceleration in the browser's settings, then restart the browser.",
  "Update the graphics driver.",
  TRY_BROWSER,
];

/** A module with one vector instruction. */
const SIMD = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11);

/** The back ends that the page has a program for. */
export const BACKENDS = /** @type {Backend[]} */ (["webgpu", "webgl2"]).filter((backend) => backend in programs);

/** @param {Backend} backend */
export function hasBackend(backend) {
  if (!BACKENDS.includes(backend)) return false;
  if (backend === "webgpu") return navigator.gpu !== undefined;
  return document.createElement("canvas").getContext("webgl2") !== null;
}

/** @param {Backend} backend */
export const otherBackend = (backend) => (backend === "webgpu" ? "webgl2" : "webgpu");

/**
 * The back end that the address forces, or null.
 * @returns {Backend | null}
 */
export function forcedBackend() {
  const wanted = new URLSearchParams(location.search).get("renderer");
  return BACKENDS.find((backend) => backend === wanted) ?? null;
}

/** The back end to try first, as far as can be told without asking for an adapter. */
export const likelyBackend = () => forcedBackend() ?? BACKENDS.find(hasBackend) ?? BACKENDS[0];

/**
 * Returns what this browser lacks and what to try, in sentences; null if it has everything.
 * @returns {{ code: "unsupported" | "no-graphics", missing: string[], attempts: string[] } | null}
 */
export function missingCapabilities() {
  const wasm = missingWasm();
  const without = BACKENDS.length === 1 ? `${BACKEND_NAMES[BACKENDS[0]]} isn't` : "neither WebGPU nor WebGL2 is";
  const graphics = BACKENDS.some(hasBackend) ? [] : [`Graphics: ${without} available.`];
  const missing = [...wasm, ...graphics];
  if (missing.length === 0) return null;
  return wasm.length > 0 ? { code: "unsupported", missing, attempts: [TRY_BROWSER] } : { code: "no-graphics", missing, attempts: TRY_GRAPHICS };
}

function missingWasm() {
  if (typeof WebAssembly !== "object") return ["WebAssembly is turned off or missing in this browser."];
  if (!WebAssembly.validate(SIMD)) return ["This browser's WebAssembly lacks vector instructions (SIMD)."];
  return [];
}
