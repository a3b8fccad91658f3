// The skinning exercise on the page, on each back end: dropped, opened by its address, bent while frames are counted.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, VIEWPORT, apply, drop, meanDifference, open, picture, pose, startSite, state, stats, whenShown } from "./browser.mjs";

const VERTICES = 13336;
const KINDS = ["obj", "skel", "attach"];

for (const renderer of BACK_ENDS) {
  describe(`exercise on ${renderer}`, () => {
    let site;
    before(async () => (site = await startSite()));
    after(() => site?.close());

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
    const dropModel = (page, name) =>
      drop(page, KINDS.map((kind) => ({ name: `${name}.${kind}`, url: site.data(`mit6837/${name}.${kind}`) })));

    onPage("three files are dropped together and bent by a slider without a stutter", {}, async (page) => {
      await dropModel(page, "Model1");
      await whenShown(page, VERTICES);
      const [rest, restPicture] = [await pose(page), await picture(page)];
      assert.equal(rest.nodes.length, 18);
      assert.deepEqual(rest.meshes.map(({ positions }) => positions.length), [3 * VERTICES]);
      // Frames of the page while the slider goes through its range, one step for each.
      const steps = await page.evaluate(async () => {
        const cpu = [];
        for (let degrees = 3; degrees <= 90; degrees += 3) {
          const shown = new Promise((resolve) => requestAnimationFrame(resolve));
          await window.gaitway.apply({ pose: `5:${degrees}:0:0` });
          await shown;
          cpu.push(window.gaitway.stats().cpu_ms);
        }
        return cpu;
      });
      assert.equal(steps.length, 30, "every step was shown");
      steps.sort((a, b) => a - b);
      console.log(`${renderer}: ${steps[15].toFixed(2)} ms of the CPU for a step (median of 30; ${steps[0].toFixed(2)} to ${steps[29].toFixed(2)})`);
      const bent = await pose(page);
      const furthest = Math.max(...bent.meshes[0].positions.map((value, at) => Math.abs(value - rest.meshes[0].positions[at])));
      assert.ok(furthest > 0.1, `a leg is up: ${furthest}`);
      assert.ok(meanDifference(await picture(page), restPicture) > 0.1, "the picture shows it");
      const { joints, characters } = await stats(page);
      assert.deepEqual([joints, characters], [18, 1]);
      assert.equal((await state(page)).pose, "5:90:0:0");
    });

    onPage("joints keep the names they are given", {}, async (page) => {
      await dropModel(page, "Model3");
      await whenShown(page, VERTICES);
      const before = await pose(page);
      await apply(page, { joint: 5, names: "5:Left thigh" });
      assert.equal((await state(page)).names, "5:Left thigh");
      assert.match(new URL(page.url()).hash, /names=5:Left%20thigh/);
      assert.deepEqual((await pose(page)).meshes[0].positions, before.meshes[0].positions);
    });

    onPage(
      "the address of the mesh is enough",
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

    onPage("a set that is not complete says what is missing, and the picture stays", { forgiven: /Model1/ }, async (page) => {
      const before = (await pose(page)).meshes.length;
      const problem = await page.evaluate(async ([obj, skel]) => {
        const bytes = async (url) => await (await fetch(url)).arrayBuffer();
        const files = { "Model1.obj": await bytes(obj), "Model1.skel": await bytes(skel) };
        return await window.gaitway.open(files).then(() => "", (error) => error.message);
      }, ["obj", "skel"].map((kind) => site.data(`mit6837/Model1.${kind}`)));
      assert.match(problem, /Model1\.attach.*drop it together/);
      assert.equal((await pose(page)).meshes.length, before);
    });
  });
}
