// The dialog in which files, folders and URLs are chosen, and its keyboard shortcut.
import { refuse } from "./changes.js";
import { button, byId, dialog, field, focusCanvas, isDialogOpen } from "./dom.js";
import { showGallery } from "./gallery.js";
import { openByHand } from "./opening.js";
import { panel } from "./panels.js";
import { facts } from "./session.js";
import { allowsFiles } from "./viewer.js";

/** @typedef {import("./types.d.ts").Openable} Openable */
/** @typedef {import("./types.d.ts").Role} Role */

export const EMPTY_FOLDER = "This folder has no files in it. Choose or drop one that contains a model.";

/** What the files are chosen for. @type {Role} */
let role;

const TEXTS = {
  any: {
    title: "Open a model",
    what: ".glb, .gltf with its files, .vrm, .fbx, .x, .obj (with .skel and .attach) or a .zip of them, motions to go with it (.bvh, .vrma, .npy, .npz), and an .hdr image to light it. Files stay in this browser.",
    example: "https://example.org/character.glb",
    sample: "Samples",
  },
  motion: {
    title: "Borrow motion",
    what: ".bvh, .vrma, .npy, .npz, .fbx, .x, .glb or .gltf with clips for any skeleton, or a joint map (.json). Files stay in this browser.",
    example: "https://example.org/walk.bvh",
    sample: "Sample walk",
  },
};

/** @param {"any" | "motion"} [kind] */
export function showOpenDialog(kind = "any") {
  if (panel() !== null || isDialogOpen() || !allowsFiles) return;
  role = kind === "motion" ? kind : undefined;
  byId("open-form", HTMLFormElement).reset();
  const { title, what, example, sample } = TEXTS[kind];
  byId("open-title").textContent = title;
  const { need } = facts();
  byId("open-what").textContent = kind === "any" && need !== null ? `${need} ${what}` : what;
  field("open-url").placeholder = example;
  byId("open-sample").textContent = sample;
  dialog("open").showModal();
}

/** @param {Openable[]} items */
function openChosen(items) {
  dialog("open").close();
  openByHand(items, { as: role });
}

/** @param {string} id */
const filesOf = (id) => [...(field(id).files ?? [])];

/**
 * Names files by their paths inside the chosen folder.
 * @param {File[]} files
 */
const insideFolder = (files) => files.map((file) => ({ name: file.webkitRelativePath.split("/").slice(1).join("/") || file.name, content: file }));

field("open-files").addEventListener("change", () => filesOf("open-files").length > 0 && openChosen(filesOf("open-files")));
field("open-folder").addEventListener("change", () => {
  const files = filesOf("open-folder");
  if (files.length > 0) return openChosen(insideFolder(files));
  dialog("open").close();
  refuse(EMPTY_FOLDER);
});
button("open-sample").addEventListener("click", () => {
  if (role === "motion") return openChosen(["sample:walker"]);
  dialog("open").close();
  showGallery();
});
button("open-cancel").addEventListener("click", () => dialog("open").close());
dialog("open").addEventListener("close", () => (document.activeElement ?? document.body) === document.body && focusCanvas());
byId("open-form").addEventListener("submit", (event) => {
  event.preventDefault();
  const url = field("open-url").value.trim();
  if (url !== "") openChosen([url]);
});

addEventListener(
  "keydown",
  (event) => {
    const isOpen = event.key.toLowerCase() === "o" && (event.ctrlKey || event.metaKey) && !event.shiftKey && !event.altKey;
    if (!isOpen || panel() !== null || !allowsFiles) return;
    event.preventDefault();
    event.stopPropagation();
    showOpenDialog();
  },
  { capture: true },
);
