// Requests the likely program before anything else, and says so if the page doesn't start. The build writes this script into the
// page's head: a file of its own would arrive as late as the style sheet, and could be what is damaged.
import { likelyBackend } from "./shell/capabilities.js";
import { clearAndReload } from "./shell/clear.js";
import { request } from "./shell/request.js";

if (typeof WebAssembly === "object") window.earlyRequest = request(likelyBackend());

// The shell has run by now, unless its script is missing or damaged.
addEventListener("DOMContentLoaded", () => {
  if ("gaitway" in window) return;
  for (const panel of document.querySelectorAll(".panel")) /** @type {HTMLElement} */ (panel).hidden = panel.id !== "not-started";
  document.getElementById("not-started-clear")?.addEventListener("click", clearAndReload);
});
