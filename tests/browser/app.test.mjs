// The page as an app: what is pasted, what other apps share with it, and what lies over the viewport meanwhile.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { serve } from "../../xtask/site/server.mjs";
import { dist } from "../three/data.mjs";
import { triangle } from "../three/triangle.mjs";
import { BACK_ENDS, VIEWPORT, centreOf, control, eventually, launch, startSite, state, until, watched, whenModel, whenReady } from "./browser.mjs";

/** @typedef {import("./browser.mjs").TestPage} TestPage */

const REMOTE = "https://files.example/own.gltf";

/**
 * Pastes as Ctrl+V does.
 * @param {TestPage} page
 * @param {{ text?: string, files?: string[] }} clipboard Names of files.
 */
const paste = (page, { text, files = [] }) =>
  page.evaluate(
    ({ text, files, content }) => {
      const clipboardData = new DataTransfer();
      if (text !== undefined) clipboardData.setData("text/plain", text);
      for (const name of files) clipboardData.items.add(new File([content], name));
      const event = new ClipboardEvent("paste", { clipboardData, bubbles: true, cancelable: true });
      (document.activeElement ?? document.body).dispatchEvent(event);
      return event.defaultPrevented;
    },
    { text, files, content: triangle().text },
  );

/** @param {TestPage} page */
const notice = (page) => page.locator("#news").innerText();

for (const renderer of BACK_ENDS)
  describe(`app on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => {
      site = await startSite({ isOffScreen: true, isCalm: true });
    });
    after(() => site?.close());

    /** @param {string} [link] */
    async function opened(link) {
      const page = await site.page({ renderer, link });
      await page.route("https://files.example/**", (route) => route.fulfill({ body: triangle().text, headers: { "access-control-allow-origin": "*" } }));
      return page;
    }

    test("opens what is pasted, unless a text field has the caret", async () => {
      const page = await opened();
      assert.equal(await paste(page, { files: ["mine.gltf"] }), true);
      await whenModel(page, "mine.gltf");
      // As the keyboard does it.
      await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
      await page.evaluate((text) => navigator.clipboard.writeText(text), ` ${REMOTE}\n`);
      await page.locator("canvas").focus();
      await page.keyboard.press("Control+V");
      await whenModel(page, REMOTE);
      await paste(page, { text: `${site.address}#v=2&model=sample:walker&play=0&t=0.5` });
      await whenModel(page, "sample:walker");
      assert.equal((await state(page)).t, 0.5);
      await paste(page, { text: "v=2&model=sample:pilot&play=0" });
      await whenModel(page, "sample:pilot");
      await paste(page, { text: "see https://files.example/own.gltf" });
      await eventually(async () => /no file or URL/.test(await notice(page)));
      assert.deepEqual((await state(page)).model, ["sample:pilot"]);
      // A field of the panels, in the page's mirror of them, and one of the page's own.
      await control(page, "spinbutton", /speed/i).focus();
      assert.equal(await paste(page, { text: REMOTE }), false);
      await page.locator("canvas").focus();
      await page.keyboard.press("Control+O");
      await page.locator("#open-url").focus();
      assert.equal(await paste(page, { text: REMOTE }), false);
      assert.deepEqual((await state(page)).model, ["sample:pilot"]);
      assert.deepEqual(page.troubles, []);
      await page.finish();
    });

    test("a dialog shows errors that arise meanwhile, and closes for what the user opens", async () => {
      const page = await opened();
      /** @type {() => void} */
      let fail = () => {};
      await page.route("https://files.example/slow.gltf", async (route) => {
        await new Promise((done) => (fail = () => done(undefined)));
        await route.fulfill({ status: 404, headers: { "access-control-allow-origin": "*" } });
      });
      const requested = page.waitForRequest("https://files.example/slow.gltf");
      await paste(page, { text: "https://files.example/slow.gltf" });
      await requested;
      await page.locator("canvas").focus();
      await page.keyboard.press("Control+O");
      const line = page.locator("#open .problem");
      assert.equal(await line.isVisible(), false);
      fail();
      await line.waitFor({ state: "visible" });
      assert.match(await line.innerText(), /slow\.gltf: the server answered 404/);
      await page.locator("#open-cancel").click();
      await page.route("https://files.example/gone.gltf", (route) => route.fulfill({ status: 404, headers: { "access-control-allow-origin": "*" } }));
      for (const [dialog, model] of [["#bring", "file:other.glb"], ["#missing", "https://files.example/gone.gltf"]]) {
        await page.evaluate((model) => void (location.hash = `v=2&model=${model}`), model);
        await page.locator(dialog).waitFor({ state: "visible" });
        assert.equal(await page.locator(`${dialog} .problem`).isVisible(), false);
        await paste(page, { files: [`for ${dialog.slice(1)}.gltf`] });
        await page.locator(dialog).waitFor({ state: "hidden" });
        await whenModel(page, `for ${dialog.slice(1)}.gltf`);
      }
      await page.finish();
    });

    test("the start strip closes a menu of the panels before it closes itself", async () => {
      const page = await opened("");
      const gallery = page.locator("#gallery");
      const isMenuOpen = () => page.locator('#mirror [data-role="group"]').first().isVisible();
      const pressEscape = () => page.evaluate(() => void document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape", bubbles: true, cancelable: true })));
      for (const close of [() => page.locator("#gallery-title").click(), pressEscape]) {
        const button = control(page, "button", "Menu");
        await button.waitFor();
        const { x, y } = await centreOf(button);
        await page.mouse.click(x, y);
        await eventually(isMenuOpen);
        await close();
        await eventually(async () => !(await isMenuOpen()));
        assert.equal(await gallery.isVisible(), true);
      }
      await pressEscape();
      await gallery.waitFor({ state: "hidden" });
      assert.deepEqual(page.troubles, []);
      await page.finish();
    });
  });

describe("shared with the app", () => {
  /** @type {import("./browser.mjs").Browser} */
  let browser;
  before(async () => {
    browser = await launch({ isOffScreen: true });
  });
  after(() => browser?.close());

  test("files and URLs are opened once, and no server sees them", async () => {
    const site = await serve({ "/app/": dist });
    const address = `${site.origin}/app/`;
    const context = await browser.newContext({ viewport: VIEWPORT, reducedMotion: "reduce" });
    await context.route("https://files.example/**", (route) => route.fulfill({ body: triangle().text, headers: { "access-control-allow-origin": "*" } }));
    const page = watched(await context.newPage());
    await page.goto(`${address}#model=sample:walker&play=0`);
    await whenReady(page);
    await until(page, async () => navigator.serviceWorker.controller !== null);
    // What the system does when something is shared, as the manifest says.
    const manifest = await page.evaluate(async () => await (await fetch("manifest.webmanifest")).json());
    const { action, method, enctype, params } = manifest.share_target;
    /** @param {string} fields */
    const share = async (fields) => {
      await page.goto(`${site.origin}/app/icon-none`).catch(() => {});
      await page.setContent(`<form action="${new URL(action, address)}" method="${method}" enctype="${enctype}" accept-charset="utf-8">${fields}<button></button></form>`);
    };
    await share(`<input type="file" multiple name="${params.files[0].name}">`);
    await page.locator("input").setInputFiles([{ name: "ünïque one.gltf", mimeType: "model/gltf+json", buffer: Buffer.from(triangle().text) }]);
    await page.locator("button").click();
    await whenReady(page);
    await whenModel(page, "ünïque one.gltf");
    assert.equal(new URL(page.url()).search, "");
    assert.deepEqual(await page.evaluate(async () => (await caches.keys()).filter((name) => name.startsWith("gaitway-shared"))), []);
    await share(`<input name="${params.text}" value="A model: ${REMOTE}"><input name="${params.title}" value="Model">`);
    await page.locator("button").click();
    await whenReady(page);
    await whenModel(page, REMOTE);
    await page.reload();
    await whenReady(page);
    assert.deepEqual(await context.cookies(), []);
    await context.close();
    await site.close();
  });
});
