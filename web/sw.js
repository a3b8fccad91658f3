// Keeps the page, its program and the samples for offline use. Names contain a hash of the content, so whatever has
// such a name never changes, and is stored only if the hash is right: a proxy may answer with a page of its own. The page itself has
// a version, which this worker shares. A new version waits until a page asks for it. Requests for anything else are left alone: other
// sites, files beside the page, ranges.

/** The build sets these. */
const VERSION = "";
/** @type {string[]} */
const FILES = [];
/**
 * The files of each program. Only those that the page asks to keep are stored, since it runs one of them.
 * @type {Record<string, string[]>}
 */
const PROGRAMS = {};
/**
 * The file of each part, stored once it has been needed.
 * @type {Record<string, string[]>}
 */
const PARTS = {};

const worker = /** @type {ServiceWorkerGlobalScope} */ (/** @type {unknown} */ (self));
const { scope } = worker.registration;
const PREFIX = `gaitway ${scope} `;
const CACHE = PREFIX + VERSION;
/** What was shared with the app, until the page takes it (shell/offline.js). It belongs to no version. */
const SHARED = `gaitway-shared ${scope}`;
/** `_bg`: programs of earlier versions, whose hashes were of another kind. */
const HASHED = /-([0-9a-f]{16})(_bg)?\.\w+$/;

worker.addEventListener("install", (event) => event.waitUntil(fill()));

async function fill() {
  const cache = await caches.open(CACHE);
  const page = await fetch("./", { cache: "reload" });
  const text = await page.text();
  if (!page.ok || !text.includes(VERSION)) throw new Error("the page's version differs from this service worker's; a later visit tries again");
  // A redirected response can't answer a navigation, so the page is stored as a new one.
  await cache.put("./", new Response(text, { headers: page.headers }));
  await keep([...FILES, ...(await filesInUse())]);
  // The page of such a version may never start, and so never asks for this one.
  if (await isEarlierDamaged()) await worker.skipWaiting();
}

const earlierCaches = async () => (await caches.keys()).filter((name) => name.startsWith(PREFIX) && name !== CACHE);

/** Files of the programs and parts that earlier versions stored: without them, this version would do less offline. */
async function filesInUse() {
  const earlier = await earlierCaches();
  const stored = await Promise.all(earlier.map(async (name) => (await caches.open(name)).keys()));
  /** @param {Record<string, string[]>} table */
  const inUse = (table) => Object.keys(table).filter((name) => stored.flat().some(({ url }) => url.startsWith(`${scope}${name}-`)));
  const programs = inUse(PROGRAMS);
  // Versions with one program for both back ends don't tell which is used.
  const isUnknown = programs.length === 0 && earlier.length > 0;
  return [...(isUnknown ? Object.keys(PROGRAMS) : programs).flatMap((name) => PROGRAMS[name]), ...inUse(PARTS).flatMap((name) => PARTS[name])];
}

/** Whether an earlier version stored a file whose content differs from the hash in its name. */
async function isEarlierDamaged() {
  for (const name of await earlierCaches()) {
    const cache = await caches.open(name);
    for (const { url } of await cache.keys()) {
      const response = await cache.match(url);
      if (response !== undefined && !(await isSound(url, response))) return true;
    }
  }
  return false;
}

/**
 * Whether a file has the hash that its name says, if it says one: the beginning of its SHA-256.
 * @param {string} file
 * @param {Response} response
 */
async function isSound(file, response) {
  const [, expected, isOther] = HASHED.exec(file) ?? [];
  if (expected === undefined || isOther !== undefined) return true;
  const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", await response.clone().arrayBuffer()));
  return Array.from(digest.subarray(0, expected.length / 2), (byte) => byte.toString(16).padStart(2, "0")).join("") === expected;
}

/**
 * Returns a file with a hash in its name as any version has stored it, unless that is damaged.
 * @param {string} file
 */
async function held(file) {
  const response = await caches.match(file);
  return response !== undefined && (await isSound(file, response)) ? response : undefined;
}

/** @param {string[]} files */
async function keep(files) {
  const cache = await caches.open(CACHE);
  const keepOne = async (/** @type {string} */ file) => {
    // What has a hash in its name never changes.
    if (!HASHED.test(file) || (await cache.match(file)) === undefined) await cache.put(file, await fetched(file));
  };
  await Promise.all(files.map(keepOne));
}

/** @param {string} file */
async function fetched(file) {
  const isHashed = HASHED.test(file);
  const stored = isHashed ? await held(file) : undefined;
  if (stored !== undefined) return stored;
  // The browser's own cache may hold the damaged file.
  for (const cache of /** @type {RequestCache[]} */ (isHashed ? ["default", "reload"] : ["reload"])) {
    const response = await fetch(file, { cache });
    if (!response.ok) throw new Error(`${file}: the server answered ${response.status}`);
    if (await isSound(file, response)) return response;
  }
  throw new Error(`${file}: what the server sent has another hash`);
}

worker.addEventListener("activate", (event) => event.waitUntil(tidy()));

async function tidy() {
  await worker.clients.claim();
  // Another tab may still run the previous version; the next new version cleans up after it.
  if ((await worker.clients.matchAll({ type: "window" })).length > 1) return;
  for (const name of await caches.keys()) if (name.startsWith(PREFIX) && name !== CACHE) await caches.delete(name);
}

worker.addEventListener("message", (event) => {
  if (event.data === "use") return worker.skipWaiting();
  const files = Object.values({ ...PROGRAMS, ...PARTS }).flat();
  // A page of another version names files that this worker doesn't know.
  event.waitUntil(keep(event.data.keep.filter((/** @type {string} */ file) => files.includes(file))));
});

worker.addEventListener("fetch", (event) => {
  const { method, mode, url, headers } = event.request;
  if (method === "POST" && mode === "navigate" && url === `${scope}share`) return event.respondWith(share(event.request));
  if (method !== "GET" || !url.startsWith(scope) || headers.has("range")) return;
  const path = url.slice(scope.length).split(/[?#]/)[0];
  if (mode === "navigate" ? path === "" || path === "index.html" : FILES.includes(path) || HASHED.test(path))
    event.respondWith(answer(event.request, mode === "navigate" ? "./" : path));
});

/**
 * Keeps what another app shares (`share_target` in the manifest) and leads to the page, which opens it.
 * @param {Request} request
 */
async function share(request) {
  // What can't be read is as good as nothing: the page says so.
  const form = await request.formData().catch(() => new FormData());
  await caches.delete(SHARED);
  const cache = await caches.open(SHARED);
  const files = form.getAll("files").filter((file) => file instanceof File);
  for (const [index, file] of files.entries()) await cache.put(`shared/${index}`, new Response(file, { headers: { "x-name": encodeURIComponent(file.name) } }));
  // Apps put a URL in either.
  const text = ["url", "text"].map((name) => form.get(name) ?? "").join("\n");
  if (files.length === 0) await cache.put("shared/text", new Response(text));
  return Response.redirect(`${scope}?shared`, 303);
}

/**
 * @param {Request} request
 * @param {string} path
 */
async function answer(request, path) {
  const cache = await caches.open(CACHE);
  return (await cache.match(path)) ?? (await held(path)) ?? (await fetch(request));
}
