// Self-contained pages that show a scene: saved by the page, opened from the disk, in a sandboxed frame and on both back ends, with
// every network request a failure.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { after, before, describe, it } from "node:test";
import { pathToFileURL } from "node:url";
import { BACK_ENDS, apply, control, pose, reportPolicyViolations, startSite, state, temporaryFolder, until, watched, whenReady } from "./browser.mjs";

/** @typedef {import("./browser.mjs").TestPage} TestPage */

const LINK = "v=1&model=sample:dwarf&motion=sample:walk&root=horizontal:in-place&t=1.2&play=0&pose=5:0:20:0&camera=30,10,3,0,1,0";

const folder = temporaryFolder("web-page");
/** @type {import("./browser.mjs").Site} */
let site;

before(async () => {
  site = await startSite();
});
after(() => site.close());

/**
 * Saves what a page shows, and returns the file's path and the size that the dialog has said.
 * @param {TestPage} page
 * @param {import("./browser.mjs").Backend} backend
 */
async function save(page, backend) {
  await control(page, "button", "Export").press("Enter");
  await control(page, "button", /web page/).press("Enter");
  const dialog = page.locator("#web-page");
  await dialog.locator(`[value=${backend}]`).check();
  await dialog.locator("#page-save:enabled").waitFor();
  const said = await dialog.locator("#page-size").textContent();
  const download = page.waitForEvent("download");
  await dialog.locator("#page-save").click();
  const saved = await download;
  assert.equal(saved.suggestedFilename(), "Dwarf.html");
  const file = path.join(folder, `${backend}.html`);
  await saved.saveAs(file);
  await dialog.waitFor({ state: "detached" });
  return { file, said };
}

/** @param {string} address */
async function opened(address) {
  const page = watched(await site.browser.newPage({ viewport: { width: 400, height: 300 } }));
  await page.addInitScript(reportPolicyViolations);
  await page.goto(address);
  return page;
}

/** @param {TestPage} page */
const outside = (page) => page.requests.filter((url) => !/^(blob|data|file):/.test(url));

describe("a saved page", () => {
  for (const renderer of BACK_ENDS) {
    it(`shows the same scene from the disk with ${renderer}`, async () => {
      const page = await site.page({ renderer: "webgl2", link: LINK });
      const [expected, view] = [await pose(page), await state(page)];
      const { file, said } = await save(page, renderer);
      await page.finish();
      const bytes = fs.statSync(file).size;
      assert.equal(said, `Size: ${(bytes / 1e6).toFixed(1)} MB`);
      const shown = await opened(pathToFileURL(file).href);
      await whenReady(shown);
      assert.equal((await shown.evaluate(() => window.gaitway.stats())).backend, renderer);
      assert.deepEqual({ ...(await pose(shown)), warnings: [] }, { ...expected, warnings: [] });
      assert.deepEqual(await state(shown), { ...view, model: ["dwarf.glb"], motion: ["walk.bvh"], embed: true });
      assert.match(await shown.title(), /Dwarf/);
      assert.deepEqual([shown.troubles, outside(shown)], [[], []]);
      await shown.finish();
    });
  }

  it("says what couldn't be made, and makes it when asked again", async () => {
    const page = await site.page({ renderer: "webgl2", link: LINK });
    await page.evaluate(() => {
      const broken = () => {
        throw new Error("none left");
      };
      const { CompressionStream, createImageBitmap } = window;
      Object.assign(window, { CompressionStream: class { constructor() { broken(); } }, createImageBitmap: broken, restored: { CompressionStream, createImageBitmap } });
    });
    await page.route(/standalone-webgl2/, (route) => route.abort());
    await control(page, "button", "Export").press("Enter");
    await control(page, "button", /web page/).press("Enter");
    const dialog = page.locator("#web-page");
    const restore = (/** @type {string} */ name) => page.evaluate((name) => void Object.assign(window, { [name]: /** @type {any} */ (window).restored[name] }), name);
    const again = () => dialog.locator("#page-save:enabled", { hasText: "Try again" });
    // One after the other, the first that fails.
    const failures = /** @type {const} */ ([
      [/^Couldn't draw the picture\. \(none left\)$/, () => restore("createImageBitmap")],
      [/^Couldn't compress the files\. \(none left\)$/, () => restore("CompressionStream")],
      [/^Couldn't download the program\. Check the connection\. \(.+\)$/, () => page.unroute(/standalone-webgl2/)],
    ]);
    const seen = new Set();
    while (seen.size < failures.length) {
      await again().waitFor();
      const said = (await dialog.locator("#page-size").textContent()) ?? "";
      const at = failures.findIndex(([message]) => message.test(said));
      assert.ok(at >= 0 && !seen.has(at), said);
      seen.add(at);
      await failures[at][1]();
      await again().click();
    }
    await dialog.locator("#page-save:enabled", { hasText: "Save" }).waitFor();
    assert.match((await dialog.locator("#page-size").textContent()) ?? "", /^Size: /);
    await page.finish();
  });

  it("allows nothing but what is inside", () => {
    const page = fs.readFileSync(path.join(folder, "webgl2.html"), "utf8");
    const policy = /Content-Security-Policy" content="([^"]*)"/.exec(page)?.[1] ?? "";
    assert.match(policy, /^default-src 'none'; script-src 'sha256-[^']+' blob: 'wasm-unsafe-eval'; style-src 'sha256-[^']+'; img-src data: blob:; connect-src blob:; worker-src blob:; base-uri 'none'; form-action 'none'$/);
  });

  it("keeps a changed view when it is reloaded", async () => {
    const page = await opened(pathToFileURL(path.join(folder, "webgl2.html")).href);
    await whenReady(page);
    await apply(page, { t: 0.5 });
    await until(page, () => location.hash.includes("t=0.5"));
    await page.reload();
    await whenReady(page);
    const { model, t } = await state(page);
    assert.deepEqual([model, t], [["dwarf.glb"], 0.5]);
    assert.deepEqual([page.troubles, outside(page)], [[], []]);
    await page.finish();
  });

  it("works in a sandboxed frame of a notebook, without an address", async () => {
    const page = watched(await site.browser.newPage({ viewport: { width: 400, height: 300 } }));
    const html = fs.readFileSync(path.join(folder, "webgl2.html"), "utf8");
    await page.setContent(`<iframe sandbox="allow-scripts" width="380" height="280" srcdoc="${html.replaceAll("&", "&amp;").replaceAll('"', "&quot;")}"></iframe>`);
    const [, frame] = page.frames();
    await whenReady(frame);
    await apply(frame, { t: 0.5 });
    assert.equal((await state(frame)).t, 0.5);
    assert.deepEqual([page.troubles, outside(page)], [[], []]);
    await page.finish();
  });
});
