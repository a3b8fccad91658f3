// The first screen and its scenes: each is a link that opens by itself, moves, and looks like its picture.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import sharp from "sharp";
import { readScenes } from "../../xtask/site/samples.mjs";
import { BACK_ENDS, coloursOf, dist, drop, meanDifference, picture, startSite, state, until, untilStill } from "./browser.mjs";

/** Of 255: the picture was drawn with four samples a pixel, the page draws one where the processor does it, and WebP loses a little. */
const MOST_DIFFERENCE = 4;
const STILL = { width: 640, height: 480 };
const DESKTOP = { width: 1280, height: 720 };
const PHONE = { width: 390, height: 844 };
const scenes = readScenes();

/** The picture of a scene that was built into the page. */
async function still(name) {
  const file = fs.readdirSync(path.join(dist, "pictures")).find((file) => file.startsWith(`${name}-${STILL.width}-`));
  const { data } = await sharp(path.join(dist, "pictures", file)).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
  return { ...STILL, rgba: data };
}

const linkWith = (link, parts) => [...link.split("&").filter((pair) => !(pair.split("=")[0] in parts)), ...Object.entries(parts).map(([key, value]) => `${key}=${value}`)].join("&");

for (const renderer of BACK_ENDS)
  describe(`gallery on ${renderer}`, () => {
    let site;
    before(async () => void (site = await startSite()));
    after(() => site?.close());

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

    const gallery = (page) => page.locator("#gallery");
    const card = (page, name) => page.locator(`#gallery-scenes a >> nth=${scenes.findIndex((scene) => scene.name === name)}`);

    onFirstScreen("fetches the program and the sample once, side by side", {}, async (page) => {
      for (const ending of [".wasm", ".glb"]) assert.equal(page.requests.filter((url) => url.endsWith(ending)).length, 1, ending);
      const begins = await page.evaluate(() =>
        [".wasm", ".glb"].map((ending) => performance.getEntriesByType("resource").find(({ name }) => name.endsWith(ending)).initiatorType),
      );
      assert.deepEqual(begins, ["link", "link"], "both are asked for by the page itself");
    });

    for (const scene of scenes)
      test(`${scene.name} opens from its link, moves, and looks like its picture`, async () => {
        const page = await site.page({ renderer, link: scene.link });
        try {
          const expected = new URLSearchParams(scene.link);
          assert.deepEqual([(await state(page)).model].flat(), expected.getAll("model"));
          assert.equal(await page.locator("#missing").isVisible(), false, "nothing should be missing");
          const first = await picture(page);
          await page.waitForTimeout(300);
          assert.ok(meanDifference(await picture(page), first) > 0, "it should move");
          assert.deepEqual(page.troubles, []);
        } finally {
          await page.finish();
        }
        // Standing still, with a picture of the same size as the gallery's.
        const calm = await site.page({ renderer, link: linkWith(scene.link, { play: 0, turntable: 0, embed: 1 }), viewport: { width: STILL.width, height: 700 } });
        try {
          const around = 700 - (await picture(calm)).height;
          await calm.setViewportSize({ width: STILL.width, height: STILL.height + around });
          await untilStill(calm);
          const shown = await picture(calm);
          assert.ok(coloursOf(shown) > 64, "something should be drawn");
          const difference = meanDifference(shown, await still(scene.name));
          console.log(`${scene.name} on ${renderer}: mean difference from its picture ${difference.toFixed(3)} of 255`);
          assert.ok(difference <= MOST_DIFFERENCE, `mean difference ${difference} of 255`);
          const others = await Promise.all(scenes.filter(({ name }) => name !== scene.name).map(async ({ name }) => meanDifference(shown, await still(name))));
          assert.ok(others.every((other) => other > difference), `it looks more like another scene's picture: ${others.join(", ")}`);
          assert.deepEqual(calm.troubles, []);
        } finally {
          await calm.finish();
        }
      });

    for (const [name, viewport] of Object.entries({ DESKTOP, PHONE }))
      onFirstScreen(`the first screen shows the scenes under the moving character (${name.toLowerCase()})`, { viewport }, async (page) => {
        assert.equal(await page.locator("#gallery-scenes li").count(), scenes.length + 1);
        const [picture, cards] = [await page.locator("canvas").first().boundingBox(), await gallery(page).boundingBox()];
        assert.ok(picture.y + picture.height <= cards.y + 0.5, "the cards should be below the picture");
        assert.ok(cards.y + cards.height <= viewport.height + 0.5, "the cards should be on the screen");
        assert.ok(picture.height > viewport.height / 2, `the picture has ${picture.height} of ${viewport.height}`);
        assert.deepEqual([(await state(page)).model].flat(), new URLSearchParams(scenes[0].link).getAll("model"));
        assert.equal(await page.evaluate(() => location.hash), "", "the address stays as it was typed");
        assert.equal(await card(page, scenes[0].name).getAttribute("aria-current"), "true");
        await until(page, () => [...document.querySelectorAll("#gallery-scenes img")].some(({ complete, naturalWidth }) => complete && naturalWidth > 0));
      });

    onFirstScreen("a card is a link, the gallery closes and comes back", { viewport: DESKTOP }, async (page) => {
      const last = scenes.at(-1);
      await card(page, last.name).click();
      await until(page, async (model) => [(await window.gaitway.state()).model].flat().join() === model, new URLSearchParams(last.link).getAll("model").join());
      await until(page, (name) => document.querySelectorAll("#gallery-scenes a")[name].ariaCurrent === "true", scenes.length - 1);
      assert.equal(await gallery(page).isVisible(), true, "it stays for the next one");
      assert.equal(await page.evaluate(() => document.activeElement.closest("#stage") !== null), true, "the keys go to the picture");
      await card(page, scenes[0].name).focus();
      await page.keyboard.press("Escape");
      assert.equal(await gallery(page).isVisible(), false);
      await until(page, (height) => document.querySelector("canvas").getBoundingClientRect().height === height, DESKTOP.height);
      await page.locator("#do-samples").focus();
      await page.keyboard.press("Enter");
      assert.equal(await gallery(page).isVisible(), true);
      assert.equal(await card(page, last.name).evaluate((card) => card === document.activeElement), true, "it begins at what is shown");
      await page.locator("#gallery-close").press("Enter");
      assert.equal(await gallery(page).isVisible(), false);
      await page.keyboard.press("Control+o");
      await page.getByRole("button", { name: "Samples" }).last().click();
      assert.equal(await gallery(page).isVisible(), true);
      await page.goBack();
      await until(page, async (model) => [(await window.gaitway.state()).model].flat().join() === model, new URLSearchParams(scenes[0].link).getAll("model").join());
    });

    onFirstScreen("the gallery leaves when a file is dropped", {}, async (page) => {
      assert.equal(await gallery(page).isVisible(), true);
      await page.evaluate(async () => await window.gaitway.open({ "own.gltf": new ArrayBuffer(2) }).catch(() => {}));
      assert.equal(await gallery(page).isVisible(), true, "what could not be opened changes nothing");
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
      const linked = await site.page({ renderer, link: "model=sample:walker" });
      assert.equal(await gallery(linked).isVisible(), false);
      await linked.finish();
    });
  });
