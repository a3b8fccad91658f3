// Takes the place of web/sw.js where the page reloads itself after a change, so that it is always the latest: removes what an
// earlier page at the same address has stored, and then itself.
const worker = /** @type {ServiceWorkerGlobalScope} */ (/** @type {unknown} */ (self));

worker.addEventListener("install", () => worker.skipWaiting());
worker.addEventListener("activate", (event) => event.waitUntil(remove()));

async function remove() {
  const stored = (await caches.keys()).filter((name) => name.startsWith(`gaitway ${worker.registration.scope} `));
  for (const name of stored) await caches.delete(name);
  await worker.registration.unregister();
  if (stored.length === 0) return;
  // They came from there.
  for (const page of await worker.clients.matchAll({ type: "window" })) await page.navigate(page.url);
}
