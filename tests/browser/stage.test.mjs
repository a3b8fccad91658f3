// What the workspace shows and gives away: compared skinning modes, the source on the stage, joints turned by hand, pictures
// and videos.
import assert from "node:assert/strict";
import fs from "node:fs";
import { after, before, describe, test } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, apply, pose, startSite, state, untilStill } from "./browser.mjs";

const SOLDIER = "threejs/Soldier.glb";
const XBOT = "threejs/Xbot.glb";
/** Soldier's left forearm, as the file numbers its nodes. */
const FOREARM = "mixamorig:LeftForeArm";

for (const renderer of BACK_ENDS)
  describe(`stage on ${renderer}`, { skip: skipWithoutData }, () => {
    let site;
    before(async () => void (site = await startSite()));
    after(() => site?.close());

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

    const characters = (page) => page.evaluate(() => window.gaitway.stats().characters);

    onPage("the source and the compared modes are drawn beside, and the numbers stay the model's", async (page) => {
      const alone = await pose(page);
      assert.equal(await characters(page), 1);
      await apply(page, { show: "grid,source" });
      assert.equal(await characters(page), 2);
      await apply(page, { show: "grid,split" });
      assert.equal(await characters(page), 3);
      assert.deepEqual(await pose(page), alone);
    });

    onPage("a joint turned by hand moves the mesh and is in the link", async (page) => {
      const before = await pose(page);
      const forearm = before.nodes.find(({ name }) => name === FOREARM).node;
      await apply(page, { pose: `${forearm}:0:0:60` });
      assert.equal((await state(page)).pose, `${forearm}:0:0:60`);
      const after = await pose(page);
      const furthest = Math.max(...after.meshes[0].positions.map((place, at) => Math.abs(place - before.meshes[0].positions[at])));
      assert.ok(furthest > 0.05, `${furthest} m`);
      await apply(page, { pose: "" });
      assert.deepEqual(await pose(page), before);
    });

    onPage("a picture of its own size and a video of one loop are handed over", async (page) => {
      await page.setViewportSize({ width: 1280, height: 800 });
      await untilStill(page);
      // The canvas has no elements to ask for: the View tab, its end, the switch and the buttons.
      await page.mouse.click(1183, 29);
      await untilStill(page);
      await page.mouse.move(1130, 400);
      for (let step = 0; step < 12; step++) {
        await page.mouse.wheel(0, 200);
        await page.waitForTimeout(100);
      }
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
        const canvas = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
        canvas.drawImage(bitmap, 0, 0);
        return canvas.getImageData(2, 2, 1, 1).data[3];
      }, png.toString("base64"));
      assert.equal(corner, 0, "nothing is behind the model");

      const video = page.waitForEvent("download");
      await page.mouse.click(1125, 658);
      const recorded = await video;
      assert.equal(recorded.suggestedFilename(), "Soldier-walk.webm");
      const webm = fs.readFileSync(await recorded.path());
      assert.equal(webm.readUInt32BE(0), 0x1a45dfa3, "it begins as Matroska does");
      assert.ok(webm.length > 5000, `${webm.length} bytes`);
      assert.equal((await state(page)).play, false, "the view is as before");
    });
  });
