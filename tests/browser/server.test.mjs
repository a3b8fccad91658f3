// Servers that announce more than they send, and downloads that never end: the page's memory grows with what arrives, and
// what isn't complete doesn't stay in the program, whose memory never shrinks.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { pose, startServer, startSite } from "./browser.mjs";

const MIB = 2 ** 20;
/** What a program takes at most of a download that isn't complete, and while that grows. */
const MAX_HELD = 160 * MIB;

/** Keeps the memory of the program that runs. Runs in the page, before its scripts. */
function keepMemory() {
  const { instantiate } = WebAssembly;
  /** @type {any} */ (WebAssembly).instantiate = async (/** @type {[any, any]} */ ...given) => {
    const instance = /** @type {any} */ (await instantiate(...given));
    /** @type {any} */ (window).memory = instance.exports.memory;
    return instance;
  };
}

/** @param {import("playwright-core").Page} page */
const memoryOf = (page) => page.evaluate(() => /** @type {number} */ (/** @type {any} */ (window).memory.buffer.byteLength));

/** @type {(page: import("playwright-core").Page, url: string) => Promise<string>} */
const problemOf = (page, url) => page.evaluate((url) => window.gaitway.open(url).then(() => "", (error) => error.message), url);

/**
 * Returns a GLB of which only the last bytes matter: a triangle, 2 m high.
 * @param {number} length Of its buffer.
 */
function largeGlb(length) {
  const corners = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 2, 0]).buffer);
  const text = JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 2, 0] }],
    bufferViews: [{ buffer: 0, byteOffset: length - corners.length, byteLength: corners.length }],
    buffers: [{ byteLength: length }],
  });
  const json = Buffer.from(text.padEnd(Math.ceil(text.length / 4) * 4));
  const head = Buffer.alloc(20);
  head.write("glTF");
  [2, 28 + json.length + length, json.length].forEach((value, index) => head.writeUInt32LE(value, 4 + 4 * index));
  head.write("JSON", 16);
  const chunk = Buffer.alloc(8);
  chunk.writeUInt32LE(length);
  chunk.write("BIN\0", 4);
  return Buffer.concat([head, json, chunk, Buffer.alloc(length - corners.length), corners]);
}

describe("a server", () => {
  /** @type {import("./browser.mjs").Site} */
  let site;
  before(async () => {
    site = await startSite({ isOffScreen: true, isCalm: true });
  });
  after(() => site.close());

  test("that announces a gigabyte and sends four bytes costs no memory", async () => {
    const server = await startServer((_, response) => {
      response.writeHead(200, { "content-length": 1024 * MIB, "access-control-allow-origin": "*" });
      response.write("glTF", () => setTimeout(() => response.destroy(), 100));
    });
    const page = await site.page({ renderer: "webgl2", before: keepMemory });
    const atFirst = await memoryOf(page);
    for (let index = 0; index < 5; index++) assert.match(await problemOf(page, `${server.address}/${index}.glb`), /the connection was lost after 4 bytes$/);
    assert.ok((await memoryOf(page)) - atFirst < 16 * MIB, `${await memoryOf(page)} bytes after ${atFirst}`);
    await page.finish();
    server.close();
  });

  test("that never ends leaves the program as small as before", async () => {
    const block = Buffer.alloc(4 * MIB);
    const server = await startServer((_, response) => {
      response.writeHead(200, { "access-control-allow-origin": "*" });
      const send = (/** @type {number} */ left) => (left > 0 ? response.write(block, () => send(left - 1)) : response.destroy());
      send(75);
    });
    const page = await site.page({ renderer: "webgl2", before: keepMemory });
    const atFirst = await memoryOf(page);
    assert.match(await problemOf(page, `${server.address}/endless.glb`), /the connection was lost after \d{9} bytes$/);
    assert.ok((await memoryOf(page)) - atFirst < MAX_HELD, `${await memoryOf(page)} bytes after ${atFirst}`);
    await page.finish();
    server.close();
  });

  test("that sends a large file sends all of it", async () => {
    const large = largeGlb(70 * MIB);
    const server = await startServer((_, response) => {
      // Without its length.
      response.writeHead(200, { "access-control-allow-origin": "*" });
      response.end(large);
    });
    const page = await site.page({ renderer: "webgl2" });
    assert.equal(await problemOf(page, `${server.address}/large.glb`), "");
    assert.deepEqual((await pose(page)).meshes[0].positions, [0, 0, 0, 1, 0, 0, 0, 2, 0]);
    assert.deepEqual(page.troubles, []);
    await page.finish();
    server.close();
  });
});
