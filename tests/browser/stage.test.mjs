// The viewport: compared skinning methods, the motion's source, joints posed manually, and saved images and videos.
import assert from "node:assert/strict";
import fs from "node:fs";
import { after, before, describe, test } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, apply, furthest, pose, startSite, state, stats, untilStill } from "./browser.mjs";

const SOLDIER = "threejs/Soldier.glb";
const XBOT = "threejs/Xbot.glb";
const FOREARM = "mixamorig:LeftForeArm";

for (const renderer of BACK_ENDS)
  describe(`stage on ${renderer}`, { skip: skipWithoutData }, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => void (site = await startSite()));
    after(() => site?.close());

    /**
     * @param {string} name
     * @param {(page: import("./browser.mjs").TestPage) => Promise<void>} body
     */
    const onPage = (name, body) =>
      test(name, async () => {
        const link = `model=${site.data(SOLDIER)}&motion=${site.data(XBOT)}&clip=walk&t=0.3&play=0`;
        const page = await site.page({ renderer, link });
        try {
          await body(page);
        } finally {
          await page.finish();
        }
      });

    /** @param {import("./browser.mjs").TestPage} page */
    const characters = async (page) => (await stats(page)).characters;

    onPage("the source and the compared methods are drawn beside the model, and the numbers stay the model's", async (page) => {
      const alone = await pose(page);
      assert.equal(await characters(page), 1);
      await apply(page, { show: "grid,source" });
      assert.equal(await characters(page), 2);
      await apply(page, { show: "grid,split" });
      assert.equal(await characters(page), 3);
      assert.deepEqual(await pose(page), alone);
    });

    onPage("a manually posed joint moves the mesh and is in the link", async (page) => {
      const before = await pose(page);
      const forearm = before.nodes.find(({ name }) => name === FOREARM)?.node;
      await apply(page, { pose: `${forearm}:0:0:60` });
      assert.equal((await state(page)).pose, `${forearm}:0:0:60`);
      const moved = furthest(await pose(page), before);
      assert.ok(moved > 0.05, `${moved} m`);
      await apply(page, { pose: "" });
      assert.deepEqual(await pose(page), before);
    });

    onPage("an image of any size and a video of one loop are saved", async (page) => {
      await page.setViewportSize({ width: 1280, height: 800 });
      await untilStill(page);
      // The canvas has no elements to ask for: the View tab, its end, the toggle and the buttons.
      await page.mouse.click(1183, 29);
      await untilStill(page);
      await page.mouse.move(1130, 400);
      await page.mouse.wheel(0, 2400);
      await untilStill(page);
      await page.mouse.click(1248, 584);
      await untilStill(page);
      const picture = page.waitForEvent("download");
      await page.mouse.click(1125, 620);
      const file = await picture;
      assert.equal(file.suggestedFilename(), "Soldier-walk.png");
      const png = fs.readFileSync(await file.path());
      assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [1920, 1080]);
      const corner = await page.evaluate(async (base64) => {
        const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
        const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
        context?.drawImage(bitmap, 0, 0);
        return context?.getImageData(2, 2, 1, 1).data[3];
      }, png.toString("base64"));
      assert.equal(corner, 0, "nothing is behind the model");

      const video = page.waitForEvent("download");
      await page.mouse.click(1125, 658);
      const recorded = await video;
      assert.equal(recorded.suggestedFilename(), "Soldier-walk.webm");
      const webm = fs.readFileSync(await recorded.path());
      assert.equal(webm.readUInt32BE(0), 0x1a45dfa3, "it starts like Matroska");
      assert.ok(webm.length > 5000, `${webm.length} bytes`);
      assert.equal((await state(page)).play, false, "the view stays as it was");
    });
  });
