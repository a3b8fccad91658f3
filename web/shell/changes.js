// Propagates changes of the view to screen readers, the title, the gallery, the address bar and scripts.
import { byId } from "./dom.js";
import { markCard } from "./gallery.js";
import { localFiles } from "./held.js";
import { keepTypedAddressOnce, recordView } from "./history.js";
import { say, sayNews, sayProblem } from "./panels.js";
import { session } from "./session.js";

const SUMMARY_DELAY_MS = 250;

/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

/**
 * The error that the app shows, as announced last.
 * @type {string | null}
 */
let announced = null;

/**
 * The app's notice, as announced last.
 * @type {string | null}
 */
let announcedNotice = null;

/**
 * Takes over the app's new link.
 * @param {string} link
 */
export function viewChanged(link) {
  session.link = link;
  keepTypedAddressOnce();
  summarizeSoon();
  // After the frame, so that listeners may ask for the state.
  setTimeout(() => dispatchEvent(new CustomEvent("gaitway:change")));
}

export function summarizeSoon() {
  cancelSummary();
  timer = setTimeout(summarize, SUMMARY_DELAY_MS);
}

export function cancelSummary() {
  clearTimeout(timer);
}

/** Clears the last error once something has been opened. */
export function forgetProblem() {
  announced = null;
  sayProblem("");
}

/**
 * Announces the current view and writes it to the address bar. Returns the model's name and the app's notice.
 * @returns {{ model: string, notice: string | null }}
 */
export function summarize() {
  if (session.app === null) return { model: "", notice: null };
  /** @type {{ model: string, clip: string | null, playing: boolean, isEmbedded: boolean, notice: string | null, problem: string | null }} */
  const { model, clip, playing, isEmbedded, notice, problem } = JSON.parse(session.app.summary());
  byId("stage").classList.toggle("embedded", isEmbedded);
  say(`${model}: ${clip ?? "rest pose"}, ${clip !== null && playing ? "playing" : "paused"}`);
  // What is gone from the screen is no longer announced; errors that the page itself found stay.
  if (problem !== announced) sayProblem(problem ?? "");
  announced = problem;
  if (notice !== null && notice !== announcedNotice) sayNews(notice);
  announcedNotice = notice;
  session.isLocal = localFiles(session.link).length > 0;
  markCard(session.link, session.isLocal);
  document.title = model === "" ? "Gaitway" : `${model} – Gaitway`;
  recordView();
  return { model, notice };
}

addEventListener("pagehide", cancelSummary);
