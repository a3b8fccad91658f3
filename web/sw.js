// Keeps the page, its program and the samples for when there is no network. Names have a hash of their content in them, so
// what has such a name never changes; the page itself comes in one version with this worker. A new version waits until a
// page asks for it. What is not part of Gaitway is none of its business: other sites, files beside the page, parts of files.

/** Both are written by the build. */
const VERSION = "";
const FILES = [];

const OF_HERE = `gaitway ${registration.scope} `;
const CACHE = OF_HERE + VERSION;
const HASHED = /-[0-9a-f]{16}(_bg)?\.\w+$/;

addEventListener("install", (event) => event.waitUntil(fill()));

async function fill() {
  const cache = await caches.open(CACHE);
  const page = await fetch("./", { cache: "reload" });
  const text = await page.clone().text();
  if (!page.ok || !text.includes(VERSION)) throw new Error("the page is of another version than this service worker; a later visit tries again");
  await cache.put("./", page);
  await Promise.all(FILES.map(async (file) => cache.put(file, await fetched(file))));
}

async function fetched(file) {
  const isHashed = HASHED.test(file);
  const held = isHashed ? await caches.match(file) : undefined;
  if (held !== undefined) return held;
  const response = await fetch(file, { cache: isHashed ? "default" : "reload" });
  if (!response.ok) throw new Error(`${file}: the server answered ${response.status}`);
  return response;
}

addEventListener("activate", (event) => event.waitUntil(tidy()));

async function tidy() {
  await clients.claim();
  // Another page may still run the version before; the next new version tidies up after it.
  if ((await clients.matchAll({ type: "window" })).length > 1) return;
  for (const name of await caches.keys()) if (name.startsWith(OF_HERE) && name !== CACHE) await caches.delete(name);
}

addEventListener("message", ({ data }) => data === "use" && skipWaiting());

addEventListener("fetch", (event) => {
  const { method, mode, url, headers } = event.request;
  if (method !== "GET" || !url.startsWith(registration.scope) || headers.has("range")) return;
  const path = url.slice(registration.scope.length).split(/[?#]/)[0];
  if (mode === "navigate" ? path === "" || path === "index.html" : FILES.includes(path) || HASHED.test(path))
    event.respondWith(answer(event.request, mode === "navigate" ? "./" : path));
});

async function answer(request, path) {
  const cache = await caches.open(CACHE);
  return (await cache.match(path)) ?? (await caches.match(path)) ?? (await fetch(request));
}
