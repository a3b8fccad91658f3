// What stays after a visit: the page and its samples without a network, and new versions that wait until they are wanted.
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import { readScenes } from "../../xtask/site/samples.mjs";
import { BACK_ENDS, VIEWPORT, dist, launch, state, until, whenReady } from "./browser.mjs";
import { serve } from "./server.mjs";

const FOLDER = "/some/folder/";

/** Waits until everything is kept. */
const whenKept = (page) =>
  until(page, async () => {
    const registration = await navigator.serviceWorker.getRegistration();
    return registration?.active?.state === "activated" && navigator.serviceWorker.controller !== null;
  });

describe("after a visit", () => {
  let browser, folder;
  before(async () => {
    browser = await launch();
    folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-site-"));
  });
  after(async () => {
    await browser?.close();
    if (folder !== undefined) fs.rmSync(folder, { recursive: true });
  });

  async function visit(address) {
    const context = await browser.newContext({ viewport: VIEWPORT });
    const page = await context.newPage();
    page.troubles = [];
    page.on("pageerror", (error) => page.troubles.push(error.message));
    page.on("console", (message) => message.type() === "error" && page.troubles.push(message.text()));
    await page.goto(address);
    await whenReady(page);
    await whenKept(page);
    return { context, page };
  }

  for (const renderer of BACK_ENDS)
    test(`the page and every scene work without a network (${renderer})`, async () => {
      const site = await serve({ [FOLDER]: dist });
      const address = `${site.origin}${FOLDER}`;
      const { context, page } = await visit(`${address}?renderer=${renderer}`);
      await site.close();
      for (const [index, { name, link }] of readScenes().entries()) {
        // The first as somebody comes, the others from their links.
        const offline = await context.newPage();
        await offline.goto(`${address}?renderer=${renderer}${index === 0 ? "" : `#${link}`}`);
        await whenReady(offline);
        assert.deepEqual([(await state(offline)).model].flat(), new URLSearchParams(link).getAll("model"), name);
        assert.equal(await offline.locator("#missing").isVisible(), false, `${name}: nothing should be missing`);
        await offline.close();
      }
      assert.deepEqual(page.troubles, []);
      await context.close();
    });

  test("a new version is offered and waits", async () => {
    // Without the compressed copies, which would not be the new version.
    fs.cpSync(dist, folder, { recursive: true, filter: (file) => !/\.(br|gz)$/.test(file) });
    const site = await serve({ [FOLDER]: folder }, { "cache-control": "no-cache" });
    const { context, page } = await visit(`${site.origin}${FOLDER}#model=sample:walker&play=0`);
    assert.equal(await page.locator("#update").isVisible(), false);
    const file = (name) => path.join(folder, name);
    const [, version] = fs.readFileSync(file("index.html"), "utf8").match(/name="gaitway-version" content="([0-9a-f]+)"/);
    const next = "0123456789abcdef";
    for (const name of ["index.html", "sw.js"]) fs.writeFileSync(file(name), fs.readFileSync(file(name), "utf8").replaceAll(version, next));
    const shown = () => page.evaluate(() => document.querySelector('meta[name="gaitway-version"]').content);
    await page.reload();
    await whenReady(page);
    assert.equal(await shown(), version, "what was there is shown at once");
    await page.locator("#update").waitFor({ state: "visible" });
    await page.locator("#update-later").click();
    assert.equal(await page.locator("#update").isVisible(), false);
    assert.equal(await shown(), version);
    await page.reload();
    await whenReady(page);
    await page.locator("#update").waitFor({ state: "visible" });
    assert.equal(await shown(), version, "nobody is taken away from anything");
    await page.locator("#update-use").click();
    await until(page, (next) => document.querySelector('meta[name="gaitway-version"]')?.content === next, next);
    await whenReady(page);
    assert.match(await page.evaluate(() => location.hash), /model=sample:walker/, "the view stays");
    assert.equal((await page.evaluate(() => caches.keys())).length, 1, "the version before is gone");
    assert.deepEqual(page.troubles, []);
    await context.close();
    await site.close();
  });

  test("other sites, parts of files and frames are left alone", async () => {
    const site = await serve({ [FOLDER]: dist });
    const other = await serve({ [FOLDER]: dist }, { "access-control-allow-origin": "*" });
    const { context, page } = await visit(`${site.origin}${FOLDER}`);
    const kept = await page.evaluate(async () => (await (await caches.open((await caches.keys())[0])).keys()).map(({ url }) => url));
    const address = kept.find((url) => url.endsWith(".webp")) ?? kept.find((url) => url.endsWith(".svg"));
    const fromWorker = async (url, headers) => {
      const [response] = await Promise.all([page.waitForResponse(url), page.evaluate(async ([url, headers]) => void (await (await fetch(url, { headers })).blob()), [url, headers])]);
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
    const frameContext = await browser.newContext({ viewport: VIEWPORT });
    const framing = await frameContext.newPage();
    await framing.goto(outside.origin);
    const frame = framing.frames()[1];
    await until(frame, () => window.gaitway !== undefined);
    await frame.evaluate(async () => await window.gaitway.ready);
    await framing.waitForTimeout(500);
    assert.deepEqual(await frame.evaluate(async () => (await navigator.serviceWorker.getRegistrations()).length), 0);
    await frameContext.close();
    for (const server of [site, other, outside]) await server.close();
    fs.rmSync(around, { recursive: true });
  });
});
