// The viewport: compared skinning methods, the motion's source, joints posed manually, and saved images and videos.
import assert from "node:assert/strict";
import { after, afterEach, before, describe, test } from "node:test";
import { unzipSync } from "fflate";
import { skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, apply, control, eventually, furthest, resize, toggleInspector, pose, savedBy, startSite, state, stats } from "./browser.mjs";

const SOLDIER = "threejs/Soldier.glb";
const XBOT = "threejs/Xbot.glb";
const FOREARM = "mixamorig:LeftForeArm";
const RECORD = "Record one loop";

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
    before(async () => void (site = await startSite({ isOffScreen: true })));
    after(() => site?.close());

    const link = () => `model=${site.data(SOLDIER)}&motion=${site.data(XBOT)}&clip=walk&t=0.3&range=0.1,0.5&play=0`;

    /**
     * @param {string} name
     * @param {(page: import("./browser.mjs").TestPage) => Promise<void>} body
     * @param {() => void} [before] Runs in the page before its scripts.
     */
    const onPage = (name, body, before) =>
      test(name, async () => {
        const page = await site.page({ renderer, link: link(), before });
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

    /** @param {import("./browser.mjs").TestPage} page */
    async function openCameraTab(page) {
      await resize(page, 1280, 800);
      await toggleInspector(page);
      await control(page, "tab", "Camera").press("Enter");
      await control(page, "button", RECORD).waitFor({ state: "attached" });
    }

    /**
     * @param {import("./browser.mjs").TestPage} page
     * @param {boolean} isTransparent
     */
    async function chooseBackground(page, isTransparent) {
      const box = control(page, "checkbox", "Transparent background");
      const isChosen = async () => (await box.getAttribute("aria-checked")) === String(isTransparent);
      if (!(await isChosen())) await box.press("Enter");
      await eventually(isChosen);
    }

    /**
     * Chooses a size for what is saved.
     * @param {import("./browser.mjs").TestPage} page
     * @param {number} width
     * @param {number} height
     */
    async function chooseSize(page, width, height) {
      for (const [name, pixels] of /** @type {const} */ ([["Width in pixels", width], ["Height in pixels", height]])) {
        const field = control(page, "spinbutton", name);
        await field.fill(String(pixels));
        await eventually(async () => (await field.inputValue()) === String(pixels));
      }
    }

    /**
     * Decodes a picture in the page, and returns the alpha of one of its corners beside a sum over all pixels.
     * @param {import("./browser.mjs").TestPage} page
     * @param {Uint8Array} png
     */
    const decodedPicture = (page, png) =>
      page.evaluate(async (base64) => {
        const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
        const { width, height } = bitmap;
        const context = new OffscreenCanvas(width, height).getContext("2d");
        if (context === null) throw new Error("no 2D context");
        context.drawImage(bitmap, 0, 0);
        const { data } = context.getImageData(0, 0, width, height);
        return { width, height, cornerAlpha: data[4 * width * 2 + 4 * 2 + 3], sum: data.reduce((sum, byte) => sum + byte, 0) };
      }, Buffer.from(png).toString("base64"));

    /**
     * Decodes a GIF in the page.
     * @param {import("./browser.mjs").TestPage} page
     * @param {Buffer} file
     */
    const decodedGif = (page, file) =>
      page.evaluate(async (base64) => {
        const decoder = new ImageDecoder({ type: "image/gif", data: await (await fetch(`data:image/gif;base64,${base64}`)).arrayBuffer() });
        await Promise.all([decoder.completed, decoder.tracks.ready]);
        const track = decoder.tracks.selectedTrack;
        const frames = [];
        for (let frameIndex = 0; frameIndex < (track?.frameCount ?? 0); frameIndex++) {
          const { image } = await decoder.decode({ frameIndex });
          const { displayWidth: width, displayHeight: height, duration } = image;
          const context = new OffscreenCanvas(width, height).getContext("2d");
          if (context === null) throw new Error("no 2D context");
          context.drawImage(image, 0, 0);
          const { data } = context.getImageData(0, 0, width, height);
          const alphas = data.filter((_, at) => at % 4 === 3);
          /** @type {(x: number, y: number) => number} */
          const shownAt = (x, y) => (x >= 0 && x < width && data[4 * (y * width + x) + 3] === 255 ? 1 : 0);
          let specks = 0;
          for (let at = 0; at < width * height; at++) {
            const [x, y] = [at % width, Math.floor(at / width)];
            const around = [-1, 0, 1].reduce((sum, dy) => sum + shownAt(x - 1, y + dy) + shownAt(x, y + dy) + shownAt(x + 1, y + dy), 0);
            if (shownAt(x, y) === 1 && around < 4) specks += 1;
          }
          const colors = new Set(new Uint32Array(data.buffer)).size;
          frames.push({ width, height, specks, millis: (duration ?? 0) / 1000, colors, shown: alphas.filter((alpha) => alpha === 255).length, hidden: alphas.filter((alpha) => alpha === 0).length, text: data.join() });
          image.close();
        }
        return { frames, playsForever: track?.repetitionCount === Infinity };
      }, file.toString("base64"));

    /**
     * Records a video and checks it.
     * @param {import("./browser.mjs").TestPage} page
     * @param {{ extension: string, isTransparent?: boolean, isExact?: boolean }} expected
     */
    async function checkVideo(page, { extension, isTransparent = false, isExact = true }) {
      await chooseSize(page, 320, 180);
      await chooseBackground(page, isTransparent);
      const shown = await state(page);
      const { name, bytes } = await savedBy(page, RECORD);
      assert.equal(name, `Soldier-walk.${extension}`);
      const video = await decoded(page, bytes, 30);
      assert.deepEqual([video.width, video.height], [320, 180]);
      // MediaRecorder has its own clock: on a busy machine, 11 of 12 frames were seen.
      assert.ok(isExact ? video.frames === 12 : video.frames >= 9 && video.frames <= 12, `${video.frames} frames`);
      assert.ok(isExact ? Math.abs(video.durationSecs - 0.4) < 0.002 : video.durationSecs > 0.3, `${video.durationSecs} s`);
      assert.equal(video.cornerAlpha, isTransparent ? 0 : 255);
      assert.deepEqual(await state(page), shown, "the view stays as it was");
      assert.deepEqual(page.troubles, []);
    }

    describe("of one page", () => {
      /** @type {import("./browser.mjs").TestPage} */
      let page;
      before(async () => {
        page = await site.page({ renderer, link: link() });
        await openCameraTab(page);
      });
      after(() => page?.finish());
      afterEach(() => assert.deepEqual(page.troubles, []));

      test("images of any size are saved", async () => {
        await chooseBackground(page, true);
        const { name, bytes } = await savedBy(page, "Save image (PNG)");
        assert.equal(name, "Soldier-walk.png");
        const { width, height, cornerAlpha } = await decodedPicture(page, bytes);
        assert.deepEqual([width, height], [1920, 1080]);
        assert.equal(cornerAlpha, 0, "nothing is behind the model");
      });

      test("one loop is saved as images", async () => {
        // Unlike a video's, their height may be odd.
        await chooseSize(page, 320, 181);
        await chooseBackground(page, true);
        const { name, bytes } = await savedBy(page, "Save one loop as images");
        assert.equal(name, "Soldier-walk.zip");
        const files = unzipSync(bytes);
        const names = Array.from({ length: 12 }, (_, index) => `frame-${String(index + 1).padStart(2, "0")}.png`);
        assert.deepEqual(Object.keys(files), names);
        const pictures = [];
        for (const file of names) pictures.push(await decodedPicture(page, files[file]));
        for (const { width, height, cornerAlpha } of pictures) assert.deepEqual([width, height, cornerAlpha], [320, 181, 0]);
        assert.ok(new Set(pictures.map(({ sum }) => sum)).size > 6, "it moves");
      });

      for (const isTransparent of [false, true])
        test(`a GIF of one loop has every frame${isTransparent ? ", without a background" : ""}`, async () => {
          await chooseSize(page, 320, 180);
          await chooseBackground(page, isTransparent);
          const { name, bytes } = await savedBy(page, "Record one loop as a GIF");
          assert.equal(name, "Soldier-walk.gif");
          const { frames, playsForever } = await decodedGif(page, bytes);
          assert.ok(playsForever);
          // 30 frames per second, in hundredths of a second.
          assert.deepEqual(frames.map(({ millis }) => millis), [30, 40, 30, 30, 40, 30, 30, 40, 30, 30, 40, 30]);
          assert.equal(new Set(frames.map(({ text }) => text)).size, 12, "it moves");
          for (const { width, height, specks, colors, shown, hidden } of frames) {
            assert.deepEqual([width, height, shown + hidden], [320, 180, 320 * 180]);
            assert.ok(colors > 128 && colors <= 256, `${colors} colours`);
            assert.ok(isTransparent ? hidden > shown && shown > 2000 : hidden === 0, `${shown} pixels shown`);
            // Tips of the character; with the grid, it was 26 and more.
            assert.ok(specks <= 8, `${specks} specks`);
          }
        });

      test("a video of one loop has every frame", () => checkVideo(page, { extension: "mp4" }));
      test("a video without a background is transparent", () => checkVideo(page, { extension: "webm", isTransparent: true }));
    });

    onPage(
      "a browser without WebCodecs records in real time",
      async (page) => {
        await openCameraTab(page);
        await checkVideo(page, { extension: "webm", isExact: false });
      },
      () => void Reflect.deleteProperty(window, "VideoEncoder"),
    );

    onPage("a video that is cancelled or can't be encoded is not saved", async (page) => {
      /** @type {string[]} */
      const downloads = [];
      page.on("download", (download) => downloads.push(download.suggestedFilename()));
      await page.route("**/parts/video-*", (route) => route.abort());
      await openCameraTab(page);
      await control(page, "button", RECORD).press("Enter");
      const said = (/** @type {string} */ id, /** @type {RegExp} */ text) => eventually(async () => text.test((await page.locator(id).textContent()) ?? ""), String(text));
      await said("#problem", /Couldn't record the video: .*can't be loaded/);
      await page.unroute("**/parts/video-*");
      await control(page, "button", RECORD).press("Enter");
      await eventually(() => page.requests.filter((url) => url.includes("/parts/video-")).length > 1);
      await page.keyboard.press("Escape");
      await said("#news", /Recording cancelled/);
      assert.deepEqual(downloads, []);
    });
  });
