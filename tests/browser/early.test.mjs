// A link's model is shown as soon as nothing but its images is missing, from a server that sends them only when told to.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import sharp from "sharp";
import { BACK_ENDS, apply, control, drop, eventually, open, picture, startServer, startSite, state, toggleInspector, until } from "./browser.mjs";

/** @typedef {import("./browser.mjs").TestPage} TestPage */

const RED = [255, 0, 0];
const IMAGE_BYTES = 300_000;

/** Returns an unlit cube that moves to and fro, red by its image, which is last. */
async function cube() {
  const corners = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z) => [x, y, z]))).flat();
  const faces = [0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3];
  const png = await sharp({ create: { width: 8, height: 8, channels: 3, background: "#ff0000" } }).png().toBuffer();
  const parts = [
    Buffer.from(new Float32Array(corners).buffer),
    Buffer.from(new Float32Array(16).fill(0.5).buffer),
    Buffer.from(new Uint16Array(faces).buffer),
    Buffer.from(new Float32Array([0, 0.5, 1]).buffer),
    Buffer.from(new Float32Array([0, 0, 0, 0.3, 0, 0, 0, 0, 0]).buffer),
    Buffer.concat([png, Buffer.alloc(IMAGE_BYTES - png.length)]),
  ];
  let byteOffset = 0;
  const bufferViews = parts.map(({ length }) => ({ buffer: 0, byteLength: length, byteOffset: (byteOffset += length) - length }));
  const accessors = [
    { bufferView: 0, componentType: 5126, type: "VEC3", count: 8, min: [-1, -1, -1], max: [1, 1, 1] },
    { bufferView: 1, componentType: 5126, type: "VEC2", count: 8 },
    { bufferView: 2, componentType: 5123, type: "SCALAR", count: 36 },
    { bufferView: 3, componentType: 5126, type: "SCALAR", count: 3, min: [0], max: [1] },
    { bufferView: 4, componentType: 5126, type: "VEC3", count: 3 },
  ];
  const document = {
    asset: { version: "2.0" },
    buffers: [{ byteLength: byteOffset }],
    bufferViews,
    accessors,
    images: [{ bufferView: 5, mimeType: "image/png" }],
    textures: [{ source: 0 }],
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } }, extensions: { KHR_materials_unlit: {} } }],
    extensionsUsed: ["KHR_materials_unlit"],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2, material: 0 }] }],
    nodes: [{ mesh: 0 }],
    animations: [{ name: "sway", channels: [{ sampler: 0, target: { node: 0, path: "translation" } }], samplers: [{ input: 3, output: 4 }] }],
  };
  const text = JSON.stringify(document);
  const json = Buffer.from(text.padEnd(Math.ceil(text.length / 4) * 4));
  /** @type {(length: number, kind: string) => Buffer} */
  const head = (length, kind) => {
    const bytes = Buffer.alloc(8);
    bytes.writeUInt32LE(length);
    bytes.write(kind, 4, "latin1");
    return bytes;
  };
  const chunks = Buffer.concat([head(json.length, "JSON"), json, head(byteOffset, "BIN\0"), ...parts]);
  const start = Buffer.alloc(12);
  start.write("glTF");
  start.writeUInt32LE(2, 4);
  start.writeUInt32LE(12 + chunks.length, 8);
  return Buffer.concat([start, chunks]);
}

/**
 * Serves a file, at first only up to its images.
 * @param {Buffer} file
 */
async function serveSlowly(file) {
  /** @type {import("node:http").ServerResponse[]} */
  const waiting = [];
  let requests = 0;
  const { address, close } = await startServer((_, response) => {
    requests += 1;
    response.writeHead(200, { "access-control-allow-origin": "*", "cache-control": "no-store", "content-length": file.length });
    if (requests > 1) return void response.end(file);
    response.write(file.subarray(0, file.length - IMAGE_BYTES + 100));
    waiting.push(response);
  });
  return {
    url: `${address}/cube.glb`,
    requests: () => requests,
    /** Sends some more. */
    more: () => waiting.forEach((response) => response.write(file.subarray(file.length - IMAGE_BYTES + 100, file.length - IMAGE_BYTES + 200))),
    finish: () => waiting.forEach((response) => response.end(file.subarray(file.length - IMAGE_BYTES + 100))),
    cut: () => waiting.forEach((response) => response.destroy()),
    isClosed: () => waiting.every((response) => response.closed),
    close,
  };
}

/**
 * Returns the colour on the screen in the middle of the viewport.
 * @param {TestPage} page
 */
async function middle(page) {
  const png = await page.screenshot();
  const { width = 0, height = 0 } = await sharp(png).metadata();
  const pixel = { left: Math.round(width / 2), top: Math.round(height / 2), width: 1, height: 1 };
  return [...(await sharp(png).extract(pixel).removeAlpha().raw().toBuffer())];
}

/** @param {number[]} color */
const isWhite = (color) => Math.min(...color) > 250;
/** @param {number[]} color */
const isRed = (color) => color.every((channel, at) => Math.abs(channel - RED[at]) < 3);
/** @param {TestPage} page */
const whenPictured = (page) => until(page, () => document.getElementById("loading")?.hidden === true);
/** @param {TestPage} page */
const isReady = (page) => page.evaluate(() => Promise.race([window.gaitway.ready.then(() => true), new Promise((resolve) => setTimeout(resolve, 0, false))]));
/** @type {(page: TestPage, text: string) => Promise<boolean | undefined>} */
const says = (page, text) => page.evaluate((text) => document.querySelector("#mirror")?.textContent?.includes(text), text);

for (const renderer of BACK_ENDS)
  describe(`a model before its images on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    /** @type {Buffer} */
    let file;
    before(async () => {
      site = await startSite();
      file = await cube();
    });
    after(() => site?.close());

    /**
     * @param {string} name
     * @param {(page: TestPage, server: Awaited<ReturnType<typeof serveSlowly>>) => Promise<void>} body
     */
    const onPage = (name, body) =>
      test(name, async () => {
        const server = await serveSlowly(file);
        const page = await site.page({ renderer, link: `model=${encodeURIComponent(server.url)}`, ready: false });
        try {
          await whenPictured(page);
          await eventually(async () => isWhite(await middle(page)), "the cube should be there, without its image");
          await eventually(() => says(page, "Opening cube.glb"), "the progress should be shown");
          await body(page, server);
        } finally {
          server.close();
          await page.finish();
        }
      });

    onPage("it moves, and gets its images where it is", async (page, server) => {
      const first = await page.screenshot();
      await eventually(async () => !first.equals(await page.screenshot()), "the cube should move");
      assert.equal(await isReady(page), false, "scripts wait for all of it");
      await apply(page, { speed: 0.25 });
      const withoutTime = async () => ({ ...(await state(page)), t: 0 });
      const before = await withoutTime();
      server.finish();
      await page.evaluate(() => window.gaitway.ready);
      await eventually(async () => isRed(await middle(page)), "the cube should get its image");
      assert.deepEqual(await withoutTime(), before, "nothing else has changed");
      await eventually(async () => !(await says(page, "Opening cube.glb")), "the progress should be gone");
      assert.equal(server.requests(), 1, "nothing is downloaded twice");
      assert.deepEqual(page.troubles, []);
    });

    onPage("a picture that a script asks for has the images", async (page, server) => {
      const asked = picture(page);
      await until(page, () => window.gaitway !== undefined);
      server.finish();
      const { width, height, rgba } = await asked;
      const at = 4 * (Math.round(height / 2) * width + Math.round(width / 2));
      assert.ok(isRed([...rgba.subarray(at, at + 3)]));
      assert.deepEqual(page.troubles, []);
    });

    onPage("a connection that is lost is reported, and can be tried again", async (page, server) => {
      await apply(page, { speed: 0.25 });
      server.cut();
      await page.locator("#missing").waitFor({ state: "visible" });
      assert.equal(await page.locator("#missing-title").innerText(), "The images of this model couldn't be loaded");
      assert.match((await page.locator("#missing-parts li").allInnerTexts()).join(), /cube\.glb: the connection was lost after \d+ bytes/);
      assert.equal(await isReady(page), true, "nothing more is awaited");
      await eventually(async () => !(await says(page, "Opening cube.glb")), "the progress should be gone");
      await page.locator("#missing-again").click();
      await eventually(async () => isRed(await middle(page)), "the cube should get its image");
      assert.equal(Object(await state(page)).speed, 0.25, "the view is kept");
      assert.equal(server.requests(), 2);
    });

    onPage("a dropped copy has the images that didn't arrive, and the view is kept", async (page, server) => {
      await apply(page, { camera: "30,10,4,0,0,0" });
      server.cut();
      await page.locator("#missing-continue").click();
      await drop(page, [{ name: "cube.glb", url: server.url }]);
      await until(page, async () => (await window.gaitway.state()).model.join() === "cube.glb" && (await window.gaitway.state()).camera !== "auto");
      assert.match(String(Object(await state(page)).camera), /^30,10,4,/);
      await eventually(async () => isRed(await middle(page)), "the cube should get its image");
    });

    onPage("the rest is awaited beside what else is opened, and can be cancelled then", async (page, server) => {
      await open(page, "sample:pilot");
      await eventually(async () => !(await says(page, "Opening cube.glb")), "the other progress should end");
      server.more();
      await eventually(() => says(page, "Opening cube.glb"), "the progress should be shown again");
      await control(page, "button", "Cancel").press("Enter");
      await eventually(() => server.isClosed(), "the download should end");
      assert.deepEqual(page.troubles, []);
    });

    onPage("the rest can be cancelled", async (page, server) => {
      await control(page, "button", "Cancel").press("Enter");
      await eventually(() => isReady(page), "nothing more is awaited");
      await eventually(() => server.isClosed(), "the download should end");
      assert.ok(isWhite(await middle(page)), "the cube stays as it is");
      await eventually(() => says(page, "without its images"), "the page should say so");
      await apply(page, { play: false });
      await toggleInspector(page);
      await control(page, "tab", "Camera").press("Enter");
      await control(page, "button", "Record one loop").press("Enter");
      await eventually(() => says(page, "images have not arrived"), "nothing is recorded");
      assert.deepEqual(page.troubles, []);
    });
  });
