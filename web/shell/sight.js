// A frame that is out of sight draws nothing. Browsers stop the animation frames of another origin's frame then, but not those of one
// from the page's own origin. Both are alike here: animation frames wait until the frame is back in sight, unless somebody waits for an
// answer, such as a screenshot.

/** About as long as an animation frame, for those that can't be had from the browser. */
const FRAME_MS = 16;

let isInSight = true;
/** How many answers are awaited. */
let awaited = 0;

/**
 * What was requested out of sight, by the identifiers that were returned: negative ones, unlike the browser's.
 * @type {Map<number, FrameRequestCallback>}
 */
const held = new Map();
let last = 0;

function callHeld() {
  const now = performance.now();
  // What they request belongs to the next frame.
  for (const id of [...held.keys()]) {
    const callback = held.get(id);
    held.delete(id);
    callback?.(now);
  }
}

/** @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

function callSoonIfAwaited() {
  if (isInSight || awaited === 0 || timer !== undefined) return;
  timer = setTimeout(() => {
    timer = undefined;
    if (awaited > 0) callHeld();
    callSoonIfAwaited();
  }, FRAME_MS);
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
  const [request, cancel] = [window.requestAnimationFrame.bind(window), window.cancelAnimationFrame.bind(window)];
  window.requestAnimationFrame = (callback) => {
    if (isInSight) return request(callback);
    last -= 1;
    held.set(last, callback);
    return last;
  };
  window.cancelAnimationFrame = (id) => void (held.delete(id) || cancel(id));
  const observer = new IntersectionObserver((entries) => {
    isInSight = entries.at(-1)?.isIntersecting ?? true;
    if (isInSight) request(callHeld);
    else callSoonIfAwaited();
  });
  observer.observe(document.documentElement);
}
