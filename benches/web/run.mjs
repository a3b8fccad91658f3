// Measures three.js and Gaitway on the same work in the same headless Chromium, in alternating rounds, and prints
// medians. Run `node benches/web/run.mjs` after `cargo xtask build --bench` (or with GAITWAY_DIST), with `characters`,
// `retargeting`, `loads`, `frames`, `first`, `lighthouse` or `decoders` to measure only these. Nothing is asserted:
// times vary between machines, ratios less so.
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { chromium } from "playwright-core";
import { FLAGS, USES_GRAPHICS_CARD, until, untilStill, whenReady } from "../../tests/browser/browser.mjs";
import { measureFirstVisit } from "../../tests/browser/lighthouse.mjs";
import { dataFile, dist, hasData, repository, targetFolder } from "../../tests/three/data.mjs";
import { serve } from "../../xtask/site/server.mjs";
import { measureDecoders } from "./decoders.mjs";
import { measureFirstFrames } from "./first.mjs";

const XBOT = "threejs/Xbot.glb";
const SOLDIER = "threejs/Soldier.glb";
const LOADED = ["khronos/Fox/glTF-Binary/Fox.glb", "khronos/CesiumMan/glTF-Binary/CesiumMan.glb", SOLDIER, XBOT, "threejs/RobotExpressive.glb"];
const CROWDS = [1, 100, 1000];
const ROUNDS = 9;
/** More, since what is measured takes only milliseconds. */
const LOAD_ROUNDS = 25;
/**
 * Character-frames per round: long enough for the clock, short enough that both sides run under the same conditions.
 */
const CHARACTER_FRAMES = 4000;
const DRAWN_FRAMES = 40;

/** @typedef {import("playwright-core").Page} Page */
/** @typedef {Record<string, number[]>} Figures Measurements by name. */

/** @param {string} part */
const wanted = (part) => process.argv.length < 3 || process.argv.includes(part);
/** @param {number[]} values */
const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
/** @param {...(string | number)} cells */
const row = (...cells) => console.log(`| ${cells.join(" | ")} |`);

if (!hasData) {
  console.log("skipped: no test data folder (GAITWAY_DATA)");
  process.exit(0);
}
const site = await serve({
  "/three/": path.join(repository, "node_modules/three"),
  "/bench/": path.join(repository, "benches/web"),
  "/data/": dataFile(""),
  "/": dist,
});
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
const context = await browser.newContext({ viewport: { width: 1280, height: 720 } });

const three = async () => {
  const page = await context.newPage();
  await page.goto(`${site.origin}/bench/three.html`);
  await until(page, () => window.bench !== undefined);
  return page;
};
/** @param {string} link */
const gaitway = async (link) => {
  const page = await context.newPage();
  await page.goto(`${site.origin}/?renderer=webgl2#${link}`);
  await whenReady(page);
  return page;
};

try {
  if (wanted("characters")) await measureCharacters();
  if (wanted("retargeting")) await measureRetargeting();
  if (wanted("loads")) await measureLoads();
  if (wanted("frames")) await measureFrames();
  if (wanted("first")) await measureFirst();
  if (wanted("lighthouse")) await measureLighthouse();
  if (wanted("decoders")) await printDecoders();
} finally {
  await browser.close();
  await site.close();
}

async function measureCharacters() {
  console.log("\nSampling, world matrices and palette of Xbot's walk, µs per character-frame\n");
  row("characters", "three.js", "Gaitway", "ratio", "Gaitway, native");
  row("--", "--", "--", "--", "--");
  const native = nativeCharacters();
  const [theirs, ours] = [await three(), await gaitway("play=0")];
  if (!(await ours.evaluate(() => window.gaitway.benchCharacters !== undefined))) {
    console.log("skipped: the page was built without the feature; run `cargo xtask build --bench`");
    return;
  }
  await fetchFiles(ours, XBOT);
  for (const count of CROWDS) {
    await theirs.evaluate(({ url, count }) => window.bench.prepareCharacters(url, "walk", count), { url: `/data/${XBOT}`, count });
    const frames = Math.max(1, Math.round(CHARACTER_FRAMES / count));
    /** @type {Figures} */
    const figures = { three: [], gaitway: [] };
    for (let round = 0; round < ROUNDS; round++) {
      figures.three.push(await theirs.evaluate((frames) => window.bench.characters(frames), frames));
      figures.gaitway.push(await ours.evaluate(({ count, frames }) => window.gaitway.benchCharacters?.(window.fetched[0], "walk", count, frames) ?? NaN, { count, frames }));
    }
    const [slow, fast] = [median(figures.three), median(figures.gaitway)];
    row(count, slow.toFixed(2), fast.toFixed(3), `${(slow / fast).toFixed(1)}×`, native.get(count) ?? "–");
  }
  if (native.size === 0) console.log("\nFor the native figures, run `cargo bench --bench characters` first");
  await theirs.close();
  await ours.close();
}

/**
 * Runs the native benchmark, if it has been built, before the browser is busy, and returns its figures for the same
 * walk by the number of characters.
 * @returns {Map<number, string>}
 */
function nativeCharacters() {
  const folder = path.join(targetFolder, "release/deps");
  const built = fs.existsSync(folder) ? fs.readdirSync(folder).filter((name) => /^characters-[0-9a-f]{16}(\.exe)?$/.test(name)) : [];
  if (built.length === 0) return new Map();
  const [newest] = built.map((name) => path.join(folder, name)).sort((a, b) => fs.statSync(b).mtimeMs - fs.statSync(a).mtimeMs);
  const lines = execFileSync(newest, { cwd: repository, encoding: "utf8" }).matchAll(/^threejs\/Xbot\.glb walk +(\d+) +([\d.]+)/gm);
  return new Map([...lines].map(([, count, micros]) => [Number(count), micros]));
}

/**
 * Fetches test files into `window.fetched`.
 * @param {Page} page
 * @param {...string} names
 */
async function fetchFiles(page, ...names) {
  const urls = names.map((name) => `/data/${name}`);
  await page.evaluate(async (urls) => {
    window.fetched = await Promise.all(urls.map(async (url) => new Uint8Array(await (await fetch(url)).arrayBuffer())));
  }, urls);
}

async function measureRetargeting() {
  console.log("\nRetargeting a clip to another skeleton, ms\n");
  row("clip", "SkeletonUtils.retargetClip", "Gaitway", "ratio");
  row("--", "--", "--", "--");
  const [theirs, ours] = [await three(), await gaitway("play=0")];
  if (!(await ours.evaluate(() => window.gaitway.benchRetarget !== undefined))) return;
  for (const [model, motion, clip] of [[SOLDIER, XBOT, "walk"], [SOLDIER, XBOT, "idle"], [XBOT, SOLDIER, "Walk"], [XBOT, SOLDIER, "Idle"]]) {
    await theirs.evaluate(({ model, motion, clip }) => window.bench.prepareRetarget(`/data/${model}`, `/data/${motion}`, clip), { model, motion, clip });
    await fetchFiles(ours, model, motion);
    /** @type {Figures} */
    const figures = { three: [], gaitway: [] };
    for (let round = 0; round < ROUNDS; round++) {
      figures.three.push(await theirs.evaluate(() => window.bench.retarget(5)));
      figures.gaitway.push(await ours.evaluate((clip) => window.gaitway.benchRetarget?.(window.fetched[0], window.fetched[1], clip, 100) ?? NaN, clip));
    }
    const [slow, fast] = [median(figures.three), median(figures.gaitway)];
    row(`${path.basename(motion)} ${clip} → ${path.basename(model)}`, slow.toFixed(2), fast.toFixed(3), `${(slow / fast).toFixed(1)}×`);
  }
  await theirs.close();
  await ours.close();
}

async function measureLoads() {
  console.log("\nLoading from bytes in memory with images decoded, ms; shown: until the call that draws it returns\n");
  row("file", "GLTFLoader.parse", "Gaitway", "three.js, shown", "Gaitway, shown", "decoding its images alone");
  row("--", "--", "--", "--", "--", "--");
  const pages = await loadPages();
  for (const name of LOADED) {
    /** @type {Figures} */
    const figures = { parse: [], load: [], render: [], open: [], images: [] };
    for (let round = 0; round < LOAD_ROUNDS; round++) await measureLoad(pages, name, figures);
    row(path.basename(name), ...Object.values(figures).map((values) => median(values).toFixed(1)));
  }
  await closeAll(pages);
  console.log("\nThe same, as the first file of a fresh page (median of 3 pages)\n");
  row("file", "GLTFLoader.parse", "Gaitway");
  row("--", "--", "--");
  for (const name of LOADED) {
    /** @type {Figures} */
    const figures = { parse: [], load: [] };
    for (let round = 0; round < 3; round++) {
      const pages = await loadPages();
      await measureLoad(pages, name, figures);
      await closeAll(pages);
    }
    row(path.basename(name), median(figures.parse).toFixed(1), median(figures.load).toFixed(1));
  }
}

/** Opens both pages in a small viewport, since software rendering is measured separately below. */
async function loadPages() {
  const pages = [await three(), await gaitway("play=0")];
  for (const page of pages) await page.setViewportSize({ width: 320, height: 240 });
  await pages[1].evaluate(() => {
    const request = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (callback) =>
      request((time) => {
        callback(time);
        window.drawnMs = performance.now();
      });
    // What has been read is drawn at once (`Frames` in src/web/page.rs).
    const dispatch = EventTarget.prototype.dispatchEvent;
    EventTarget.prototype.dispatchEvent = function (event) {
      const isAllowed = dispatch.call(this, event);
      if (event.type === "frame") window.drawnMs = performance.now();
      return isAllowed;
    };
  });
  return pages;
}

/** @param {Page[]} pages */
async function closeAll(pages) {
  for (const page of pages) await page.close();
}

/**
 * Adds one measurement of each kind that `figures` has.
 * @param {Page[]} pages
 * @param {string} name
 * @param {Figures} figures
 */
async function measureLoad([theirs, ours], name, figures) {
  const url = `/data/${name}`;
  /** @type {(options: { url: string, work: string }) => Promise<number>} */
  const timed = ({ url, work }) =>
    fetch(url)
      .then((response) => response.arrayBuffer())
      .then(async (bytes) => {
        const start = performance.now();
        if (work === "load") {
          await window.gaitway.benchLoad?.(bytes);
          return performance.now() - start;
        }
        // Under a name of its own: a file that is already open isn't uploaded again. Returns after its frame, with the document that
        // describes the model.
        window.opened = (window.opened ?? 0) + 1;
        await window.gaitway.open({ [`model-${window.opened}.glb`]: bytes });
        return window.drawnMs - start;
      });
  // It may still be refining the previous file's picture, which three.js doesn't do, and would slow three.js's page down.
  await untilStill(ours);
  await bringToRest(theirs);
  figures.parse.push(await theirs.evaluate((url) => window.bench.load(url), url));
  if (figures.render) figures.render.push(await theirs.evaluate((url) => window.bench.open(url), url));
  await bringToRest(ours);
  figures.load.push(await ours.evaluate(timed, { url, work: "load" }));
  if (figures.open) figures.open.push(await ours.evaluate(timed, { url, work: "open" }));
  if (figures.images) {
    await untilStill(ours);
    figures.images.push(await ours.evaluate(decodeImages, url));
  }
}

/**
 * Brings a page to the front and waits until the browser is done with it.
 * @param {Page} page
 */
async function bringToRest(page) {
  await page.bringToFront();
  await page.evaluate(async () => {
    for (let left = 20; left > 0; left--) await new Promise(requestAnimationFrame);
  });
}

/**
 * Has the browser decode the images of a GLB and nothing else, all at once and without options, which is fastest: no page that uses
 * its decoder can show them sooner. Runs in the page.
 * @param {string} url
 */
async function decodeImages(url) {
  const bytes = await (await fetch(url)).arrayBuffer();
  const jsonLength = new DataView(bytes).getUint32(12, true);
  const { images = [], bufferViews = [] } = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 20, jsonLength)));
  const start = performance.now();
  await Promise.all(
    images.map((/** @type {{ bufferView: number, mimeType: string }} */ { bufferView, mimeType }) => {
      const { byteOffset = 0, byteLength } = bufferViews[bufferView];
      const blob = new Blob([new Uint8Array(bytes, 28 + jsonLength + byteOffset, byteLength)], { type: mimeType });
      return createImageBitmap(blob);
    }),
  );
  return performance.now() - start;
}

async function measureFrames() {
  const where = USES_GRAPHICS_CARD ? "on the graphics card" : "in software";
  console.log(`\nA frame of Soldier's walk at 1280×720 on WebGL2 ${where}, ms (image-based light, one shadow, grid)\n`);
  row("image", "three.js", "Gaitway");
  row("--", "--", "--");
  /** @type {Figures} */
  const figures = { plain: [], smooth: [], gaitway: [] };
  for (let round = 0; round < 5; round++) {
    for (const { kind, samples } of [{ kind: "plain", samples: 1 }, { kind: "smooth", samples: 4 }]) {
      const page = await three();
      await page.evaluate(({ url, samples }) => window.bench.draw(url, "Walk", samples), { url: `/data/${SOLDIER}`, samples });
      figures[kind].push(await frameMs(page));
      await page.close();
    }
    const page = await gaitway(`embed=1&clip=Walk&play=1&model=${encodeURIComponent(`${site.origin}/data/${SOLDIER}`)}`);
    await until(page, async () => (await window.gaitway.stats()).triangles > 5000);
    figures.gaitway.push(await frameMs(page));
    await page.close();
  }
  // Gaitway takes one sample on a software adapter, and four on others.
  const [ours, none] = [median(figures.gaitway).toFixed(1), "–"];
  row("1 sample per pixel", median(figures.plain).toFixed(1), USES_GRAPHICS_CARD ? none : ours);
  row("4 samples per pixel", median(figures.smooth).toFixed(1), USES_GRAPHICS_CARD ? ours : none);
}

/**
 * Returns the median time from the start of the page's own work in a frame until the graphics process has finished it,
 * which reading a pixel waits for. Earlier work is finished first, and presenting the frame is left out.
 * @param {Page} page
 */
async function frameMs(page) {
  await page.bringToFront();
  await page.waitForTimeout(1500);
  const frames = await page.evaluate(async (count) => {
    const context = document.querySelector("canvas")?.getContext("webgl2");
    if (!context) throw new Error("no WebGL2 context");
    const pixel = new Uint8Array(4);
    const finish = () => context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, pixel);
    /** @type {number | null} */
    let start = null;
    const request = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (callback) =>
      request((time) => {
        if (start === null) {
          finish();
          start = performance.now();
        }
        callback(time);
      });
    const afterCallbacks = new MessageChannel();
    /** @type {number[]} */
    const frames = [];
    while (frames.length < count) {
      await new Promise((resolve) => request(resolve));
      await new Promise((resolve) => {
        afterCallbacks.port1.onmessage = resolve;
        afterCallbacks.port2.postMessage(null);
      });
      if (start === null) continue;
      finish();
      frames.push(performance.now() - start);
      start = null;
    }
    return frames;
  }, DRAWN_FRAMES);
  return median(frames);
}

async function measureFirst() {
  console.log("\nFrom navigation to the first moving frame of Soldier.glb, and to the first with its images, cold, 10 Mbit/s, 40 ms latency, ms (median of 5)\n");
  row("page", "moving", "all", "ratio", "with images", "all", "ratio", "longest task", "all");
  row("--", "--", "--", "--", "--", "--", "--", "--", "--");
  const starts = await measureFirstFrames(browser);
  /** @type {(rounds: import("./first.mjs").Start[], figure: "moving" | "complete" | "longestTask") => number[]} */
  const figures = (rounds, figure) => rounds.map((start) => Math.round(start[figure]));
  for (const [name, rounds] of Object.entries(starts)) {
    const cells = /** @type {const} */ (["moving", "complete"]).flatMap((figure) => {
      const [ours, theirs] = [figures(rounds, figure), figures(starts["three.js"], figure)];
      return [median(ours), ours.join(", "), `${(median(ours) / median(theirs)).toFixed(2)}×`];
    });
    const tasks = figures(rounds, "longestTask");
    row(name, ...cells, median(tasks), tasks.join(", "));
  }
}

async function measureLighthouse() {
  console.log("\nLighthouse's performance score of a first visit\n");
  const scores = [];
  for (let round = 0; round < 5; round++) scores.push((await measureFirstVisit(`${site.origin}/`)).scores.performance);
  console.log(`median ${median(scores)} of ${scores.join(", ")}`);
}

async function printDecoders() {
  console.log("\nDecoding a file's meshes or textures, ms\n");
  row("part", "file", "npm's decoder", "Gaitway's part");
  row("--", "--", "--", "--");
  const page = await gaitway("play=0");
  for (const { part, file, npm_ms, part_ms } of await measureDecoders(page)) row(part, file, npm_ms.toFixed(2), part_ms.toFixed(2));
  await page.close();
}
