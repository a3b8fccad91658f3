// The page as an installed app: it works offline after the first visit (sw.js), announces new versions, and opens files
// that the system hands it.
import { button, byId } from "./dom.js";
import { openByHand } from "./opening.js";
import { program } from "./running.js";

/** In a frame of another site nobody visits this page, so nothing is stored; a sandboxed one may not even ask. */
const isStored = parent === window && "serviceWorker" in navigator;

export function install() {
  window.launchQueue?.setConsumer(async ({ files }) => openByHand(await Promise.all(files.map((handle) => handle.getFile()))));
  // Don't delay the first image.
  if (isStored) program.started.then(register, register);
}

/**
 * Has the service worker store files of the program that runs.
 * @param {string[]} files
 */
export async function keepOffline(files) {
  if (!isStored) return;
  // `ready` never resolves if there is no service worker.
  const { active } = await navigator.serviceWorker.ready;
  active?.postMessage({ keep: files });
}

async function register() {
  // Without HTTPS, or with service workers turned off, the page works all the same.
  const registration = await navigator.serviceWorker.register("sw.js", { scope: "./" }).catch(() => undefined);
  if (registration === undefined) return;
  /** @param {ServiceWorker | null} worker On a first visit there is no older version. */
  const offerIfReady = (worker) => worker?.state === "installed" && navigator.serviceWorker.controller !== null && offer(worker);
  offerIfReady(registration.waiting);
  /** @param {ServiceWorker | null} worker */
  const watch = (worker) => worker?.addEventListener("statechange", () => offerIfReady(worker));
  // The browser may have found one by itself.
  watch(registration.installing);
  registration.addEventListener("updatefound", () => watch(registration.installing));
}

/** @param {ServiceWorker} worker */
function offer(worker) {
  byId("update").hidden = false;
  button("update-later").onclick = () => (byId("update").hidden = true);
  button("update-use").onclick = () => {
    // Another tab may have activated it already.
    if (worker.state !== "installed") return location.reload();
    navigator.serviceWorker.addEventListener("controllerchange", () => location.reload(), { once: true });
    worker.postMessage("use");
  };
}
