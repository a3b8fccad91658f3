// The first screen and its scenes: each is a link that opens by itself, moves, and matches its image.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import sharp from "sharp";
import { linkOf, readScenes } from "../../xtask/site/samples.mjs";
import { dist } from "../three/data.mjs";
import { triangle } from "../three/triangle.mjs";
import { BACK_ENDS, PIXEL_RATIO, colorsOf, control, drop, meanDifference, picture, resize, startSite, state, until, watched, whenModel, whenPictureDiffers, whenReady } from "./browser.mjs";

/** Of 255. The image is drawn at another resolution, and WebP loses a little. Other scenes differ by 6 and more. */
const MAX_DIFFERENCE = 4;
const STILL = { width: 640, height: 480 };
const DESKTOP = { width: 1280, height: 720 };
const PHONE = { width: 390, height: 844 };
const SIDEWAYS = { width: 844, height: 390 };
const scenes = readScenes();

/** @typedef {import("./browser.mjs").TestPage} TestPage */

/**
 * Returns the image of a scene in the built page, at the tests' resolution.
 * @param {string} name
 */
async function still(name) {
  const file = fs.readdirSync(path.join(dist, "pictures")).find((file) => file.startsWith(`${name}-${STILL.width}-`));
  assert.ok(file !== undefined, `no image of ${name}`);
  const [width, height] = [STILL.width, STILL.height].map((edge) => edge * PIXEL_RATIO);
  const rgba = await sharp(path.join(dist, "pictures", file)).resize(width, height).ensureAlpha().raw().toBuffer();
  return { width, height, rgba };
}

/** Chooses the third card, as Enter does, once the program has said what it shows and before the page shows its first picture. */
function withEarlyChoice() {
  const choose = () => {
    if (document.getElementById("loading")?.hidden !== false) throw new Error("it is too late");
    const card = /** @type {NodeListOf<HTMLAnchorElement>} */ (document.querySelectorAll("#gallery-scenes a"))[2];
    card.focus();
    card.click();
  };
  addEventListener("gaitway:change", choose, { once: true });
}

for (const renderer of BACK_ENDS)
  describe(`scenes on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    // Composed by the graphics API: nothing else slows down scenes that move, and frames would queue up.
    before(async () => void (site = await startSite()));
    after(() => site?.close());

    for (const scene of scenes)
      test(`${scene.name} opens from its link, moves, and looks like its image`, async () => {
        const page = await site.page({ renderer, link: `${linkOf(scene)}&embed=1`, viewport: { width: STILL.width, height: 700 } });
        try {
          assert.deepEqual((await state(page)).model, [scene.model]);
          assert.equal(await page.locator("#missing").isVisible(), false, "nothing should be missing");
          await whenPictureDiffers(page, await picture(page));
          // Paused, with the shape of the gallery's image. Later keys of a link win.
          await page.evaluate((calm) => void (location.hash = calm), `${linkOf(scene)}&play=0&turntable=0&embed=1`);
          await until(page, async () => {
            const { play, turntable } = await window.gaitway.state();
            return !play && turntable === 0;
          });
          const around = 700 - (await picture(page)).height / PIXEL_RATIO;
          await resize(page, STILL.width, STILL.height + around);
          const shown = await picture(page);
          assert.ok(colorsOf(shown) > 64, "something should be drawn");
          const difference = meanDifference(shown, await still(scene.name));
          console.log(`${scene.name} on ${renderer}: mean difference from its image ${difference.toFixed(3)} of 255`);
          assert.ok(difference <= MAX_DIFFERENCE, `mean difference ${difference} of 255`);
          const others = await Promise.all(scenes.filter(({ name }) => name !== scene.name).map(async ({ name }) => meanDifference(shown, await still(name))));
          assert.ok(others.every((other) => other > difference), `it looks more like another scene's image: ${others.join(", ")}`);
          assert.deepEqual(page.troubles, []);
        } finally {
          await page.finish();
        }
      });
  });

for (const renderer of BACK_ENDS)
  describe(`gallery on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => void (site = await startSite({ isOffScreen: true, isCalm: true })));
    after(() => site?.close());

    /**
     * Tests the first screen, which must report no errors.
     * @param {string} name
     * @param {import("./browser.mjs").PageOptions} options
     * @param {(page: TestPage) => Promise<void>} body
     */
    const onFirstScreen = (name, options, body) =>
      test(name, async () => {
        const page = await site.page({ renderer, link: "", ...options });
        try {
          await body(page);
          assert.deepEqual(page.troubles, []);
        } finally {
          await page.finish();
        }
      });

    /** @param {TestPage} page */
    const gallery = (page) => page.locator("#gallery");
    /** @type {(page: TestPage, name: string) => import("playwright-core").Locator} */
    const card = (page, name) => page.locator(`#gallery-scenes a >> nth=${scenes.findIndex((scene) => scene.name === name)}`);

    /** @type {(page: TestPage, wanted: boolean) => Promise<void>} */
    const whenInert = (page, wanted) => until(page, (wanted) => document.querySelector("#gallery")?.matches("[inert]") === wanted, wanted);

    test("fetches the program and the sample once, side by side", async () => {
      const context = await site.browser.newContext({ viewport: DESKTOP, deviceScaleFactor: PIXEL_RATIO, serviceWorkers: "block", reducedMotion: "reduce" });
      const page = watched(await context.newPage());
      const session = await context.newCDPSession(page);
      await session.send("Network.enable");
      // Unthrottled, either arrives before the other is requested.
      await session.send("Network.emulateNetworkConditions", { offline: false, latency: 40, downloadThroughput: 2_000_000, uploadThroughput: -1 });
      await page.goto(`${site.address}?renderer=${renderer}`);
      await whenReady(page);
      for (const ending of [".wasm", ".glb"]) assert.equal(page.requests.filter((url) => url.endsWith(ending)).length, 1, ending);
      const [program, sample, style] = await page.evaluate(() =>
        [".wasm", ".glb", ".css"].map((ending) => performance.getEntriesByType("resource").filter(({ name }) => name.endsWith(ending)).map((entry) => /** @type {PerformanceResourceTiming} */ (entry))[0]),
      );
      assert.equal(program.initiatorType, "fetch", "a script requests it");
      assert.ok(program.startTime < style.responseEnd, "it doesn't wait for the style sheet");
      assert.equal(sample.initiatorType, "link", "the page itself requests it");
      assert.ok(sample.startTime < program.responseEnd && program.startTime < sample.responseEnd, "side by side");
      assert.deepEqual(page.troubles, []);
      await page.finish();
    });

    for (const [name, viewport] of Object.entries({ DESKTOP, PHONE }))
      onFirstScreen(`the first screen shows the scenes under the character (${name.toLowerCase()})`, { viewport }, async (page) => {
        assert.equal(await page.locator("#gallery-scenes li").count(), scenes.length + 2);
        const [picture, cards] = [await page.locator("canvas").first().boundingBox(), await gallery(page).boundingBox()];
        assert.ok(picture !== null && cards !== null);
        assert.ok(picture.y + picture.height <= cards.y + 0.5, "the cards should be below the viewport");
        assert.ok(cards.y + cards.height <= viewport.height + 0.5, "the cards should be on the screen");
        assert.ok(picture.height > viewport.height / 2, `the viewport has ${picture.height} of ${viewport.height}`);
        assert.deepEqual((await state(page)).model, [scenes[0].model]);
        assert.equal(await page.evaluate(() => location.hash), "", "the address stays as it was typed");
        assert.equal(await card(page, scenes[0].name).getAttribute("aria-current"), "true");
        await until(page, () => [...document.querySelectorAll("#gallery-scenes img")].some((image) => image instanceof HTMLImageElement && image.complete && image.naturalWidth > 0));
      });

    onFirstScreen("a card is a link, the gallery closes and comes back", { viewport: DESKTOP }, async (page) => {
      const last = scenes[scenes.length - 1];
      await card(page, last.name).click();
      await whenModel(page, last.model);
      await until(page, (index) => document.querySelectorAll("#gallery-scenes a")[index].ariaCurrent === "true", scenes.length - 1);
      assert.equal(await gallery(page).isVisible(), true, "it stays open for the next one");
      assert.equal(await page.evaluate(() => document.querySelector("#stage")?.contains(document.activeElement)), true, "the keyboard controls the viewport");
      await card(page, scenes[0].name).focus();
      await page.keyboard.press("Escape");
      assert.equal(await gallery(page).isVisible(), false);
      await until(page, (height) => document.querySelector("canvas")?.getBoundingClientRect().height === height, DESKTOP.height);
      await control(page, "button", "Samples").press("Enter");
      await gallery(page).waitFor({ state: "visible" });
      assert.equal(await card(page, last.name).evaluate((card) => card === document.activeElement), true, "the focus starts at the current scene");
      await page.locator("#gallery-close").press("Enter");
      assert.equal(await gallery(page).isVisible(), false);
      await page.keyboard.press("Control+o");
      await page.locator("#open-sample").click();
      assert.equal(await gallery(page).isVisible(), true);
      await page.goBack();
      await whenModel(page, scenes[0].model);
    });

    onFirstScreen("after Enter on a card, keys act on the viewport", { viewport: DESKTOP }, async (page) => {
      for (const { name, model } of [scenes[2], scenes[3]]) {
        await card(page, name).press("Enter");
        await whenModel(page, model);
        assert.equal(await page.evaluate(() => document.activeElement?.localName), "canvas");
        await page.keyboard.press("?");
        await whenInert(page, true);
        await page.keyboard.press("Escape");
        await whenInert(page, false);
      }
    });

    onFirstScreen("after Enter on a card while the page starts, the scene is shown and keys act on the viewport", { before: withEarlyChoice }, async (page) => {
      await until(page, () => document.activeElement?.localName === "canvas");
      await whenModel(page, scenes[2].model);
    });

    onFirstScreen("a card can be dragged onto the viewport, and its address pasted", { viewport: DESKTOP }, async (page) => {
      const address = await card(page, scenes[1].name).evaluate((card) => (card instanceof HTMLAnchorElement ? card.href : ""));
      await drop(page, [{ link: address }]);
      await whenModel(page, scenes[1].model);
      await page.keyboard.press("Control+o");
      await page.locator("#open-url").fill(new URL(`#${linkOf(scenes[2])}`, page.url()).href);
      await page.locator("#open-url").press("Enter");
      await whenModel(page, scenes[2].model);
    });

    onFirstScreen("on a phone held sideways, the samples are there only when asked for", { viewport: SIDEWAYS }, async (page) => {
      assert.equal(await gallery(page).isVisible(), false);
      assert.equal((await page.locator("canvas").first().boundingBox())?.height, SIDEWAYS.height);
      await control(page, "button", "Menu").press("Enter");
      await control(page, "button", "Samples").press("Enter");
      await gallery(page).waitFor({ state: "visible" });
      const cards = await gallery(page).boundingBox();
      assert.ok(cards !== null && cards.height < SIDEWAYS.height / 4, `a single row, not ${cards?.height} of ${SIDEWAYS.height}`);
      const last = scenes[scenes.length - 1];
      await card(page, last.name).click();
      await whenModel(page, last.model);
      assert.equal(await gallery(page).isVisible(), false, "the choice closes them");
      await page.setViewportSize(PHONE);
      await until(page, (width) => innerWidth === width, PHONE.width);
      assert.equal(await gallery(page).isVisible(), false);
    });

    onFirstScreen("a phone turned sideways and back shows the samples again, unless something was opened meanwhile", { viewport: PHONE }, async (page) => {
      const turn = async () => {
        await page.setViewportSize(SIDEWAYS);
        await gallery(page).waitFor({ state: "hidden" });
      };
      await turn();
      await page.setViewportSize(PHONE);
      await gallery(page).waitFor({ state: "visible" });
      await turn();
      await drop(page, [{ name: "mine.gltf", text: triangle().text }]);
      await whenModel(page, "mine.gltf");
      await page.setViewportSize(PHONE);
      await until(page, (width) => innerWidth === width, PHONE.width);
      assert.equal(await gallery(page).isVisible(), false);
    });

    onFirstScreen("the samples are inert while a modal dialog is open", { viewport: DESKTOP }, async (page) => {
      await page.locator("canvas").focus();
      await page.keyboard.press("?");
      await whenInert(page, true);
      await page.evaluate(() => document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape", bubbles: true })));
      assert.equal(await gallery(page).isVisible(), true, "Escape is the dialog's");
      await page.keyboard.press("Escape");
      await whenInert(page, false);
    });

    test("a restart ends a modal dialog", async () => {
      const page = await site.page({ renderer });
      await drop(page, [{ name: "mine.gltf", text: triangle().text }]);
      await whenModel(page, "mine.gltf");
      await page.locator("canvas").focus();
      await page.keyboard.press("?");
      await whenInert(page, true);
      // An address has no local file: “Try again” restarts with it.
      await page.evaluate(() => void (location.hash = "model=mine.gltf&t=0.5"));
      await page.locator("#missing-again").click();
      await whenModel(page, "mine.gltf");
      await whenInert(page, false);
      await page.finish();
    });

    onFirstScreen("what the user opens hides the gallery, by URL as well (phone)", { viewport: PHONE }, async (page) => {
      const own = "https://files.example/own.gltf";
      await page.route("https://files.example/**", (route) => route.fulfill({ body: triangle().text, headers: { "access-control-allow-origin": "*" } }));
      await page.locator("#gallery-own").click();
      await page.locator("#open-url").fill(own);
      await page.locator("#open-go").click();
      await whenModel(page, own);
      await gallery(page).waitFor({ state: "hidden" });
      await until(page, (height) => document.querySelector("canvas")?.getBoundingClientRect().height === height, PHONE.height);
      await page.goBack();
      await whenModel(page, scenes[0].model);
      await page.evaluate(() => document.querySelector("#gallery")?.removeAttribute("hidden"));
      await page.locator("#gallery-own").click();
      await page.locator("#open-files").setInputFiles({ name: "mine.gltf", mimeType: "model/gltf+json", buffer: Buffer.from(triangle().text) });
      await whenModel(page, "mine.gltf");
      await gallery(page).waitFor({ state: "hidden" });
    });

    onFirstScreen("dropping a file hides the gallery", {}, async (page) => {
      assert.equal(await gallery(page).isVisible(), true);
      await page.evaluate(async () => await window.gaitway.open({ "own.gltf": new ArrayBuffer(2) }).catch(() => {}));
      assert.equal(await gallery(page).isVisible(), true, "a file that can't be opened changes nothing");
      const triangle = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]);
      const uri = `data:application/octet-stream;base64,${Buffer.from(triangle.buffer).toString("base64")}`;
      const gltf = {
        asset: { version: "2.0" },
        buffers: [{ byteLength: 36, uri }],
        bufferViews: [{ buffer: 0, byteLength: 36 }],
        accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
        nodes: [{ mesh: 0 }],
        scenes: [{ nodes: [0] }],
      };
      await drop(page, [{ name: "own.gltf", text: JSON.stringify(gltf) }]);
      await page.locator("#gallery").waitFor({ state: "hidden" });
    });

    test("with a link there is no gallery", async () => {
      const linked = await site.page({ renderer, link: "model=sample:walker&play=0" });
      assert.equal(await gallery(linked).isVisible(), false);
      await linked.finish();
    });
  });
