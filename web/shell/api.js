// `window.gaitway`, the script interface.
import { open } from "./opening.js";
import { parts } from "./parts.js";
import { program, running, unlessEnded, whenComplete } from "./running.js";
import { facts, send } from "./session.js";
import { addressOf } from "./share.js";
import { allowsFiles } from "./viewer.js";

/** @typedef {import("./types.d.ts").Gaitway} Gaitway */

const samples = /** @type {HTMLMetaElement | null} */ (document.querySelector('meta[name="gaitway-samples"]'))?.content ?? "{}";

/**
 * Answers at once while the program runs, otherwise as soon as it does.
 * @param {"state" | "pose" | "stats"} name
 */
function ask(name) {
  if (program.app !== null) return JSON.parse(program.app[name]());
  return running().then((app) => JSON.parse(app[name]()));
}

/** @type {Gaitway} */
export const gaitway = {
  samples: JSON.parse(samples),
  parts,
  allowsFiles: () => allowsFiles,
  get ready() {
    return whenComplete();
  },
  open: (items, { as } = {}) => open(items, { as }),
  state: () => ask("state"),
  pose: () => ask("pose"),
  stats: () => ask("stats"),
  async toLink() {
    await running();
    // Those who open it see the whole page.
    const pairs = facts().link.split("&").filter((pair) => !pair.startsWith("embed="));
    return addressOf(pairs.join("&"));
  },
  async apply(partial) {
    const app = await running();
    const { loaded } = JSON.parse(await unlessEnded(app.apply(JSON.stringify(partial ?? null))));
    send({ event: "applied", read: loaded });
  },
  async screenshot() {
    await whenComplete();
    const app = await running();
    return new Blob([await unlessEnded(app.screenshot())], { type: "image/png" });
  },
};

/** Adds what only a build for benches/web has. */
export function addBenches() {
  const { bench_characters: characters, bench_load: load, bench_retarget: retarget } = program.app ?? {};
  if (characters === undefined || load === undefined || retarget === undefined) return;
  gaitway.benchCharacters = characters;
  gaitway.benchLoad = (bytes) => load(new Uint8Array(bytes));
  gaitway.benchRetarget = retarget;
}
