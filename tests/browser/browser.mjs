// Chromium with both back ends in software, and the page as a test sees it.
import fs from "node:fs";
import path from "node:path";
import { chromium } from "playwright-core";
import { dataFolder, repository } from "../three/data.mjs";
import { serve } from "./server.mjs";

export const BACK_ENDS = ["webgpu", "webgl2"];

/** Small, since a software renderer draws it. */
export const VIEWPORT = { width: 800, height: 600 };

/** Both back ends on the software renderer; a domain whose GPU process was crashed on purpose may draw again. */
export const FLAGS = [
  "--enable-unsafe-webgpu",
  "--use-webgpu-adapter=swiftshader",
  "--enable-features=Vulkan",
  "--use-vulkan=swiftshader",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--disable-domain-blocking-for-3d-apis",
];

export const dist = process.env.GAITWAY_DIST ?? path.join(repository, "dist");

export function launch() {
  return chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
}

/** The two servers and one Chromium: `{browser, address, data, page, close}`. */
export async function startSite() {
  if (!fs.existsSync(path.join(dist, "index.html"))) throw new Error(`no built page in ${dist}: run \`cargo xtask build\``);
  const site = await serve({ "/some/folder/": dist });
  const data = dataFolder === null ? null : await serve({ "/": dataFolder }, { "access-control-allow-origin": "*" });
  const browser = await launch();
  return {
    browser,
    /** URL of the page itself. */
    address: `${site.origin}/some/folder/`,
    /** URL of a file of the data folder, on another origin than the page. */
    data: (name) => `${data.origin}/${name}`,
    page: (options) => openPage(browser, `${site.origin}/some/folder/`, options),
    close: async () => {
      await browser.close();
      await site.close();
      await data?.close();
    },
  };
}

/** A fresh page that is ready, with the walker unless told otherwise (an empty link: as somebody first comes). `page.troubles` collects uncaught errors and messages of level error, `page.requests` all URLs. */
async function openPage(browser, address, { renderer, link = "model=sample:walker", viewport = VIEWPORT, before, ready = true }) {
  // What each fresh profile would keep is megabytes; offline.test.mjs looks at it.
  const context = await browser.newContext({ viewport, serviceWorkers: "block" });
  const page = await context.newPage();
  page.setDefaultTimeout(60_000);
  page.troubles = [];
  page.requests = [];
  page.on("pageerror", (error) => page.troubles.push(error.message));
  page.on("console", (message) => message.type() === "error" && page.troubles.push(message.text()));
  page.on("request", (request) => page.requests.push(request.url()));
  await page.addInitScript(() => addEventListener("securitypolicyviolation", ({ violatedDirective, blockedURI }) => console.error(`against the content security policy: ${violatedDirective} ${blockedURI}`)));
  if (before !== undefined) await page.addInitScript(before);
  await page.goto(`${address}${renderer === undefined ? "" : `?renderer=${renderer}`}${link === "" ? "" : `#${link}`}`);
  if (ready) await whenReady(page);
  page.finish = () => context.close();
  return page;
}

/** What the question gives that was put to a page just as it left for the next. */
const LEAVING = /Execution context was destroyed/;

/** Waits until a function of the page, which may be asynchronous, gives something true; a page on its way to the next is asked again there. (Playwright's own wait takes a promise for something true.) */
export async function until(page, holds, argument) {
  const deadline = Date.now() + 60_000;
  const asked = () =>
    page.evaluate(holds, argument).catch((error) => {
      if (!LEAVING.test(error.message)) throw error;
    });
  while (!(await asked())) {
    if (Date.now() > deadline) throw new Error(`still not so after a minute: ${holds}`);
    await page.waitForTimeout(50);
  }
}

export async function whenReady(page) {
  await until(page, () => window.gaitway !== undefined);
  await page.evaluate(async () => {
    await window.gaitway.ready;
  });
}

// The calls of `window.gaitway`, from the test's side.

export const state = (page) => page.evaluate(async () => await window.gaitway.state());
export const stats = (page) => page.evaluate(async () => await window.gaitway.stats());
export const pose = (page) => page.evaluate(async () => await window.gaitway.pose());
export const apply = (page, partial) => page.evaluate(async (partial) => void (await window.gaitway.apply(partial)), partial);
export const open = (page, ...items) => page.evaluate(async (items) => await window.gaitway.open(items), items);

/** The picture that `screenshot()` gives: `{width, height, rgba}`, straight alpha. */
export async function picture(page) {
  const { width, height, base64 } = await page.evaluate(async () => {
    const bitmap = await createImageBitmap(await window.gaitway.screenshot(), { premultiplyAlpha: "none" });
    const { width, height } = bitmap;
    const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    context.drawImage(bitmap, 0, 0);
    const bytes = context.getImageData(0, 0, width, height).data;
    let text = "";
    for (let at = 0; at < bytes.length; at += 0x8000) text += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
    return { width, height, base64: btoa(text) };
  });
  return { width, height, rgba: Buffer.from(base64, "base64") };
}

/** Drops files on the middle of the page as a person would: `files` are `{name, url}` or `{name, text}`. */
export function drop(page, files) {
  return page.evaluate(async (files) => {
    const transfer = new DataTransfer();
    for (const { name, url, text } of files) {
      const content = url === undefined ? text : await (await fetch(url)).blob();
      transfer.items.add(new File([content], name));
    }
    const where = { clientX: innerWidth / 2, clientY: innerHeight / 2, bubbles: true, cancelable: true, composed: true };
    const target = document.elementFromPoint(where.clientX, where.clientY);
    for (const type of ["dragenter", "dragover", "drop"]) target.dispatchEvent(new DragEvent(type, { ...where, dataTransfer: transfer }));
  }, files);
}

/** The part of an address after the `#`: `parts` are pairs of key and value. */
export const fragment = (parts) => parts.map(([key, value]) => `${key}=${encodeURIComponent(value)}`).join("&");

/** Opens the dialog with the link, as the keyboard reaches it. */
export async function share(page) {
  await page.locator("#do-share").focus();
  await page.keyboard.press("Enter");
  await page.locator("#share").waitFor({ state: "visible" });
}

/** Waits until what is on the screen has this many vertices. */
export function whenShown(page, vertices) {
  const shows = async (vertices) => {
    const { meshes } = await window.gaitway.pose();
    return meshes.reduce((sum, { positions }) => sum + positions.length / 3, 0) === vertices;
  };
  return until(page, shows, vertices);
}

/** Mean absolute difference of two pictures' colours, 0 to 255; they must have the same size. */
export function meanDifference(a, b) {
  if (a.width !== b.width || a.height !== b.height) throw new Error(`sizes differ: ${a.width}×${a.height}, ${b.width}×${b.height}`);
  let sum = 0;
  for (let at = 0; at < a.rgba.length; at++) sum += Math.abs(a.rgba[at] - b.rgba[at]);
  return sum / a.rgba.length;
}

/** How many different colours a picture has. */
export function coloursOf({ rgba }) {
  const colours = new Set();
  for (let at = 0; at < rgba.length; at += 4) colours.add(rgba.readUInt32LE(at));
  return colours.size;
}

/** Waits until nothing has been drawn for a while: what was resized, pressed or scrolled is in its place. */
export async function untilStill(page) {
  const frames = () => page.evaluate(() => window.gaitway.stats().frames);
  let [before, still] = [await frames(), 0];
  while (still < 4) {
    await page.waitForTimeout(200);
    const now = await frames();
    still = now === before ? still + 1 : 0;
    before = now;
  }
}
