// What the page itself says: the three panels over the canvas (loading, cannot run, stopped), loading progress, and the
// live regions for screen readers.
import { byId, showList } from "./dom.js";

/** @typedef {"loading" | "cannot-run" | "stopped"} Panel */

/** @type {Panel[]} */
const PANELS = ["loading", "cannot-run", "stopped"];

/** @type {Panel | null} */
let shown = "loading";

/** The panel that covers the canvas, or null. */
export const panel = () => shown;

/**
 * Shows one panel, or none.
 * @param {Panel | null} name
 */
export function showPanel(name) {
  shown = name;
  for (const other of PANELS) byId(other).hidden = other !== name;
  byId("stage").inert = name === "stopped" || name === "cannot-run";
}

/**
 * Tells screen readers what the canvas shows.
 * @param {string} message
 */
export function say(message) {
  // The same text again would be read out again.
  if (byId("live").textContent !== message) byId("live").textContent = message;
}

/**
 * Tells screen readers what was opened.
 * @param {string} message
 */
export function sayNews(message) {
  byId("news").textContent = message;
}

/**
 * Tells screen readers about an error, which the app shows as well, but dimmed while a dialog is open: so that shows it, too.
 * @param {string} message
 */
export function sayProblem(message) {
  byId("problem").textContent = message;
  const line = document.querySelector("dialog[open] .problem");
  if (line !== null) line.textContent = message;
}

for (const line of document.querySelectorAll("dialog .problem")) line.closest("dialog")?.addEventListener("close", () => (line.textContent = ""));

/**
 * What kind of failure the first problem of the link is.
 * @type {import("./types.d.ts").ErrorCode | null}
 */
let linkFailure = null;

/** @param {import("./types.d.ts").ErrorCode | null} code */
export const noteLinkFailure = (code) => void (linkFailure = code);

/**
 * Reports a problem to the page around this one.
 * @param {string} message
 * @param {import("./types.d.ts").ErrorCode | null} [code] That of the link's problems if absent.
 */
export function reportProblem(message, code = linkFailure) {
  dispatchEvent(new CustomEvent("gaitway:problem", { detail: { message, code } }));
}

/** Updating the progress with every chunk of a file would block the page. */
const PROGRESS_INTERVAL_MS = 100;
let progressAt = -Infinity;

/** What is loaded before any file. */
export const LOADING_PROGRAM = "Loading Gaitway";

/**
 * Shows loading progress. A total of 0 means that it is unknown.
 * @param {string} what
 * @param {number} received
 * @param {number} total
 */
export function showProgress(what, received, total) {
  const hasMore = received > 0 && received !== total;
  if (hasMore && performance.now() < progressAt + PROGRESS_INTERVAL_MS) return;
  progressAt = performance.now();
  const isKnown = total > 0;
  dispatchEvent(new CustomEvent("gaitway:progress", { detail: { what, share: isKnown ? Math.min(1, received / total) : 0 } }));
  const bar = byId("loading-progress", HTMLProgressElement);
  if (isKnown) bar.value = Math.min(1, received / total);
  else bar.removeAttribute("value");
  const amount = `${(received / 1e6).toFixed(1)}${isKnown ? ` of ${(total / 1e6).toFixed(1)}` : ""} MB`;
  byId("loading-what").textContent = received > 0 ? `${what}: ${amount}` : `${what}…`;
}

/**
 * Shows why Gaitway cannot run here, in sentences.
 * @param {string[]} missing
 * @param {string[]} attempts What to try.
 */
export function showCannotRun(missing, attempts) {
  showList("cannot-run-missing", missing);
  showList("cannot-run-try", attempts);
  showPanel("cannot-run");
}
