// After a first visit, the page and its samples work offline, and a new version waits until the user accepts it.
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import { linkOf, readScenes } from "../../xtask/site/samples.mjs";
import { serve } from "../../xtask/site/server.mjs";
import { dataFile, dist, skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, PIXEL_RATIO, VIEWPORT, launch, state, until, watched, whenReady } from "./browser.mjs";

const FOLDER = "/some/folder/";

/**
 * Waits until everything is stored, the running program last.
 * @param {import("playwright-core").Page} page
 */
const whenStored = (page) =>
  until(page, async () => {
    const registration = await navigator.serviceWorker.getRegistration();
    if (registration?.active?.state !== "activated" || navigator.serviceWorker.controller === null) return false;
    const { script, wasm } = JSON.parse(document.querySelector('meta[name="gaitway-programs"]')?.getAttribute("content") ?? "{}")[(await window.gaitway.stats()).backend];
    return (await caches.match(script)) !== undefined && (await caches.match(wasm)) !== undefined;
  });

/**
 * Lists the stored programs.
 * @param {import("playwright-core").Page} page
 */
const storedPrograms = (page) =>
  page.evaluate(async () => {
    const files = await Promise.all((await caches.keys()).map(async (name) => (await caches.open(name)).keys()));
    return files.flat().flatMap(({ url }) => url.match(/(webgpu|webgl2)-[0-9a-f]{16}\.wasm$/)?.[1] ?? []);
  });

/**
 * Copies the page, without the compressed copies, which would stay at the old version.
 * @param {string} folder
 */
const copyTo = (folder) => fs.cpSync(dist, folder, { recursive: true, filter: (file) => !/\.(br|gz)$/.test(file) });

/**
 * Makes a folder's page another version. Returns that.
 * @param {string} folder
 */
function renameVersion(folder) {
  const [index, worker] = ["index.html", "sw.js"].map((name) => path.join(folder, name));
  const [, version] = fs.readFileSync(index, "utf8").match(/name="gaitway-version" content="([0-9a-f]+)"/) ?? [];
  const next = "0123456789abcdef";
  for (const file of [index, worker]) fs.writeFileSync(file, fs.readFileSync(file, "utf8").replaceAll(version, next));
  return next;
}

/** @param {import("playwright-core").Page} page */
const shownVersion = (page) => page.evaluate(() => document.querySelector('meta[name="gaitway-version"]')?.getAttribute("content"));

describe("after a visit", () => {
  /** @type {import("./browser.mjs").Browser} */
  let browser;
  /** @type {string} */
  let folder;
  before(async () => {
    browser = await launch({ isOffScreen: true });
    folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-site-"));
  });
  after(async () => {
    await browser?.close();
    if (folder !== undefined) fs.rmSync(folder, { recursive: true });
  });

  /** @param {string} address */
  async function visit(address) {
    // Nothing moves: frames that nobody sees would queue up.
    const context = await browser.newContext({ viewport: VIEWPORT, deviceScaleFactor: PIXEL_RATIO, reducedMotion: "reduce" });
    const page = watched(await context.newPage());
    await page.goto(address);
    await whenReady(page);
    await whenStored(page);
    return { context, page };
  }

  for (const renderer of BACK_ENDS)
    test(`the page and every scene work offline (${renderer})`, async () => {
      const site = await serve({ [FOLDER]: dist });
      const address = `${site.origin}${FOLDER}`;
      const { context, page } = await visit(`${address}?renderer=${renderer}`);
      assert.deepEqual(await storedPrograms(page), [renderer], "only the program that runs");
      await site.close();
      for (const [index, scene] of readScenes().entries()) {
        // The first as on a first visit, the others from their links.
        const offline = await context.newPage();
        await offline.goto(`${address}?renderer=${renderer}${index === 0 ? "" : `#${linkOf(scene)}`}`);
        await whenReady(offline);
        assert.deepEqual((await state(offline)).model, [scene.model], scene.name);
        assert.equal(await offline.locator("#missing").isVisible(), false, `${scene.name}: nothing should be missing`);
        await offline.close();
      }
      assert.deepEqual(page.troubles, []);
      await context.close();
    });

  for (const renderer of BACK_ENDS)
    test(`a part that was used works offline (${renderer})`, { skip: skipWithoutData }, async () => {
      const site = await serve({ [FOLDER]: dist });
      const { context, page } = await visit(`${site.origin}${FOLDER}?renderer=${renderer}`);
      const base64 = fs.readFileSync(dataFile("compressed/Fox-gltfpack-meshopt.glb"), "base64");
      /** @param {import("playwright-core").Page} page */
      const openFox = (page) =>
        page.evaluate(async (base64) => {
          const fox = await fetch(`data:model/gltf-binary;base64,${base64}`);
          return (await window.gaitway.open({ "fox.glb": await fox.arrayBuffer() })).joints;
        }, base64);
      const joints = await openFox(page);
      const stored = () => JSON.parse(document.querySelector('meta[name="gaitway-parts"]')?.getAttribute("content") ?? "{}").meshopt;
      await until(page, async (file) => (await caches.match(file)) !== undefined, await page.evaluate(stored));
      await site.close();
      const offline = await context.newPage();
      await offline.goto(page.url());
      await whenReady(offline);
      assert.deepEqual(await openFox(offline), joints);
      await context.close();
    });

  for (const renderer of BACK_ENDS)
    test(`a new version is offered and waits (${renderer})`, async () => {
      copyTo(folder);
      const site = await serve({ [FOLDER]: folder }, { "cache-control": "no-cache" });
      const { context, page } = await visit(`${site.origin}${FOLDER}?renderer=${renderer}#model=sample:walker&play=0`);
      assert.equal(await page.locator("#update").isVisible(), false);
      const shown = () => shownVersion(page);
      const version = await shown();
      const next = renameVersion(folder);
      await page.reload();
      await whenReady(page);
      assert.equal(await shown(), version, "the stored version is shown at once");
      await page.locator("#update").waitFor({ state: "visible" });
      await page.locator("#update-later").click();
      assert.equal(await page.locator("#update").isVisible(), false);
      assert.equal(await shown(), version);
      await page.reload();
      await whenReady(page);
      await page.locator("#update").waitFor({ state: "visible" });
      assert.equal(await shown(), version, "nobody is interrupted");
      await page.locator("#update-use").click();
      await until(page, (next) => document.querySelector('meta[name="gaitway-version"]')?.getAttribute("content") === next, next);
      await whenReady(page);
      assert.match(await page.evaluate(() => location.hash), /model=sample:walker/, "the view stays");
      assert.equal((await page.evaluate(() => caches.keys())).length, 1, "the previous version is gone");
      assert.deepEqual(await storedPrograms(page), [renderer], "the new version has the program without another visit");
      assert.deepEqual(page.troubles, []);
      await context.close();
      await site.close();
    });

  /** What a proxy answers to any request. */
  const PROXY_PAGE = "<!doctype html><title>Sign in</title>";

  /**
   * Stores a proxy's page as the shell's script, as service workers did that compared no hashes.
   * @param {import("playwright-core").Page} page
   */
  const damageShell = (page) =>
    page.evaluate(async (text) => {
      const script = /** @type {HTMLScriptElement} */ (document.querySelector('script[type="module"]')).src;
      await (await caches.open((await caches.keys())[0])).put(script, new Response(text, { headers: { "content-type": "text/javascript" } }));
    }, PROXY_PAGE);

  test("a page whose stored script is damaged can be cleared and then starts", async () => {
    const site = await serve({ [FOLDER]: dist });
    const { context, page } = await visit(`${site.origin}${FOLDER}#model=sample:walker&play=0`);
    await damageShell(page);
    await page.reload();
    await page.locator("#not-started").waitFor({ state: "visible" });
    assert.equal(await page.locator("#loading").isVisible(), false);
    await page.locator("#not-started-clear").click();
    await until(page, () => "gaitway" in window);
    await whenReady(page);
    await whenStored(page);
    await context.close();
    await site.close();
  });

  test("a new version takes over from one that doesn't start, without its damaged script", async () => {
    copyTo(folder);
    const site = await serve({ [FOLDER]: folder }, { "cache-control": "no-cache" });
    const { context, page } = await visit(`${site.origin}${FOLDER}#model=sample:walker&play=0`);
    await damageShell(page);
    const next = renameVersion(folder);
    await page.reload();
    await until(page, async (next) => (await caches.keys()).length === 1 && (await caches.keys())[0].endsWith(next), next);
    await page.reload();
    await whenReady(page);
    assert.equal(await shownVersion(page), next);
    await context.close();
    await site.close();
  });

  test("what the server sends under another file's name isn't stored", async () => {
    copyTo(folder);
    const sample = fs.readdirSync(path.join(folder, "samples")).find((name) => name.startsWith("pilot-")) ?? "";
    const damaged = path.join(folder, "samples", sample);
    const content = fs.readFileSync(damaged);
    fs.writeFileSync(damaged, PROXY_PAGE);
    const site = await serve({ [FOLDER]: folder }, { "cache-control": "no-cache" });
    const context = await browser.newContext({ viewport: VIEWPORT, deviceScaleFactor: PIXEL_RATIO, reducedMotion: "reduce" });
    const page = await context.newPage();
    await page.goto(`${site.origin}${FOLDER}#model=sample:walker&play=0`);
    await whenReady(page);
    // The worker is given up.
    await until(page, async () => (await caches.keys()).length > 0 && (await navigator.serviceWorker.getRegistration()) === undefined);
    assert.equal(await page.evaluate((url) => caches.match(url).then((response) => response === undefined), `samples/${sample}`), true);
    fs.writeFileSync(damaged, content);
    await page.reload();
    await whenReady(page);
    await whenStored(page);
    await context.close();
    await site.close();
  });

  // Tests only the worker's URL rules, which don't depend on the program.
  test("other sites, ranges and frames are left alone", async () => {
    const site = await serve({ [FOLDER]: dist });
    const other = await serve({ [FOLDER]: dist }, { "access-control-allow-origin": "*" });
    const { context, page } = await visit(`${site.origin}${FOLDER}`);
    const stored = await page.evaluate(async () => (await (await caches.open((await caches.keys())[0])).keys()).map(({ url }) => url));
    const address = stored.find((url) => url.endsWith(".webp")) ?? stored.find((url) => url.endsWith(".svg")) ?? "";
    /** @type {(url: string, headers: Record<string, string>) => Promise<boolean>} */
    const fromWorker = async (url, headers) => {
      const [response] = await Promise.all([page.waitForResponse(url), page.evaluate(async ({ url, headers }) => void (await (await fetch(url, { headers })).blob()), { url, headers })]);
      return response.fromServiceWorker();
    };
    assert.equal(await fromWorker(address, {}), true);
    assert.equal(await fromWorker(address, { range: "bytes=0-9" }), false);
    assert.equal(await fromWorker(address.replace(site.origin, other.origin), {}), false);
    assert.equal(await fromWorker(`${site.origin}${FOLDER}sw.js`, {}), false);
    await context.close();
    const around = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-frame-"));
    fs.writeFileSync(path.join(around, "index.html"), `<!doctype html><title>around</title><iframe src="${site.origin}${FOLDER}#model=sample:walker&embed=1"></iframe>`);
    const outside = await serve({ "/": around });
    const frameContext = await browser.newContext({ viewport: VIEWPORT, deviceScaleFactor: PIXEL_RATIO });
    const framing = await frameContext.newPage();
    await framing.addInitScript(() => {
      navigator.serviceWorker.register = async () => {
        document.documentElement.dataset.registered = "";
        throw new Error("a frame needs no service worker");
      };
    });
    await framing.goto(outside.origin);
    const frame = framing.frames()[1];
    await whenReady(frame);
    // The first image would trigger registration.
    await frame.evaluate(() => new Promise(requestAnimationFrame));
    assert.equal(await frame.evaluate(() => document.documentElement.dataset.registered), undefined);
    await frameContext.close();
    for (const server of [site, other, outside]) await server.close();
    fs.rmSync(around, { recursive: true });
  });
});
