// The page as something to install: it works without a network after the first visit (sw.js), says when there is a new
// version, and opens the files that the system hands it.

const byId = (id) => document.getElementById(id);

addEventListener(
  "gaitway:shell",
  ({ detail: { openByHand } }) => {
    globalThis.launchQueue?.setConsumer(async ({ files }) => {
      const opened = await Promise.all(files.map((handle) => handle.getFile()));
      openByHand(opened);
    });
    // Inside another site's page nobody visits this one, and keeping it would be at their cost.
    if (parent !== window || !("serviceWorker" in navigator)) return;
    // What is on the screen comes first.
    window.gaitway.ready.then(keep, keep);
  },
  { once: true },
);

async function keep() {
  // Not over https, switched off, or not there: the page works without.
  const registration = await navigator.serviceWorker.register("sw.js", { scope: "./" }).catch(() => undefined);
  if (registration === undefined) return;
  // At the first visit there is nothing older than what is kept.
  const offerWhenReady = (worker) => worker?.state === "installed" && navigator.serviceWorker.controller !== null && offer(worker);
  offerWhenReady(registration.waiting);
  registration.addEventListener("updatefound", () => {
    const { installing } = registration;
    installing.addEventListener("statechange", () => offerWhenReady(installing));
  });
}

function offer(worker) {
  byId("update").hidden = false;
  byId("update-later").onclick = () => (byId("update").hidden = true);
  byId("update-use").onclick = () => {
    navigator.serviceWorker.addEventListener("controllerchange", () => location.reload(), { once: true });
    worker.postMessage("use");
  };
}
