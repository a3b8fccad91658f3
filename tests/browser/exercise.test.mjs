// The skinning exercise on the page, on each back end: dropped, opened by URL, and bent while frames are counted.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, apply, centreOf, controls, drop, meanDifference, open, toggleInspector, picture, pose, startSite, state, stats, until, untilStill, whenShown } from "./browser.mjs";

const VERTICES = 13336;
/** Steps of a dragged slider, and how far apart they are. */
const [STEPS, STEP] = [12, 8];
const KINDS = ["obj", "skel", "attach"];

for (const renderer of BACK_ENDS) {
  describe(`exercise on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => (site = await startSite({ isOffScreen: true })));
    after(() => site?.close());

    /**
     * Tests on a fresh page, which must report no errors but the forgiven ones.
     * @param {string} name
     * @param {{ link?: (site: import("./browser.mjs").Site) => string, deviceScaleFactor?: number, forgiven?: RegExp }} options
     * @param {(page: import("./browser.mjs").TestPage) => Promise<void>} body
     */
    const onPage = (name, options, body) =>
      test(name, { skip: skipWithoutData }, async () => {
        const page = await site.page({ renderer, ...options, link: options.link?.(site) });
        try {
          await body(page);
          assert.deepEqual(page.troubles.filter((trouble) => !options.forgiven?.test(trouble)), []);
        } finally {
          await page.finish();
        }
      });
    /** @type {(page: import("./browser.mjs").TestPage, name: string) => Promise<void>} */
    const dropModel = (page, name) =>
      drop(page, KINDS.map((kind) => ({ name: `${name}.${kind}`, url: site.data(`mit6837/${name}.${kind}`) })));

    onPage("three files dropped together are bent by a slider without stutter", {}, async (page) => {
      await dropModel(page, "Model1");
      await whenShown(page, VERTICES);
      await toggleInspector(page);
      const [rest, restPicture] = [await pose(page), await picture(page)];
      assert.equal(rest.nodes.length, 18);
      assert.deepEqual(rest.meshes.map(({ positions }) => positions.length), [3 * VERTICES]);
      // The selected joint's “Pose manually” switch, then the handle of the first slider: an angle of 0, in the middle.
      await apply(page, { joint: 5 });
      // Its controls scroll into sight.
      await untilStill(page);
      const posing = await centreOf(controls(page, "checkbox", "Pose manually"));
      // egui finds what is under the pointer in the previous frame.
      await page.mouse.move(posing.x, posing.y);
      await untilStill(page);
      await page.mouse.click(posing.x, posing.y);
      await untilStill(page);
      const handle = await centreOf(controls(page, "slider", "Rotation X", true));
      await page.mouse.move(handle.x, handle.y);
      await untilStill(page);
      await page.mouse.down();
      await untilStill(page);
      const cpu = [];
      const { frames } = await stats(page);
      let before = (await state(page)).pose;
      for (let step = 1; step <= STEPS; step++) {
        // egui picks the roundest number within a point to either side; no two steps share one.
        await page.mouse.move(handle.x + STEP * step, handle.y);
        // Each step is shown before the next one.
        await until(page, async (before) => (await window.gaitway.state()).pose !== before, before);
        before = (await state(page)).pose;
        cpu.push((await stats(page)).cpu_ms);
      }
      await page.mouse.up();
      assert.ok((await stats(page)).frames >= frames + STEPS, "a frame for every step");
      assert.match(before, /^5:[1-9][0-9.]*:-?0:-?0$/, "the slider turns the chosen joint about X");
      cpu.sort((a, b) => a - b);
      console.log(`${renderer}: ${cpu[STEPS / 2].toFixed(2)} ms of CPU time per frame with panels (median of ${STEPS}; ${cpu[0].toFixed(2)} to ${cpu[STEPS - 1].toFixed(2)})`);
      const bent = await pose(page);
      const furthest = Math.max(...bent.meshes[0].positions.map((value, at) => Math.abs(value - rest.meshes[0].positions[at])));
      assert.ok(furthest > 0.1, `a leg is up: ${furthest}`);
      assert.ok(meanDifference(await picture(page), restPicture) > 0.1, "the picture shows it");
      const { joints, characters } = await stats(page);
      assert.deepEqual([joints, characters], [18, 1]);
    });

    onPage("joints keep the names they are given", {}, async (page) => {
      await dropModel(page, "Model3");
      await whenShown(page, VERTICES);
      const before = await pose(page);
      await apply(page, { joint: 5, names: "5:Left thigh" });
      assert.equal((await state(page)).names, "5:Left thigh");
      await until(page, () => location.hash.includes("names=5:Left%20thigh"));
      assert.deepEqual((await pose(page)).meshes[0].positions, before.meshes[0].positions);
    });

    onPage(
      "the URL of the mesh is enough",
      { link: (site) => `model=${encodeURIComponent(site.data("mit6837/Model2.obj"))}&pose=6:60:0:0&show=skeleton,boxes,smooth&vertex=0:0:40` },
      async (page) => {
        await whenShown(page, VERTICES);
        assert.equal((await stats(page)).joints, 18);
        const smooth = await picture(page);
        assert.equal((await pose(page)).meshes[0].normals.length, 3 * VERTICES);
        await apply(page, { show: "skeleton,boxes" });
        assert.equal((await pose(page)).meshes[0].normals.length, 0);
        assert.ok(meanDifference(await picture(page), smooth) > 0.05, "flat faces look different");
        const inspected = await open(page, site.data("mit6837/Model4.obj"));
        assert.deepEqual([inspected.format, inspected.joints, inspected.vertices], ["obj", 18, VERTICES]);
      },
    );

    onPage("a mesh that arrives first gets its joints from the files that follow", { forgiven: /Model1/ }, async (page) => {
      /** @param {string} name */
      const dropped = (name) => drop(page, [{ name, url: site.data(`mit6837/${name}`) }]);
      /** @param {number} count */
      const whenJoints = (count) => until(page, async (count) => (await window.gaitway.stats()).joints === count, count);
      await dropped("Model1.obj");
      await whenJoints(1);
      await dropped("Model1.skel");
      await until(page, () => /Model1\.attach/.test(document.querySelector("#problem")?.textContent ?? ""));
      assert.equal((await stats(page)).joints, 1, "the .attach is still missing");
      await dropped("Model1.attach");
      await whenJoints(18);
    });

    onPage("an incomplete set says what is missing, and the viewport stays", { forgiven: /Model1/ }, async (page) => {
      const before = (await pose(page)).meshes.length;
      const problem = await page.evaluate(async ([obj, skel]) => {
        /** @param {string} url */
        const bytes = async (url) => await (await fetch(url)).arrayBuffer();
        const files = { "Model1.obj": await bytes(obj), "Model1.skel": await bytes(skel) };
        return await window.gaitway.open(files).then(() => "", (error) => error.message);
      }, ["obj", "skel"].map((kind) => site.data(`mit6837/Model1.${kind}`)));
      assert.match(problem, /Model1\.attach.*open them together/);
      assert.equal((await pose(page)).meshes.length, before);
    });
  });
}
