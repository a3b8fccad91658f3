// Measures three.js and Gaitway on the same work in the same headless Chromium, round by round in turn, and prints medians.
// `node benches/web/run.mjs`, after `cargo xtask build --bench` (or with GAITWAY_DIST). Asserts nothing:
// figures move from machine to machine, ratios less.
import path from "node:path";
import { chromium } from "playwright-core";
import { FLAGS, dist, until } from "../../tests/browser/browser.mjs";
import { serve } from "../../tests/browser/server.mjs";
import { dataFolder, repository } from "../../tests/three/data.mjs";

const XBOT = "threejs/Xbot.glb";
const SOLDIER = "threejs/Soldier.glb";
const LOADED = ["khronos/Fox/glTF-Binary/Fox.glb", "khronos/CesiumMan/glTF-Binary/CesiumMan.glb", SOLDIER, XBOT, "threejs/RobotExpressive.glb"];
const CROWDS = [1, 100, 1000];
const ROUNDS = 9;
/** Character-frames in one round: long enough for the clock, short enough that both sides see the same weather. */
const CHARACTER_FRAMES = 4000;
const DRAWN_FRAMES = 40;

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const row = (...cells) => console.log(`| ${cells.join(" | ")} |`);

if (dataFolder === null) {
  console.log("skipped: no test data folder (GAITWAY_DATA)");
  process.exit(0);
}
const site = await serve({
  "/three/": path.join(repository, "node_modules/three"),
  "/bench/": path.join(repository, "benches/web"),
  "/data/": dataFolder,
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
const gaitway = async (link) => {
  const page = await context.newPage();
  await page.goto(`${site.origin}/?renderer=webgl2#${link}`);
  await until(page, () => window.gaitway !== undefined);
  await page.evaluate(async () => void (await window.gaitway.ready));
  return page;
};

try {
  await measureCharacters();
  await measureRetargeting();
  await measureLoads();
  await measureFrames();
} finally {
  await browser.close();
  await site.close();
}

async function measureCharacters() {
  console.log("\nSampling, world matrices and palette of Xbot's walk, µs per character-frame\n");
  row("characters", "three.js", "Gaitway", "ratio");
  row("--", "--", "--", "--");
  const [theirs, ours] = [await three(), await gaitway("play=0")];
  if (!(await ours.evaluate(() => window.gaitway.benchCharacters !== undefined))) {
    console.log("skipped: the page was built without the feature; run `cargo xtask build --bench`");
    return;
  }
  await ours.evaluate(async (url) => void (window.bytes = new Uint8Array(await (await fetch(url)).arrayBuffer())), `/data/${XBOT}`);
  for (const count of CROWDS) {
    await theirs.evaluate(([url, count]) => window.bench.prepareCharacters(url, "walk", count), [`/data/${XBOT}`, count]);
    const frames = Math.max(1, Math.round(CHARACTER_FRAMES / count));
    const figures = { three: [], gaitway: [] };
    for (let round = 0; round < ROUNDS; round++) {
      figures.three.push(await theirs.evaluate((frames) => window.bench.characters(frames), frames));
      figures.gaitway.push(await ours.evaluate(([count, frames]) => window.gaitway.benchCharacters(window.bytes, "walk", count, frames), [count, frames]));
    }
    const [slow, fast] = [median(figures.three), median(figures.gaitway)];
    row(count, slow.toFixed(2), fast.toFixed(3), `${(slow / fast).toFixed(1)}×`);
  }
  await theirs.close();
  await ours.close();
}

async function measureRetargeting() {
  console.log("\nMaking a clip over for another skeleton, ms\n");
  row("clip", "SkeletonUtils.retargetClip", "Gaitway", "ratio");
  row("--", "--", "--", "--");
  const [theirs, ours] = [await three(), await gaitway("play=0")];
  if (!(await ours.evaluate(() => window.gaitway.benchRetarget !== undefined))) return;
  for (const [model, motion, clip] of [[SOLDIER, XBOT, "walk"], [SOLDIER, XBOT, "idle"], [XBOT, SOLDIER, "Walk"], [XBOT, SOLDIER, "Idle"]]) {
    await theirs.evaluate((pair) => window.bench.prepareRetarget(...pair), [`/data/${model}`, `/data/${motion}`, clip]);
    await ours.evaluate(
      async (urls) => void (window.pair = await Promise.all(urls.map(async (url) => new Uint8Array(await (await fetch(url)).arrayBuffer())))),
      [`/data/${model}`, `/data/${motion}`],
    );
    const figures = { three: [], gaitway: [] };
    for (let round = 0; round < ROUNDS; round++) {
      figures.three.push(await theirs.evaluate(() => window.bench.retarget(5)));
      figures.gaitway.push(await ours.evaluate((clip) => window.gaitway.benchRetarget(...window.pair, clip, 100), clip));
    }
    const [slow, fast] = [median(figures.three), median(figures.gaitway)];
    row(`${path.basename(motion)} ${clip} → ${path.basename(model)}`, slow.toFixed(2), fast.toFixed(3), `${(slow / fast).toFixed(1)}×`);
  }
  await theirs.close();
  await ours.close();
}

async function measureLoads() {
  console.log("\nLoading from bytes in memory, textures included, ms (Gaitway: until it is on the screen)\n");
  row("file", "GLTFLoader.parse", "gaitway.open");
  row("--", "--", "--");
  const [theirs, ours] = [await three(), await gaitway("play=0")];
  // A small picture: what drawing it in software takes is measured below.
  await ours.setViewportSize({ width: 320, height: 240 });
  for (const name of LOADED) {
    const figures = { three: [], gaitway: [] };
    for (let round = 0; round < ROUNDS; round++) {
      figures.three.push(await theirs.evaluate((url) => window.bench.load(url), `/data/${name}`));
      figures.gaitway.push(
        await ours.evaluate(async (url) => {
          const bytes = await (await fetch(url)).arrayBuffer();
          const start = performance.now();
          await window.gaitway.open({ "model.glb": bytes });
          return performance.now() - start;
        }, `/data/${name}`),
      );
    }
    row(path.basename(name), median(figures.three).toFixed(1), median(figures.gaitway).toFixed(1));
  }
  await theirs.close();
  await ours.close();
}

async function measureFrames() {
  console.log("\nA frame of Soldier's walk at 1280×720 on WebGL2 in software, ms (image-based light, one shadow, grid)\n");
  row("picture", "three.js", "Gaitway");
  row("--", "--", "--");
  const figures = { plain: [], smooth: [], gaitway: [] };
  for (let round = 0; round < 3; round++) {
    for (const [kind, samples] of [["plain", 1], ["smooth", 4]]) {
      const page = await three();
      await page.evaluate(([url, samples]) => window.bench.draw(url, "Walk", samples), [`/data/${SOLDIER}`, samples]);
      figures[kind].push(await frameMs(page));
      await page.close();
    }
    const page = await gaitway(`embed=1&clip=Walk&play=1&model=${encodeURIComponent(`${site.origin}/data/${SOLDIER}`)}`);
    await until(page, async () => (await window.gaitway.stats()).triangles > 5000);
    figures.gaitway.push(await frameMs(page));
    await page.close();
  }
  row("1 sample a pixel", median(figures.plain).toFixed(1), median(figures.gaitway).toFixed(1));
  row("4 samples a pixel", median(figures.smooth).toFixed(1), "one sample on a software adapter");
}

/** Median of frames from their start until everything asked of the graphics process is done, which reading a pixel waits for. */
async function frameMs(page) {
  await page.bringToFront();
  await page.waitForTimeout(1500);
  const frames = await page.evaluate(async (count) => {
    const context = document.querySelector("canvas").getContext("webgl2");
    const pixel = new Uint8Array(4);
    const afterCallbacks = new MessageChannel();
    const frames = [];
    while (frames.length < count) {
      const start = await new Promise((resolve) => requestAnimationFrame(resolve));
      await new Promise((resolve) => {
        afterCallbacks.port1.onmessage = resolve;
        afterCallbacks.port2.postMessage(null);
      });
      context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, pixel);
      frames.push(performance.now() - start);
    }
    return frames;
  }, DRAWN_FRAMES);
  return median(frames);
}
