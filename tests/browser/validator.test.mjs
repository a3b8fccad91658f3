// The Khronos validator in the Info tab: downloaded when it is asked for, and its findings lead to nodes.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { BODY, LOWER, triangle } from "../three/triangle.mjs";
import { archive } from "./archive.mjs";
import { BACK_ENDS, control, controls, open, startSite, until, whenModel, withShortMinute, withoutHashes } from "./browser.mjs";

/** @typedef {import("./browser.mjs").TestPage} TestPage */

const CHECK = "Check with the Khronos validator";
const AGAIN = "Check again";
const FILES = "https://files.example";
const MISTAKES = triangle({ weight: 0.5, turn: 2 }).text;

/** @param {TestPage} page */
const downloads = (page) => page.requests.filter((url) => /\/parts\/validator-[0-9a-f]{16}\.js$/.test(url)).length;

/**
 * Waits until the Info tab says this.
 * @param {TestPage} page
 * @param {string | RegExp} text
 */
const says = (page, text) => page.locator("#mirror").getByText(text, { exact: true }).first().waitFor({ state: "attached" });

/**
 * Activates a control by keyboard.
 * @param {TestPage} page
 * @param {"button" | "tab"} role
 * @param {string | RegExp} name
 */
async function press(page, role, name) {
  // A warning of our own may lead to the same node; the validator's come after it.
  const found = controls(page, role, name, true).last();
  await found.waitFor({ state: "attached" });
  await found.press("Enter");
}

for (const renderer of BACK_ENDS)
  describe(`the Khronos validator on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => void (site = await startSite({ isOffScreen: true })));
    after(() => site?.close());

    /**
     * Opens a page, wide enough to start with the inspector, at the Info tab of a model.
     * @param {string} model
     * @param {Record<string, string | Buffer>} [files]
     * @param {() => void} [before]
     */
    async function infoOf(model, files, before) {
      const page = await site.page({ renderer, link: `model=${model}&play=0`, viewport: { width: 1440, height: 900 }, files, before });
      await press(page, "tab", "Info");
      return page;
    }

    test("is downloaded only when it is asked for, and finds nothing in a valid file", async () => {
      const { text, bytes } = triangle({ uri: "sub%20folder/its.bin" });
      const page = await infoOf(`${FILES}/made.gltf`, { "made.gltf": text, "sub%20folder/its.bin": bytes });
      await control(page, "button", CHECK).waitFor({ state: "attached" });
      assert.equal(downloads(page), 0);
      await press(page, "button", CHECK);
      await says(page, "No findings");
      assert.equal(downloads(page), 1);
      await press(page, "button", AGAIN);
      await says(page, "No findings");
      assert.deepEqual(page.troubles, []);
      await page.finish();
    });

    test("lists mistakes, which lead to the nodes that they are about", async () => {
      const page = await infoOf(`${FILES}/made.gltf`, { "made.gltf": MISTAKES });
      await press(page, "button", CHECK);
      await says(page, "2 errors");
      await says(page, /^\/meshes\/0\/primitives\/0\/attributes\/WEIGHTS_0: .* sum: 0\.5/);
      for (const [name, node] of /** @type {const} */ ([["Lower", LOWER], ["Body", BODY]])) {
        await press(page, "tab", "Info");
        await press(page, "button", `Go to ${name}`);
        await until(page, async (node) => (await window.gaitway.state()).joint === node, node);
        await until(page, (name) => document.activeElement?.role === "treeitem" && document.activeElement.ariaLabel?.includes(name) === true, name);
      }
      assert.deepEqual(page.troubles, []);
      await page.finish();
    });

    test("reads files inside an archive", async () => {
      const { text, bytes } = triangle({ uri: "its.bin" });
      const packed = archive({ "models/made.gltf": Buffer.from(text), "models/its.bin": bytes });
      const page = await infoOf(`${FILES}/made.zip`, { "made.zip": packed });
      await press(page, "button", CHECK);
      await says(page, "No findings");
      await page.finish();
    });

    test("checks a compressed file as it is, and another model by itself", { skip: skipWithoutData }, async () => {
      const compressed = site.data("khronos/CesiumMan/glTF-Draco/CesiumMan.gltf");
      const page = await infoOf(compressed);
      await press(page, "button", CHECK);
      // The app has decoded it, but the validator sees the extension, which it doesn't know.
      await says(page, "1 warning, 2 infos");
      await press(page, "button", /^Info: .* UNSUPPORTED_EXTENSION$/);
      await says(page, /'KHR_draco_mesh_compression'/);
      await open(page, site.data("khronos/Fox/glTF-Binary/Fox.glb"));
      await control(page, "button", CHECK).waitFor({ state: "attached" });
      assert.deepEqual(page.troubles, []);
      await page.finish();
    });

    test("is not offered for other formats", async () => {
      const page = await infoOf("sample:walker");
      await says(page, /^Checks only glTF files/);
      assert.equal(await control(page, "button", CHECK).count(), 0);
      await page.finish();
    });

    test("that can't be downloaded says so, and is downloaded again", async () => {
      const page = await infoOf(`${FILES}/made.gltf`, { "made.gltf": MISTAKES });
      await page.route("**/parts/validator-*", (route) => route.abort());
      await press(page, "button", CHECK);
      await says(page, /^Couldn't check the file: it can't be loaded\. Check the connection and try again\./);
      await page.unroute("**/parts/validator-*");
      await press(page, "button", AGAIN);
      await says(page, "2 errors");
      assert.equal(downloads(page), 2);
      await page.finish();
    });

    /** The last member: it never ends. @type {[string, string, RegExp, (() => void)?, boolean?][]} */
    const damaged = [
      ["isn't what the page was built with", "", /^Couldn't check the file: it can't be loaded\. .*expected a download whose SHA-256/],
      ["fails", "onmessage = () => { throw new Error('broken'); }", /^Couldn't check the file: .*broken/, withoutHashes],
      ["never ends", "onmessage = () => { for (;;); }", /^Couldn't check the file: it took longer than 60 seconds/, withoutHashes, true],
    ];
    for (const [name, body, message, before, isEndless = false] of damaged)
      test(`that ${name} is an error, and the page goes on`, async () => {
        const page = await infoOf(`${FILES}/made.gltf`, { "made.gltf": MISTAKES }, before);
        if (isEndless) await page.evaluate(withShortMinute);
        await page.route("**/parts/validator-*", (route) => route.fulfill({ body, contentType: "text/javascript" }));
        await press(page, "button", CHECK);
        await says(page, message);
        await whenModel(page, `${FILES}/made.gltf`);
        await page.finish();
      });
  });
