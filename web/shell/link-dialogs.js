// The dialogs about a link: which of its files the user has to bring, and what of it couldn't be loaded.
import { button, byId, dialog, field, focusCanvas, showDialog, showList } from "./dom.js";
import { openByHand } from "./opening.js";
import { panel, reportProblem, sayProblem } from "./panels.js";
import { performs, send } from "./session.js";
import { allowsFiles, isViewer } from "./viewer.js";

performs({
  ask({ files, others, isOwn }) {
    if (panel() !== null || dialog("bring").open || !allowsFiles) return;
    showList("bring-files", files);
    byId("bring-others").hidden = others === null;
    byId("bring-others").textContent = others === null ? "" : `${others} couldn't be opened.`;
    byId("bring-again").hidden = !isOwn;
    byId("bring-sender").hidden = isOwn;
    showDialog("bring", button("bring-choose"));
  },
  closeAsk: () => dialog("bring").close(),
  report({ problems, title, rest, without }) {
    dialog("missing").close();
    sayProblem(problems.join(" "));
    showList("missing-parts", problems);
    byId("missing-title").textContent = title;
    byId("missing-rest").textContent = rest;
    byId("missing-continue").textContent = without;
    reportProblem(problems.join(" "));
    if (panel() === null && !isViewer) showDialog("missing", button("missing-again"));
  },
  closeReport: () => dialog("missing").close(),
});

button("bring-choose").addEventListener("click", () => field("bring-chosen").click());
field("bring-chosen").addEventListener("change", () => {
  const files = [...(field("bring-chosen").files ?? [])];
  // Choosing them again is a change, too.
  field("bring-chosen").value = "";
  openByHand(files);
});
// Not on `close`, which Chromium reports a frame later, when this dialog may be open again.
button("bring-later").addEventListener("click", () => send({ event: "later" }));
// Escape. The event of a cancelled file chooser bubbles up to here, too.
dialog("bring").addEventListener("cancel", ({ target, currentTarget }) => target === currentTarget && send({ event: "later" }));
dialog("bring").addEventListener("close", () => document.activeElement === document.body && focusCanvas());
button("missing-again").addEventListener("click", () => {
  dialog("missing").close();
  send({ event: "tryAgain" });
});
