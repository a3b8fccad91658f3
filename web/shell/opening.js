// Opening: what a script or the user gives becomes items of the session, and its tasks are done: files are read, and the program
// shows them. The page keeps the files; the session knows their numbers and names.
import { summarize } from "./changes.js";
import { closeDialogs, messageOf } from "./dom.js";
import { enclosed } from "./enclosed.js";
import { codeOf, coded } from "./errors.js";
import { hideGallery } from "./gallery.js";
import { sayNews, sayProblem } from "./panels.js";
import { program } from "./running.js";
import { performs, send } from "./session.js";

/** @typedef {import("./types.d.ts").Bindings} Bindings */
/** @typedef {import("./types.d.ts").InspectDocument} InspectDocument */
/** @typedef {import("./types.d.ts").Item} Item */
/** @typedef {import("./types.d.ts").Kind} Kind */
/** @typedef {import("./types.d.ts").NamedFile} NamedFile */
/** @typedef {import("./types.d.ts").Openable} Openable */
/** @typedef {import("./types.d.ts").ReadItem} ReadItem */
/** @typedef {import("./types.d.ts").Role} Role */

/**
 * Files by their numbers.
 * @type {Map<number, NamedFile["content"]>}
 */
const files = new Map();
let lastFile = 0;

/**
 * What tasks have read.
 * @type {Map<number, ReadItem[]>}
 */
const read = new Map();

/**
 * Descriptions of what tasks have opened.
 * @type {Map<number, InspectDocument>}
 */
const documents = new Map();

/**
 * Those who wait for an answer.
 * @type {Map<number, { resolve: (document: InspectDocument) => void, reject: (error: unknown) => void }>}
 */
const requests = new Map();
let lastRequest = 0;

/**
 * Opens what a script gives, or the page around this one, which may learn of its own files.
 * @param {Openable | Openable[] | FileList} given
 * @param {{ as?: Role, by?: "script" | "frame" }} [options]
 * @returns {Promise<InspectDocument>}
 */
export async function open(given, { as, by = "script" } = {}) {
  const items = toItems(given);
  return await new Promise((resolve, reject) => {
    lastRequest += 1;
    requests.set(lastRequest, { resolve, reject });
    // Without any program, there is no session to answer.
    program.started.catch(reject);
    send({ event: "open", request: lastRequest, by, items, role: roleOf(as) });
  });
}

/**
 * Opens what the user dropped or chose. The app shows errors itself.
 * @param {Openable[]} given
 * @param {{ as?: Role }} [options]
 */
export function openByHand(given, { as } = {}) {
  if (given.length === 0) return;
  closeDialogs();
  const link = ownLink(given);
  if (link !== undefined && as !== "motion") {
    location.hash = link;
    hideGallery();
  } else {
    send({ event: "open", request: null, by: "hand", items: toItems(given), role: roleOf(as) });
  }
}

/** @param {Role} as Scripts may give anything. */
const roleOf = (as) => (as === "motion" ? as : "any");

/**
 * Returns the link if the user gives a URL of this page, such as a card of the gallery.
 * @param {Openable[]} given
 */
function ownLink([item]) {
  if (typeof item !== "string" || !URL.canParse(item)) return undefined;
  const { origin, pathname, hash } = new URL(item);
  return origin === location.origin && pathname === location.pathname && hash !== "" ? hash : undefined;
}

/**
 * Turns anything that `gaitway.open` takes, alone or in a list, into items, and keeps the files.
 * @param {Openable | Openable[] | FileList} given
 */
function toItems(given) {
  const isList = Array.isArray(given) || given instanceof FileList;
  return (isList ? [...given] : [given]).flatMap(named).map(kept);
}

/**
 * @param {Openable} item
 * @returns {(string | NamedFile)[]}
 */
function named(item) {
  if (typeof item === "string") return [item];
  if (item instanceof URL) return [item.href];
  if (item instanceof File) return [{ name: item.webkitRelativePath || item.name, content: item }];
  if (isNamedFile(item)) return [item];
  if (item === null || typeof item !== "object") throw coded("malformed", "open: expected URLs, files, or an object with a buffer for each name");
  return Object.entries(item).map(([name, content]) => {
    if (content instanceof Blob || content instanceof ArrayBuffer) return { name, content };
    if (ArrayBuffer.isView(content)) return { name, content: new Uint8Array(/** @type {ArrayBuffer} */ (content.buffer), content.byteOffset, content.byteLength) };
    throw coded("malformed", `open: ${name}: expected an ArrayBuffer`);
  });
}

/**
 * @param {Openable} item
 * @returns {item is NamedFile}
 */
const isNamedFile = (item) => item !== null && typeof item === "object" && "name" in item && typeof item.name === "string" && "content" in item && item.content instanceof Blob;

/**
 * @param {string | NamedFile} item
 * @returns {Item}
 */
function kept(item) {
  if (typeof item === "string") return item;
  lastFile += 1;
  files.set(lastFile, item.content);
  return { id: lastFile, name: item.name };
}

for (const set of enclosed.sets) if (set.length > 0) send({ event: "hold", items: set.map(kept) });

/**
 * Reads an item into the form that the app takes.
 * @param {Item} item
 * @returns {Promise<ReadItem>}
 */
async function readItem(item) {
  if (typeof item === "string") return item;
  const content = /** @type {NamedFile["content"]} */ (files.get(item.id));
  try {
    return [item.name, new Uint8Array(content instanceof Blob ? await content.arrayBuffer() : content)];
  } catch {
    throw coded("not-found", `${item.name}: the browser can't read it; it may have been moved or changed, or it isn't a file`);
  }
}

/**
 * Reads files for a new instance; one that can't be read any more is announced and left out.
 * @param {Item[]} items
 */
export async function readAgain(items) {
  const results = await Promise.allSettled(items.map(readItem));
  const problems = results.flatMap((result) => (result.status === "rejected" ? [messageOf(result.reason)] : []));
  if (problems.length > 0) sayProblem(problems.join(" "));
  return results.flatMap((result) => (result.status === "fulfilled" ? [result.value] : []));
}

/**
 * Returns what does a task with the program, and tells the session how it has ended. An instance that has ended has nothing more to
 * tell.
 * @template {{ task: number }} Task
 * @param {(app: Bindings, effect: Task) => Promise<import("./types.d.ts").TaskResult>} work
 */
const task = (work) => async (/** @type {Task} */ effect) => {
  const { app } = program;
  if (app === null) return;
  const result = await work(app, effect).catch((error) => ({ event: /** @type {const} */ ("failed"), failure: { code: codeOf(error) ?? null, message: messageOf(error) } }));
  if (program.app === app) send({ ...result, task: effect.task });
};

performs({
  read: task(async (app, { task, items }) => {
    const given = await Promise.all(items.map(readItem));
    if (program.app === app) read.set(task, given);
    return { event: "read" };
  }),
  show: task(async (app, { task, items, role, isPrivate, isByHand }) => {
    const given = read.get(task) ?? /** @type {string[]} */ (items);
    read.delete(task);
    /** @type {{ shown: Kind, document: InspectDocument }} */
    const { shown, document } = JSON.parse(await app.open(given, role, isPrivate, isByHand));
    if (program.app === app) documents.set(task, document);
    return { event: "opened", kind: shown };
  }),
  follow: task(async (app, { link, reload }) => {
    const { loaded, problems } = JSON.parse(await app.follow_link(link, reload));
    return { event: "followed", read: loaded, problems };
  }),
  findReferences: task(async (app, { items }) => {
    // Of the others, the names are enough.
    const given = items.map((item) => (typeof item === "string" || /\.gltf$/i.test(item.name) ? readItem(item) : /** @type {ReadItem} */ ([item.name, new Uint8Array()])));
    return { event: "lacking", names: app.missing_files(await Promise.all(given)) };
  }),
  forget({ task }) {
    read.delete(task);
    documents.delete(task);
  },
  release: (released) => released.files.forEach((id) => files.delete(id)),
  reply({ request, task }) {
    requests.get(request)?.resolve(/** @type {InspectDocument} */ (documents.get(task)));
    requests.delete(request);
  },
  reject({ request, failure: { code, message } }) {
    requests.get(request)?.reject(code === null ? new Error(message) : coded(code, message));
    requests.delete(request);
  },
  announce: ({ task, kind }) => announce(kind, summarize(), /** @type {InspectDocument} */ (documents.get(task))),
});

/**
 * Tells screen readers what the app says about what was opened, and what can be seen of it.
 * @param {Kind} kind
 * @param {{ model: string, notice: string | null }} summary
 * @param {InspectDocument} document
 */
function announce(kind, { model, notice }, { clips, borrowed_clips: borrowed, joints, triangles }) {
  /** @type {(count: number, noun: string) => string} */
  const counted = (count, noun) => `${count.toLocaleString("en")} ${noun}${count === 1 ? "" : "s"}`;
  // None where a motion shows its own skeleton.
  const lent = borrowed?.length ?? 0;
  const texts = {
    model: [`Opened ${model}.`, `${counted(clips.length, "clip")}, ${counted(joints, "joint")}, ${counted(triangles, "triangle")}.`],
    motion: ["Borrowed the motion.", `${lent > 0 ? counted(lent, "borrowed clip") : counted(clips.length, "clip")}.`],
    light: ["The image lights the scene."],
    map: ["Joint map applied."],
  };
  const [opened, ...contents] = texts[kind];
  sayNews([notice ?? opened, ...contents].join(" "));
}
