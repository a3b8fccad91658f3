// Borrowing motion on each back end by drop, script and link; loading and saving joint maps; motions that don't fit.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, apply, control, drop, furthest, meanDifference, open, picture, pose, resize, savedBy, startSite, state, until, whenBorrowed, whenReady } from "./browser.mjs";

const XBOT = "threejs/Xbot.glb";
const XBOT_CLIPS = 7;
const SOLDIER = "threejs/Soldier.glb";
const DANCE = "bvh/cosc422_Dance.bvh";
const SNAKE = "mesh2motion/snake-animations.glb";

/** @typedef {import("./browser.mjs").TestPage} TestPage */

/** A worm of two joints without a mesh, which shares neither names nor shape with Xbot. */
const WORM = `HIERARCHY
ROOT seg0
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT seg1
  {
    OFFSET 0 0 10
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 0 10
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.5
0 0 0 0 0 0 0 0 0
0 0 0 0 0 0 0 40 0
`;

describe("borrowed motion", { skip: skipWithoutData }, () => {
  for (const renderer of BACK_ENDS)
    describe(`on ${renderer}`, () => {
      /** @type {import("./browser.mjs").Site} */
      let site;
      before(async () => (site = await startSite({ isOffScreen: true })));
      after(() => site?.close());

      /**
       * Tests on a fresh page, which must report no errors.
       * @param {string} name
       * @param {((site: import("./browser.mjs").Site) => string) | null} link
       * @param {(page: TestPage) => Promise<void>} body
       */
      const onPage = (name, link, body) =>
        test(name, async () => {
          const page = await site.page({ renderer, link: link?.(site) ?? "" });
          try {
            await body(page);
            assert.deepEqual(page.troubles, []);
          } finally {
            await page.finish();
          }
        });

      /** @param {import("./browser.mjs").Site} site */
      const model = (site) => `model=${encodeURIComponent(site.data(XBOT))}&play=0`;

      onPage("a dropped .bvh plays on the model that is shown", model, async (page) => {
        await apply(page, { clip: "", play: 1 });
        const rest = await pose(page);
        await drop(page, [{ name: "dance.bvh", url: site.data(DANCE) }]);
        await until(page, async () => (await window.gaitway.pose()).clip === "dance");
        const { motion, map, model } = await state(page);
        assert.deepEqual(motion, ["dance.bvh"]);
        assert.equal(map.length, 1);
        assert.deepEqual(model, [site.data(XBOT)]);
        await until(page, async () => (await window.gaitway.pose()).time_secs > 0.2);
        const dancing = await pose(page);
        assert.equal(dancing.meshes[0].positions.length, rest.meshes[0].positions.length);
        assert.ok(furthest(dancing, rest) > 0.1, `moved by ${furthest(dancing, rest)} m`);
      });

      onPage("a character dropped at the right lends its motion", model, async (page) => {
        await drop(page, [{ name: "Soldier.glb", url: site.data(SOLDIER) }], 0.9);
        await whenBorrowed(page, 1);
        const { model, motion } = await state(page);
        assert.deepEqual([model, motion], [[site.data(XBOT)], ["Soldier.glb"]]);
        assert.equal(await page.locator("#drop").isVisible(), false);
      });

      onPage("another character's clips are borrowed by role", model, async (page) => {
        const document = await page.evaluate(async (url) => await window.gaitway.open(url, { as: "motion" }), site.data(SOLDIER));
        assert.equal(document.clips.length, XBOT_CLIPS);
        assert.ok(document.borrowed_clips?.some(({ name }) => name === "Run"), JSON.stringify(document.borrowed_clips));
        await apply(page, { clip: "Run", t: 0.3, play: 0 });
        const run = await pose(page);
        assert.equal(run.clip, "Run");
        await apply(page, { clip: "" });
        assert.ok(furthest(run, await pose(page)) > 0.1);
        assert.deepEqual((await state(page)).motion, [site.data(SOLDIER)]);
      });

      onPage("a link with model and motion gives the same pose again", model, async (page) => {
        await open(page, site.data(DANCE));
        await apply(page, { t: 2, play: 0, root: "in-place", feet: "plant" });
        const shown = await pose(page);
        const link = await page.evaluate(async () => {
          const { model, motion, map, clip, root, feet } = await window.gaitway.state();
          const all = Object.entries({ model, motion, map, clip: clip ?? "", root: root ?? "", feet: feet ?? "", t: 2, play: 0 });
          return all.flatMap(([key, value]) => [value].flat().map((value) => `${key}=${encodeURIComponent(value)}`)).join("&");
        });
        const again = await site.page({ renderer, link });
        try {
          const other = await pose(again);
          assert.equal(other.clip, shown.clip);
          assert.equal(furthest(other, shown), 0);
          await apply(again, { root: null });
          assert.ok(furthest(await pose(again), shown) > 0, "the root option should matter");
        } finally {
          await again.finish();
        }
      });

      onPage("motion with nothing in common is rejected and changes nothing", model, async (page) => {
        await apply(page, { clip: "walk", t: 0.4, play: 0 });
        const [earlier, before] = [await state(page), await picture(page)];
        const refused = await page.evaluate(async (text) => {
          const bytes = new TextEncoder().encode(text);
          return await window.gaitway.open({ "worm.bvh": bytes.buffer }).then(() => "", (error) => error.message);
        }, WORM);
        assert.match(refused, /worm\.bvh.*no joint in common/);
        assert.deepEqual(await state(page), earlier);
        assert.equal(meanDifference(await picture(page), before), 0);
        // It can still be shown by itself.
        await apply(page, { model: await page.evaluate((text) => URL.createObjectURL(new Blob([text])), WORM) });
        assert.equal((await pose(page)).nodes.length, 2);
        assert.equal((await state(page)).motion.length, 0);
      });

      onPage("a joint map is dropped, changed by script, and kept when a new one is wrong", model, async (page) => {
        const alone = await page.evaluate(async () => {
          const bytes = new TextEncoder().encode('{"gaitway_map":1,"joints":{}}');
          return await window.gaitway.open({ "map.json": bytes.buffer }).then(() => "", (error) => error.message);
        });
        assert.match(alone, /no motion/);
        await open(page, site.data(DANCE));
        await apply(page, { t: 1, play: 0 });
        const automatic = await pose(page);
        const joints = { "mixamorig:Hips": { source: "Hips" }, "mixamorig:LeftArm": { source: "RightUpArm" } };
        await drop(page, [{ name: "map.json", text: JSON.stringify({ gaitway_map: 1, joints }) }]);
        await until(page, async () => (await window.gaitway.state()).map[0].split(",").length === 2);
        assert.ok(furthest(await pose(page), automatic) > 0.05);
        const wrong = { gaitway_map: 1, joints: { "mixamorig:Hip": { source: 0 } } };
        await assert.rejects(apply(page, { map: wrong }), /mixamorig:Hip.*nearest.*mixamorig:Hips/);
        assert.equal((await state(page)).map[0].split(",").length, 2);
        await apply(page, { map: null });
        assert.equal(furthest(await pose(page), automatic), 0);
      });

      onPage("a model and its motion arrive together, and the motion stays for the next model", null, async (page) => {
        await drop(page, [
          { name: "Xbot.glb", url: site.data(XBOT) },
          { name: "dance.bvh", url: site.data(DANCE) },
        ]);
        await until(page, async () => (await window.gaitway.pose()).clip === "dance");
        assert.deepEqual((await state(page)).model, ["Xbot.glb"]);
        await drop(page, [{ name: "Soldier.glb", url: site.data(SOLDIER) }]);
        await until(page, async () => (await window.gaitway.state()).model[0] === "Soldier.glb");
        assert.equal((await pose(page)).clip, "dance");
        // A snake has no arms or legs to retarget to.
        await drop(page, [{ name: "snake.glb", url: site.data(SNAKE) }]);
        await until(page, async () => (await window.gaitway.state()).model[0] === "snake.glb");
        assert.notEqual((await pose(page)).clip, "dance");
      });

      test("everything comes back after a crash, dropped motion too", async () => {
        const own = await startSite({ isOffScreen: true });
        try {
          const page = await own.page({ renderer });
          await drop(page, [{ name: "Xbot.glb", url: own.data(XBOT) }]);
          await until(page, async () => (await window.gaitway.state()).model[0] === "Xbot.glb");
          await drop(page, [{ name: "dance.bvh", url: own.data(DANCE) }]);
          await until(page, async () => (await window.gaitway.pose()).clip === "dance");
          await apply(page, { t: 1, play: 0 });
          const shown = await pose(page);
          const session = await own.browser.newBrowserCDPSession();
          await session.send("Browser.crashGpuProcess").catch(() => {});
          const again = page.locator("#stopped-again");
          await again.waitFor({ state: "visible" });
          await again.click();
          await whenReady(page);
          assert.equal(furthest(await pose(page), shown), 0);
        } finally {
          await own.close();
        }
      });

      onPage("layers play over the current clip, by script and link", model, async (page) => {
        await apply(page, { clip: "agree", t: 0.2, play: 0 });
        const agree = await pose(page);
        await apply(page, { clip: "run", t: 0.2 });
        const run = await pose(page);
        await apply(page, { layers: ["agree:weight:0", "headShake:weight:0"] });
        assert.equal(furthest(await pose(page), run), 0);
        // Each layer has a track below the viewport.
        const running = await picture(page);
        await apply(page, { layers: ["agree"] });
        assert.equal(furthest(await pose(page), agree), 0);
        await apply(page, { layers: ["agree:mask:head", "headShake:weight:0.5,additive,mask:left-arm:right-arm"] });
        const layered = await pose(page);
        assert.ok(furthest(layered, run) > 0.01 && furthest(layered, agree) > 0.1);
        const foot = (/** @type {typeof run} */ shown) => shown.nodes.find((node) => node.name === "mixamorig:LeftFoot")?.world;
        assert.deepEqual(foot(layered), foot(run));
        assert.ok(meanDifference(await picture(page), running) > 0);
        await assert.rejects(apply(page, { layers: ["agree:weight:NaN"] }), /layers=agree:weight:NaN: expected a clip/);
        const kept = await state(page);
        assert.deepEqual(kept.layers, ["agree:mask:head", "headShake:weight:0.5,additive,mask:left-arm:right-arm"]);
        // The link has them, and they return with it.
        await apply(page, { layers: null });
        assert.equal(furthest(await pose(page), run), 0);
        await apply(page, { layers: kept.layers });
        assert.equal(furthest(await pose(page), layered), 0);
      });

      onPage("the model is saved with the borrowed clip", model, async (page) => {
        await open(page, site.data(DANCE));
        await apply(page, { t: 1.5, play: 0 });
        const shown = await pose(page);
        await showFiles(page);
        const { name, bytes } = await savedBy(page, "Save GLB");
        assert.equal(name, "Xbot-cosc422_Dance.glb");
        const document = await page.evaluate(async (base64) => {
          const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
          return await window.gaitway.open({ "again.glb": bytes.buffer });
        }, bytes.toString("base64"));
        assert.equal(document.clips.length, XBOT_CLIPS + 1);
        await apply(page, { clip: String(XBOT_CLIPS), t: 1.5, play: 0 });
        assert.ok(furthest(await pose(page), shown) < 1e-6);
      });

      onPage("a pinned hand stays while the dance goes on, in the link, too", model, async (page) => {
        const hand = async (/** @type {TestPage} */ page) => {
          const { nodes } = await pose(page);
          const world = nodes.find(({ name }) => name === "mixamorig:LeftHand")?.world ?? [];
          return world.slice(12, 15);
        };
        await open(page, site.data(DANCE));
        await apply(page, { t: 1, play: 0 });
        const free = await hand(page);
        const { nodes } = await pose(page);
        const [number, head] = ["mixamorig:LeftHand", "mixamorig:Head"].map((joint) => nodes.find(({ name }) => name === joint)?.node ?? NaN);
        const before = await picture(page);
        // Above the head, within reach.
        const at = [free[0], free[1] + 0.1, free[2] + 0.05];
        await apply(page, { pin: [`${number}:at:${at.join(",")}`, `${head}:look:camera`] });
        const pinned = await hand(page);
        assert.ok(Math.hypot(...pinned.map((x, axis) => x - at[axis])) < 1e-4, `${pinned} instead of ${at}`);
        assert.ok(meanDifference(await picture(page), before) > 0);
        const { model, motion, map, clip, pin } = await state(page);
        assert.deepEqual(pin.map((text) => text.split(":")[1]), head < number ? ["look", "at"] : ["at", "look"]);
        const all = Object.entries({ model, motion, map, clip: clip ?? "", pin, t: 1, play: 0 });
        const link = all.flatMap(([key, value]) => [value].flat().map((value) => `${key}=${encodeURIComponent(value)}`)).join("&");
        const again = await site.page({ renderer, link });
        try {
          assert.equal(furthest(await pose(again), await pose(page)), 0);
          await assert.rejects(apply(again, { pin: ["x:at:1,2,3"] }), /pin/);
        } finally {
          await again.finish();
        }
        await apply(page, { pin: null });
        assert.deepEqual(await hand(page), free);
      });

      onPage("the active map is saved as a file", model, async (page) => {
        await open(page, site.data(DANCE));
        await apply(page, { play: 0 });
        await showFiles(page);
        const { name, bytes } = await savedBy(page, "Save map");
        assert.equal(name, "Xbot-cosc422_Dance.json");
        const saved = JSON.parse(bytes.toString());
        assert.equal(saved.gaitway_map, 1);
        assert.deepEqual(saved.joints["mixamorig:Hips"], { source: "Hips" });
      });
    });
});

/**
 * Opens Files in the Motion tab.
 * @param {TestPage} page
 */
async function showFiles(page) {
  await resize(page, 1280, 800);
  await control(page, "tab", "Motion").press("Enter");
  await control(page, "radio", "Files").press("Enter");
}
