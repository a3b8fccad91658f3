// Gaitway in a frame of another page: `window.gaitway` by messages. The page around it sends `{gaitway: 1, id, call,
// arguments}` and gets `{gaitway: 1, id, result}` or `{gaitway: 1, id, error, code}`; events are `{gaitway: 1, event}`. It
// never learns anything about files that the user dropped or chose in the frame.
import { messageOf } from "./dom.js";
import { codeOf, coded } from "./errors.js";
import { open } from "./opening.js";
import { whenComplete } from "./running.js";
import { facts } from "./session.js";

/** @typedef {import("./types.d.ts").Gaitway} Gaitway */
/**
 * @typedef {(...given: any[]) => unknown} Call Arguments come from another page; the functions themselves check them.
 */

const READS = /** @type {const} */ (["state", "pose", "stats", "screenshot"]);
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
    result = await CALLS[call](...given);
  } catch (error) {
    // Error messages name joints and files.
    throw isPrivateNow() ? withheld() : error;
  }
  if (!isPrivateNow()) return result;
  if (reads) throw withheld();
  // The document that `open` returns lists borrowed clips too.
  return undefined;
}

/** @param {"ready" | "failed" | "change"} event */
function tell(event) {
  // Events carry nothing private, so any page may have them.
  parent.postMessage({ gaitway: 1, event }, "*");
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
  addEventListener("gaitway:change", () => tell("change"));
  whenComplete().then(() => tell("ready"), () => tell("failed"));
}
