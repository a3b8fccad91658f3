// What the browser lends, full screen and the theme of page and panels, which is remembered; and the font of both.
import { isViewer } from "./viewer.js";

const KEY = "gaitway-theme";

export const hasFullscreen = () => document.fullscreenEnabled;

export function toggleFullscreen() {
  const done = document.fullscreenElement === null ? document.documentElement.requestFullscreen() : document.exitFullscreen();
  // The browser refuses when the click was too long ago.
  done.catch(() => {});
}

/** Returns `light`, `dark` or, for the system's theme, nothing. */
export function theme() {
  // The element's own origin may be that of any site: nothing is stored there.
  if (isViewer) return "";
  try {
    return localStorage.getItem(KEY) ?? "";
  } catch {
    // No storage, as in a frame of another site.
    return "";
  }
}

/** @param {string} name */
export function setTheme(name) {
  document.documentElement.style.colorScheme = name;
  if (isViewer) return;
  try {
    localStorage.setItem(KEY, name);
  } catch {
    // It lasts as long as the page.
  }
}

/** @type {FontFace | undefined} */
let font;

/**
 * Gives the page the font of the panels. A program contains it, so it isn't downloaded twice.
 * @param {import("./types.d.ts").Bindings} program
 */
export function shareFont(program) {
  font ??= new FontFace("Gaitway", program.font());
  document.fonts.add(font);
}

document.documentElement.style.colorScheme = theme();
