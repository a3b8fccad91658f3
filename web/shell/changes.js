// What follows a change of the view: screen readers, the title, the gallery, the address bar and scripts hear of it.
import { markCard } from "./gallery.js";
import { localFiles } from "./held.js";
import { keepTypedAddressOnce, recordView } from "./history.js";
import { say, sayProblem } from "./panels.js";
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

/** Announces the current view and writes it to the address bar. */
export function summarize() {
  if (session.app === null) return;
  /** @type {{ model: string, clip: string | null, playing: boolean, problem: string | null }} */
  const { model, clip, playing, problem } = JSON.parse(session.app.summary());
  say(`${model}: ${clip ?? "rest pose"}, ${clip !== null && playing ? "playing" : "paused"}`);
  if (problem !== null && problem !== announced) sayProblem(problem);
  announced = problem;
  session.isLocal = localFiles(session.link).length > 0;
  markCard(session.link, session.isLocal);
  document.title = model === "" ? "Gaitway" : `${model.split("/").pop()} – Gaitway`;
  recordView();
}

addEventListener("pagehide", cancelSummary);
