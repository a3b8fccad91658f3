// The instance of the program that runs now, for the modules that ask it.
import { coded } from "./errors.js";

/** @typedef {import("./types.d.ts").Bindings} Bindings */

export const program = {
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
};

/** Why no instance runs. */
let reason = coded("lost-device", "Gaitway has not started yet");

/**
 * Rejects those who wait for an answer of the instance that runs or starts.
 * @type {Set<(error: Error) => void>}
 */
const waiting = new Set();

/**
 * The instance that runs or starts has ended: promises that wait for it reject with the reason.
 * @param {string} why
 */
export function endWaiting(why) {
  program.app = null;
  reason = coded("lost-device", `Gaitway has stopped: ${why}`);
  for (const reject of waiting) reject(reason);
}

/**
 * Returns an answer of the instance that runs or starts, or rejects if that ends before it can give one.
 * @template T
 * @param {Promise<T>} answer
 * @returns {Promise<T>}
 */
export const unlessEnded = (answer) =>
  new Promise((resolve, reject) => {
    waiting.add(reject);
    answer.then(resolve, reject).finally(() => waiting.delete(reject));
  });

/** Returns the bindings once they run. */
export async function running() {
  await program.started;
  if (program.app === null) throw reason;
  return program.app;
}

/** Resolves once the first image is on screen and its model is complete. */
export const whenComplete = () => program.started.then(() => program.completed).then(() => {});

/** Whether an instance runs that shows no model. */
export const isStageEmpty = () => program.app !== null && JSON.parse(program.app.summary()).isEmpty;
