// Requests the likely program before anything else. The build writes this script into the page's head: a file of its
// own would arrive as late as the style sheet.
import { likelyBackend } from "./shell/capabilities.js";
import { request } from "./shell/request.js";

if (typeof WebAssembly === "object") window.earlyRequest = request(likelyBackend());
