// Propagates changes of the view to screen readers, the title, the gallery, the session and scripts, and tells the user what the
// session says.
import { byId, focusCanvas, frames, messageOf } from "./dom.js";
import { isEnclosed } from "./enclosed.js";
import { hideGallery, markCard } from "./gallery.js";
import { say, sayNews, sayProblem } from "./panels.js";
import { program } from "./running.js";
import { facts, performs, send } from "./session.js";

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
  send({ event: "changed", link });
  // In a task of its own, so that listeners may ask for the state.
  setTimeout(() => dispatchEvent(new CustomEvent("gaitway:change")));
}

/**
 * Announces the current view. Returns the model's name and the app's notice.
 * @returns {{ model: string, notice: string | null }}
 */
export function summarize() {
  if (program.app === null) return { model: "", notice: null };
  /** @type {{ model: string, clip: string | null, playing: boolean, isEmbedded: boolean, notice: string | null, problem: string | null }} */
  const { model, clip, playing, isEmbedded, notice, problem } = JSON.parse(program.app.summary());
  byId("stage").classList.toggle("embedded", isEmbedded);
  say(`${model}: ${clip ?? "rest pose"}, ${clip !== null && playing ? "playing" : "paused"}`);
  // What is gone from the screen is no longer announced; errors that the page itself found stay.
  if (problem !== announced) sayProblem(problem ?? "");
  announced = problem;
  if (notice !== null && notice !== announcedNotice) sayNews(notice);
  announcedNotice = notice;
  markCard(facts().link, facts().isLocal);
  // A saved page has a title of its own.
  if (!isEnclosed()) document.title = model === "" ? "Gaitway" : `${model} – Gaitway`;
  return { model, notice };
}

/**
 * Shows an error about something that never reached the app.
 * @param {unknown} error
 */
export function refuse(error) {
  sayProblem(messageOf(error));
  program.app?.refuse(messageOf(error));
}

performs({
  settleSoon() {
    clearTimeout(timer);
    timer = setTimeout(() => {
      summarize();
      send({ event: "settled" });
    }, SUMMARY_DELAY_MS);
  },
  async notify({ text }) {
    const { app } = program;
    // After what the app is about to say itself.
    await frames(2);
    if (program.app === app) app?.notify(text);
  },
  async sayProblem({ message }) {
    // The app learns of it in its next frame and may announce an older error first.
    await frames(2);
    sayProblem(message);
  },
  refuse: ({ message }) => refuse(message),
  forgetProblem() {
    announced = null;
    sayProblem("");
  },
  hideGallery,
  focus() {
    // A dialog has given the focus back to the control that opened it, if that is still there.
    if (!byId("stage").contains(document.activeElement)) focusCanvas();
  },
});

addEventListener("pagehide", () => clearTimeout(timer));
