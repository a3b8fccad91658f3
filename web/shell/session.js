// What outlives an instance of the program: the link of the current view, and the instance that runs now.
import { messageOf } from "./dom.js";
import { coded } from "./errors.js";
import { sayProblem } from "./panels.js";

/** @typedef {import("./types.d.ts").Bindings} Bindings */

/** The first scene of the gallery; empty in a build without samples. */
const FIRST_LINK = /** @type {HTMLAnchorElement | null} */ (document.querySelector("#gallery-scenes a"))?.hash.slice(1) ?? "";

/** The link in the address bar, or that of the first screen. */
export const linkOfAddress = () => location.hash.slice(1) || FIRST_LINK;

export const session = {
  /** The current view, which a new instance shows again. */
  link: linkOfAddress(),
  /** Whether the current view shows local files. */
  isLocal: false,
  /**
   * Bindings of the running instance; null while none runs.
   * @type {Bindings | null}
   */
  app: null,
  /**
   * Resolves once the first image is on screen. Each start replaces it.
   * @type {Promise<void>}
   */
  started: Promise.resolve(),
  /**
   * Resolves once the first model has its images, which may arrive after the first image is on screen, or to why it hasn't
   * got them. Each start replaces it.
   * @type {Promise<string>}
   */
  completed: Promise.resolve(""),
  /** Why the last instance stopped. */
  stopReason: /** @type {string | null} */ (null),
  /**
   * Ends the running instance and starts another one; set by instance.js, which depends on the modules that call it.
   */
  restart: () => {},
  /**
   * The entry of the history that was gone to while no instance could show it.
   * @type {{ link: string, visit: import("./history.js").Visit | undefined, wasPrivate: boolean } | null}
   */
  asked: null,
};

/** Whether an instance runs that shows no model. */
export const isStageEmpty = () => session.app !== null && JSON.parse(session.app.summary()).isEmpty;

/** Returns the bindings once they run. */
export async function running() {
  await session.started;
  if (session.app === null) throw coded("lost-device", `Gaitway has stopped: ${session.stopReason}`);
  return session.app;
}

/** Resolves once the first image is on screen and its model is complete. */
export const whenComplete = () => session.started.then(() => session.completed).then(() => {});

/**
 * Returns an answer of the running instance, or rejects when the instance stops before it can give one.
 * @template T
 * @param {Bindings} current
 * @param {Promise<T>} answer
 * @returns {Promise<T>}
 */
export async function unlessStopped(current, answer) {
  /** @type {ReturnType<typeof setInterval> | undefined} */
  let timer;
  const stopped = new Promise((_, reject) => {
    const check = () => session.app !== current && reject(coded("lost-device", `Gaitway has stopped: ${session.stopReason ?? "it was restarted"}`));
    timer = setInterval(check, 100);
  });
  try {
    return await Promise.race([answer, /** @type {Promise<never>} */ (stopped)]);
  } finally {
    clearInterval(timer);
  }
}

/**
 * Shows an error about something that never reached the app.
 * @param {unknown} error
 */
export function refuse(error) {
  sayProblem(messageOf(error));
  session.app?.refuse(messageOf(error));
}
