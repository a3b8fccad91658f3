// How soon a link shows its model: from navigation to the first moving frame of Soldier.glb, and to the first with its
// images, cold cache, brotli on the wire, 10 Mbit/s and 40 ms. Against the smallest three.js page that does the same,
// bundled and minified, which shows nothing before it has all.
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import zlib from "node:zlib";
import { build } from "esbuild";
import { until } from "../../tests/browser/browser.mjs";
import { dataFile, dist, repository } from "../../tests/three/data.mjs";
import { serve } from "../../xtask/site/server.mjs";

/** @typedef {import("playwright-core").Browser} Browser */

const NETWORK = { offline: false, latency: 40, downloadThroughput: 10e6 / 8, uploadThroughput: 10e6 / 8 };
const ROUNDS = 5;
const SOLDIER = "threejs/Soldier.glb";

const HTML = '<!doctype html><meta charset="utf-8"><title>three.js</title><link rel="icon" href="data:,"><style>body{margin:0}canvas{display:block}</style><script type="module" src="first.js"></script>';

/** Builds the three.js page; returns its folder. */
async function threePage() {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-three-"));
  const script = path.join(folder, "first.js");
  await build({ entryPoints: [path.join(repository, "benches/web/first-three.mjs")], outfile: script, bundle: true, minify: true, format: "esm", logLevel: "warning" });
  fs.writeFileSync(path.join(folder, "index.html"), HTML);
  fs.writeFileSync(`${script}.br`, zlib.brotliCompressSync(fs.readFileSync(script)));
  return folder;
}

/**
 * How a page started, in milliseconds: from navigation to its first moving frame and to the first one with images, and
 * the longest task on its main thread until then, 0 if none took 50 ms.
 * @typedef {{ moving: number, complete: number, longestTask: number }} Start
 */

/**
 * Opens a page until it shows its first moving frame, which the page's own script or the one here reports.
 * @param {Browser} browser
 * @param {string} address
 * @returns {Promise<Start>}
 */
async function firstFrame(browser, address) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 } });
  const page = await context.newPage();
  const session = await context.newCDPSession(page);
  await session.send("Network.enable");
  await session.send("Network.setCacheDisabled", { cacheDisabled: true });
  await session.send("Network.emulateNetworkConditions", NETWORK);
  await page.addInitScript(() => {
    window.longTasks = [];
    new PerformanceObserver((list) => window.longTasks.push(...list.getEntries())).observe({ type: "longtask" });
    addEventListener("DOMContentLoaded", async () => {
      if (document.querySelector('meta[name="gaitway-programs"]') === null) return;
      while (window.gaitway === undefined) await new Promise((resolve) => setTimeout(resolve));
      const loading = document.getElementById("loading");
      while (loading?.hidden === false) await new Promise((resolve) => new MutationObserver(resolve).observe(loading, { attributes: true }));
      // The first frame of playback, and the end of it.
      const nextFrame = () => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
      await nextFrame();
      performance.mark("moving");
      await window.gaitway.ready;
      await nextFrame();
      performance.mark("complete");
    });
  });
  await page.goto(address, { waitUntil: "commit" });
  await until(page, () => performance.getEntriesByName("complete").length > 0);
  const start = await page.evaluate(() => {
    const [moving, complete] = ["moving", "complete"].map((mark) => performance.getEntriesByName(mark)[0].startTime);
    return { moving, complete, longestTask: Math.max(0, ...window.longTasks.filter(({ startTime }) => startTime < complete).map(({ duration }) => duration)) };
  });
  await context.close();
  return start;
}

/**
 * Returns how each page started in each round, by the page's name.
 * @param {Browser} browser
 */
export async function measureFirstFrames(browser) {
  const folder = await threePage();
  const site = await serve({ "/three/": folder, "/data/": dataFile(""), "/": dist }, { "cache-control": "no-store" });
  const link = `#model=${encodeURIComponent(`${site.origin}/data/${SOLDIER}`)}&clip=Walk`;
  const pages = { "three.js": `${site.origin}/three/`, WebGPU: `${site.origin}/?renderer=webgpu${link}`, WebGL2: `${site.origin}/?renderer=webgl2${link}` };
  /** @type {Record<string, Start[]>} */
  const starts = { "three.js": [], WebGPU: [], WebGL2: [] };
  try {
    for (let round = 0; round < ROUNDS; round++) for (const [name, address] of Object.entries(pages)) starts[name].push(await firstFrame(browser, address));
  } finally {
    await site.close();
    fs.rmSync(folder, { recursive: true });
  }
  return starts;
}
