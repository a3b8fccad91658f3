// The viewport: compared skinning methods, the motion's source, joints posed manually, and saved images and videos.
import assert from "node:assert/strict";
import fs from "node:fs";
import { after, before, describe, test } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, apply, eventually, furthest, toggleInspector, pose, startSite, state, stats, untilStill } from "./browser.mjs";

const SOLDIER = "threejs/Soldier.glb";
const XBOT = "threejs/Xbot.glb";
const FOREARM = "mixamorig:LeftForeArm";

/** @typedef {[x: number, y: number]} Place */

// The canvas has no elements to ask for. Places at the end of the Camera tab, in a window of 1280×800.
/** @type {Place} */
const WIDTH = [1035, 501];
/** @type {Place} */
const HEIGHT = [1133, 501];
/** @type {Place} */
const TRANSPARENT = [1244, 535];
/** @type {Place} */
const SAVE_IMAGE = [1125, 571];
/** @type {Place} */
const RECORD = [1125, 649];

/**
 * Plays a video in the page: seeks to the middle of each frame and compares it with the one before.
 * @param {import("./browser.mjs").TestPage} page
 * @param {Buffer} file
 * @param {number} framesPerSec
 */
function decoded(page, file, framesPerSec) {
  /** @param {{ base64: string, framesPerSec: number }} video */
  const decode = async ({ base64, framesPerSec }) => {
    const video = document.createElement("video");
    video.src = URL.createObjectURL(await (await fetch(`data:video/webm;base64,${base64}`)).blob());
    /** @param {"loadeddata" | "seeked"} event */
    const next = (event) =>
      new Promise((resolve, reject) => {
        video.addEventListener(event, resolve, { once: true });
        video.onerror = () => reject(new Error(video.error?.message));
      });
    await next("loadeddata");
    const { videoWidth: width, videoHeight: height } = video;
    const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    if (context === null) throw new Error("no 2D context");
    let before = "";
    let frames = 0;
    let cornerAlpha = 0;
    // A video recorded in real time has no known duration until it has been played to its end.
    video.currentTime = 1e6;
    await next("seeked");
    const durationSecs = video.duration;
    // One seek beyond the end, since the last recorded frame has no duration.
    for (let index = 0; (index - 1) / framesPerSec < durationSecs; index++) {
      // The new frame can be drawn a moment after the seek; past the end there is none.
      const presented = new Promise((resolve) => {
        video.requestVideoFrameCallback(resolve);
        setTimeout(resolve, 2000);
      });
      video.currentTime = (index + 0.5) / framesPerSec;
      await next("seeked");
      await presented;
      context.clearRect(0, 0, width, height);
      context.drawImage(video, 0, 0);
      const { data } = context.getImageData(0, 0, width, height);
      cornerAlpha = data[4 * width * 2 + 4 * 2 + 3];
      const frame = data.join();
      if (frame !== before) frames += 1;
      before = frame;
    }
    return { width, height, frames, durationSecs, cornerAlpha };
  };
  return page.evaluate(decode, { base64: file.toString("base64"), framesPerSec });
}

for (const renderer of BACK_ENDS)
  describe(`stage on ${renderer}`, { skip: skipWithoutData }, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => void (site = await startSite()));
    after(() => site?.close());

    /**
     * @param {string} name
     * @param {(page: import("./browser.mjs").TestPage) => Promise<void>} body
     * @param {() => void} [before] Runs in the page before its scripts.
     */
    const onPage = (name, body, before) =>
      test(name, async () => {
        const link = `model=${site.data(SOLDIER)}&motion=${site.data(XBOT)}&clip=walk&t=0.3&play=0`;
        const page = await site.page({ renderer, link, before });
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

    /**
     * Opens the end of the Camera tab. The canvas has no elements to ask for, so the places of its controls are known here.
     * @param {import("./browser.mjs").TestPage} page
     */
    async function openCameraTab(page) {
      await page.setViewportSize({ width: 1280, height: 800 });
      await toggleInspector(page);
      await page.mouse.click(1183, 69);
      await untilStill(page);
      await page.mouse.move(1130, 400);
      await page.mouse.wheel(0, 2400);
      await untilStill(page);
    }

    /**
     * @param {import("./browser.mjs").TestPage} page
     * @param {Place} at
     */
    async function press(page, [x, y]) {
      await page.mouse.click(x, y);
      await untilStill(page);
    }

    onPage("images of any size are saved", async (page) => {
      await openCameraTab(page);
      await press(page, TRANSPARENT);
      const picture = page.waitForEvent("download");
      await page.mouse.click(...SAVE_IMAGE);
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
    });

    /** @type {{ name: string, extension: string, isTransparent?: boolean, before?: () => void }[]} */
    const videos = [
      { name: "a video of one loop has every frame", extension: "mp4" },
      { name: "a video without a background is transparent", extension: "webm", isTransparent: true },
      { name: "a browser without WebCodecs records in real time", extension: "webm", before: () => void Reflect.deleteProperty(window, "VideoEncoder") },
    ];
    for (const { name, extension, isTransparent = false, before } of videos)
      onPage(
        name,
        async (page) => {
          await apply(page, { range: "0.1,0.5" });
          await openCameraTab(page);
          for (const [field, pixels] of /** @type {const} */ ([[WIDTH, 320], [HEIGHT, 180]])) {
            // Its blinking caret never comes to rest.
            await page.mouse.click(...field);
            await page.keyboard.type(`${pixels}\n`);
            await untilStill(page);
          }
          if (isTransparent) await press(page, TRANSPARENT);
          const shown = await state(page);
          const saved = page.waitForEvent("download");
          await page.mouse.click(...RECORD);
          const file = await saved;
          assert.equal(file.suggestedFilename(), `Soldier-walk.${extension}`);
          const video = await decoded(page, fs.readFileSync(await file.path()), 30);
          const isExact = before === undefined;
          assert.deepEqual([video.width, video.height], [320, 180]);
          // MediaRecorder has its own clock: on a busy machine, 11 of 12 frames were seen.
          assert.ok(isExact ? video.frames === 12 : video.frames >= 9 && video.frames <= 12, `${video.frames} frames`);
          assert.ok(isExact ? Math.abs(video.durationSecs - 0.4) < 0.002 : video.durationSecs > 0.3, `${video.durationSecs} s`);
          assert.equal(video.cornerAlpha, isTransparent ? 0 : 255);
          assert.deepEqual(await state(page), shown, "the view stays as it was");
          assert.deepEqual(page.troubles, []);
        },
        before,
      );

    onPage("a video that is cancelled or can't be encoded is not saved", async (page) => {
      /** @type {string[]} */
      const downloads = [];
      page.on("download", (download) => downloads.push(download.suggestedFilename()));
      await page.route("**/parts/video-*", (route) => route.abort());
      await openCameraTab(page);
      await page.mouse.click(...RECORD);
      const said = (/** @type {string} */ id, /** @type {RegExp} */ text) => eventually(async () => text.test((await page.locator(id).textContent()) ?? ""), String(text));
      await said("#problem", /Couldn't record the video: .*can't be loaded/);
      await page.unroute("**/parts/video-*");
      await page.mouse.click(...RECORD);
      await eventually(() => page.requests.filter((url) => url.includes("/parts/video-")).length > 1);
      await page.keyboard.press("Escape");
      await said("#news", /Recording cancelled/);
      assert.deepEqual(downloads, []);
    });
  });
