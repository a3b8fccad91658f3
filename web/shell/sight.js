// A frame that is out of sight draws nothing. Browsers stop its animation frames only if it is from another origin than the page around
// it. Here they wait in either case until the frame is back in sight, unless the page around it awaits an answer, such as a screenshot.

import { canvas } from "./dom.js";

/** About the length of an animation frame, for when the browser provides none. */
const FRAME_MS = 16;
/** An animation frame this late won't come: the browser has stopped them, and the observer hasn't reported it yet. */
const LATE_MS = 250;

/** A frame of another origin that starts out of sight isn't even observed. */
let isInSight = false;
/** How many answers are awaited. */
let awaited = 0;

/**
 * The requested callbacks, by the identifiers that were returned.
 * @type {Map<number, FrameRequestCallback>}
 */
const held = new Map();
let last = 0;

/** @param {number} now */
function callHeld(now) {
  // What they request belongs to the next frame.
  for (const id of [...held.keys()]) {
    const callback = held.get(id);
    held.delete(id);
    callback?.(now);
  }
}

function drawNow() {
  // egui requests its first frame once the browser has measured the canvas, which it doesn't do out of sight, or when the visibility
  // changes.
  if (held.size === 0) canvas()?.dispatchEvent(new Event("visibilitychange"));
  callHeld(performance.now());
}

/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

function callSoonIfAwaited() {
  if (awaited === 0 || timer !== undefined) return;
  timer = setTimeout(() => {
    timer = undefined;
    if (awaited > 0) drawNow();
    callSoonIfAwaited();
  }, isInSight ? LATE_MS : FRAME_MS);
}

/**
 * Draws as often as an answer needs it, even out of sight.
 * @template T
 * @param {Promise<T>} answer
 */
export async function drawingFor(answer) {
  awaited += 1;
  callSoonIfAwaited();
  try {
    return await answer;
  } finally {
    awaited -= 1;
  }
}

/** Stops drawing while this page is a frame that is out of sight. */
export function pauseOutOfSight() {
  if (parent === window) return;
  const request = window.requestAnimationFrame.bind(window);
  let isRequested = false;
  const requestHeld = () => {
    if (!isInSight || isRequested) return;
    isRequested = true;
    request((now) => {
      isRequested = false;
      callHeld(now);
    });
  };
  window.requestAnimationFrame = (callback) => {
    last += 1;
    held.set(last, callback);
    requestHeld();
    return last;
  };
  window.cancelAnimationFrame = (id) => void held.delete(id);
  const observer = new IntersectionObserver((entries) => {
    isInSight = entries.at(-1)?.isIntersecting ?? true;
    requestHeld();
  });
  observer.observe(document.documentElement);
}
