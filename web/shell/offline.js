// The page as an installed app: it works offline after the first visit (sw.js), announces new versions, and opens files
// that the system hands it.
import { refuse } from "./changes.js";
import { button, byId } from "./dom.js";
import { isEnclosed } from "./enclosed.js";
import { openByHand } from "./opening.js";
import { program } from "./running.js";
import { urlWithin } from "./urls.js";

/** @typedef {import("./types.d.ts").NamedFile} NamedFile */

/** In a frame of another site nobody visits this page, so nothing is stored; a sandboxed one may not even ask. A saved page has all of it. */
const isStored = parent === window && "serviceWorker" in navigator && !isEnclosed();

export function install() {
  window.launchQueue?.setConsumer(async ({ files }) => openByHand(await Promise.all(files.map((handle) => handle.getFile()))));
  if (new URLSearchParams(location.search).has("shared")) openShared();
  // Don't delay the first image.
  if (isStored) program.started.then(register, register);
}

/** Opens what another app has shared, which the service worker keeps until then. Only once: a reload doesn't open it again. */
async function openShared() {
  const address = new URL(location.href);
  address.searchParams.delete("shared");
  history.replaceState(history.state, "", address);
  const name = `gaitway-shared ${new URL("./", location.href)}`;
  const cache = await caches.open(name);
  const items = await Promise.all((await cache.keys()).map(async (key) => sharedItems(await cache.match(key))));
  await caches.delete(name);
  if (items.flat().length > 0) openByHand(items.flat());
  else refuse("What was shared has no file or URL that Gaitway could open.");
}

/**
 * @param {Response | undefined} response
 * @returns {Promise<(string | NamedFile)[]>}
 */
async function sharedItems(response) {
  if (response === undefined) return [];
  const name = response.headers.get("x-name");
  if (name !== null) return [{ name: decodeURIComponent(name), content: await response.blob() }];
  const url = urlWithin(await response.text());
  return url === undefined ? [] : [url];
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
