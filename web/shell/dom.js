// Small helpers for the page's elements.

/**
 * Returns the element with this id; it has to be of the given type.
 * @template {HTMLElement} [T=HTMLElement]
 * @param {string} id
 * @param {{ new (): T }} [type]
 * @returns {T}
 */
export function byId(id, type) {
  const element = document.getElementById(id);
  if (!(element instanceof (type ?? HTMLElement))) throw new Error(`index.html: #${id}: expected ${type?.name ?? "an element"}`);
  return /** @type {T} */ (element);
}

/** @param {string} id */
export const button = (id) => byId(id, HTMLButtonElement);

/** @param {string} id */
export const dialog = (id) => byId(id, HTMLDialogElement);

/** Whether a dialog is open. It has to be answered before another one opens. */
export const isDialogOpen = () => document.querySelector("dialog[open]") !== null;

/** Closes what was asked or shown about the view so far, for one that the user opens. */
export function closeDialogs() {
  for (const id of ["open", "missing", "share", "bring"]) dialog(id).close();
}

/** @param {string} id */
export const field = (id) => byId(id, HTMLInputElement);

/**
 * Selects a field's text and copies it. Returns whether it could.
 * @param {HTMLInputElement | HTMLTextAreaElement} shown
 * @param {boolean} isAsked Whether the user has asked for it, so that the older way may be tried, too.
 */
export async function copyText(shown, isAsked) {
  shown.select();
  shown.scrollLeft = 0;
  try {
    await navigator.clipboard.writeText(shown.value);
    return true;
  } catch {
    // Not allowed, or the page was not served over HTTPS.
    return isAsked && document.execCommand("copy");
  }
}

/**
 * Fills a list with one item per text.
 * @param {string} id
 * @param {string[]} texts
 */
export function showList(id, texts) {
  byId(id).replaceChildren(
    ...texts.map((text) => {
      const item = document.createElement("li");
      item.textContent = text;
      return item;
    }),
  );
}

/** Names that a sentence lists; more would hide the rest of it. */
const MAX_NAMES = 4;

/**
 * Lists names for a sentence: “a, b and c”, or the first few and how many more there are.
 * @param {string[]} names
 */
export function listOf(names) {
  const more = names.length - MAX_NAMES;
  const listed = more > 0 ? [...names.slice(0, MAX_NAMES), `${more} more`] : names;
  return new Intl.ListFormat("en-GB").format(listed);
}

export const canvas = () => byId("stage").querySelector("canvas");

/**
 * Whether another page embeds this one and has the keyboard. Until the user comes in, nothing here may take the focus: it would
 * take what they type there, and scroll that page.
 */
export const isGuest = () => parent !== window && !document.hasFocus();

/**
 * Gives an element the focus, unless this page is a guest.
 * @param {HTMLElement | null | undefined} element
 */
export function takeFocus(element) {
  if (!isGuest()) element?.focus({ preventScroll: true });
}

export const focusCanvas = () => takeFocus(canvas());

/**
 * Opens a dialog that the user didn't ask for. Modal ones take the focus, so a guest's becomes modal once the user comes in.
 * @param {string} id
 * @param {HTMLElement} first What has the focus then.
 */
export function showDialog(id, first) {
  const shown = dialog(id);
  if (isGuest()) {
    shown.open = true;
    addEventListener("focus", () => shown.open && showDialog(id, first), { once: true });
    return;
  }
  shown.open = false;
  shown.showModal();
  takeFocus(first);
}

/**
 * Waits for animation frames. A hidden page draws none, so each is waited for only briefly.
 * @param {number} count
 */
export async function frames(count) {
  for (let frame = 0; frame < count; frame++) await Promise.race([new Promise(requestAnimationFrame), new Promise((done) => setTimeout(done, 200))]);
}

/** @param {unknown} error */
export const messageOf = (error) => (error instanceof Error ? error.message : String(error));
