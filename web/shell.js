// The page around the canvas. It owns what must outlive a crash: the files that were dropped or chosen, the view's link,
// the messages, and `window.gaitway`. The app itself is one wasm instance on one canvas; when it ends, another can be
// started on a fresh canvas with the same files and view.

const byId = (id) => document.getElementById(id);
const meta = document.querySelector('meta[name="gaitway-module"]');
const moduleUrl = new URL(meta.content, document.baseURI).href;
const wasmUrl = new URL(meta.dataset.wasm, document.baseURI).href;
const NAMES = { webgpu: "WebGPU", webgl2: "WebGL2" };

/** The scene of the first screen; none in a build without samples. */
const FIRST_LINK = document.querySelector("#gallery-scenes a")?.hash.slice(1) ?? "";
const linkOfAddress = () => location.hash.slice(1) || FIRST_LINK;

/** What is shown now, so that it can be shown again. */
const kept = { link: linkOfAddress() };
/** Sets of files that were opened and can be shown again, the newest last; a link names them by their files. */
const held = [];
const MOST_HELD = 32;
/** The files among them that are a person's own. */
const ownFiles = new WeakSet();
/** What is a person's own besides what the app shows: files that were refused, and the address of a view of such files. */
const own = { refused: false, view: history.state?.own === true };
/** Compiled once for all instances. */
let compiled = null;
/** Bindings of the running instance; null while none runs. */
let app = null;
let instances = 0;
let started = null;
let stopReason = null;

// ---- Panels ----

const panels = ["loading", "cannot-run", "stopped"];
let panel = "loading";

/** Shows one panel, or none of them. */
function show(name) {
  panel = name;
  for (const other of panels) byId(other).hidden = other !== name;
  byId("stage").inert = name === "stopped" || name === "cannot-run";
}

function say(message) {
  byId("live").textContent = message;
}

/** What went wrong, for screen readers; the app shows it as well. */
function sayProblem(message) {
  byId("problem").textContent = message;
}

/** Shows what is wrong with what was to be opened, where nothing gets as far as the app. */
function refuse(message) {
  sayProblem(message);
  app?.refuse(message);
}

const EMPTY_FOLDER = "There are no files in this folder. Choose or drop one with a model in it.";

/** Progress is shown no more often than that: with every piece of a file it would keep the page from answering. */
const PROGRESS_MS = 100;
let progressAt = -Infinity;

/** `total` 0: not known. */
function showProgress(what, received, total) {
  const hasMore = received > 0 && received !== total;
  if (hasMore && performance.now() < progressAt + PROGRESS_MS) return;
  progressAt = performance.now();
  const known = total > 0;
  const bar = byId("loading-progress");
  if (known) bar.value = Math.min(1, received / total);
  else bar.removeAttribute("value");
  const amount = `${(received / 1e6).toFixed(1)}${known ? ` of ${(total / 1e6).toFixed(1)}` : ""} MB`;
  byId("loading-what").textContent = received > 0 ? `${what}: ${amount}` : `${what}…`;
}

function list(id, texts) {
  byId(id).replaceChildren(
    ...texts.map((text) => {
      const item = document.createElement("li");
      item.textContent = text;
      return item;
    }),
  );
}

/** `missing` and `attempts` are sentences. */
function cannotRun(missing, attempts) {
  list("cannot-run-missing", missing);
  list("cannot-run-try", attempts);
  show("cannot-run");
}

/** Ends a start that is under way. */
let giveUp = null;

function stopped(message) {
  if (panel === "stopped" || panel === "cannot-run") return;
  giveUp?.(new Error(message));
  stopReason = message;
  byId("stopped-why").textContent = message.charAt(0).toUpperCase() + message.slice(1);
  const other = drawnWith() === "webgpu" ? "webgl2" : "webgpu";
  byId("stopped-other").textContent = `Use ${NAMES[other]} instead`;
  byId("stopped-other").onclick = () => restart(other);
  byId("stopped-other").hidden = !has(other);
  const ended = app;
  app = null;
  show("stopped");
  for (const dialog of document.querySelectorAll("dialog")) dialog.close();
  byId("stopped-again").focus();
  // Not from inside the instance's own call.
  setTimeout(() => {
    end(ended);
    byId("stage").replaceChildren();
  });
}

function end(instance) {
  stopRecording(null);
  if (app === instance) app = null;
  try {
    instance?.destroy();
  } catch {
    // After a panic nothing of the instance answers any more.
  }
}

// ---- What this browser can do ----

/** A module with one vector instruction. */
const SIMD = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11);

function has(backend) {
  if (backend === "webgpu") return navigator.gpu !== undefined;
  return document.createElement("canvas").getContext("webgl2") !== null;
}

function lacksWasm() {
  if (typeof WebAssembly !== "object") return ["WebAssembly is switched off or missing in this browser."];
  if (!WebAssembly.validate(SIMD)) return ["This browser's WebAssembly has no vector instructions (SIMD)."];
  return [];
}

function lacksGraphics() {
  if (has("webgpu") || has("webgl2")) return [];
  return ["Graphics: there is neither WebGPU nor WebGL2."];
}

const TRY_BROWSER = "Open this page in a current Chrome, Edge, Firefox or Safari.";
const TRY_GRAPHICS = [
  "Switch on graphics (hardware) acceleration in the browser's settings, then start the browser again.",
  "Update the graphics driver.",
  TRY_BROWSER,
];

// ---- Instances ----

const forced = () => {
  const wanted = new URLSearchParams(location.search).get("renderer");
  return wanted in NAMES ? wanted : null;
};

/** What the last instance asked for or got. */
let backend = null;
const drawnWith = () => backend ?? (has("webgpu") ? "webgpu" : "webgl2");

/** The compiled module, with its progress shown on the way. */
async function compile() {
  const response = await fetch(wasmUrl);
  if (!response.ok) throw new Error(`${wasmUrl}: the server answered ${response.status}`);
  // The length that is sent may be that of the compressed bytes; the build writes down the other.
  const total = Number(meta.dataset.bytes ?? response.headers.get("content-length") ?? 0);
  let received = 0;
  const counted = response.body.pipeThrough(
    new TransformStream({
      transform(chunk, controller) {
        received += chunk.byteLength;
        showProgress("Loading Gaitway", received, total);
        controller.enqueue(chunk);
      },
    }),
  );
  const headers = { "content-type": "application/wasm" };
  return await WebAssembly.compileStreaming(new Response(counted, { headers }));
}

/** Starts a fresh instance with what is kept. `renderer` null: whichever works. */
async function start(renderer) {
  stopReason = null;
  show("loading");
  dispatchEvent(new CustomEvent("gaitway:loading", { detail: { link: kept.link, isLocal: valuesOf(kept.link, "model", "motion").some(isHeld) } }));
  showProgress("Loading Gaitway", 0, 0);
  const missing = [...lacksWasm(), ...lacksGraphics()];
  if (missing.length > 0) {
    cannotRun(missing, lacksWasm().length > 0 ? [TRY_BROWSER] : TRY_GRAPHICS);
    throw new Error(missing.join(" "));
  }
  let bindings;
  try {
    compiled ??= await compile();
    instances += 1;
    // An address of its own gives an instance of its own.
    bindings = await import(instances === 1 ? moduleUrl : `${moduleUrl}?instance=${instances}`);
    await bindings.default({ module_or_path: compiled });
  } catch (error) {
    cannotRun([`The program could not be loaded: ${error.message}`], ["Check the connection and reload the page.", TRY_BROWSER]);
    throw error;
  }
  kept.link = awaited?.link ?? kept.link;
  awaitFiles(kept.link);
  asked = null;
  const [entries, motionEntries] = await Promise.all(
    [heldItems(kept.link), heldMotions(kept.link)].map((items) =>
      read(items).catch((error) => {
        sayProblem(error.message);
        return [];
      }),
    ),
  );
  const problems = [];
  for (const attempt of renderer === null ? [null, "webgl2"] : [renderer]) {
    const canvas = document.createElement("canvas");
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", "The model and its controls. Ctrl+O opens files.");
    // On the screen it would wait for the device, and the whole page with it, until the first picture is drawn.
    canvas.style.visibility = "hidden";
    byId("stage").replaceChildren(canvas);
    backend = attempt;
    const ended = new Promise((_, reject) => (giveUp = reject));
    ended.catch(() => {});
    const link = withoutAwaited(kept.link);
    let missing;
    try {
      const isOwn = [...heldItems(link), ...heldMotions(link)].some((item) => ownFiles.has(item));
      const run = bindings.run(canvas, attempt ?? undefined, link, entries, motionEntries, isOwn, hooks(() => app === bindings || app === null));
      missing = JSON.parse(await Promise.race([run, ended]));
    } catch (error) {
      if (panel === "stopped") throw error;
      problems.push(`${NAMES[attempt] ?? "Graphics"}: ${error.message}`);
      continue;
    }
    app = bindings;
    backend = JSON.parse(bindings.stats()).backend;
    canvas.addEventListener("webglcontextlost", () => stopped("The browser took the graphics context away."));
    const handOver = drawUnseen(canvas);
    // One for the panels, one for the scene, one to be sure that both were before it.
    await frames(3);
    await Promise.race([bindings.begin(), ended]);
    handOver();
    // The first one that is handed over, before it is seen.
    await frames(2);
    if (stopReason !== null) throw new Error(stopReason);
    canvas.style.visibility = "";
    // What is typed goes through a field that nobody sees.
    byId("stage").querySelector("input")?.setAttribute("aria-label", "Typed into the picture");
    show(null);
    summarise();
    showMissing(missing, awaited?.link ?? link);
    showAwaited();
    if (asked !== null) follow(asked);
    return;
  }
  const other = renderer === null ? null : renderer === "webgpu" ? "webgl2" : "webgpu";
  const attempts = other !== null && has(other) ? [`Open this page with ?renderer=${other} instead.`, ...TRY_GRAPHICS] : TRY_GRAPHICS;
  cannotRun(problems, attempts);
  throw new Error(problems.join(" "));
}

/**
 * Has WebGPU draw into a texture of its own until the answer is called: what goes into a canvas is handed over, and there the
 * browser's graphics process, and with it every page, would wait until all shaders are compiled.
 */
function drawUnseen(canvas) {
  const context = backend === "webgpu" ? canvas.getContext("webgpu") : null;
  if (!context?.getConfiguration) return () => {};
  let texture = null;
  context.getCurrentTexture = () => {
    const { device, format, usage } = context.getConfiguration();
    const { width, height } = canvas;
    if (texture?.width !== width || texture.height !== height) {
      texture?.destroy();
      texture = device.createTexture({ size: [width, height], format, usage });
    }
    return texture;
  };
  return () => {
    delete context.getCurrentTexture;
    texture?.destroy();
  };
}

// An instance that runs out of memory or stack says nothing itself.
addEventListener("error", ({ error }) => isTrap(error) && stopped(`An error inside Gaitway: ${error.message}`));
addEventListener("unhandledrejection", ({ reason }) => isTrap(reason) && stopped(`An error inside Gaitway: ${reason.message}`));

const isTrap = (error) => typeof WebAssembly === "object" && error instanceof WebAssembly.RuntimeError;

/** What an instance tells the page; `current` is false for one that has been replaced. */
const hooks = (current) => ({
  choose: (role) => openDialog(role),
  gallery: () => dispatchEvent(new CustomEvent("gaitway:samples")),
  save: (name, bytes) => save(name, bytes),
  startRecording,
  stopRecording,
  share: (link) => share(link),
  progress: (name, received, total) => showProgress(name, received, total),
  changed: (link) => current() && changed(link),
  warn: (message) => {
    console.warn(message);
    sayProblem(message);
  },
  stopped: (message) => current() && stopped(message),
});

const frames = async (count) => {
  // A hidden page draws no frames.
  for (let frame = 0; frame < count; frame++) await Promise.race([new Promise(requestAnimationFrame), new Promise((done) => setTimeout(done, 200))]);
};

function launch(renderer) {
  started = start(renderer);
  // Whoever waits for `ready` gets the error; the panel shows it in any case.
  started.catch(() => {});
  return started;
}

function restart(renderer) {
  return launch(renderer);
}

// ---- What was set ----

let soon = null;

function changed(link) {
  kept.link = link;
  if (visit.files === null) keepTyped();
  clearTimeout(soon);
  soon = setTimeout(summarise, 250);
  // After the frame, so that whoever hears it may ask for the state.
  setTimeout(() => dispatchEvent(new CustomEvent("gaitway:change")));
}

/** The trouble that the app shows, as it was said last. */
let told = null;

/** Tells a screen reader, the title and the address bar. */
function summarise() {
  if (app === null) return;
  const { model, clip, playing, problem } = JSON.parse(app.summary());
  say(`${model}: ${clip ?? "rest pose"}, ${clip !== null && playing ? "playing" : "paused"}`);
  if (problem !== null && problem !== told) sayProblem(problem);
  told = problem;
  dispatchEvent(new CustomEvent("gaitway:shown", { detail: { link: kept.link, isLocal: valuesOf(kept.link, "model", "motion").some(isHeld) } }));
  document.title = model === "" ? "Gaitway" : `${model.split("/").pop()} – Gaitway`;
  record();
}

// ---- Links: the address bar, back and forward ----

/** The pairs of a link, decoded. */
const pairsOf = (link) => link.split("&").filter((pair) => pair !== "").map((pair) => [pair.split("=", 1)[0], decoded(pair.slice(pair.indexOf("=") + 1)), pair]);

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** What a link shows and borrows from, each with its key. */
function filesOf(link) {
  const files = pairsOf(link).filter(([key]) => key === "model" || key === "motion");
  if (!files.some(([key]) => key === "model")) files.unshift(["model", "sample:walker"]);
  return files.map(([key, value]) => `${key}=${value}`);
}

const valuesOf = (link, ...keys) => pairsOf(link).filter(([key]) => keys.includes(key)).map(([, value]) => value);

/** The file that a link's value names: of one model of an archive, the archive. */
const fileOf = (value) => value.split(/(?:#!\/|(?<=\.zip)#\/)/i)[0];

const nameOf = (item) => (typeof item === "string" ? item : item.name);

/** The sets that files of a link are in, by their names. */
const setsOf = (link, key) => [...new Set(valuesOf(link, key).map(fileOf).map((name) => held.findLast((items) => items.some((item) => nameOf(item) === name))))].filter(Boolean);

/** What a link's model is opened from, besides addresses. */
const heldItems = (link) => setsOf(link, "model").flat();

/** What its motions are opened from, where that is something else. */
const heldMotions = (link) => setsOf(link, "motion").filter((set) => !setsOf(link, "model").includes(set)).flat();

const isHeld = (value) => held.some((items) => items.some((item) => typeof item !== "string" && item.name === fileOf(value)));

/** The parts of a link that lie on this computer alone: `[key, name, pair]`. */
const localParts = (link) => pairsOf(link).filter(([key, value]) => (key === "model" || key === "motion") && isHeld(value));

/** What a file of a kind is made of besides itself, which a link does not name: in words, and by the endings of the names. */
const BESIDE = {
  gltf: { words: "its .bin and images", ending: /\.(bin|png|jpe?g|webp)$/i },
  obj: { words: "its .skel and .attach", ending: /\.(skel|attach|mtl|png|jpe?g)$/i },
};

const endingOf = (name) => name.split(".").pop().toLowerCase();

/** The names of such files that came together with one. */
function besides(name) {
  const set = held.findLast((items) => items.some((item) => nameOf(item) === name)) ?? [];
  return set.map(nameOf).filter((other) => BESIDE[endingOf(name)]?.ending.test(other));
}

/** Before the name of a file in a link that somebody has to bring along. */
const BRING = "file:";

/** A link that says which files have to be brought along. */
function publicLink(link) {
  const local = new Map(localParts(link).map(([key, name, pair]) => [pair, `${key}=${BRING}${encodeURIComponent(name)}`]));
  return link.split("&").map((pair) => local.get(pair) ?? pair).join("&");
}

/**
 * The entry of the browser's history that is shown: its number, what files it shows, and the link as the instance gave it
 * back at first where the address bar keeps what was typed until something is set.
 */
const visit = { number: history.state?.gaitway ?? 0, files: null, typed: null };
let lastVisit = visit.number;
/** Entries that show files of this computer, for as long as the page lives: number → `{link, items, motionItems}`. */
const visited = new Map();
const MOST_VISITED = 16;
/** Links that are being followed; what the app shows on the way is no entry. */
let following = 0;

/** Other files are a new entry, everything else changes the present one. */
function record() {
  const files = filesOf(kept.link).join("\n");
  // The address keeps what is waited for until there is something else to see.
  if (following > 0 || kept.link === visit.typed || (awaited !== null && files === visit.files)) return;
  visit.typed = null;
  const address = `#${publicLink(kept.link)}`;
  if (files === visit.files) {
    history.replaceState({ gaitway: visit.number, own: isPrivate() }, "", address);
  } else {
    lastVisit += 1;
    [visit.number, visit.files] = [lastVisit, files];
    history.pushState({ gaitway: visit.number, own: isPrivate() }, "", address);
  }
  remember();
}

/** The address stays as it is until something is set. */
function keepTyped() {
  [visit.files, visit.typed] = [filesOf(kept.link).join("\n"), kept.link];
}

function remember() {
  visited.delete(visit.number);
  const [items, motionItems] = [heldItems(kept.link), heldMotions(kept.link)];
  if (items.length + motionItems.length === 0) return;
  visited.set(visit.number, { link: kept.link, items, motionItems });
  if (visited.size > MOST_VISITED) visited.delete(visited.keys().next().value);
}

// Back, forward, and another address typed after the `#`.
addEventListener("popstate", ({ state }) => {
  clearTimeout(soon);
  // The entry's link is behind what was set in the last moment.
  if (following === 0 && visited.has(visit.number)) visited.get(visit.number).link = kept.link;
  if (state?.gaitway === undefined) {
    lastVisit += 1;
    visit.number = lastVisit;
    history.replaceState({ gaitway: visit.number }, "");
  } else {
    visit.number = state.gaitway;
    lastVisit = Math.max(lastVisit, visit.number);
  }
  const link = linkOfAddress();
  // What has not started yet begins with this one.
  if (app === null) asked = kept.link = link;
  else follow(link, { wasOwn: state?.own, ...visited.get(visit.number) });
});

let follows = 0;
/** What was asked for while an instance starts, which began with something else. */
let asked = null;

const areSame = (items, others) => items.length === others.length && items.every((item, index) => item === others[index]);

/** Shows what a link says, with the files that its entry of the history held. */
async function follow(link, { items = [], motionItems = [], link: heldLink = link, wasOwn = false } = {}, again = false) {
  const current = app;
  follows += 1;
  const number = follows;
  following += 1;
  byId("missing").close();
  own.view ||= wasOwn;
  awaitFiles(heldLink);
  const shownLink = withoutAwaited(heldLink);
  [visit.files, visit.typed] = [filesOf(shownLink).join("\n"), null];
  const lacking = (problems, stays) => {
    if (number !== follows || problems.length === 0) return;
    // What is shown now lacks something that the address still has.
    keepTyped();
    showMissing(problems, link, stays);
  };
  try {
    const before = { items: heldItems(kept.link), motionItems: heldMotions(kept.link) };
    const isOwn = (items) => items.some((item) => ownFiles.has(item));
    if (items.length > 0 && !areSame(items, before.items)) await bring(items, undefined, isOwn(items));
    if (motionItems.length > 0 && !areSame(motionItems, before.motionItems)) await bring(motionItems, "motion", isOwn(motionItems));
    if (number !== follows) return;
    // Files of the same name are others now.
    const isOther = (items.length === 0 && before.items.length > 0) || (motionItems.length === 0 && before.motionItems.length > 0);
    if (again || isOther || shownLink !== kept.link) {
      const all = again || (isOther && items.length + motionItems.length === 0);
      const { problems } = loaded(await unlessStopped(current, current.follow_link(shownLink, all)));
      lacking(problems);
    }
    if (number === follows) showAwaited();
  } catch (error) {
    lacking([error.message], true);
  } finally {
    following -= 1;
    clearTimeout(soon);
    soon = setTimeout(summarise, 250);
  }
}

/** Takes note of what was read from addresses, which takes the place of files of the same names. */
function loaded(answer) {
  const news = JSON.parse(answer);
  for (const name of news.loaded) {
    for (let at = held.length - 1; at >= 0; at--) if (held[at].some((item) => nameOf(item) === name)) held.splice(at, 1);
  }
  if (news.loaded.length > 0) own.refused = false;
  return news;
}

// ---- Links that name files which somebody has to bring ----

/** The link that is waited for, the names of its files, and the sets that came meanwhile; null when nothing is. */
let awaited = null;

const wantedBy = (link) => pairsOf(link).filter(([key, value]) => (key === "model" || key === "motion") && value.startsWith(BRING));

/** Waits for the files that a link names, if it names any. */
function awaitFiles(link) {
  byId("bring").close();
  const wanted = wantedBy(link).map(([key, value, pair]) => {
    const brought = value.slice(BRING.length);
    return { key, pair, name: fileOf(brought), member: brought.slice(fileOf(brought).length) };
  });
  awaited = wanted.length > 0 ? { link, wanted, missing: wanted, sets: [] } : null;
}

/** What of a link can be shown before its files are there. */
function withoutAwaited(link) {
  const missing = wantedBy(link).map(([key]) => key);
  if (missing.length === 0) return link;
  // What is about one model means nothing for another; clips and maps go with their motions.
  const stays = ([key]) => (missing.includes("model") ? ["v", "embed", "background", "exposure", "environment"].includes(key) : key !== "clip" && key !== "map");
  return pairsOf(link).filter(([key, value]) => stays([key]) && !value.startsWith(BRING)).map(([, , pair]) => pair).join("&");
}

function showAwaited() {
  if (awaited === null || panel !== null || byId("bring").open) return;
  byId("bring").returnValue = "";
  const lines = awaited.missing.map(({ key, name }) => {
    const beside = BESIDE[endingOf(name)];
    return `${name} (${key === "model" ? "the model" : "motion"})${beside === undefined ? "" : `, with ${beside.words}`}`;
  });
  list("bring-files", lines);
  byId("bring").showModal();
  byId("bring-choose").focus();
}

/** A set has come: shows the link that is waited for when it was the last one, and says so. `taken`: the app shows the set. */
async function fulfil(items, taken) {
  if (awaited === null) return false;
  awaited.sets.push(items);
  const { link, wanted, sets } = awaited;
  const lastPart = (path) => path.split("/").pop();
  const found = wanted.map(({ key, pair, name, member }) => {
    const set = sets.findLast((items) => items.some((item) => lastPart(nameOf(item)) === lastPart(name)));
    return { key, pair, name, member, set, as: set?.map(nameOf).find((path) => lastPart(path) === lastPart(name)) };
  });
  if (!found.every(({ set }) => set !== undefined)) {
    // Something else was opened: that is what the person wants to see.
    if (taken && !found.some(({ set }) => set === items)) awaited = null;
    else {
      awaited.missing = found.filter(({ set }) => set === undefined);
      showAwaited();
    }
    return false;
  }
  let whole = link;
  for (const { key, pair, member, as } of found) {
    whole = whole.split("&").map((other) => (other === pair ? `${key}=${encodeURIComponent(as + member)}` : other)).join("&");
  }
  awaited = null;
  await follow(whole, { link: whole, items: heldItems(whole), motionItems: heldMotions(whole) });
  if (valuesOf(withoutAwaited(link), "model").length === 0) app?.close_stand_in();
  return true;
}

/** What of a link could not be had, and the way to try again. `stays`: nothing of it is shown. */
function showMissing(problems, link, stays = false) {
  if (problems.length === 0) return;
  sayProblem(problems.join(" "));
  list("missing-parts", problems);
  byId("missing-rest").textContent = stays ? "What was shown stays." : "What could be loaded is shown.";
  byId("missing-again").onclick = () => {
    byId("missing").close();
    if (heldItems(kept.link).length + heldMotions(kept.link).length === 0) {
      follow(link, {}, true);
    } else {
      kept.link = link;
      end(app);
      restart(drawnWith());
    }
  };
  if (panel === null && !byId("missing").open) byId("missing").showModal();
}

/** Shows what there is to pass on: see share.js. */
function share(link) {
  if (app === null) return;
  const url = new URL(location.href);
  // Which back end draws is this machine's own affair.
  url.searchParams.delete("renderer");
  const page = url.href.split("#")[0];
  const rest = publicLink(link);
  const address = `${page}#${rest}`;
  const local = localParts(link).map(([key, value]) => ({ key, name: fileOf(value), beside: besides(fileOf(value)) }));
  const embedded = `${page}#${rest.split("&").filter((pair) => !pair.startsWith("embed=")).join("&")}&embed=1`;
  dispatchEvent(new CustomEvent("gaitway:share", { detail: { address, embedded, local, qr: app.qr(address) ?? null } }));
}

// ---- Opening ----

/** Items as the app takes them: an address, or a path with its bytes. */
async function read(items) {
  return await Promise.all(
    items.map(async (item) => {
      if (typeof item === "string") return item;
      try {
        return [item.name, new Uint8Array(item.content instanceof Blob ? await item.content.arrayBuffer() : item.content)];
      } catch {
        throw new Error(`${item.name}: the browser cannot read it; it was moved, changed or is not a file`);
      }
    }),
  );
}

/** Addresses, `File`s or one object of buffers by name, alone or in a list, as addresses and `{name, content}`. */
function normalised(items) {
  const isList = Array.isArray(items) || items instanceof FileList;
  return [...(isList ? items : [items])].flatMap((item) => {
    if (typeof item === "string") return [item];
    if (item instanceof URL) return [item.href];
    if (item instanceof File) return [{ name: item.webkitRelativePath || item.name, content: item }];
    if (typeof item?.name === "string" && item.content instanceof Blob) return [item];
    if (item === null || typeof item !== "object") throw new Error("open: expected addresses, files, or one object with a buffer for each name");
    return Object.entries(item).map(([name, content]) => {
      if (content instanceof Blob || content instanceof ArrayBuffer) return { name, content };
      if (ArrayBuffer.isView(content)) return { name, content: new Uint8Array(content.buffer, content.byteOffset, content.byteLength) };
      throw new Error(`open: ${name}: expected an ArrayBuffer`);
    });
  });
}

/** `as: "motion"`: to borrow from, whatever it is. */
async function open(items, { as } = {}) {
  return await openAll(items, { as });
}

/** A .skel or .attach that comes after its .obj: with what came before it. */
function completed(items) {
  if (items.length === 0 || !items.every((item) => ["skel", "attach"].includes(endingOf(nameOf(item))))) return items;
  const stem = nameOf(items[0]).replace(/\.[^.]*$/, "");
  const mesh = held.findLast((items) => items.some((item) => nameOf(item) === `${stem}.obj`));
  if (mesh === undefined) return items;
  const others = ["skel", "attach"].map((ending) => held.flat().findLast((item) => nameOf(item) === `${stem}.${ending}`));
  const all = [...mesh, ...others.filter((item) => item !== undefined), ...items];
  return [...new Map(all.map((item) => [nameOf(item), item])).values()];
}

/** `isOwn`: files among them are a person's own, which a page around this one gets to know nothing of. */
async function openAll(items, { as, isOwn = true } = {}) {
  const wanted = completed(normalised(items));
  await running();
  try {
    const { shown, document } = await bring(wanted, as, isOwn);
    tellOpened(shown, document);
    await fulfil(wanted, true);
    summarise();
    return document;
  } catch (error) {
    // A motion may have come before its model.
    await fulfil(wanted, false);
    throw error;
  }
}

/** Files of a person's own that are on their way to the screen. */
let ownOnTheWay = 0;
/** How often there were any: it tells what has come and gone meanwhile. */
let ownSeen = 0;

/** Reads and shows items, and holds on to them. */
async function bring(items, as, isOwn) {
  // A link says where addresses lead; other files have to be held on to.
  const isLocal = !items.every((item) => typeof item === "string");
  const isOwnNow = isLocal && isOwn;
  ownOnTheWay += isOwnNow ? 1 : 0;
  ownSeen += isOwnNow ? 1 : 0;
  if (isOwnNow) items.filter((item) => typeof item !== "string").forEach((item) => ownFiles.add(item));
  if (isLocal) hold(items);
  try {
    const current = app;
    const answer = await unlessStopped(current, (async () => current.open(await read(items), as, isOwnNow))());
    const { shown, document } = JSON.parse(answer);
    own.refused = false;
    return { shown, document };
  } catch (error) {
    if (isLocal) {
      // It may be shown yet, if the person says so, but not instead of what is there under the same name.
      letGo(items);
      held.unshift(items);
    }
    own.refused ||= isOwnNow;
    throw error;
  } finally {
    ownOnTheWay -= isOwnNow ? 1 : 0;
  }
}

function letGo(items) {
  const at = held.indexOf(items);
  if (at >= 0) held.splice(at, 1);
}

function hold(items) {
  letGo(items);
  held.push(items);
  if (held.length > MOST_HELD) held.shift();
}

/** What the app said last, which counts while it is not there. */
let wasPrivate = false;

/** Whether a page around this one must not get to know what is shown: dropped and chosen files are for the person's eyes. */
function isPrivate() {
  try {
    wasPrivate = app?.is_private() ?? wasPrivate;
  } catch {
    wasPrivate = true;
  }
  return wasPrivate || own.refused || own.view || ownOnTheWay > 0;
}

function tellOpened(shown, { files, clips, borrowed_clips: borrowed, joints, triangles }) {
  const count = (number, one, many) => `${number} ${number === 1 ? one : many}`;
  const model = `Opened ${files.join(", ")}: ${count(clips.length, "clip", "clips")}, ${count(joints, "joint", "joints")}, ${count(triangles, "triangle", "triangles")}.`;
  const text = { model, motion: `Borrowed motion: ${count(borrowed?.length ?? 0, "clip", "clips")} can be played.`, map: "The joint map is in force." };
  byId("news").textContent = text[shown];
}

/** For the person at the page: what goes wrong is shown by the app. */
async function openByHand(items, options) {
  if (items.length === 0) return;
  try {
    await open(items, options);
  } catch (error) {
    // The app takes note of it in its next frame; said sooner, what was wrong until then would be said after it.
    await frames(2);
    sayProblem(error.message);
  }
  focusCanvas();
}

let recorder = null;

/** Records what the canvas shows; false where the browser cannot. */
function startRecording() {
  const canvas = byId("stage").querySelector("canvas");
  const types = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];
  const mimeType = typeof MediaRecorder === "undefined" ? undefined : types.find((type) => MediaRecorder.isTypeSupported(type));
  if (mimeType === undefined || canvas?.captureStream === undefined) return false;
  try {
    recorder = new MediaRecorder(canvas.captureStream(), { mimeType, videoBitsPerSecond: 12_000_000 });
    recorder.start();
  } catch {
    recorder = null;
  }
  return recorder !== null;
}

/** Ends the recording; without a name it is thrown away. */
function stopRecording(name) {
  const ended = recorder;
  recorder = null;
  if (ended === null) return;
  const parts = [];
  ended.ondataavailable = (event) => parts.push(event.data);
  ended.onstop = () => {
    ended.stream.getTracks().forEach((track) => track.stop());
    if (name != null) save(name, new Blob(parts));
  };
  ended.stop();
}

/** Hands a file over as a download. */
function save(name, bytes) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" }));
  link.download = name;
  link.click();
  // Not before the browser has begun to read it.
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const focusCanvas = () => byId("stage").querySelector("canvas")?.focus({ preventScroll: true });

/** What the files are chosen for. */
let openAs;

const DIALOG = {
  any: { title: "Open a model", what: ".glb, .gltf with its files, .vrm, .obj (with .skel and .attach) or a .zip of them; motions for it (.bvh, .vrma) can come along. Files stay in this browser.", example: "https://example.org/character.glb", sample: "Samples" },
  motion: { title: "Borrow motion", what: ".bvh, .vrma, .glb or .gltf: the clips of any skeleton, or a joint map (.json). Files stay in this browser.", example: "https://example.org/walk.bvh", sample: "Sample walk" },
};

function openDialog(role = "any") {
  const dialog = byId("open");
  if (panel !== null || dialog.open) return;
  openAs = role === "motion" ? role : undefined;
  byId("open-form").reset();
  const { title, what, example, sample } = DIALOG[role];
  byId("open-title").textContent = title;
  byId("open-what").textContent = what;
  byId("open-url").placeholder = example;
  byId("open-sample").textContent = sample;
  dialog.showModal();
}

function openFromDialog(items) {
  byId("open").close();
  openByHand(items, { as: openAs });
}

byId("open-files").addEventListener("change", ({ target }) => target.files.length > 0 && openFromDialog([...target.files]));
byId("open-folder").addEventListener("change", ({ target }) => {
  if (target.files.length > 0) return openFromDialog(insideFolder([...target.files]));
  byId("open").close();
  refuse(EMPTY_FOLDER);
});
byId("open-sample").addEventListener("click", () => {
  if (openAs === "motion") return openFromDialog(["sample:walker"]);
  byId("open").close();
  dispatchEvent(new CustomEvent("gaitway:samples"));
});
byId("open-cancel").addEventListener("click", () => byId("open").close());
byId("open").addEventListener("close", () => (document.activeElement ?? document.body) === document.body && focusCanvas());
byId("bring").addEventListener("close", () => byId("bring").returnValue === "choose" && openDialog());
byId("open-form").addEventListener("submit", (event) => {
  event.preventDefault();
  const url = byId("open-url").value.trim();
  if (url !== "") openFromDialog([url]);
});

/** Paths seen from the chosen folder. */
function insideFolder(files) {
  return files.map((file) => ({ name: file.webkitRelativePath.split("/").slice(1).join("/") || file.name, content: file }));
}

addEventListener(
  "keydown",
  (event) => {
    const isOpen = event.key.toLowerCase() === "o" && (event.ctrlKey || event.metaKey) && !event.shiftKey && !event.altKey;
    if (!isOpen || panel !== null) return;
    event.preventDefault();
    event.stopPropagation();
    openDialog();
  },
  { capture: true },
);

// ---- Dropping: taken before the canvas sees it ----

const carriesFiles = ({ dataTransfer }) => dataTransfer !== null && [...dataTransfer.types].some((type) => type === "Files" || type === "text/uri-list");
let leaving = null;

/** The sheet that shows where to drop; it goes away when no drag has been seen for a while, which misses no case. */
function showDrop(shown) {
  clearTimeout(leaving);
  byId("drop").hidden = !shown;
  if (shown) leaving = setTimeout(() => showDrop(false), 1000);
}

for (const type of ["dragenter", "dragover", "dragleave", "drop"])
  addEventListener(
    type,
    (event) => {
      if (!carriesFiles(event)) return;
      event.preventDefault();
      event.stopPropagation();
      if (type === "dragenter" || type === "dragover") {
        event.dataTransfer.dropEffect = "copy";
        showDrop(true);
      } else if (type === "dragleave") {
        if (event.relatedTarget === null) showDrop(false);
      } else {
        showDrop(false);
        byId("open").close();
        byId("bring").close();
        dropped(event.dataTransfer).then((items) => openByHand(items), (error) => refuse(error.message));
      }
    },
    { capture: true },
  );

/** What a drop carries: files, files of folders with their paths, or the address of a link. */
async function dropped(transfer) {
  // All entries have to be asked for before the first pause: the list is empty after it.
  const entries = [...transfer.items].filter(({ kind }) => kind === "file").map((item) => ({ entry: item.webkitGetAsEntry?.() ?? null, file: item.getAsFile() }));
  const address = transfer.getData("text/uri-list").split(/\r?\n/).find((line) => line !== "" && !line.startsWith("#"));
  const folders = entries.filter(({ entry }) => entry?.isDirectory);
  if (entries.length === 0) return address === undefined ? [] : [address];
  const files = [];
  for (const { entry, file } of entries) {
    if (entry?.isDirectory) await walk(entry, folders.length === 1 && entries.length === 1 ? "" : `${entry.name}/`, files);
    else if (file !== null) files.push({ name: file.name, content: file });
  }
  if (files.length === 0) throw new Error(EMPTY_FOLDER);
  return files;
}

const MOST_FILES = 4096;

async function walk(folder, path, files) {
  const reader = folder.createReader();
  for (;;) {
    // A part of the folder at a time, until there is none left.
    const entries = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (entries.length === 0) return;
    for (const entry of entries) {
      if (files.length >= MOST_FILES) throw new Error(`More than ${MOST_FILES} files in the folder; drop the model's own files instead.`);
      if (entry.isDirectory) await walk(entry, `${path}${entry.name}/`, files);
      else files.push({ name: `${path}${entry.name}`, content: await new Promise((resolve, reject) => entry.file(resolve, reject)) });
    }
  }
}

// ---- The script interface ----

/** The bindings once they run. */
async function running() {
  await started;
  if (app === null) throw new Error(`Gaitway has stopped: ${stopReason}`);
  return app;
}

/** An answer that an instance that stops meanwhile can no longer give. */
async function unlessStopped(current, answer) {
  let timer;
  const ended = new Promise((_, reject) => {
    timer = setInterval(() => app !== current && reject(new Error(`Gaitway has stopped: ${stopReason ?? "it was started again"}`)), 100);
  });
  try {
    return await Promise.race([answer, ended]);
  } finally {
    clearInterval(timer);
  }
}

/** Answered at once while the app runs, otherwise as soon as it does. */
function ask(name) {
  if (app !== null) return JSON.parse(app[name]());
  return running().then((current) => JSON.parse(current[name]()));
}

window.gaitway = {
  /** The files of each sample: addresses beside the page, by the name after `sample:`. */
  samples: JSON.parse(document.querySelector('meta[name="gaitway-samples"]')?.content ?? "{}"),
  /** Resolves when the first picture is on the screen; a new promise after each restart. */
  get ready() {
    return started.then(() => undefined);
  },
  open,
  state: () => ask("state"),
  pose: () => ask("pose"),
  stats: () => ask("stats"),
  async apply(partial) {
    const current = await running();
    loaded(await unlessStopped(current, current.apply(JSON.stringify(partial ?? null))));
  },
  async screenshot() {
    const current = await running();
    return new Blob([await unlessStopped(current, current.screenshot())], { type: "image/png" });
  },
};

byId("stopped-again").addEventListener("click", () => restart(drawnWith()));
byId("stopped-reload").addEventListener("click", () => location.reload());
byId("cannot-run-reload").addEventListener("click", () => location.reload());
addEventListener("pagehide", () => clearTimeout(soon));

// ---- Buttons for those whom the canvas says nothing ----

byId("do-open").addEventListener("click", () => openDialog());
byId("do-play").addEventListener("click", async () => {
  const { play } = await window.gaitway.state();
  await window.gaitway.apply({ play: !play });
});
byId("do-share").addEventListener("click", () => share(kept.link));

launch(forced()).then(
  () => {
    // Only in a build for benches/web.
    if (app?.bench_characters !== undefined) {
      window.gaitway.benchCharacters = (...work) => app.bench_characters(...work);
      window.gaitway.benchLoad = (bytes) => app.bench_load(new Uint8Array(bytes));
      window.gaitway.benchRetarget = (...work) => app.bench_retarget(...work);
    }
  },
  () => {},
);

// For embed.js and offline.js.
dispatchEvent(new CustomEvent("gaitway:shell", { detail: { openByHand, isPrivate, ownSeen: () => ownSeen, open: (items, { as } = {}) => openAll(items, { as, isOwn: false }) } }));
