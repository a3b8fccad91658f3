// The page around the canvas. It owns what must outlive a crash: the files that were dropped or chosen, the link of the
// view, the messages, and `window.gaitway`. The build bundles this file with the modules in shell/.
import { addBenches, gaitway } from "./shell/api.js";
import { forcedBackend } from "./shell/capabilities.js";
import { button, byId } from "./shell/dom.js";
import "./shell/drop.js";
import { answerParent } from "./shell/embed.js";
import { launch } from "./shell/instance.js";
import "./shell/link-dialogs.js";
import { install } from "./shell/offline.js";
import { showOpenDialog } from "./shell/open-dialog.js";
import "./shell/paste.js";
import { shareScrolling } from "./shell/scrolling.js";
import "./shell/share.js";
import { pauseOutOfSight } from "./shell/sight.js";

window.gaitway = gaitway;

button("gallery-own").addEventListener("click", () => showOpenDialog());
button("gallery-borrow").addEventListener("click", () => showOpenDialog("motion"));

// Chrome's emulation of other devices still counts the pixels of the real one here, by which egui sizes its canvas: everything would
// be too large. Without the property, egui multiplies.
new ResizeObserver(([{ contentBoxSize, devicePixelContentBoxSize }]) => {
  const difference = devicePixelContentBoxSize?.[0].inlineSize - contentBoxSize[0].inlineSize * devicePixelRatio;
  if (Math.abs(difference) > 2) Reflect.deleteProperty(ResizeObserverEntry.prototype, "devicePixelContentBoxSize");
}).observe(byId("stage"));

pauseOutOfSight();
// Before anything can fail.
answerParent();
launch(forcedBackend()).then(addBenches, () => {});
shareScrolling();
install();
