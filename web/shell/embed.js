// Gaitway in a frame of another page: `window.gaitway` by messages. The page around it sends `{gaitway: 1, id, call,
// arguments}` and gets `{gaitway: 1, id, result}` or `{gaitway: 1, id, error, code}`; events are `{gaitway: 1, event}`, some with more.
// It never learns anything about files that the user dropped or chose in the frame.
import { messageOf } from "./dom.js";
import { codeOf, coded } from "./errors.js";
import { open } from "./opening.js";
import { LOADING_PROGRAM } from "./panels.js";
import { isStageEmpty, whenComplete } from "./running.js";
import { facts } from "./session.js";
import { drawingFor } from "./sight.js";

/** @typedef {import("./types.d.ts").Gaitway} Gaitway */
/**
 * @typedef {(...given: any[]) => unknown} Call Arguments come from another page; the functions themselves check them.
 */

const READS = /** @type {const} */ (["state", "pose", "stats", "screenshot", "toLink"]);
const withheld = () => coded("cross-origin", "withheld: the user has opened local files in this frame; what they show stays here");

/** @type {Record<string, Call>} */
const CALLS = {
  ready: async () => void (await window.gaitway.ready),
  open: (items, { as } = {}) => open(items, { as, by: "frame" }),
  apply: (partial) => window.gaitway.apply(partial),
  ...Object.fromEntries(READS.map((call) => [call, () => window.gaitway[call]()])),
};

/**
 * @param {string} call
 * @param {unknown[]} given
 */
async function answer(call, given) {
  if (!Object.hasOwn(CALLS, call)) throw coded("malformed", `${call}: there is no such call; expected one of ${Object.keys(CALLS).join(", ")}`);
  const reads = READS.some((name) => name === call);
  const { isPrivate: wasPrivate, seenPrivate: seen } = facts();
  if (wasPrivate && reads) throw withheld();
  // A file may have been dropped meanwhile, and closed again.
  const isPrivateNow = () => wasPrivate || facts().isPrivate || facts().seenPrivate !== seen;
  let result;
  try {
    result = await drawingFor(Promise.resolve(CALLS[call](...given)));
  } catch (error) {
    // Error messages name joints and files.
    throw isPrivateNow() ? withheld() : error;
  }
  if (!isPrivateNow()) return result;
  if (reads) throw withheld();
  // The document that `open` returns lists borrowed clips too.
  return undefined;
}

/**
 * Any page may have events, so they carry nothing private.
 * @param {"ready" | "failed" | "change" | "progress" | "error"} event
 * @param {object} [more]
 */
function announce(event, more) {
  parent.postMessage({ gaitway: 1, event, ...more }, "*");
}

/** The program's share of the progress; files have the rest. */
const PROGRAM_SHARE = 0.5;
/** How much has arrived, from 0 to 1. It never goes back. */
let progress = 0;

/** @param {{ what: string, share: number }} download */
function announceProgress({ what, share }) {
  progress = Math.max(progress, what === LOADING_PROGRAM ? PROGRAM_SHARE * share : PROGRAM_SHARE + (1 - PROGRAM_SHARE) * share);
  announce("progress", { progress });
}

/** Answers the page around this one, if there is one. */
export function answerParent() {
  if (parent === window) return;
  addEventListener("message", async ({ data, source, origin }) => {
    if (source !== parent || data?.gaitway !== 1 || typeof data.call !== "string") return;
    // A page without an origin (a sandbox) can't be addressed by one.
    /** @param {object} part */
    const reply = (part) => parent.postMessage({ gaitway: 1, id: data.id, ...part }, { targetOrigin: origin === "null" ? "*" : origin });
    try {
      reply({ result: await answer(data.call, Array.isArray(data.arguments) ? data.arguments : []) });
    } catch (error) {
      reply({ error: messageOf(error), code: codeOf(error) });
    }
  });
  addEventListener("gaitway:change", () => announce("change"));
  addEventListener("gaitway:progress", ({ detail }) => facts().isPrivate || announceProgress(detail));
  addEventListener("gaitway:problem", ({ detail: { message, code } }) => facts().isPrivate || announce("error", { error: message, code }));
  // Later, since the first instance is yet to be launched.
  const complete = Promise.resolve().then(whenComplete);
  drawingFor(complete).then(
    () => announce("ready", { isEmpty: isStageEmpty() }),
    () => announce("failed"),
  );
}
