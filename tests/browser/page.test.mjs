// The built page on each back end: it starts, opens real files in every way, and responds to users and scripts.
import assert from "node:assert/strict";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import { dataFile, skipWithoutData } from "../three/data.mjs";
import { loadScene } from "../three/scene.mjs";
import { triangle } from "../three/triangle.mjs";
import { BACK_ENDS, VIEWPORT, apply, colorsOf, controls, drop, eventually, framesDrawnDuring, meanDifference, onOneBackEnd, open, picture, pose, resize, startSite, state, stats, until, untilStill, whenModel, whenPictureDiffers, whenReady, whenShown } from "./browser.mjs";

const FOX = "khronos/Fox/glTF-Binary/Fox.glb";
const FOX_VERTICES = 1728;
const CESIUM_MAN = "khronos/CesiumMan/glTF/CesiumMan.gltf";
const CESIUM_MAN_VERTICES = 3273;
/** Display frames in an idle second. */
const IDLE_FRAMES = 60;
const CENTER = { x: VIEWPORT.width / 2, y: VIEWPORT.height / 2 };

/** A PNG of one pixel. */
const PIXEL = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";

/** A code point that no font has. */
const UNASSIGNED = "\u0378";

/**
 * Runs in the page: whether its browser has glyphs for a text, rather than drawing the missing-glyph box.
 * @param {string} text
 */
function hasFontFor(text) {
  /** @param {string} text */
  const pixels = (text) => {
    const context = new OffscreenCanvas(200, 40).getContext("2d");
    if (context === null) throw new Error("no 2D context");
    context.font = "20px sans-serif";
    context.fillText(text, 0, 30);
    return context.getImageData(0, 0, 200, 40).data.join();
  };
  return pixels(text) !== pixels("\u0378".repeat(text.length));
}

/** Runs in the page: the first instance of the program traps when it is asked for a pose. */
function trapOnce() {
  const { instantiate } = WebAssembly;
  /** @type {any} */ (WebAssembly).instantiate = async (/** @type {WebAssembly.Module} */ module, /** @type {WebAssembly.Imports} */ imports) => {
    WebAssembly.instantiate = instantiate;
    const { exports } = await instantiate(module, imports);
    const pose = () => {
      throw new WebAssembly.RuntimeError("unreachable");
    };
    return { instance: { exports: { ...exports, pose } }, module };
  };
}

/** Runs in the page: the first instance of the program panics when it is asked for a pose. */
function panicOnce() {
  const { instantiate } = WebAssembly;
  /** @type {any} */ (WebAssembly).instantiate = async (/** @type {WebAssembly.Module} */ module, /** @type {WebAssembly.Imports} */ imports) => {
    WebAssembly.instantiate = instantiate;
    const { exports } = await instantiate(module, imports);
    return { instance: { exports: { ...exports, pose: exports.panic_for_test } }, module };
  };
}

/**
 * Programs that the page has requested.
 * @param {import("./browser.mjs").TestPage} page
 */
const programs = (page) => page.requests.flatMap((url) => url.match(/(webgpu|webgl2)-[0-9a-f]{16}\.wasm$/)?.[1] ?? []);

// GLTFLoader's warnings about the reference file don't matter here.
console.warn = () => {};

/**
 * Returns a function that declares tests on fresh pages of a site, which must report no errors.
 * @param {import("../../web/shell/types.d.ts").Backend} renderer
 * @param {() => import("./browser.mjs").Site} site
 * @param {(name: string, body: (t: import("node:test").TestContext) => Promise<void>, options: import("node:test").TestOptions) => void} declare
 */
const onFreshPages =
  (renderer, site, declare = (name, body, options) => void test(name, options, body)) =>
  /**
   * @param {string} name
   * @param {{ data?: boolean, link?: () => string, isCalm?: boolean }} options
   * @param {(page: import("./browser.mjs").TestPage, t: import("node:test").TestContext) => Promise<void>} body
   */
  (name, { data = false, link, isCalm }, body) =>
    declare(
      name,
      async (t) => {
        const page = await site().page({ renderer, link: link?.(), ...(isCalm === undefined ? {} : { isCalm }) });
        try {
          await body(page, t);
          assert.deepEqual(page.troubles, []);
        } finally {
          await page.finish();
        }
      },
      { skip: data ? skipWithoutData : false },
    );

for (const renderer of BACK_ENDS) {
  describe(`screen on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => (site = await startSite()));
    after(() => site?.close());

    const onPage = onFreshPages(renderer, () => site);

    onPage("starts with a sample that moves", { link: () => "model=sample:walker" }, async (page) => {
      const { backend } = await stats(page);
      assert.equal(backend, renderer);
      const first = await pose(page);
      const firstPicture = await picture(page);
      const firstScreen = await page.screenshot();
      await until(page, async (before) => (await window.gaitway.pose()).time_secs !== before, first.time_secs);
      const second = await pose(page);
      assert.ok(first.meshes.length > 0);
      assert.notDeepEqual(second.meshes[0].positions, first.meshes[0].positions);
      await whenPictureDiffers(page, firstPicture);
      await eventually(async () => !firstScreen.equals(await page.screenshot()), "the screen should move");
    });

    for (const [script, one, other] of [["Japanese", "腕", "脚"], ["Georgian", "მკლავი", "ფეხი"]])
      onPage(`shows names in ${script}, which its own font lacks`, { link: () => "model=sample:walker&play=0&joint=3" }, async (page, t) => {
        if (!(await page.evaluate(hasFontFor, one))) return t.skip(`this machine has no font for ${script}`);
        /** @param {string} name */
        const labelled = async (name) => {
          await apply(page, { names: `3:${encodeURIComponent(name)}` });
          await untilStill(page);
          return (await page.screenshot()).toString("base64");
        };
        const shown = await labelled(one);
        assert.notEqual(shown, await labelled(other), "two names");
        assert.notEqual(shown, await labelled(UNASSIGNED.repeat(one.length)), "a box for each letter");
        assert.equal(shown, await labelled(one), "nothing but the name changes the picture");
      });

    onPage("says that a folder has no files in it", {}, async (page) => {
      const before = await page.screenshot();
      await page.locator("#gallery-own").evaluate((button) => button instanceof HTMLElement && button.click());
      await page.locator("#open-folder").dispatchEvent("change");
      await until(page, () => /folder has no files/.test(document.querySelector("#problem")?.textContent ?? ""));
      assert.equal(await page.locator("#open").isVisible(), false);
      // Resolves after the next frame.
      await apply(page, { play: 0 });
      assert.ok(!before.equals(await page.screenshot()), "the notice should be on the screen");
    });
  });

  describe(`page on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => (site = await startSite({ isOffScreen: true, isCalm: true })));
    after(() => site?.close());

    /** @type {import("./browser.mjs").TestPage | undefined} */
    let shared;
    /**
     * Tests on a page that several tests share: each opens what it needs itself. The page must report no errors.
     * @param {string} name
     * @param {{ data?: boolean }} options
     * @param {(page: import("./browser.mjs").TestPage) => Promise<void>} body
     */
    const onSharedPage = (name, options, body) =>
      test(name, { skip: options.data === true ? skipWithoutData : false }, async () => {
        shared ??= await site.page({ renderer });
        await body(shared);
        assert.deepEqual(shared.troubles, []);
      });

    const onPage = onFreshPages(renderer, () => site);
    /** For what doesn't depend on the back end. */
    const once = onOneBackEnd(renderer);
    const onPageOnce = onFreshPages(renderer, () => site, once);

    onSharedPage("requests nothing from other hosts and works in any folder", {}, async (page) => {
      const { origin } = new URL(page.url());
      const others = page.requests.filter((url) => !/^(data|blob):/.test(url) && !url.startsWith(`${origin}/some/folder/`));
      assert.deepEqual(others, []);
    });

    onSharedPage("opens one dropped file", { data: true }, async (page) => {
      await drop(page, [{ name: "Fox.glb", url: site.data(FOX) }]);
      await whenShown(page, FOX_VERTICES);
    });

    onSharedPage("opens a .gltf dropped with its files", { data: true }, async (page) => {
      const folder = path.posix.dirname(CESIUM_MAN);
      const names = ["CesiumMan.jpg", "CesiumMan.gltf", "CesiumMan0.bin"];
      await drop(page, names.map((name) => ({ name, url: site.data(`${folder}/${name}`) })));
      await whenShown(page, CESIUM_MAN_VERTICES);
    });

    onPage("opens the URL of a link, with clip, time and camera", { data: true, link: () => `model=${encodeURIComponent(site.data(FOX))}&clip=Run&t=0.5&play=0&camera=40,15,250,0,40,0` }, async (page) => {
      await whenShown(page, FOX_VERTICES);
      const { clip, time_secs } = await pose(page);
      assert.equal(clip, "Run");
      assert.equal(time_secs, 0.5);
      const { camera, play } = await state(page);
      assert.deepEqual(String(camera).split(",").map(Number), [40, 15, 250, 0, 40, 0]);
      assert.equal(Number(play), 0);
    });

    onSharedPage("opens URLs, buffers and files from a script", { data: true }, async (page) => {
      const byUrl = await open(page, site.data(CESIUM_MAN));
      assert.equal(byUrl.vertices, CESIUM_MAN_VERTICES);
      const byBuffer = await page.evaluate(
        async (url) => await window.gaitway.open({ "Fox.glb": await (await fetch(url)).arrayBuffer() }),
        site.data(FOX),
      );
      assert.equal(byBuffer.vertices, FOX_VERTICES);
      assert.deepEqual(byBuffer.clips.map(({ name }) => name), ["Survey", "Walk", "Run"]);
      const byFile = await page.evaluate(
        async (url) => await window.gaitway.open([new File([await (await fetch(url)).blob()], "CesiumMan.glb")]),
        site.data("khronos/CesiumMan/glTF-Binary/CesiumMan.glb"),
      );
      assert.equal(byFile.vertices, CESIUM_MAN_VERTICES);
      await whenShown(page, CESIUM_MAN_VERTICES);
    });

    onSharedPage("shows what has been read without waiting for an animation frame", { data: true }, async (page) => {
      const shown = await page.evaluate(async (url) => {
        const bytes = await (await fetch(url)).arrayBuffer();
        const request = window.requestAnimationFrame.bind(window);
        /** @type {FrameRequestCallback[]} */
        const held = [];
        window.requestAnimationFrame = (callback) => held.push(callback);
        // The app's own, requested before, comes first.
        await new Promise(request);
        try {
          const opened = window.gaitway.open({ "Fox.glb": bytes }).then(() => true);
          const isOpened = await Promise.race([opened, new Promise((done) => setTimeout(done, 5000, false))]);
          return { isOpened, framesHeld: held.length, triangles: (await window.gaitway.stats()).triangles };
        } finally {
          window.requestAnimationFrame = request;
          held.forEach(request);
        }
      }, site.data(FOX));
      // Its triangles share no vertices.
      assert.deepEqual(shown, { isOpened: true, framesHeld: 1, triangles: FOX_VERTICES / 3 });
    });

    onSharedPage("shows the chosen clip at the chosen time", { data: true }, async (page) => {
      await open(page, site.data(FOX));
      const reference = await loadScene(dataFile(FOX));
      for (const { clip, t } of [{ clip: "Survey", t: 1.25 }, { clip: "Run", t: 0.3 }, { clip: "Walk", t: 0.6 }]) {
        await apply(page, { clip, t, play: 0 });
        const shown = await pose(page);
        assert.equal(shown.clip, clip);
        assert.equal(shown.time_secs, t);
        reference.play(reference.clips.findIndex(({ name }) => name === clip), t);
        const [expected] = reference.meshes();
        const worst = Math.max(...shown.meshes[0].positions.map((value, at) => Math.abs(value - expected.positions[at])));
        assert.ok(worst < 0.015, `${clip} at ${t} s: off by ${worst} of the fox's 150 units`);
      }
      await apply(page, { clip: "" });
      assert.equal((await pose(page)).clip, null);
    });

    onSharedPage("dispatches an event for a change", {}, async (page) => {
      await page.evaluate(() => {
        window.changes = 0;
        window.addEventListener("gaitway:change", () => window.changes++);
      });
      await apply(page, { play: 0, exposure: 1 });
      await until(page, () => window.changes > 0);
    });

    onSharedPage("rejects a wrong value and keeps the state", {}, async (page) => {
      const earlier = await state(page);
      await assert.rejects(apply(page, { speed: "quickly" }), /speed/);
      assert.deepEqual(await state(page), earlier);
    });

    onPage("plays and pauses with the space bar", { link: () => "model=sample:walker", isCalm: false }, async (page) => {
      await page.mouse.click(CENTER.x, CENTER.y);
      await page.keyboard.press("Space");
      await until(page, async () => Number((await window.gaitway.state()).play) === 0);
      await page.keyboard.press("Space");
      await until(page, async () => Number((await window.gaitway.state()).play ?? 1) === 1);
    });

    onPage("orbits by dragging and zooms in with the wheel", {}, async (page) => {
      const before = await picture(page);
      await page.mouse.move(CENTER.x, CENTER.y);
      await page.mouse.down();
      await page.mouse.move(CENTER.x + 60, CENTER.y + 20, { steps: 4 });
      await page.mouse.up();
      const orbited = await camera(page);
      assert.ok(orbited.every(Number.isFinite) && orbited.length === 6, `camera: ${orbited}`);
      assert.ok(meanDifference(await picture(page), before) > 0, "the view should turn");
      await page.mouse.wheel(0, -240);
      await until(page, async (distance) => Number(String((await window.gaitway.state()).camera).split(",")[2]) < distance, orbited[2]);
      const nearer = await camera(page);
      assert.ok(Math.abs(nearer[0] - orbited[0]) < 1e-3 && Math.abs(nearer[1] - orbited[1]) < 1e-3, "the wheel should not turn");
    });

    onPage("follows a resize", {}, async (page) => {
      const before = await picture(page);
      await resize(page, 1000, 500);
      const wide = await picture(page);
      assert.ok(wide.width / wide.height > before.width / before.height, `${before.width}×${before.height} → ${wide.width}×${wide.height}`);
      await resize(page, 390, 700);
      const narrow = await picture(page);
      assert.ok(narrow.width < wide.width, `${wide.width}×${wide.height} → ${narrow.width}×${narrow.height}`);
      assert.ok(colorsOf(narrow) > 16, "something should be drawn");
    });

    test("fills the screen of an emulated device", async () => {
      const page = await site.page({ renderer, link: "model=sample:walker&play=0", viewport: { width: 500, height: 400 }, deviceScaleFactor: 2 });
      /** Waits until the canvas has all of the screen's pixels, and the panels its width. @param {number} width */
      const fills = (width) =>
        until(page, (width) => {
          const edges = [...document.querySelectorAll("#mirror *")].map((control) => control.getBoundingClientRect().right);
          const [edge, canvas] = [Math.max(...edges), document.querySelector("canvas")];
          return canvas?.width === width * devicePixelRatio && edge > 0.9 * width && edge < 1.1 * width;
        }, width);
      await fills(500);
      const session = await page.context().newCDPSession(page);
      for (const [width, height, deviceScaleFactor] of [[390, 600, 3], [600, 390, 1], [500, 400, 2]]) {
        await session.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor, mobile: true });
        await fills(width);
      }
      await page.finish();
    });

    onPage("draws nothing while nothing changes", {}, async (page) => {
      // Let animations such as a fading tooltip finish.
      await untilStill(page);
      const drawn = await framesDrawnDuring(page, IDLE_FRAMES);
      assert.ok(drawn <= 2, `${drawn} frames in an idle second`);
    });

    /** A model in three files. */
    const inPieces = (name = "own") => {
      const { bytes, document: plain } = triangle({ uri: `${encodeURIComponent(name)}.bin` });
      const textured = { ...plain, images: [{ uri: `${encodeURIComponent(name)}.png` }], textures: [{ source: 0 }], materials: [{ emissiveTexture: { index: 0 } }] };
      return {
        gltf: { name: `${name}.gltf`, text: JSON.stringify(textured) },
        buffer: { name: `${name}.bin`, url: `data:application/octet-stream;base64,${bytes.toString("base64")}` },
        image: { name: `${name}.png`, url: `data:image/png;base64,${PIXEL}` },
      };
    };
    /** @type {(page: import("./browser.mjs").TestPage, name: string) => Promise<unknown>} */
    const whenLacking = (page, name) => until(page, (name) => document.querySelector("#problem")?.textContent?.includes(name) === true, name);
    /** @type {(page: import("./browser.mjs").TestPage, name: string) => Promise<void>} */
    const whenWhole = async (page, name) => {
      await until(page, (name) => document.querySelector("#news")?.textContent?.startsWith(`Opened ${name}.`) && document.querySelector("#problem")?.textContent === "", name);
      await eventually(async () => (await controls(page, "button", `Close ${name}`).count()) === 1, "it replaces the one without its image");
    };

    onPageOnce("names the .gltf that lacks a file, not the file that was dropped last", {}, async (page) => {
      const { gltf, buffer, image } = inPieces();
      await drop(page, [gltf]);
      await whenLacking(page, "own.bin");
      await drop(page, [image]);
      await page.locator("#mirror").getByText("Couldn't open own.gltf").waitFor({ state: "attached" });
      await whenLacking(page, "own.bin");
      await drop(page, [buffer]);
      await whenModel(page, "own.gltf");
    });

    onPageOnce("gives a .gltf only the files that it lacks", {}, async (page) => {
      const { gltf, buffer, image } = inPieces();
      await drop(page, [gltf, buffer]);
      await whenModel(page, "own.gltf");
      await apply(page, { camera: "30,10,4,0,1,0" });
      // Another model, which lacks nothing, while the first lacks its image.
      const other = inPieces("other");
      await drop(page, [other.buffer]);
      await whenLacking(page, "other.bin");
      await drop(page, [other.image]);
      await whenLacking(page, "other.png");
      await drop(page, [image]);
      await whenWhole(page, "own.gltf");
      assert.equal((await state(page)).camera, "30,10,4,0,1,0", "its view is kept");
      await drop(page, [other.buffer]);
      await whenLacking(page, "other.bin");
      await drop(page, [other.gltf, other.image]);
      await whenWhole(page, "other.gltf");
    });

    onPageOnce("puts files together that are dropped without waiting", {}, async (page) => {
      const { gltf, buffer, image } = inPieces("my own");
      for (const file of [gltf, buffer, image]) await drop(page, [file]);
      await whenWhole(page, "my own.gltf");
    });

    onPage("shows the next model without the weights of the previous model's joint", { data: true }, async (page) => {
      await apply(page, { joint: 5, show: "grid,weights" });
      await drop(page, [{ name: "Fox.glb", url: site.data(FOX) }]);
      await whenShown(page, FOX_VERTICES);
      const { joint, show } = await state(page);
      assert.deepEqual([joint, show], [null, "grid"]);
    });

    test("keeps what it shows when a file is broken", { skip: skipWithoutData }, async () => {
      const page = await site.page({ renderer });
      try {
        await open(page, site.data(FOX));
        await apply(page, { play: 0, t: 0.4 });
        const before = await picture(page);
        const refused = await page.evaluate(async () => {
          const bytes = new TextEncoder().encode("glTF but not really, and then some more");
          return await window.gaitway.open({ "broken.glb": bytes.buffer }).then(() => null, (error) => (error instanceof Error ? error.message : "not an Error"));
        });
        assert.match(refused ?? "open() should reject", /broken\.glb/);
        await drop(page, [{ name: "cut.gltf", text: '{"asset":{"version":"2.0"},"buffers":[{"byteLength":12,"uri":"missing.bin"}]}' }]);
        // Screen readers hear what the canvas shows.
        await until(page, () => /missing\.bin/.test(document.querySelector("#problem")?.textContent ?? ""));
        await assert.rejects(open(page, site.data("nothing-here.glb")), /nothing-here\.glb/);
        assert.equal((await pose(page)).meshes[0].positions.length, FOX_VERTICES * 3);
        assert.equal((await pose(page)).time_secs, 0.4);
        assert.equal(meanDifference(await picture(page), before), 0, "the view should stay as it was");
        await drop(page, [{ name: "CesiumMan.glb", url: site.data("khronos/CesiumMan/glTF-Binary/CesiumMan.glb") }]);
        await whenShown(page, CESIUM_MAN_VERTICES);
      } finally {
        await page.finish();
      }
    });

    once("gives every error a code", async () => {
      const page = await site.page({ renderer });
      try {
        const codes = await page.evaluate(async (missing) => {
          const bytes = (/** @type {string} */ text) => new TextEncoder().encode(text).buffer;
          const joints = "JOINT b { OFFSET 0 0 0 CHANNELS 0 } ".repeat(300_000);
          /** @type {Record<string, () => unknown>} */
          const calls = {
            missing: () => window.gaitway.open(missing),
            sample: () => window.gaitway.open("sample:nobody"),
            argument: () => window.gaitway.open(/** @type {any} */ (5)),
            value: () => window.gaitway.apply({ speed: "quickly" }),
            broken: () => window.gaitway.open({ "broken.glb": bytes("glTF but not really, and then some more") }),
            format: () => window.gaitway.open({ "scene.blend": bytes("BLENDER") }),
            nodes: () => window.gaitway.open({ "many.bvh": bytes(`HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 0 ${joints}}`) }),
            overtaken: async () => {
              const calls = [missing, "sample:walker"].map((item) => window.gaitway.open(item));
              await calls[1];
              return calls[0];
            },
          };
          /** @type {Record<string, string>} */
          const codes = {};
          for (const [name, call] of Object.entries(calls)) {
            codes[name] = await (async () => call())().then(() => "resolved", (error) => (error instanceof Error ? /** @type {any} */ (error).code : "not an Error"));
          }
          return codes;
        }, site.data("nothing-here.glb"));
        const expected = { missing: "not-found", sample: "not-found", argument: "malformed", value: "malformed", broken: "malformed", format: "unsupported", nodes: "too-large", overtaken: "cancelled" };
        assert.deepEqual(codes, expected);
      } finally {
        await page.finish();
      }
    });

    test("stops when the graphics process dies and restarts with the same view", { skip: skipWithoutData }, async () => {
      const own = await startSite({ isOffScreen: true });
      try {
        const page = await own.page({ renderer });
        await drop(page, [{ name: "Fox.glb", url: own.data(FOX) }]);
        await whenShown(page, FOX_VERTICES);
        await apply(page, { clip: "Run", play: 0, t: 0.5, camera: "40,15,250,0,40,0" });
        const before = await picture(page);
        const session = await own.browser.newBrowserCDPSession();
        await session.send("Browser.crashGpuProcess").catch(() => {});
        const again = page.locator("#stopped-again");
        await again.waitFor({ state: "visible" });
        assert.equal(await page.locator("#stopped").isVisible(), true);
        await again.click();
        await whenReady(page);
        await whenShown(page, FOX_VERTICES);
        const { clip, camera } = await state(page);
        assert.equal(clip, "Run");
        assert.deepEqual(String(camera).split(",").map(Number), [40, 15, 250, 0, 40, 0]);
        const { backend } = await stats(page);
        assert.ok(BACK_ENDS.includes(backend));
        assert.ok(meanDifference(await picture(page), before) < 1, "the view should come back");
      } finally {
        await own.close();
      }
    });

    once("stops at an error inside the program, also where a script catches it, and restarts with the same view", async () => {
      const page = await site.page({ renderer, link: "model=sample:walker&play=0&t=0.5", before: trapOnce });
      await assert.rejects(pose(page), /unreachable/);
      const again = page.locator("#stopped-again");
      await again.waitFor({ state: "visible" });
      assert.match((await page.locator("#stopped-why").textContent()) ?? "", /An error inside Gaitway: unreachable/);
      await again.click();
      await whenReady(page);
      assert.equal((await pose(page)).time_secs, 0.5);
      assert.ok(colorsOf(await picture(page)) > 16, "something should be drawn");
      await page.finish();
    });

    once("tells message and place of a panic, for a report that can be copied", async () => {
      const page = await site.page({ renderer, before: panicOnce });
      await assert.rejects(pose(page), /unreachable/);
      await page.locator("#stopped-again").waitFor({ state: "visible" });
      const why = (await page.locator("#stopped-why").textContent()) ?? "";
      assert.match(why, /^An error inside Gaitway: as the test asked \(src\/web\/calls\.rs:\d+:\d+\)$/);
      await page.locator("#stopped-details summary").click();
      await page.locator("#stopped-copy").click();
      await page.getByText("Report copied.").waitFor({ state: "visible" });
      const [message, program, browser, ...stack] = (await page.locator("#stopped-report").inputValue()).split("\n");
      assert.equal(message, why);
      assert.match(program, new RegExp(`${renderer}-[0-9a-f]{16}\\.wasm$`));
      assert.match(browser, /Chrome/);
      assert.match(stack.join("\n"), /wasm-function/);
      await page.finish();
    });

    test("switches to the other back end when the graphics process dies", async () => {
      const own = await startSite({ isOffScreen: true });
      try {
        const page = await own.page({ renderer, link: "model=sample:walker&play=0&t=0.5" });
        assert.deepEqual(programs(page), [renderer]);
        const session = await own.browser.newBrowserCDPSession();
        await session.send("Browser.crashGpuProcess").catch(() => {});
        await page.locator("#stopped-other").click();
        await whenReady(page);
        const [other] = BACK_ENDS.filter((backend) => backend !== renderer);
        assert.equal((await stats(page)).backend, other);
        assert.deepEqual(programs(page), [renderer, other], "the other program is downloaded now");
        assert.equal((await pose(page)).time_secs, 0.5, "the view stays as it was");
        assert.ok(colorsOf(await picture(page)) > 16, "something should be drawn");
      } finally {
        await own.close();
      }
    });
  });
}

describe("page without graphics", () => {
  /** @type {import("./browser.mjs").Site} */
  let site;
  before(async () => (site = await startSite({ isOffScreen: true })));
  after(() => site?.close());

  test("says what is missing and what to try", async () => {
    const page = await site.page({
      ready: false,
      before: () => {
        Object.defineProperty(Navigator.prototype, "gpu", { value: undefined });
        for (const { prototype } of [HTMLCanvasElement, OffscreenCanvas]) Object.assign(prototype, { getContext: () => null });
      },
    });
    await page.locator("#cannot-run").waitFor({ state: "visible" });
    assert.match(await page.locator("#cannot-run-missing").innerText(), /WebGL\s?2/i);
    await page.finish();
  });

  test("falls back to WebGL2 without asking", async () => {
    const page = await site.page({ before: () => void Object.defineProperty(Navigator.prototype, "gpu", { value: undefined }) });
    assert.equal((await stats(page)).backend, "webgl2");
    assert.deepEqual(programs(page), ["webgl2"], "nobody downloads the other program");
    await page.finish();
  });

  test("uses WebGPU if there is an adapter", async () => {
    const page = await site.page({});
    assert.equal((await stats(page)).backend, "webgpu");
    assert.deepEqual(programs(page), ["webgpu"]);
    await page.finish();
  });

  test("takes the other program if there is no adapter", async () => {
    const page = await site.page({ before: () => void Object.assign(GPU.prototype, { requestAdapter: async () => null }) });
    assert.equal((await stats(page)).backend, "webgl2");
    // The likelier program's download has begun and is aborted.
    assert.equal(programs(page).at(-1), "webgl2");
    await page.finish();
  });

  test("takes the other program if WebGPU has no device", async () => {
    const page = await site.page({
      before: () => {
        Object.assign(GPUAdapter.prototype, {
          requestDevice: async () => {
            throw new DOMException("none today", "OperationError");
          },
        });
      },
    });
    assert.equal((await stats(page)).backend, "webgl2");
    assert.deepEqual(programs(page), ["webgpu", "webgl2"]);
    assert.equal((await state(page)).model[0], "sample:walker", "the link is shown");
    await page.finish();
  });
});

/** @param {import("./browser.mjs").TestPage} page */
async function camera(page) {
  return String((await state(page)).camera).split(",").map(Number);
}
