// Pasted files and URLs are opened as dropped ones are, unless a text field has the caret.
import { openByHand } from "./opening.js";
import { panel } from "./panels.js";
import { program } from "./running.js";
import { urlsIn } from "./urls.js";
import { allowsFiles } from "./viewer.js";

/** Inputs without a caret. */
const NO_TEXT = /^(button|checkbox|file|radio|range|submit)$/;

/**
 * Whether an element takes the text itself. One of those is egui's, which has the focus while a field in the canvas has it.
 * @param {EventTarget | null} target
 */
const isTextField = (target) => target instanceof HTMLTextAreaElement || (target instanceof HTMLInputElement && !NO_TEXT.test(target.type));

addEventListener(
  "paste",
  (event) => {
    if (!allowsFiles || event.clipboardData === null || isTextField(event.target) || (panel() !== null && panel() !== "loading")) return;
    event.preventDefault();
    event.stopPropagation();
    const files = [...event.clipboardData.files];
    const items = files.length > 0 ? files : urlsIn(event.clipboardData.getData("text"));
    if (items.length > 0) openByHand(items);
    else program.app?.notify("There is no file or URL to open on the clipboard.");
  },
  { capture: true },
);
