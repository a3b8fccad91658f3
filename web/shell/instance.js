// Instances of the program. Each is one wasm instance on one canvas; when one ends, another starts on a new canvas with the
// same files and view.
import { hasFullscreen, setTheme, shareFont, theme, toggleFullscreen } from "./appearance.js";
import { awaitFiles, awaited, showAwaited } from "./awaited.js";
import { BACKEND_NAMES, TRY_DOWNLOAD, TRY_GRAPHICS, hasBackend, missingCapabilities, otherBackend } from "./capabilities.js";
import { summarize, viewChanged } from "./changes.js";
import { button, byId, copyText, focusCanvas, frames, isDialogOpen, isGuest, messageOf, takeFocus } from "./dom.js";
import { coded } from "./errors.js";
import { drawOffScreen } from "./first-frame.js";
import { followAsked, showMissing, showMissingImages, takeAsked } from "./following.js";
import { setInert, showGallery } from "./gallery.js";
import { heldFor } from "./held.js";
import { withMissing } from "./history.js";
import { linkWithoutMissing, readLinksWith } from "./links.js";
import { readOrReport } from "./load.js";
import { Mirror } from "./mirror.js";
import { keepOffline } from "./offline.js";
import { showOpenDialog } from "./open-dialog.js";
import { panel, sayProblem, showCannotRun, showPanel, showProgress } from "./panels.js";
import { arePrivate } from "./privacy.js";
import { backendsToTry, loadProgram, programFiles } from "./program.js";
import { cancelRecording, download, record } from "./recording.js";
import { programs } from "./request.js";
import { session } from "./session.js";
import { addressOf, share } from "./share.js";
import { validate } from "./validation.js";

/** @typedef {import("./types.d.ts").Backend} Backend */
/** @typedef {import("./types.d.ts").Bindings} Bindings */
/** @typedef {import("./types.d.ts").ReadItem} ReadItem */
/** @typedef {import("./types.d.ts").ShellCalls} ShellCalls */

/**
 * The back end of the last instance.
 * @type {Backend}
 */
let backend = "webgl2";

/**
 * Bindings of the instance that runs or starts.
 * @type {Bindings | null}
 */
let current = null;

/**
 * The mirror of the current instance.
 * @type {Mirror | null}
 */
let mirror = null;

const report = byId("stopped-report", HTMLTextAreaElement);

/**
 * Aborts a start that is under way.
 * @type {((reason: Error) => void) | null}
 */
let abortStart = null;

/**
 * Starts an instance that shows the current view.
 * @param {Backend | null} renderer Null: whichever works.
 */
export function launch(renderer) {
  session.started = start(renderer);
  // `ready` passes the error on; the panel shows it in any case.
  session.started.catch(() => {});
  return session.started;
}

/** @param {Backend | null} renderer */
async function start(renderer) {
  session.stopReason = null;
  showPanel("loading");
  dispatchEvent(new CustomEvent("gaitway:loading", { detail: { link: session.link, isLocal: session.isLocal } }));
  showProgress("Loading Gaitway", 0, 0);
  const lacking = missingCapabilities();
  if (lacking !== null) {
    showCannotRun(lacking.missing, lacking.attempts);
    throw coded("unsupported", lacking.missing.join(" "));
  }
  const problems = [];
  let hasProgram = false;
  for (const attempt of renderer === null ? await backendsToTry() : [renderer]) {
    /** @type {Bindings} */
    let bindings;
    try {
      bindings = await loadProgram(attempt);
    } catch (error) {
      problems.push(`The program couldn't be loaded: ${messageOf(error)}`);
      continue;
    }
    hasProgram = true;
    shareFont(bindings);
    readLinksWith(bindings);
    const asked = takeAsked();
    session.link = asked === null ? linkToRestore() : (asked.entry.link ?? asked.link);
    awaitFiles(session.link);
    const { items, motionItems } = heldFor(session.link);
    const files = await Promise.all([items, motionItems].map((items) => readOrReport(items, sayProblem)));
    const problem = await startOn(bindings, attempt, files);
    if (problem === null) {
      session.completed.then(() => keepOffline(programFiles(attempt)));
      return;
    }
    problems.push(problem);
  }
  showCannotRun(problems, hasProgram ? graphicsToTry(renderer) : TRY_DOWNLOAD);
  throw coded(hasProgram ? "unsupported" : "not-found", problems.join(" "));
}

/**
 * Returns the link that the next instance shows: of the current view, with the files that it lacks, or, if something stands in for
 * them, the link that asked for them.
 */
function linkToRestore() {
  const whole = withMissing(session.link);
  return whole === session.link ? (awaited()?.link ?? whole) : whole;
}

/**
 * What to try if there is no graphics device.
 * @param {Backend | null} renderer
 */
function graphicsToTry(renderer) {
  const other = renderer === null ? null : otherBackend(renderer);
  return other !== null && hasBackend(other) ? [`Open this page with ?renderer=${other} instead.`, ...TRY_GRAPHICS] : TRY_GRAPHICS;
}

/**
 * Starts on one back end; returns the problem if it can't be used.
 * @param {Bindings} bindings
 * @param {Backend} renderer
 * @param {ReadItem[][]} files Local files of the model, and of its motions.
 */
async function startOn(bindings, renderer, [items, motionItems]) {
  const canvas = newCanvas();
  mirror = new Mirror(bindings);
  byId("stage").replaceChildren(canvas, mirror.root);
  // egui takes the focus when it starts, which nothing inert does.
  byId("stage").inert = isGuest();
  [backend, current] = [renderer, bindings];
  canvas.addEventListener("webglcontextlost", () => current === bindings && stopped("The browser took the graphics context away."));
  /** @type {Promise<never>} */
  const aborted = new Promise((_, reject) => (abortStart = reject));
  aborted.catch(() => {});
  const presentFrames = drawOffScreen(canvas, renderer);
  const link = linkWithoutMissing(session.link);
  /** @type {string[]} */
  let missing;
  try {
    const isPrivate = arePrivate(Object.values(heldFor(link)).flat());
    const run = bindings.run(canvas, session.link, items, motionItems, isPrivate, callsFor(bindings));
    missing = JSON.parse(await Promise.race([run, aborted]));
  } catch (error) {
    if (panel() === "stopped") throw error;
    end(bindings);
    return `${BACKEND_NAMES[renderer]}: ${messageOf(error)}`;
  }
  session.app = bindings;
  await showFirstFrame(canvas, aborted, bindings, presentFrames);
  // Not before it moves: decoding and uploading images would delay that.
  const images = frames(2).then(() => bindings.complete());
  awaitImages(bindings, images, aborted);
  showPanel(null);
  summarize();
  showMissing(missing, awaited()?.link ?? link);
  showAwaited();
  followAsked();
  return null;
}

/**
 * Waits for the images of a model that is shown without them.
 * @param {Bindings} bindings
 * @param {Promise<string>} images
 * @param {Promise<never>} aborted
 */
function awaitImages(bindings, images, aborted) {
  session.completed = Promise.race([images, aborted]).catch(() => "");
  session.completed.then((problem) => {
    if (session.app !== bindings || problem === "") return;
    showMissingImages(problem, () => awaitImages(bindings, bindings.complete_again(), aborted));
  });
}

function newCanvas() {
  const canvas = document.createElement("canvas");
  // Assistive technology reads its mirror instead.
  canvas.setAttribute("aria-hidden", "true");
  // A visible canvas would make the whole page wait for the device until the first frame is drawn.
  canvas.style.visibility = "hidden";
  return canvas;
}

/**
 * Draws the first frame and then shows the canvas.
 * @param {HTMLCanvasElement} canvas
 * @param {Promise<never>} aborted
 * @param {Bindings} bindings
 * @param {() => void} presentFrames Ends drawing off screen.
 */
async function showFirstFrame(canvas, aborted, bindings, presentFrames) {
  // One for the panels, one for the scene, and one to be sure that both came before it.
  await frames(3);
  await Promise.race([bindings.drawn(), aborted]);
  presentFrames();
  // The same image is presented, before it is seen. Time stands still until then: moving images would queue up behind it.
  await frames(2);
  if (session.stopReason !== null) throw coded("lost-device", session.stopReason);
  canvas.style.visibility = "";
  bindings.begin();
  // egui makes its canvas a stop of the Tab key, and receives text through a hidden input while it has the keyboard.
  canvas.tabIndex = -1;
  const agent = byId("stage").querySelector(":scope > input");
  agent?.setAttribute("aria-hidden", "true");
  agent?.setAttribute("tabindex", "-1");
}

/**
 * What an instance calls; one that has been replaced no longer changes anything.
 * @param {Bindings} bindings
 * @returns {ShellCalls}
 */
function callsFor(bindings) {
  const isCurrent = () => current === bindings;
  return {
    choose: showOpenDialog,
    gallery: showGallery,
    setModal: (isOpen) => isCurrent() && setInert(isOpen),
    save: download,
    record: (name, width, height, framesPerSec, frameCount, isTransparent, format) => record(name, { width, height, framesPerSec, frameCount, isTransparent, format, frame: bindings.video_frame }),
    cancelRecording,
    validate: (model) => validate((uri) => bindings.gltf_file(model, uri)),
    share,
    visit: (address) => void open(address.startsWith("#") ? addressOf(address.slice(1)) : address, "_blank", "noopener"),
    hasFullscreen,
    toggleFullscreen,
    theme,
    setTheme,
    progress: showProgress,
    changed: (link) => isCurrent() && viewChanged(link),
    warn: (message) => {
      console.warn(message);
      sayProblem(message);
    },
    // Deferred: the program borrows its side of the mirror during this call, and moving the focus would call it back.
    mirror: (tree) => queueMicrotask(() => isCurrent() && mirror?.show(tree)),
    stopped: (message) => isCurrent() && stopped(message),
  };
}

/**
 * @param {string} message
 * @param {string} [stack] Where it happened, if that isn't here.
 */
function stopped(message, stack = new Error().stack) {
  if (panel() === "stopped" || panel() === "cannot-run") return;
  abortStart?.(coded("lost-device", message));
  session.stopReason = message;
  byId("stopped-why").textContent = message.charAt(0).toUpperCase() + message.slice(1);
  // The program's name tells its version.
  report.value = [message, programs[backend].wasm, navigator.userAgent, stack].join("\n");
  byId("stopped-said").textContent = "";
  const other = otherBackend(backend);
  button("stopped-other").textContent = `Use ${BACKEND_NAMES[other]} instead`;
  button("stopped-other").onclick = () => launch(other);
  button("stopped-other").hidden = !hasBackend(other);
  const ended = current;
  session.app = current = null;
  showPanel("stopped");
  for (const dialog of document.querySelectorAll("dialog")) dialog.close();
  takeFocus(button("stopped-again"));
  // Not from inside the instance's own call.
  setTimeout(() => {
    end(ended);
    byId("stage").replaceChildren();
  });
}

/** @param {Bindings | null} instance */
function end(instance) {
  cancelRecording();
  if (session.app === instance) session.app = null;
  if (current === instance) current = null;
  // A modal dialog of the instance ends with it.
  setInert(false);
  try {
    instance?.destroy();
  } catch {
    // After a trap nothing in the instance answers any more.
  }
}

session.restart = () => {
  end(current);
  launch(backend);
};

/** @param {unknown} error */
function stopOnTrap(error) {
  // A panic has been reported by now. An instance that runs out of memory or stack can't report it.
  if (typeof WebAssembly === "object" && error instanceof WebAssembly.RuntimeError) stopped(`An error inside Gaitway: ${error.message}`, error.stack);
}

/**
 * Passes keys on to the canvas while nothing has the focus, as after loading. Tab and what others have handled stay with them.
 * @param {KeyboardEvent} event
 */
function passToCanvas(event) {
  const { key, target, defaultPrevented } = event;
  // The key may have closed what had the focus.
  const isNobodys = target === document.body && document.activeElement === document.body && !defaultPrevented;
  if (!isNobodys || key === "Tab" || session.app === null || panel() !== null || isDialogOpen()) return;
  focusCanvas();
  // Nothing inert takes the focus.
  const { activeElement } = document;
  if (activeElement instanceof HTMLCanvasElement && !activeElement.dispatchEvent(new KeyboardEvent(event.type, event))) event.preventDefault();
}

addEventListener("keydown", passToCanvas);
byId("stage").addEventListener("keydown", (event) => mirror?.leaveCanvas(event), true);
addEventListener("error", ({ error }) => stopOnTrap(error));
addEventListener("unhandledrejection", ({ reason }) => stopOnTrap(reason));
button("stopped-again").addEventListener("click", () => launch(backend));
button("stopped-copy").addEventListener("click", async () => {
  const isCopied = await copyText(report, true);
  byId("stopped-said").textContent = isCopied ? "Report copied." : "Couldn't copy the report. It is selected: copy it with the keyboard.";
});
for (const id of ["stopped-reload", "cannot-run-reload"]) button(id).addEventListener("click", () => location.reload());
