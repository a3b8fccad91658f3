// Clears what this browser has stored of the page, for one that doesn't start: a damaged file would stay there.

/** Removes the service worker and its files, downloads the page's files again past the browser's cache, and reloads the page. */
export async function clearAndReload() {
  // Some frames may not even ask what is stored.
  await clearStored().catch(() => {});
  const files = document.head.innerHTML.match(/(?<![/\w-])[\w-]+-[0-9a-f]{16}\.\w+/g) ?? [];
  await Promise.allSettled(files.map((file) => fetch(file, { cache: "reload" })));
  location.reload();
}

async function clearStored() {
  const folder = new URL("./", location.href).href;
  // The prefix is the service worker's (sw.js); other pages of this site have caches of their own.
  for (const name of await caches.keys()) if (name.startsWith(`gaitway ${folder} `)) await caches.delete(name);
  await (await navigator.serviceWorker.getRegistration())?.unregister();
}
