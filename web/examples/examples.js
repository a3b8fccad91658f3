// The example of a script on the page of live examples.

const byId = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @param {string} text */
const log = (text) => void (byId("log").textContent = text);

// Shown on the page.
const viewer = /** @type {import("../../npm/viewer/gaitway.d.ts").GaitwayViewer} */ (byId("scripted"));

viewer.addEventListener("progress", ({ detail }) => log(`Loading: ${Math.round(100 * detail.progress)} %`));
viewer.addEventListener("load", () => log(`Shown: ${viewer.model}`));
viewer.addEventListener("error", ({ detail }) => log(`${detail.code}: ${detail.message}`));

byId("pause").onclick = () => viewer.pause();
byId("weights").onclick = () => viewer.apply({ show: "weights", joint: 9 });
const pilot = { model: "sample:pilot", clip: "idle", alt: "A pilot" };
const goblin = { model: "sample:morphs", clip: "expressions", alt: "A goblin" };
byId("other").onclick = () => Object.assign(viewer, viewer.model === pilot.model ? goblin : pilot);
byId("link").onclick = async () => log(await viewer.toLink());
