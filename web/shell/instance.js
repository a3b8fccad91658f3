// Instances of the program. Each is one wasm instance on one canvas; when one ends, another starts on a new canvas with the
// same files and view.
import { hasFullscreen, setTheme, shareFont, theme, toggleFullscreen } from "./appearance.js";
import { BACKEND_NAMES, TRY_DOWNLOAD, TRY_GRAPHICS, hasBackend, missingCapabilities, otherBackend } from "./capabilities.js";
import { summarize, viewChanged } from "./changes.js";
import { clearAndReload } from "./clear.js";
import { button, byId, copyText, focusCanvas, frames, isDialogOpen, isGuest, messageOf, takeFocus } from "./dom.js";
import { isEnclosed } from "./enclosed.js";
import { codeOf, coded } from "./errors.js";
import { drawOffScreen } from "./first-frame.js";
import { setInert, showGallery } from "./gallery.js";
import { Mirror } from "./mirror.js";
import { keepOffline } from "./offline.js";
import { showOpenDialog } from "./open-dialog.js";
import { readAgain } from "./opening.js";
import { LOADING_PROGRAM, noteLinkFailure, panel, reportProblem, sayProblem, showCannotRun, showPanel, showProgress } from "./panels.js";
import { backendsToTry, loadProgram, programFiles } from "./program.js";
import { cancelRecording, download, record } from "./recording.js";
import { programs } from "./request.js";
import { endWaiting, program, unlessEnded } from "./running.js";
import { continueWith, facts, performs, send } from "./session.js";
import { validate } from "./validation.js";
import { isViewer } from "./viewer.js";
import { savePage } from "./web-page.js";

/** @typedef {import("./types.d.ts").Backend} Backend */
/** @typedef {import("./types.d.ts").Bindings} Bindings */
/** @typedef {import("./types.d.ts").Effect} Effect */
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

/** What the session has the next instance show. @typedef {Effect & { effect: "run" }} View */

/** @type {View | null} */
let view = null;

/**
 * Starts an instance that shows the current view.
 * @param {Backend | null} renderer Null: whichever works.
 */
export function launch(renderer) {
  program.started = start(renderer);
  // `ready` passes the error on; the panel shows it in any case.
  program.started.catch(() => {});
  return program.started;
}

/** @param {Backend | null} renderer */
async function start(renderer) {
  send({ event: "launch" });
  showPanel("loading");
  const { link, isLocal } = facts();
  dispatchEvent(new CustomEvent("gaitway:loading", { detail: { link, isLocal } }));
  showProgress(LOADING_PROGRAM, 0, 0);
  const lacking = missingCapabilities();
  if (lacking !== null) throw cannotRun(lacking.code, lacking.missing, lacking.attempts);
  const problems = [];
  /** @type {import("./types.d.ts").ErrorCode} */
  let code = "unsupported";
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
    continueWith(bindings);
    send({ event: "loaded" });
    const problem = await startOn(bindings, attempt, /** @type {View} */ (view));
    if (problem === null) {
      program.completed.then(() => keepOffline(programFiles(attempt)));
      return;
    }
    code = problem.code;
    problems.push(problem.message);
  }
  throw hasProgram ? cannotRun(code, problems, graphicsToTry(renderer)) : cannotRun("not-found", problems, TRY_DOWNLOAD);
}

/**
 * Shows why no instance can be started. Returns the error.
 * @param {import("./types.d.ts").ErrorCode} code
 * @param {string[]} problems
 * @param {string[]} attempts What to try.
 */
function cannotRun(code, problems, attempts) {
  showCannotRun(problems, attempts);
  // The program may be damaged where the browser keeps it.
  button("cannot-run-clear").hidden = code !== "not-found";
  const message = problems.join(" ");
  reportProblem(message, code);
  send({ event: "cannotRun", failure: { code, message } });
  return coded(code, message);
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
 * @param {View} view
 * @returns {Promise<import("./types.d.ts").GaitwayError | null>}
 */
async function startOn(bindings, renderer, { link, model, motion, isPrivate }) {
  const [items, motionItems] = await Promise.all([model, motion].map(readAgain));
  const canvas = newCanvas();
  mirror = new Mirror(bindings);
  byId("stage").replaceChildren(canvas, mirror.root);
  // egui takes the focus when it starts, which nothing inert does.
  byId("stage").inert = isGuest();
  [backend, current] = [renderer, bindings];
  canvas.addEventListener("webglcontextlost", () => current === bindings && stopped("The browser took the graphics context away."));
  const presentFrames = drawOffScreen(canvas, renderer);
  /** @type {string[]} */
  let problems;
  try {
    const shown = JSON.parse(await unlessEnded(bindings.run(canvas, link, items, motionItems, isPrivate, callsFor(bindings, renderer))));
    problems = shown.problems;
    noteLinkFailure(shown.code);
  } catch (error) {
    if (panel() === "stopped") throw error;
    end(bindings);
    return coded(codeOf(error) ?? "unsupported", `${BACKEND_NAMES[renderer]}: ${messageOf(error)}`);
  }
  program.app = bindings;
  await unlessEnded(showFirstFrame(canvas, bindings, presentFrames));
  // Not before it moves: decoding and uploading images would delay that.
  awaitImages(bindings, frames(2).then(() => bindings.complete()));
  showPanel(null);
  summarize();
  send({ event: "started", problems });
  return null;
}

/**
 * Waits for the images of a model that is shown without them.
 * @param {Bindings} bindings
 * @param {Promise<string>} images
 */
function awaitImages(bindings, images) {
  program.completed = unlessEnded(images).catch(() => "");
  program.completed.then((problem) => program.app === bindings && problem !== "" && send({ event: "imagesFailed", problem }));
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
 * @param {Bindings} bindings
 * @param {() => void} presentFrames Ends drawing off screen.
 */
async function showFirstFrame(canvas, bindings, presentFrames) {
  // One for the panels, one for the scene, and one to be sure that both came before it.
  await frames(3);
  await bindings.drawn();
  presentFrames();
  // The same image is presented, before it is seen. Time stands still until then: moving images would queue up behind it.
  await frames(2);
  if (program.app !== bindings) return;
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
 * @param {Backend} renderer
 * @returns {ShellCalls}
 */
function callsFor(bindings, renderer) {
  const isCurrent = () => current === bindings;
  // The session asks the program, which can't answer during its own calls.
  const tell = (/** @type {import("./types.d.ts").SessionEvent} */ event) => queueMicrotask(() => isCurrent() && send(event));
  return {
    renderer,
    choose: showOpenDialog,
    hasGallery: !isEnclosed(),
    gallery: showGallery,
    setModal: (isOpen) => isCurrent() && setInert(isOpen),
    save: download,
    savePage: (title, link, model, motion, hasKtx2) => void savePage({ title, link, model, motion, hasKtx2 }, bindings),
    record: (name, width, height, framesPerSec, frameCount, isTransparent, format) => record(name, { width, height, framesPerSec, frameCount, isTransparent, format, frame: bindings.video_frame }),
    cancelRecording,
    validate: (model) => validate((uri) => bindings.gltf_file(model, uri)),
    share: (link) => tell({ event: "share", link }),
    visit: (address) => (address.startsWith("#") ? tell({ event: "visit", link: address.slice(1) }) : void open(address, "_blank", "noopener")),
    hasFullscreen,
    toggleFullscreen,
    theme,
    setTheme,
    progress: showProgress,
    changed: (link) => queueMicrotask(() => isCurrent() && viewChanged(link)),
    warn: (message, code) => {
      console.warn(message);
      sayProblem(message);
      reportProblem(message, code ?? null);
    },
    report(problem) {
      if (isViewer) reportProblem(problem, "malformed");
      return isViewer;
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
  endWaiting(message);
  reportProblem(message, "lost-device");
  // Not from inside the instance's own call.
  queueMicrotask(() => send({ event: "stopped", reason: message }));
  byId("stopped-why").textContent = message.charAt(0).toUpperCase() + message.slice(1);
  // The program's name tells its version.
  report.value = [message, programs[backend].wasm, navigator.userAgent, stack].join("\n");
  byId("stopped-said").textContent = "";
  const other = otherBackend(backend);
  button("stopped-other").textContent = `Use ${BACKEND_NAMES[other]} instead`;
  button("stopped-other").onclick = () => launch(other);
  button("stopped-other").hidden = !hasBackend(other);
  const ended = current;
  current = null;
  showPanel("stopped");
  for (const dialog of document.querySelectorAll("dialog")) dialog.close();
  takeFocus(button("stopped-again"));
  setTimeout(() => {
    end(ended);
    byId("stage").replaceChildren();
  });
}

/** @param {Bindings | null} instance */
function end(instance) {
  cancelRecording();
  if (program.app === instance) program.app = null;
  if (current === instance) current = null;
  // A modal dialog of the instance ends with it.
  setInert(false);
  try {
    instance?.destroy();
  } catch {
    // After a trap nothing in the instance answers any more.
  }
}

performs({
  run: (effect) => void (view = effect),
  restart() {
    endWaiting("it was restarted");
    end(current);
    launch(backend);
  },
  loadImages: () => program.app !== null && awaitImages(program.app, program.app.complete_again()),
});

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
  if (!isNobodys || key === "Tab" || program.app === null || panel() !== null || isDialogOpen()) return;
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
button("cannot-run-clear").addEventListener("click", clearAndReload);
