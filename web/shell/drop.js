// Dropped files, folders and links, taken before the canvas sees them.
import { refuse } from "./changes.js";
import { byId, closeDialogs, isDialogOpen } from "./dom.js";
import { EMPTY_FOLDER } from "./open-dialog.js";
import { openByHand } from "./opening.js";
import { panel } from "./panels.js";
import { isStageEmpty, program } from "./running.js";
import { allowsFiles } from "./viewer.js";

/** @typedef {import("./types.d.ts").NamedFile} NamedFile */
/** @typedef {import("./types.d.ts").Role} Role */

const MAX_FILES = 4096;
/** Without drag events for this long, the drag has left the page. */
const SHEET_TIMEOUT_MS = 1000;

/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

function hideSheet() {
  clearTimeout(timer);
  byId("drop").hidden = true;
}

/**
 * Shows where to drop: on a model, files are either opened or lend it their motion. Returns which of the two it is here.
 * @param {DragEvent} event
 * @returns {Role}
 */
function showSheet({ clientX, clientY }) {
  clearTimeout(timer);
  timer = setTimeout(hideSheet, SHEET_TIMEOUT_MS);
  const [open, borrow] = [byId("drop-open"), byId("drop-borrow")];
  borrow.hidden = program.app === null || panel() !== null || isDialogOpen() || isStageEmpty();
  byId("drop").hidden = false;
  const { left, top } = borrow.getBoundingClientRect();
  const isBorrowed = !borrow.hidden && clientX >= left && clientY >= top;
  borrow.classList.toggle("chosen", isBorrowed);
  open.classList.toggle("chosen", !isBorrowed);
  return isBorrowed ? "motion" : undefined;
}

/** @param {DragEvent} event */
function onDrag(event) {
  const transfer = event.dataTransfer;
  if (transfer === null || !transfer.types.some((type) => type === "Files" || type === "text/uri-list")) return;
  event.preventDefault();
  event.stopPropagation();
  // The browser would show a file in the frame's place.
  if (!allowsFiles) return void (transfer.dropEffect = "none");
  if (event.type === "dragenter" || event.type === "dragover") {
    transfer.dropEffect = "copy";
    showSheet(event);
  } else if (event.type === "dragleave") {
    if (event.relatedTarget === null) hideSheet();
  } else {
    const as = showSheet(event);
    hideSheet();
    closeDialogs();
    droppedItems(transfer).then((items) => openByHand(items, { as }), refuse);
  }
}

for (const type of /** @type {const} */ (["dragenter", "dragover", "dragleave", "drop"])) addEventListener(type, onDrag, { capture: true });

/**
 * Returns what a drop carries: files, the files of folders with their paths, or the URL of a link.
 * @param {DataTransfer} transfer
 * @returns {Promise<(string | NamedFile)[]>}
 */
async function droppedItems(transfer) {
  // The list is empty after the first await, so everything is taken out of it now.
  const entries = [...transfer.items].filter(({ kind }) => kind === "file").map((item) => ({ entry: item.webkitGetAsEntry?.() ?? null, file: item.getAsFile() }));
  const url = transfer.getData("text/uri-list").split(/\r?\n/).find((line) => line !== "" && !line.startsWith("#"));
  if (entries.length === 0) return url === undefined ? [] : [url];
  /** @type {NamedFile[]} */
  const files = [];
  for (const { entry, file } of entries) {
    if (isFolder(entry)) await addFolder(entry, entries.length === 1 ? "" : `${entry.name}/`, files);
    else if (file !== null) files.push({ name: file.name, content: file });
  }
  if (files.length === 0) throw new Error(EMPTY_FOLDER);
  return files;
}

/**
 * @param {FileSystemEntry | null} entry
 * @returns {entry is FileSystemDirectoryEntry}
 */
const isFolder = (entry) => entry?.isDirectory === true;

/**
 * Adds the files of a folder and of the folders in it.
 * @param {FileSystemDirectoryEntry} folder
 * @param {string} path
 * @param {NamedFile[]} files
 */
async function addFolder(folder, path, files) {
  const reader = folder.createReader();
  for (;;) {
    // Browsers list a folder in batches; an empty one is the end.
    const entries = await new Promise((/** @type {(entries: FileSystemEntry[]) => void} */ resolve, reject) => reader.readEntries(resolve, reject));
    if (entries.length === 0) return;
    for (const entry of entries) {
      if (files.length >= MAX_FILES) throw new Error(`This folder has more than ${MAX_FILES} files. Drop only the files of the model.`);
      if (isFolder(entry)) await addFolder(entry, `${path}${entry.name}/`, files);
      else files.push({ name: `${path}${entry.name}`, content: await contentOf(/** @type {FileSystemFileEntry} */ (entry)) });
    }
  }
}

/**
 * @param {FileSystemFileEntry} entry
 * @returns {Promise<File>}
 */
const contentOf = (entry) => new Promise((resolve, reject) => entry.file(resolve, reject));
