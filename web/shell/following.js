// Following links: back and forward, another link typed into the address bar, and reporting what couldn't be loaded.
import { awaitCopies, awaitFiles, forgetAwaited, showAwaited } from "./awaited.js";
import { cancelSummary, summarizeSoon } from "./changes.js";
import { forgetCompanions } from "./companions.js";
import { button, byId, dialog, messageOf, showDialog, showList } from "./dom.js";
import { codeOf } from "./errors.js";
import { fileName, heldFor, localFiles, shareableLink, withHeldFiles } from "./held.js";
import { beginFollowing, endFollowing, keepTypedAddress, moveToEntry, showInEntry } from "./history.js";
import { linkWithoutMissing, linkedFiles, shownFiles } from "./links.js";
import { load, takeNews } from "./load.js";
import { panel, sayProblem } from "./panels.js";
import { rememberPrivateVisit } from "./privacy.js";
import { isStageEmpty, linkOfAddress, session, unlessStopped } from "./session.js";

/** @typedef {import("./types.d.ts").Item} Item */

/**
 * What the followed entry of the history showed.
 * @typedef {object} Followed
 * @property {Item[]} [items] Local files of the model.
 * @property {Item[]} [motionItems] Local files of the motions.
 * @property {string} [link] The link that names them, where the address has `file:`.
 * @property {boolean} [wasPrivate]
 * @property {boolean} [isOwn] The link's files were open in this entry before the page was reloaded.
 */

let lastFollow = 0;

/**
 * Shows what a link says, with the local files that its entry of the history held.
 * @param {string} link
 * @param {Followed} [entry]
 * @param {boolean} [again] Read all of it again.
 */
export async function follow(link, { items = [], motionItems = [], link: heldLink = link, wasPrivate = false, isOwn } = {}, again = false) {
  const app = session.app;
  if (app === null) return;
  lastFollow += 1;
  const number = lastFollow;
  const isLatest = () => number === lastFollow && session.app === app;
  const overtakes = beginFollowing();
  const shownBefore = shownFiles(session.link);
  dialog("missing").close();
  if (wasPrivate) rememberPrivateVisit();
  awaitFiles(heldLink, isOwn);
  const linkForNow = linkWithoutMissing(heldLink);
  showInEntry(linkForNow);
  /** @type {(problems: string[], isUnchanged?: boolean) => void} */
  const report = (problems, isUnchanged) => {
    if (!isLatest() || problems.length === 0) return;
    // The address still has what the screen lacks.
    keepTypedAddress();
    showMissing(problems, link, isUnchanged);
  };
  try {
    const before = heldFor(session.link);
    if (items.length > 0 && !areSame(items, before.items)) await load(items, undefined, false);
    if (motionItems.length > 0 && !areSame(motionItems, before.motionItems)) {
      // The link's own model borrows them, not the one that is shown now.
      if (items.length === 0 && modelsOf(heldLink) !== modelsOf(session.link)) {
        const { problems } = takeNews(await unlessStopped(app, app.follow_link(linkWithoutMissing(shareableLink(heldLink)), false)));
        if (problems.length > 0) return report(problems);
      }
      await load(motionItems, "motion", false);
    }
    if (number !== lastFollow) return;
    // The same names now mean other files.
    const meansOthers = (items.length === 0 && before.items.length > 0) || (motionItems.length === 0 && before.motionItems.length > 0);
    // What is shown is followed as well if something else is on its way.
    if (again || meansOthers || overtakes || linkForNow !== session.link) {
      const readAll = again || (meansOthers && items.length + motionItems.length === 0);
      report(takeNews(await unlessStopped(app, app.follow_link(heldLink, readAll))).problems);
    }
    if (number === lastFollow) showAwaited();
  } catch (error) {
    if (codeOf(error) !== "cancelled") report([messageOf(error)], true);
    else if (isLatest()) {
      app.notify(`${messageOf(error).replace(/\.$/, "")}.`);
      // What was opened meanwhile gets an entry of its own; after “Cancel”, the address has what the screen lacks.
      if (shownFiles(session.link) === shownBefore) keepTypedAddress();
    }
  } finally {
    endFollowing();
    summarizeSoon();
  }
}

/**
 * Returns the same text for links with the same models.
 * @param {string} link
 */
const modelsOf = (link) => linkedFiles(link).flatMap(({ role, name, member }) => (role === "model" ? [name + member] : [])).join("\n");

/**
 * @param {Item[]} items
 * @param {Item[]} others
 */
const areSame = (items, others) => items.length === others.length && items.every((item, index) => item === others[index]);

/**
 * Whether something else is shown than one of the link's models, such as a motion's skeleton.
 * @param {import("./types.d.ts").LinkedFile[]} models
 */
function showsOther(models) {
  const isShown = (/** @type {string} */ source) => models.some(({ name }) => source.startsWith(name));
  return session.app !== null && !JSON.parse(session.app.state()).model.some(isShown);
}

/**
 * Lists the parts of a link that couldn't be loaded, and offers to try again.
 * @param {string[]} problems
 * @param {string} link
 * @param {boolean} [isUnchanged] Nothing of the link is shown.
 */
export function showMissing(problems, link, isUnchanged = false) {
  if (problems.length === 0) return;
  // A problem may name the absolute URL of a relative one, or only the file. On an empty stage, one is about the model.
  const failed = problems.map((problem) => fileName(problem.split(": ")[0]));
  const isEmpty = isStageEmpty();
  const models = linkedFiles(link).filter(({ role, name }) => role === "model" && (isEmpty || failed.includes(fileName(name))));
  const hasFailed = models.length > 0;
  const isAwaited = hasFailed && (isEmpty || (!isUnchanged && showsOther(models)));
  if (isAwaited) awaitCopies(link, models.map(({ name }) => name));
  // Not one of several, of which another is shown.
  const isModel = isAwaited || (hasFailed && isUnchanged);
  showProblems(problems, {
    title: `${isModel ? "The model in" : "Part of"} this link couldn't be loaded`,
    rest: isUnchanged ? "The current view stays as it was." : isModel ? "“Try again” reloads the whole link." : "Everything else is shown.",
    without: "it",
    again: () => {
      const { items, motionItems } = heldFor(session.link);
      if (items.length + motionItems.length === 0) {
        follow(link, {}, true);
      } else {
        session.link = link;
        session.isLocal = localFiles(link).length > 0;
        session.restart();
      }
    },
  });
}

/**
 * Says why the images of the model that is shown couldn't be loaded, and offers to load them `again`. A copy of its file also
 * completes the view.
 * @param {string} problem
 * @param {() => void} load
 */
export function showMissingImages(problem, load) {
  const { link } = session;
  awaitCopies(link, linkedFiles(link).flatMap(({ role, name }) => (role === "model" ? [name] : [])));
  const again = () => {
    forgetAwaited();
    load();
  };
  showProblems([problem], { title: "The images of this model couldn't be loaded", rest: "It is shown without them.", without: "them", again });
}

/**
 * @param {string[]} problems
 * @param {{ title: string, rest: string, without: string, again: () => void }} texts And what trying again does.
 */
function showProblems(problems, { title, rest, without, again }) {
  sayProblem(problems.join(" "));
  showList("missing-parts", problems);
  byId("missing-title").textContent = title;
  byId("missing-rest").textContent = rest;
  byId("missing-continue").textContent = `Continue without ${without}`;
  button("missing-again").onclick = () => {
    dialog("missing").close();
    again();
  };
  if (panel() === null && !dialog("missing").open) showDialog("missing", button("missing-again"));
}

/** Takes the entry of the history that was asked for, if any: its link, and what it showed. */
export function takeAsked() {
  const { asked } = session;
  session.asked = null;
  if (asked === null) return null;
  const { link, visit, wasPrivate } = asked;
  /** The address may have been edited: files that are there aren't asked for. @type {Followed} */
  const entry = { wasPrivate, ...(visit ?? withHeldFiles(link)) };
  return { link, entry };
}

/** Follows the entry of the history that was asked for, if any. */
export function followAsked() {
  const asked = takeAsked();
  if (asked !== null) follow(asked.link, asked.entry);
}

addEventListener("popstate", ({ state }) => {
  cancelSummary();
  forgetCompanions();
  const visit = moveToEntry(state);
  const link = linkOfAddress();
  session.asked = { link, visit, wasPrivate: state?.own === true };
  // An instance that is starting, or the next one, shows it instead.
  if (session.app === null) session.link = visit?.link ?? link;
  else followAsked();
});
