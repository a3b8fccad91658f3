// In a frame of another page, scrolling is that page's until the user comes in: by wheel, and by a finger that moves up or down. Over an
// embedded view, it remains the finger's. A finger that moves sideways or taps is the view's.
import { byId, canvas, isGuest } from "./dom.js";

/**
 * The touch of a first finger that the view doesn't know of yet: it may be about to scroll.
 * @type {TouchEvent | null}
 */
let undecided = null;
let isScrolling = false;

/**
 * Whether a finger may scroll the page around this one from where it touches.
 * @param {Event} event
 */
const isShared = ({ target }) => target === canvas() && (isGuest() || byId("stage").classList.contains("embedded"));

/** @param {TouchEvent} event */
function start(event) {
  // Not one that was handed on.
  if (!event.isTrusted) return;
  if (event.touches.length === 1) isScrolling = false;
  if (!isShared(event)) return;
  if (event.touches.length > 1) return handOn();
  event.stopImmediatePropagation();
  undecided = event;
}

/** @param {TouchEvent} event */
function move(event) {
  if (undecided !== null) {
    const [[from], [to]] = [undecided.touches, event.touches];
    isScrolling = Math.abs(to.clientY - from.clientY) > Math.abs(to.clientX - from.clientX);
    if (isScrolling) undecided = null;
    else handOn();
  }
  if (isScrolling) event.stopImmediatePropagation();
}

/** @param {TouchEvent} event */
function end(event) {
  if (isScrolling) return event.stopImmediatePropagation();
  if (event.type === "touchcancel") undecided = null;
  handOn();
  // The program handles touches by itself, so the browser doesn't bring the user in.
  if (event.type === "touchend" && isGuest()) canvas()?.focus({ preventScroll: true });
}

/** Gives the view the touch. */
function handOn() {
  if (undecided === null) return;
  const { target, touches, targetTouches, changedTouches } = undecided;
  undecided = null;
  target?.dispatchEvent(new TouchEvent("touchstart", { bubbles: true, cancelable: true, touches: [...touches], targetTouches: [...targetTouches], changedTouches: [...changedTouches] }));
}

/**
 * The program would take it for a press, which doesn't end where the browser scrolls. It presses with the touch that is handed on.
 * @param {PointerEvent} event
 */
function holdPointer(event) {
  if (event.pointerType === "touch" && isShared(event)) event.stopImmediatePropagation();
}

const showGuest = () => void document.documentElement.classList.toggle("guest", isGuest());

/** Leaves scrolling to the page around this one, if there is one. */
export function shareScrolling() {
  if (parent === window) return;
  document.documentElement.classList.add("framed");
  showGuest();
  for (const type of ["focus", "blur"]) addEventListener(type, showGuest);
  const options = { capture: true, passive: true };
  addEventListener("wheel", (event) => isGuest() && event.stopImmediatePropagation(), options);
  for (const type of /** @type {const} */ (["pointerdown", "pointerup"])) addEventListener(type, holdPointer, options);
  addEventListener("touchstart", start, options);
  addEventListener("touchmove", move, options);
  for (const type of /** @type {const} */ (["touchend", "touchcancel"])) addEventListener(type, end, options);
}
