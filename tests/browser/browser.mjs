// Runs both back ends in Chromium, on a software renderer unless told otherwise, and wraps the page for tests. Tests find the shell's controls
// by their ids.
import fs from "node:fs";
import http from "node:http";
import os from "node:os";
import path from "node:path";
import { after, test } from "node:test";
import { chromium } from "playwright-core";
import { serve } from "../../xtask/site/server.mjs";
import { dataFile, dist, hasData } from "../three/data.mjs";

/** @typedef {import("playwright-core").Browser} Browser */
/** @typedef {import("playwright-core").Frame} Frame */
/** @typedef {import("playwright-core").Page} Page */
/** @typedef {import("../../web/shell/types.d.ts").Backend} Backend */
/** @typedef {import("../../web/shell/types.d.ts").PoseDocument} PoseDocument */

/** Pixels with straight alpha. @typedef {{ width: number, height: number, rgba: Buffer }} Image */

/**
 * A page with its uncaught errors and console errors, and the URLs it requested.
 * @typedef {Page & { troubles: string[], requests: string[], finish: () => Promise<void> }} TestPage
 */

/**
 * @typedef {object} PageOptions
 * @property {Backend} [renderer]
 * @property {string} [link] Empty for a first visit; without it, the walker, at rest: a playing clip keeps a software renderer busy.
 * @property {{ width: number, height: number }} [viewport]
 * @property {number} [deviceScaleFactor] Pixels per CSS pixel of an emulated device, in a context of its own. Without it, the page is in
 *   the context that the pages of a test file share.
 * @property {boolean} [isCalm] Instead of what the site's pages are otherwise (see {@link SiteOptions}).
 * @property {() => void} [before] Runs in the page before its scripts.
 * @property {Record<string, string | Buffer>} [files] Virtual files by name: contents served from any folder.
 * @property {boolean} [ready] False: don't wait for the first image.
 */

/** @typedef {Awaited<ReturnType<typeof startSite>>} Site */

/** @type {Backend[]} */
export const BACK_ENDS = ["webgpu", "webgl2"];

/**
 * Returns a function that declares tests of what doesn't depend on how the page draws: each runs on one back end, in turn.
 * @param {Backend} renderer The back end of a suite that is declared for each of them.
 */
export function onOneBackEnd(renderer) {
  let declared = 0;
  /** @type {(name: string, body: (t: import("node:test").TestContext) => Promise<void>, options?: import("node:test").TestOptions) => void} */
  const declare = (name, body, options = {}) => {
    if (declared++ % BACK_ENDS.length === BACK_ENDS.indexOf(renderer)) test(name, options, body);
  };
  return declare;
}

/** Small, since a software renderer draws it. */
export const VIEWPORT = { width: 800, height: 600 };
/** Pixels per CSS pixel: the layout is the same as with 1, but a software renderer draws a sixteenth of the pixels. */
export const PIXEL_RATIO = 0.25;

/** Both back ends on the software renderer. */
const SOFTWARE = ["--use-webgpu-adapter=swiftshader", "--use-vulkan=swiftshader", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/** Both back ends on a graphics card, without a display. */
const GRAPHICS_CARD = ["--use-angle=vulkan", "--disable-vulkan-surface", "--ignore-gpu-blocklist"];

/** Whether the graphics card draws. */
export const USES_GRAPHICS_CARD = process.env.GAITWAY_GPU === "1";

/** Domains keep the GPU after a test crashes its process. */
export const FLAGS = ["--enable-unsafe-webgpu", "--enable-features=Vulkan", "--disable-domain-blocking-for-3d-apis", ...(USES_GRAPHICS_CARD ? GRAPHICS_CARD : SOFTWARE)];

/** Composes pages without the graphics API. */
const OFF_SCREEN = "--disable-gpu-compositing";

const TIMEOUT_MS = 60_000;

/**
 * `isOffScreen`: pages aren't composed by the graphics API, which takes a software renderer as long as the program's own drawing.
 * WebGPU's canvas is then blank on the screen, so tests can look at the program's pictures only, and nothing slows down a clip that
 * plays, so their pages should be at rest.
 * @typedef {{ isOffScreen?: boolean }} LaunchOptions
 */

/**
 * `pixelRatio`: pixels per CSS pixel, more than usual for pictures that are looked at closely. `isCalm`: the user has asked for reduced
 * motion, so nothing plays by itself and keeps a software renderer busy.
 * @typedef {{ pixelRatio?: number, isCalm?: boolean }} SiteOptions
 */

/**
 * Starts a browser in which pages of one site share a process, and thereby compiled programs.
 * @param {LaunchOptions} [options]
 */
export function launch({ isOffScreen = false } = {}) {
  const args = [...FLAGS, ...(isOffScreen && !USES_GRAPHICS_CARD ? [OFF_SCREEN] : []), "--process-per-site"];
  return chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
}

/**
 * Starts the two servers and a browser.
 * @param {LaunchOptions & SiteOptions} [options]
 */
export async function startSite({ isOffScreen, pixelRatio = PIXEL_RATIO, isCalm = false } = {}) {
  if (!fs.existsSync(path.join(dist, "index.html"))) throw new Error(`no built page in ${dist}: run \`cargo xtask build\``);
  const site = await serve({ "/some/folder/": dist });
  const data = hasData ? await serve({ "/": dataFile("") }, { "access-control-allow-origin": "*" }) : null;
  const browser = await launch({ isOffScreen });
  const address = `${site.origin}/some/folder/`;
  const shared = await sharedContext(browser, pixelRatio);
  return {
    browser,
    /** URL of the page itself. */
    address,
    /**
     * Returns the URL of a test file, on another origin than the page.
     * @param {string} name
     */
    data: (name) => `${data?.origin}/${name}`,
    /** @param {PageOptions} options */
    page: (options) => openPage(browser, shared, address, { isCalm, ...options }),
    close: async () => {
      await browser.close();
      await site.close();
      await data?.close();
    },
  };
}

/**
 * Returns a context for the pages of one test file. The browser compiles the program for the first of them, and the others share the
 * result as long as a page with it is open: that saves a third of what opening one takes.
 * @param {Browser} browser
 * @param {number} deviceScaleFactor
 */
async function sharedContext(browser, deviceScaleFactor) {
  // Service workers would store megabytes for each fresh profile; offline.test.mjs tests them.
  const context = await browser.newContext({ viewport: VIEWPORT, deviceScaleFactor, serviceWorkers: "block" });
  /** Addresses whose program a page keeps alive. @type {Set<string>} */
  const held = new Set();
  return {
    context,
    /**
     * Holds a page's program from now on.
     * @param {string} address With the renderer.
     */
    hold: async (address) => {
      if (held.has(address)) return;
      const keeper = await context.newPage();
      await keeper.setViewportSize({ width: 40, height: 30 });
      await keeper.goto(`${address}#model=sample:walker&play=0`);
      await whenReady(keeper);
      held.add(address);
    },
  };
}

/**
 * Records a page's troubles and requests.
 * @param {Page} page
 * @param {boolean} [isShared] Whether it shares its context with other pages.
 * @returns {TestPage}
 */
export function watched(page, isShared = false) {
  /** @type {string[]} */
  const troubles = [];
  /** @type {string[]} */
  const requests = [];
  page.on("pageerror", (error) => troubles.push(error.message));
  page.on("console", (message) => message.type() === "error" && troubles.push(message.text()));
  page.on("request", (request) => requests.push(request.url()));
  const finish = async () => {
    if (!isShared) return await page.context().close();
    try {
      // The next page is a fresh one.
      await page.evaluate(() => localStorage.clear());
    } finally {
      await page.close();
    }
  };
  return Object.assign(page, { troubles, requests, finish });
}

/**
 * Opens a fresh page and waits until it is ready.
 * @param {Browser} browser
 * @param {Awaited<ReturnType<typeof sharedContext>>} shared
 * @param {string} address
 * @param {PageOptions} options
 */
async function openPage(browser, shared, address, { renderer, link = "model=sample:walker&play=0", viewport = VIEWPORT, deviceScaleFactor, isCalm, before, files = {}, ready = true }) {
  const isShared = deviceScaleFactor === undefined;
  const program = `${address}${renderer === undefined ? "" : `?renderer=${renderer}`}`;
  if (isShared) await shared.hold(program);
  const context = isShared ? shared.context : await browser.newContext({ viewport, deviceScaleFactor, serviceWorkers: "block" });
  const page = watched(await context.newPage(), isShared);
  if (isShared) await page.setViewportSize(viewport);
  page.setDefaultTimeout(TIMEOUT_MS);
  if (isCalm) await page.emulateMedia({ reducedMotion: "reduce" });
  await page.addInitScript(reportPolicyViolations);
  if (before !== undefined) await page.addInitScript(before);
  for (const [name, body] of Object.entries(files)) await page.route(`**/${name}`, (route) => route.fulfill({ body, headers: { "access-control-allow-origin": "*" } }));
  await page.goto(`${program}${link === "" ? "" : `#${link}`}`);
  if (ready) await whenReady(page);
  return page;
}

/**
 * Starts another server, which answers as a test wants.
 * @param {http.RequestListener} answer
 */
export async function startServer(answer) {
  const server = http.createServer(answer);
  await new Promise((resolve) => server.listen(0, "127.0.0.1", () => resolve(undefined)));
  const { port } = /** @type {import("node:net").AddressInfo} */ (server.address());
  return {
    address: `http://127.0.0.1:${port}`,
    close: () => {
      server.closeAllConnections();
      server.close();
    },
  };
}

/**
 * Makes a folder for the tests of a file, and removes it after them.
 * @param {string} name
 */
export function temporaryFolder(name) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), `gaitway-${name}-`));
  after(() => fs.rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/** Makes an error of what the page's content security policy refuses. Runs in the page, before its scripts. */
export function reportPolicyViolations() {
  addEventListener("securitypolicyviolation", ({ violatedDirective, blockedURI }) => console.error(`against the content security policy: ${violatedDirective} ${blockedURI}`));
}

// Conditions that scripts simulate in a page.

/** Without HTTPS, nothing is compared with the hash in its name. */
export function withoutHashes() {
  Object.defineProperty(crypto, "subtle", { value: undefined });
}

/** Shortens the next time limit of a part from a minute to half a second. */
export function withShortMinute() {
  const { setTimeout } = window;
  /** @type {any} */ (window).setTimeout = (/** @type {() => void} */ run, /** @type {number} */ millis) => {
    if (millis !== 60_000) return setTimeout(run, millis);
    window.setTimeout = setTimeout;
    return setTimeout(run, 500);
  };
}

/** Shortens how long a site may send nothing from 20 seconds to 5. */
export function withLessPatience() {
  const { setTimeout } = window;
  /** @type {any} */ (window).setTimeout = (/** @type {() => void} */ run, /** @type {number} */ millis) => setTimeout(run, millis === 20_000 ? 5_000 : millis);
}

/** Playwright's error when it evaluates script in a page that is navigating. */
const NAVIGATING = /Execution context was destroyed/;

/**
 * Polls until a condition holds.
 * @param {() => unknown} holds May be asynchronous.
 * @param {string} [what]
 */
export async function eventually(holds, what = String(holds)) {
  const deadline = Date.now() + TIMEOUT_MS;
  while (!(await holds())) {
    if (Date.now() > deadline) throw new Error(`still not true after a minute: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

/**
 * Waits until a function in the page, which may be asynchronous, returns a truthy value, even across navigation.
 * (Playwright's own wait considers any promise truthy.)
 * @template [A=undefined]
 * @param {Page | Frame} page
 * @param {(argument: A) => unknown} holds
 * @param {A} [argument]
 */
export async function until(page, holds, argument) {
  /** @param {Error} error */
  const unlessNavigating = (error) => {
    if (!NAVIGATING.test(error.message)) throw error;
  };
  const ask = /** @type {(page: Page | Frame) => Promise<unknown>} */ ((page) => page.evaluate(/** @type {() => unknown} */ (holds), /** @type {undefined} */ (argument)));
  await eventually(() => ask(page).catch(unlessNavigating), String(holds));
}

/** @param {Page | Frame} page */
export async function whenReady(page) {
  await until(page, () => window.gaitway !== undefined);
  await page.evaluate(async () => {
    await window.gaitway.ready;
  });
}

// `window.gaitway`, called from the test.

/** @param {Page | Frame} page */
export const state = (page) => page.evaluate(async () => await window.gaitway.state());
/** @param {Page | Frame} page */
export const stats = (page) => page.evaluate(async () => await window.gaitway.stats());
/**
 * As a text, since Playwright takes most of a second to hand over the numbers of 28,000 vertices.
 * @type {(page: Page | Frame) => Promise<PoseDocument>}
 */
export const pose = async (page) => JSON.parse(await page.evaluate(async () => JSON.stringify(await window.gaitway.pose())));
/** @type {(page: Page | Frame, partial: object) => Promise<void>} */
export const apply = (page, partial) => page.evaluate(async (partial) => void (await window.gaitway.apply(partial)), partial);
/** @type {(page: Page | Frame, ...urls: string[]) => Promise<import("../../web/shell/types.d.ts").InspectDocument>} */
export const open = (page, ...urls) => page.evaluate(async (urls) => await window.gaitway.open(urls), urls);

/**
 * Returns the decoded image of `screenshot()`.
 * @param {Page} page
 * @returns {Promise<Image>}
 */
export async function picture(page) {
  const { width, height, base64 } = await page.evaluate(async () => {
    const bitmap = await createImageBitmap(await window.gaitway.screenshot(), { premultiplyAlpha: "none" });
    const { width, height } = bitmap;
    const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    if (context === null) throw new Error("no 2D context");
    context.drawImage(bitmap, 0, 0);
    const bytes = context.getImageData(0, 0, width, height).data;
    let text = "";
    for (let at = 0; at < bytes.length; at += 0x8000) text += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
    return { width, height, base64: btoa(text) };
  });
  return { width, height, rgba: Buffer.from(base64, "base64") };
}

/**
 * Drops files on the page, or a link, as a person would.
 * @param {Page | Frame} page
 * @param {({ name: string, url?: string, text?: string } | { link: string })[]} items
 * @param {number} [across] Where, as a share of the page's width.
 */
export function drop(page, items, across = 0.5) {
  return page.evaluate(async ({ items, across }) => {
    const transfer = new DataTransfer();
    for (const item of items) {
      if ("link" in item) {
        transfer.setData("text/uri-list", item.link);
        continue;
      }
      const { name, url, text = "" } = item;
      const content = url === undefined ? text : await (await fetch(url)).blob();
      transfer.items.add(new File([content], name));
    }
    const where = { clientX: innerWidth * across, clientY: innerHeight / 2, bubbles: true, cancelable: true, composed: true };
    const target = document.elementFromPoint(where.clientX, where.clientY);
    for (const type of ["dragenter", "dragover", "drop"]) target?.dispatchEvent(new DragEvent(type, { ...where, dataTransfer: transfer }));
  }, { items, across });
}

/**
 * Builds the part of a URL after the `#`.
 * @param {[key: string, value: string | number][]} parts
 */
export const fragment = (parts) => parts.map(([key, value]) => `${key}=${encodeURIComponent(value)}`).join("&");

/**
 * Returns the panels' controls with this role and name, in reading order. Unless `exact`, a text may be a part of the name.
 * @param {Page} page
 * @param {Parameters<Page["getByRole"]>[0]} role
 * @param {string | RegExp} name
 * @param {boolean} [exact]
 */
export const controls = (page, role, name, exact = false) => page.locator("#mirror").getByRole(role, { name, exact });

/**
 * Returns the first of them.
 * @param {Page} page
 * @param {Parameters<Page["getByRole"]>[0]} role
 * @param {string | RegExp} name
 */
export const control = (page, role, name) => controls(page, role, name).first();

/**
 * Returns where the pointer hits a control, which must be in sight: the mirror lies over the panels, entry by entry.
 * @param {import("playwright-core").Locator} control
 */
export async function centreOf(control) {
  const box = await control.boundingBox();
  if (box === null) throw new Error(`${control} isn't in sight`);
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
}

/**
 * Presses a button of the panels and returns the file that it saves.
 * @param {Page} page
 * @param {string} name The button's.
 */
export async function savedBy(page, name) {
  const download = page.waitForEvent("download");
  await control(page, "button", name).press("Enter");
  const file = await download;
  return { name: file.suggestedFilename(), bytes: fs.readFileSync(await file.path()) };
}

/**
 * Opens the share dialog by keyboard.
 * @param {Page} page
 */
export async function share(page) {
  await control(page, "button", "Share…").press("Enter");
  await page.locator("#share").waitFor({ state: "visible" });
}

/**
 * Waits until the screen shows this many vertices.
 * @param {Page | Frame} page
 * @param {number} vertices
 */
export function whenShown(page, vertices) {
  /** @param {number} vertices */
  const shows = async (vertices) => {
    const { meshes } = await window.gaitway.pose();
    return meshes.reduce((sum, { positions }) => sum + positions.length / 3, 0) === vertices;
  };
  return until(page, shows, vertices);
}

/**
 * Waits until this is the only model of the view.
 * @param {Page | Frame} page
 * @param {string} name
 */
export const whenModel = (page, name) => until(page, async (name) => (await window.gaitway.state()).model.join() === name, name);

/**
 * Waits until this many motions are borrowed.
 * @param {Page | Frame} page
 * @param {number} count
 */
export const whenBorrowed = (page, count) => until(page, async (count) => (await window.gaitway.state()).motion.length === count, count);

/**
 * Waits until the picture differs from an earlier one.
 * @param {Page} page
 * @param {Image} earlier
 */
export const whenPictureDiffers = (page, earlier) => eventually(async () => meanDifference(await picture(page), earlier) > 0, "the picture should change");

/**
 * Returns the mean absolute difference of two images' colors, 0 to 255. They must have the same size.
 * @param {Image} a
 * @param {Image} b
 */
export function meanDifference(a, b) {
  if (a.width !== b.width || a.height !== b.height) throw new Error(`sizes differ: ${a.width}×${a.height}, ${b.width}×${b.height}`);
  let sum = 0;
  for (let at = 0; at < a.rgba.length; at++) sum += Math.abs(a.rgba[at] - b.rgba[at]);
  return sum / a.rgba.length;
}

/**
 * Counts the different colors of an image.
 * @param {Image} image
 */
export function colorsOf({ rgba }) {
  const colors = new Set();
  for (let at = 0; at < rgba.length; at += 4) colors.add(rgba.readUInt32LE(at));
  return colors.size;
}

/**
 * Returns the largest distance between corresponding vertices of two poses, in meters.
 * @param {PoseDocument} a
 * @param {PoseDocument} b
 */
export function furthest(a, b) {
  let longest = 0;
  for (const [mesh, { positions }] of a.meshes.entries())
    for (let at = 0; at < positions.length; at += 3) {
      const other = b.meshes[mesh].positions;
      longest = Math.max(longest, Math.hypot(...[0, 1, 2].map((axis) => positions[at + axis] - other[at + axis])));
    }
  return longest;
}

/**
 * Returns how many frames the app draws within this many animation frames.
 * @param {Page} page
 * @param {number} count
 */
export const framesDrawnDuring = (page, count) =>
  page.evaluate(async (count) => {
    const { frames: before } = await window.gaitway.stats();
    for (let frame = 0; frame < count; frame++) await new Promise(requestAnimationFrame);
    return (await window.gaitway.stats()).frames - before;
  }, count);

/**
 * The app is at rest after this many animation frames without drawing: longer than a quarter of a second, after which it refines a
 * picture and reads the panels to the mirror.
 */
const STILL_FRAMES = 24;

/**
 * Waits until the app draws no more frames: it has responded to the last resize, key or click.
 * @param {Page} page
 */
export async function untilStill(page) {
  const comesToRest = (/** @type {number} */ count) =>
    page.evaluate(async (count) => {
      let [{ frames }, still] = [await window.gaitway.stats(), 0];
      for (let left = 10 * count; left > 0 && still < count; left--) {
        await new Promise(requestAnimationFrame);
        const { frames: now } = await window.gaitway.stats();
        [still, frames] = [now === frames ? still + 1 : 0, now];
      }
      return still === count;
    }, count);
  await eventually(() => comesToRest(STILL_FRAMES), "the app should come to rest");
}

/**
 * Resizes the page and waits until the app has laid itself out: a press before that would be lost with the control it meant.
 * @param {Page} page
 * @param {number} width
 * @param {number} height
 */
export async function resize(page, width, height) {
  await page.setViewportSize({ width, height });
  await until(page, (width) => [...document.querySelectorAll("canvas")].some((canvas) => Math.abs(canvas.width - width * devicePixelRatio) < 1), width);
  await untilStill(page);
}

/**
 * Opens the inspector, with which a screen of this size does not start, or closes it.
 * @param {Page} page
 */
export async function toggleInspector(page) {
  await page.locator("canvas").focus();
  await page.keyboard.press("n");
  await untilStill(page);
}
