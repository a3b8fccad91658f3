// The session: what is shown, where that came from and what was asked for since (crates/session). It is a text, which outlives
// the instances of the program: the one that was loaded last makes the next text of each event. Events are passed on here, one
// after the other; what follows from them is done by the modules that import this one.
import { enclosed } from "./enclosed.js";
import { isViewer } from "./viewer.js";

/** @typedef {import("./types.d.ts").Bindings} Bindings */
/** @typedef {import("./types.d.ts").Effect} Effect */
/** @typedef {import("./types.d.ts").Facts} Facts */
/** @typedef {import("./types.d.ts").Performers} Performers */
/** @typedef {import("./types.d.ts").SessionEvent} SessionEvent */

/** What an entry's state holds. Older versions of the page wrote it too, so its keys stay. */
/** @typedef {{ gaitway?: number, own?: boolean } | null} EntryState */

/** The scene that the page was saved with, or the first one of the gallery; empty in a build without samples. */
const FIRST_LINK = enclosed.link ?? /** @type {HTMLAnchorElement | null} */ (document.querySelector("#gallery-scenes a"))?.hash.slice(1) ?? "";

/**
 * Returns what the session knows of an entry of the history that the browser shows.
 * @param {EntryState} state
 */
const shownEntry = (state) => ({
  /** The link in the address bar, or that of the first screen. */
  link: location.hash.slice(1) || FIRST_LINK,
  state: { number: state?.gaitway ?? null, own: state?.own === true },
});

/** The entry in which the page was opened. */
const first = shownEntry(history.state);

/**
 * The session; null before the first program has been loaded.
 * @type {string | null}
 */
let text = null;

/** @type {Facts} */
let known = { link: first.link, isLocal: false, need: null, isPrivate: first.state.own, seenPrivate: 0 };

/** What may be read of the session at any time. */
export const facts = () => known;

/**
 * The instance that makes the next session; it may have stopped otherwise. Null while there is none.
 * @type {Bindings | null}
 */
let maker = null;

/**
 * Has the session go on in an instance.
 * @param {Bindings} bindings
 */
export function continueWith(bindings) {
  maker = bindings;
  text ??= bindings.session_of(first.link, first.state.number ?? undefined, first.state.own);
}

/** The text of a frame's `srcdoc` has no address of its own. */
const hasAddress = location.protocol !== "about:";

/** @type {Partial<Performers>} */
const performers = {
  push: ({ state, link }) => isViewer || history.pushState(entryState(state), "", hasAddress ? `#${link}` : undefined),
  replace: ({ state, link }) => isViewer || history.replaceState(entryState(state), "", hasAddress && link !== null ? `#${link}` : undefined),
};

/** @type {(state: { number: number, own: boolean }) => EntryState} */
const entryState = ({ number, own }) => ({ gaitway: number, own });

/**
 * Has effects done by these functions.
 * @param {Partial<Performers>} given
 */
export const performs = (given) => void Object.assign(performers, given);

/**
 * Events that haven't been handled: they wait for a program, or for the effects of those before them.
 * @type {SessionEvent[]}
 */
const events = [];
let isHandling = false;

/**
 * Tells the session what has happened, and does what follows.
 * @param {SessionEvent} event
 */
export function send(event) {
  events.push(event);
  if (isHandling) return;
  isHandling = true;
  while (maker !== null && text !== null && events.length > 0) handle(maker, text, /** @type {SessionEvent} */ (events.shift()));
  isHandling = false;
}

/**
 * Returns an event in the form that the program reads.
 * @param {SessionEvent} event
 */
const textOf = ({ event, ...fields }) => JSON.stringify(Object.keys(fields).length > 0 ? { [event]: fields } : event);

/**
 * @param {Bindings} bindings
 * @param {string} session
 * @param {SessionEvent} event
 */
function handle(bindings, session, event) {
  /** @type {{ session: string, effects: Effect[], facts: Facts }} */
  let after;
  try {
    after = JSON.parse(bindings.session_after(session, textOf(event)));
  } catch (error) {
    // The event is lost. An instance that has trapped may do so again: the next one goes on.
    if (error instanceof WebAssembly.RuntimeError) maker = null;
    else reportError(error);
    return;
  }
  ({ session: text, facts: known } = after);
  for (const effect of after.effects) perform(effect);
}

/** @param {Effect} effect */
function perform(effect) {
  try {
    /** @type {(effect: Effect) => void} */ (performers[effect.effect])(effect);
  } catch (error) {
    // The others don't depend on it.
    reportError(error);
  }
}

addEventListener("popstate", ({ state }) => send({ event: "moved", ...shownEntry(state) }));
