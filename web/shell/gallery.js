// The samples below the viewport: cards that are plain links. The first screen shows them; a link, an embedding page
// and what the user opens hide them until they are asked for. So does a low screen, which has no room for both.
import { byId, button, focusCanvas } from "./dom.js";
import { program } from "./running.js";

const gallery = byId("gallery");
/** Phones held sideways: LOW_HEIGHT in src/ui/mod.rs, also in shell.css. */
const lowScreen = matchMedia("(max-height: 450px)");
const cards = /** @type {HTMLAnchorElement[]} */ ([...gallery.querySelectorAll("a.card")]);

/**
 * What had the focus before the samples were asked for.
 * @type {Element | null}
 */
let opener = null;

export function showGallery() {
  opener = document.activeElement;
  setShown(true);
  const first = cards.find((card) => card.ariaCurrent === "true") ?? gallery.querySelector(".card");
  /** @type {HTMLElement | null} */ (first)?.focus();
}

/** For what the user opens, which needs the room. */
export const hideGallery = () => setShown(false);

/** They are wanted, and only a low screen hides them. */
let isHiddenByHeight = false;

/** @param {boolean} isShown */
function setShown(isShown) {
  isHiddenByHeight = false;
  if (gallery.hidden !== isShown) return;
  const hadFocus = gallery.contains(document.activeElement);
  gallery.hidden = !isShown;
  if (!hadFocus || isShown) return;
  if (opener instanceof HTMLElement && opener.isConnected && opener !== document.body) opener.focus();
  else focusCanvas();
}

/** @param {boolean} isWanted */
function showIfHigh(isWanted) {
  setShown(isWanted && !lowScreen.matches);
  isHiddenByHeight = isWanted && lowScreen.matches;
}

/**
 * Dims the samples and disables them while a modal dialog is open in the canvas.
 * @param {boolean} isInert
 */
export function setInert(isInert) {
  gallery.inert = isInert;
}

/**
 * Marks the card of the current view, if it is one of the scenes.
 * @param {string} link
 * @param {boolean} isLocal
 */
export function markCard(link, isLocal) {
  if (isLocal) setShown(false);
  const shown = program.app?.most_similar_link(link, cards.map(({ hash }) => hash.slice(1)));
  for (const [index, card] of cards.entries()) card.setAttribute("aria-current", String(index === shown));
}

// Fingers can't drop files.
if (matchMedia("(pointer: coarse)").matches) {
  const [title, how] = byId("gallery-own").querySelectorAll("b, small");
  if (title && how) [title.textContent, how.textContent] = ["Open your character", "Choose its files"];
}

showIfHigh(location.hash.length < 2 && parent === window && cards.length > 0);

button("gallery-close").addEventListener("click", () => setShown(false));
lowScreen.addEventListener("change", () => showIfHigh(isHiddenByHeight || !gallery.hidden));
// In the viewport, Escape acts on the selection there.
addEventListener("keydown", (event) => {
  const isHere = event.target === document.body || gallery.contains(/** @type {Node} */ (event.target));
  if (event.key !== "Escape" || gallery.hidden || gallery.inert || !isHere) return;
  if (program.app?.close_menu() !== true) setShown(false);
  event.preventDefault();
});
// The canvas doesn't see it.
gallery.addEventListener("pointerdown", () => program.app?.close_menu());
// After a click or Enter on a card, the keyboard controls the viewport: its keys would do nothing here. Before the first image there is
// nothing to control.
for (const card of cards)
  card.addEventListener("click", ({ ctrlKey, metaKey, shiftKey }) => {
    if (ctrlKey || metaKey || shiftKey) return;
    if (lowScreen.matches) setShown(false);
    else program.started.then(() => document.activeElement === card && focusCanvas(), () => {});
  });
