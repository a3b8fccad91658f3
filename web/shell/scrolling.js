// In a frame of another page, scrolling is that page's: by wheel until the user comes in, and by a finger that moves up or down over an
// embedded view. A finger that moves sideways, rests or taps is the view's.
import { byId, isGuest } from "./dom.js";

/** A finger that rests this long is the view's, wherever it moves then. */
const REST_MS = 150;

/**
 * The touch of a first finger that the view doesn't know of yet: it may be about to scroll.
 * @type {{ event: TouchEvent, timer: ReturnType<typeof setTimeout> } | null}
 */
let undecided = null;
let isScrolling = false;

/** @param {TouchEvent} event */
function start(event) {
  // Not one that was handed on.
  if (!event.isTrusted || !byId("stage").classList.contains("embedded")) return;
  if (event.touches.length > 1) return handOn();
  event.stopImmediatePropagation();
  isScrolling = false;
  undecided = { event, timer: setTimeout(handOn, REST_MS) };
}

/** @param {TouchEvent} event */
function move(event) {
  if (undecided !== null) {
    const [[from], [to]] = [undecided.event.touches, event.touches];
    isScrolling = Math.abs(to.clientY - from.clientY) > Math.abs(to.clientX - from.clientX);
    if (isScrolling) forget();
    else handOn();
  }
  if (isScrolling) event.stopImmediatePropagation();
}

/** @param {TouchEvent} event */
function end(event) {
  if (event.type === "touchend") handOn();
  else forget();
  if (isScrolling) event.stopImmediatePropagation();
}

function forget() {
  clearTimeout(undecided?.timer);
  undecided = null;
}

/** Gives the view the touch. */
function handOn() {
  if (undecided === null) return;
  const { target, touches, targetTouches, changedTouches } = undecided.event;
  forget();
  target?.dispatchEvent(new TouchEvent("touchstart", { bubbles: true, cancelable: true, touches: [...touches], targetTouches: [...targetTouches], changedTouches: [...changedTouches] }));
}

/** Leaves scrolling to the page around this one, if there is one. */
export function shareScrolling() {
  if (parent === window) return;
  document.documentElement.classList.add("framed");
  const options = { capture: true, passive: true };
  addEventListener("wheel", (event) => isGuest() && event.stopImmediatePropagation(), options);
  addEventListener("touchstart", start, options);
  addEventListener("touchmove", move, options);
  for (const type of /** @type {const} */ (["touchend", "touchcancel"])) addEventListener(type, end, options);
}
