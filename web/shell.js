// The page around the canvas. It owns what must outlive a crash: the files that were dropped or chosen, the link of the
// view, the messages, and `window.gaitway`. The build bundles this file with the modules in shell/.
import { addBenches, gaitway } from "./shell/api.js";
import { forcedBackend } from "./shell/capabilities.js";
import { button } from "./shell/dom.js";
import "./shell/drop.js";
import { answerParent } from "./shell/embed.js";
import { showGallery } from "./shell/gallery.js";
import { launch } from "./shell/instance.js";
import { install } from "./shell/offline.js";
import { showOpenDialog } from "./shell/open-dialog.js";
import { session } from "./shell/session.js";
import { share } from "./shell/share.js";

window.gaitway = gaitway;

// Buttons for keyboards and screen readers, which the canvas doesn't serve, and the gallery's first cards.
for (const id of ["do-open", "gallery-own"]) button(id).addEventListener("click", () => showOpenDialog());
button("gallery-borrow").addEventListener("click", () => showOpenDialog("motion"));
button("do-play").addEventListener("click", async () => {
  const { play } = await gaitway.state();
  await gaitway.apply({ play: !play });
});
button("do-share").addEventListener("click", () => share(session.link));
button("do-samples").addEventListener("click", showGallery);

launch(forcedBackend()).then(addBenches, () => {});
answerParent();
install();
