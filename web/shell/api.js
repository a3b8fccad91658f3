// `window.gaitway`, the script interface.
import { takeNews } from "./load.js";
import { open } from "./opening.js";
import { parts } from "./parts.js";
import { running, session, unlessStopped, whenComplete } from "./session.js";

/** @typedef {import("./types.d.ts").Gaitway} Gaitway */

const samples = /** @type {HTMLMetaElement | null} */ (document.querySelector('meta[name="gaitway-samples"]'))?.content ?? "{}";

/**
 * Answers at once while the program runs, otherwise as soon as it does.
 * @param {"state" | "pose" | "stats"} name
 */
function ask(name) {
  if (session.app !== null) return JSON.parse(session.app[name]());
  return running().then((app) => JSON.parse(app[name]()));
}

/** @type {Gaitway} */
export const gaitway = {
  samples: JSON.parse(samples),
  parts,
  get ready() {
    return whenComplete();
  },
  open: (items, { as } = {}) => open(items, { as }),
  state: () => ask("state"),
  pose: () => ask("pose"),
  stats: () => ask("stats"),
  async apply(partial) {
    const app = await running();
    takeNews(await unlessStopped(app, app.apply(JSON.stringify(partial ?? null))));
  },
  async screenshot() {
    await whenComplete();
    const app = await running();
    return new Blob([await unlessStopped(app, app.screenshot())], { type: "image/png" });
  },
};

/** Adds what only a build for benches/web has. */
export function addBenches() {
  const { bench_characters: characters, bench_load: load, bench_retarget: retarget } = session.app ?? {};
  if (characters === undefined || load === undefined || retarget === undefined) return;
  gaitway.benchCharacters = characters;
  gaitway.benchLoad = (bytes) => load(new Uint8Array(bytes));
  gaitway.benchRetarget = retarget;
}
