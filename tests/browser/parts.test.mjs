// Parts that few files need: each is downloaded only on demand, and a failure in one affects nothing else.
import assert from "node:assert/strict";
import fs from "node:fs";
import { after, before, describe, test } from "node:test";
import binaryen from "binaryen";
import { dataFile, skipWithoutData } from "../three/data.mjs";
import { PICKLED, walkingPerson, walkingPositions } from "../three/npz.mjs";
import { dataUri, png, withPngTextures, withTextures } from "../three/ktx2.mjs";
import { withoutMeshopt } from "../three/meshopt.mjs";
import { BACK_ENDS, apply, meanDifference, open, picture, pose, startSite, state, stats, whenBorrowed, withShortMinute, withoutHashes } from "./browser.mjs";

/**
 * Models in several encodings, with a view of them and the part that each encoding needs.
 * @type {{ plain: string, view: string, encodings: { file: string, part?: string }[] }[]}
 */
const COMPRESSED = [
  {
    plain: "threejs/RobotExpressive.glb",
    view: "clip=&camera=30,10,20,0,2,0",
    encodings: [
      { file: "compressed/RobotExpressive-gltfpack-meshopt.glb", part: "meshopt" },
      { file: "compressed/RobotExpressive-gltfpack-quantized.glb" },
    ],
  },
  {
    plain: "khronos/CesiumMan/glTF/CesiumMan.gltf",
    view: "clip=&camera=30,10,4,0,0.8,0",
    encodings: [{ file: "khronos/CesiumMan/glTF-Draco/CesiumMan.gltf", part: "draco" }],
  },
  {
    plain: "khronos/Fox/glTF-Binary/Fox.glb",
    view: "clip=Run&play=0&t=0.4&camera=30,10,380,0,40,-10",
    encodings: [
      { file: "compressed/Fox-gltfpack-meshopt.glb", part: "meshopt" },
      { file: "compressed/Fox-gltftransform-meshopt.glb", part: "meshopt" },
      { file: "compressed/Fox-gltftransform-draco.glb", part: "draco" },
      { file: "compressed/Fox-gltftransform-quantize.glb" },
      { file: "compressed/Fox-gltftransform-webp.glb" },
    ],
  },
  {
    plain: "khronos/Duck/glTF-Binary/Duck.glb",
    view: "",
    encodings: [{ file: "compressed/Duck-vp-12-vt-12-vn-12.glb", part: "meshopt" }],
  },
];
/**
 * Mean difference of pictures, 0 to 255. 14 bits move no vertex of the fox by more than 0.01 pixels, so only pixels on
 * edges change: about 0.02, as with the other models. Keys at 30 Hz and lossy WebP give 0.05; a fox that is 0.001
 * seconds ahead, 0.12.
 */
const QUANTIZED = 0.1;
const FOX = "compressed/Fox-gltfpack-meshopt.glb";
/** Their uncompressed originals are not among the files. */
const MESHOPT = ["compressed/loaders-gl-meshopt/BoxTextured_meshopt.glb", "compressed/loaders-gl-meshopt/pirate.glb"];
const KTX2 = "compressed/agi-ktx2.glb";
const AVIF = new URL("../support/gradients.avif", import.meta.url);
const UASTC = new URL("../support/ktx2/uastc.ktx2", import.meta.url);
const SAMBA = "threejs/Samba_Dancing.fbx";
const PILOT = "cosc422/original/ArmyPilot/ArmyPilot.x";
const COURSEWORK = {
  original: ["cosc422/original/Mannequin/mannequin.fbx", "cosc422/original/Mannequin/run.fbx"],
  converted: ["cosc422/mannequin.glb", "cosc422/mannequin_run.glb"],
};

/**
 * A textured triangle on two joints, and a clip that lifts the upper one by 2 along Z, which is away from the viewer
 * there.
 */
const MADE_X = `xof 0303txt 0032
Frame hips { Frame chest { FrameTransformMatrix { 1,0,0,0, 0,1,0,0, 0,0,1,0, 0,1,0,1;; } } }
Frame body { Mesh {
  3; 0;0;0;, 0;1;0;, 1;0;0;; 1; 3;0,1,2;;
  MeshTextureCoords { 3; 0;0;, 0;1;, 1;1;; }
  MeshMaterialList { 1; 1; 0; Material { 1;1;1;1;; 0; 0;0;0;; 0;0;0;; TextureFilename { "C:\\art\\made.png"; } } }
  SkinWeights { "hips"; 2; 0,2; 1,1; 1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1;; }
  SkinWeights { "chest"; 1; 1; 1; 1,0,0,0, 0,1,0,0, 0,0,1,0, 0,-1,0,1;; }
} }
AnimTicksPerSecond { 30; }
AnimationSet Lift { Animation { { chest } AnimationKey { 2; 2; 0;3;0,1,0;;, 60;3;0,1,2;;; } } }
`;

/** @param {import("./browser.mjs").TestPage} page */
const requested = (page) => page.requests.filter((url) => url.includes("/parts/"));

/**
 * A module with the exports of a part. Its input lies at the beginning of its memory, so its output is far from there.
 * @param {string} body What it does when it runs.
 * @param {string} output What is found at its output.
 */
function module(body, output = "") {
  const text = `(module
    (memory (export "memory") 1000)
    (data (i32.const 60000000) "${output}")
    (func (export "input") (param i32) (result i32) (i32.const 0))
    (func (export "run") ${body})
    (func (export "output") (result i32) (i32.const 60000000))
    (func (export "output_length") (result i32) (i32.const ${output.length})))`;
  return Buffer.from(binaryen.parseText(text).emitBinary());
}

/**
 * @param {number[]} expected
 * @param {number[]} [found]
 */
const largestDifference = (expected, found) => Math.max(...expected.map((value, at) => Math.abs(value - (found?.[at] ?? NaN))));

/** The contents of the AVIF and UASTC images, as PNG; see gradients() in tests/files/decode.rs. */
function gradients() {
  const pixels = Array.from({ length: 64 * 32 }, (_, at) => {
    const [x, y] = [at % 64, at >> 6];
    return [(255 * x) / 63, (255 * y) / 31, ((x >> 4) + (y >> 4)) & 1 ? 200 : 40, 255];
  });
  return png(64, 32, Uint8Array.from(pixels.flat()));
}

/** Hides BC7 from either back end and records texture formats. */
function withoutBc7() {
  /** @type {unknown[]} */
  const formats = (/** @type {any} */ (window).textureFormats = []);
  const { getSupportedExtensions, texStorage2D } = WebGL2RenderingContext.prototype;
  WebGL2RenderingContext.prototype.getSupportedExtensions = function () {
    return getSupportedExtensions.call(this)?.filter((name) => !name.includes("bptc")) ?? null;
  };
  WebGL2RenderingContext.prototype.texStorage2D = function (target, levels, format, width, height) {
    formats.push(format);
    texStorage2D.call(this, target, levels, format, width, height);
  };
  const { get: features = () => new Set() } = Object.getOwnPropertyDescriptor(GPUAdapter.prototype, "features") ?? {};
  Object.defineProperty(GPUAdapter.prototype, "features", {
    get() {
      return new Set([...features.call(this)].filter((name) => name !== "texture-compression-bc"));
    },
  });
  const { createTexture } = GPUDevice.prototype;
  GPUDevice.prototype.createTexture = function (descriptor) {
    formats.push(descriptor.format);
    return createTexture.call(this, descriptor);
  };
}

/** Each back end's names for the formats that replace BC7. */
const WITHOUT_BC7 = {
  webgpu: { etc2: "etc2-rgb8unorm-srgb", astc: "astc-4x4-unorm-srgb" },
  webgl2: { etc2: 0x9275, astc: 0x93d0 },
};

/**
 * Two red triangles. After a second, KHR_animation_pointer has turned them blue and hidden one by KHR_node_visibility.
 */
function animatedTriangles() {
  const numbers = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 1]).buffer);
  const buffer = Buffer.concat([numbers, Buffer.from([1, 0, 0, 0])]);
  /** @type {(pointer: string, sampler: number) => object} */
  const channel = (pointer, sampler) => {
    const extensions = { KHR_animation_pointer: { pointer } };
    return { sampler, target: { path: "pointer", extensions } };
  };
  const views = [[0, 36], [36, 8], [44, 32], [76, 2]];
  const document = {
    asset: { version: "2.0" },
    extensionsUsed: ["KHR_animation_pointer", "KHR_node_visibility", "KHR_materials_unlit"],
    scene: 0,
    scenes: [{ nodes: [0, 1] }],
    nodes: [{ mesh: 0 }, { mesh: 0, translation: [1, 1, 0], extensions: { KHR_node_visibility: { visible: true } } }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorFactor: [1, 0, 0, 1] }, extensions: { KHR_materials_unlit: {} } }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] },
      { bufferView: 1, componentType: 5126, count: 2, type: "SCALAR", min: [0], max: [1] },
      { bufferView: 2, componentType: 5126, count: 2, type: "VEC4" },
      { bufferView: 3, componentType: 5121, count: 2, type: "SCALAR" },
    ],
    bufferViews: views.map(([byteOffset, byteLength]) => ({ buffer: 0, byteOffset, byteLength })),
    animations: [
      {
        samplers: [{ input: 1, output: 2 }, { input: 1, output: 3, interpolation: "STEP" }],
        channels: [
          channel("/materials/0/pbrMetallicRoughness/baseColorFactor", 0),
          channel("/nodes/1/extensions/KHR_node_visibility/visible", 1),
        ],
      },
    ],
    buffers: [{ byteLength: buffer.length, uri: dataUri("application/octet-stream", buffer) }],
  };
  return Buffer.from(JSON.stringify(document));
}

/**
 * Returns the shares of clearly red and of clearly blue pixels.
 * @param {import("./browser.mjs").Image} image
 */
function redAndBlue({ width, height, rgba }) {
  let [red, blue] = [0, 0];
  for (let at = 0; at < rgba.length; at += 4) {
    if (rgba[at] > rgba[at + 1] + 100 && rgba[at] > rgba[at + 2] + 100) red += 1;
    if (rgba[at + 2] > rgba[at + 1] + 100 && rgba[at + 2] > rgba[at] + 100) blue += 1;
  }
  return [red, blue].map((count) => count / (width * height));
}

/** Simulates a page that was built without clang: its list of parts lacks the FBX reader. */
function withoutFbx() {
  const { querySelector } = Document.prototype;
  Document.prototype.querySelector = function (/** @type {string} */ selector) {
    const found = querySelector.call(this, selector);
    if (selector.includes("gaitway-parts")) found?.setAttribute("content", JSON.stringify({ ...JSON.parse(found.getAttribute("content") ?? ""), fbx: undefined }));
    return found;
  };
}

for (const renderer of BACK_ENDS)
  describe(`parts on ${renderer}`, { skip: skipWithoutData }, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => {
      site = await startSite({ isOffScreen: true, isCalm: true });
    });
    after(() => site?.close());

    for (const { plain, view, encodings } of COMPRESSED)
      test(`${plain} is a link in every encoding, and looks the same`, async () => {
        const original = await site.page({ renderer, link: `model=${site.data(plain)}&${view}` });
        assert.deepEqual(requested(original), [], "nothing that the file doesn't need");
        const expected = await picture(original);
        await original.finish();
        for (const { file, part } of encodings) {
          const page = await site.page({ renderer, link: `model=${site.data(file)}&${view}` });
          assert.deepEqual(requested(page).map((url) => /\/parts\/(\w+)-[0-9a-f]{16}\.wasm$/.exec(url)?.[1]), part === undefined ? [] : [part]);
          assert.equal((await stats(page)).backend, renderer);
          const difference = meanDifference(await picture(page), expected);
          assert.ok(difference < QUANTIZED, `${file}: the pictures differ by ${difference} of 255`);
          assert.deepEqual(page.troubles, []);
          await page.finish();
        }
      });

    /**
     * Follows a link to a file that doesn't exist and returns the picture.
     * @param {Buffer} body
     */
    async function pictureOf(body) {
      const page = await site.page({ renderer, link: `model=${site.data("made.gltf")}`, files: { "made.gltf": body } });
      const found = await picture(page);
      assert.deepEqual([requested(page), page.troubles], [[], []]);
      await page.finish();
      return found;
    }

    for (const file of MESHOPT)
      test(`${file} looks as three.js's decoder has it, under either name of the extension`, async () => {
        const expected = await pictureOf(await withoutMeshopt(dataFile(file)));
        // Both names are equally long, so nothing else in the file changes.
        const khr = fs.readFileSync(dataFile(file), "latin1").replaceAll("EXT_meshopt_compression", "KHR_meshopt_compression");
        for (const name of [file, "made.glb"]) {
          const page = await site.page({ renderer, link: `model=${site.data(name)}`, files: { "made.glb": Buffer.from(khr, "latin1") } });
          assert.equal(requested(page).length, 1);
          assert.match(requested(page)[0], /\/parts\/meshopt-[0-9a-f]{16}\.wasm$/);
          const difference = meanDifference(await picture(page), expected);
          assert.ok(difference < QUANTIZED, `${name}: the pictures differ by ${difference} of 255`);
          assert.deepEqual(page.troubles, []);
          await page.finish();
        }
      });

    test("a model with KTX2 textures is a link and looks like the same with PNG; they cost only themselves if the decoder fails", async () => {
      const expected = await pictureOf(await withPngTextures(dataFile(KTX2)));
      const page = await site.page({ renderer, link: `model=${site.data(KTX2)}` });
      assert.equal(requested(page).length, 1);
      assert.match(requested(page)[0], /\/parts\/ktx2-[0-9a-f]{16}\.wasm$/);
      const difference = meanDifference(await picture(page), expected);
      assert.ok(difference < 0.1, `the pictures differ by ${difference} of 255`);
      assert.deepEqual(page.troubles, []);
      await page.finish();
      const failing = await site.page({ renderer, before: withoutHashes });
      await failing.route("**/parts/*", (route) => route.fulfill({ body: module("(unreachable)"), contentType: "application/wasm" }));
      assert.match(JSON.stringify(await open(failing, site.data(KTX2))), /KTX2 decoder stopped/);
      assert.ok(meanDifference(await picture(failing), expected) > 1, "the texture can be seen");
      await failing.finish();
    });

    test("a device without BC7 gets KTX2 textures as ETC2 or ASTC", async () => {
      const uastc = withTextures(dataFile(KTX2), [dataUri("image/ktx2", fs.readFileSync(UASTC))], "KHR_texture_basisu");
      const page = await site.page({ renderer, before: withoutBc7, files: { "made.gltf": uastc } });
      const { etc2, astc } = WITHOUT_BC7[renderer];
      for (const [file, format, expected] of /** @type {[string, string | number, Buffer][]} */ ([
        [KTX2, etc2, await withPngTextures(dataFile(KTX2))],
        ["made.gltf", astc, withTextures(dataFile(KTX2), [dataUri("image/png", await gradients())])],
      ])) {
        await open(page, site.data(file));
        const difference = meanDifference(await picture(page), await pictureOf(expected));
        assert.ok(difference < 0.1, `${file}: the pictures differ by ${difference} of 255`);
        const formats = await page.evaluate(() => /** @type {any} */ (window).textureFormats);
        assert.ok(formats.includes(format), `${file}: ${formats}`);
      }
      await page.finish();
    });

    test("a model with AVIF textures is a link and looks like the same with PNG", async () => {
      const expected = await pictureOf(withTextures(dataFile(KTX2), [dataUri("image/png", await gradients())]));
      const avif = dataUri("image/avif", fs.readFileSync(AVIF));
      const difference = meanDifference(await pictureOf(withTextures(dataFile(KTX2), [avif], "EXT_texture_avif")), expected);
      assert.ok(difference < 0.5, `the pictures differ by ${difference} of 255`);
    });

    test("a link shows animated colours and visibility", async () => {
      const link = `model=${site.data("made.gltf")}&play=0&camera=0,0,6,1,1,0`;
      const page = await site.page({ renderer, link: `${link}&t=0`, files: { "made.gltf": animatedTriangles() } });
      const [red, none] = redAndBlue(await picture(page));
      await apply(page, { t: 1 });
      const [gone, blue] = redAndBlue(await picture(page));
      assert.ok(red > 0.01 && none === 0 && gone === 0, `red ${red} and ${gone}, blue ${none}`);
      assert.ok(Math.abs(blue / red - 0.5) < 0.02, `one of the two triangles is left: ${blue} of ${red}`);
      assert.deepEqual(page.troubles, []);
      await page.finish();
    });

    test("an FBX file is a link like any other, as a model and as a motion", async () => {
      const samba = site.data(SAMBA);
      const page = await site.page({ renderer, link: `model=${samba}&play=0&t=1` });
      assert.equal(requested(page).length, 1);
      assert.match(requested(page)[0], /\/parts\/fbx-[0-9a-f]{16}\.wasm$/);
      assert.deepEqual((await state(page)).model, [samba]);
      const { clip, nodes } = await pose(page);
      assert.equal(clip, "mixamo.com", "the first clip is the default");
      const hips = nodes.find(({ name }) => name === "mixamorig:Hips")?.world ?? [];
      assert.ok(hips[13] > 0.5 && hips[13] < 1.5, `in metres: the hips are at ${hips[13]}`);
      await page.finish();
      const borrowing = await site.page({ renderer, link: `model=${site.data("threejs/Xbot.glb")}&motion=${samba}` });
      await whenBorrowed(borrowing, 1);
      assert.deepEqual(borrowing.troubles, []);
      await borrowing.finish();
    });

    test("the coursework's FBX files, as they were handed out, move like their converted models", async () => {
      /** @param {string[]} files */
      const moving = async ([model, motion]) => {
        const page = await site.page({ renderer, link: `model=${site.data(model)}&motion=${site.data(motion)}&play=0&t=0` });
        await whenBorrowed(page, 1);
        const parts = requested(page);
        const times = [];
        // The converted clip has a key at each of these frames; the curves between them are lost.
        for (const frame of [0, 3, 9, 17]) {
          await apply(page, { t: frame / 30 });
          times.push(await pose(page));
        }
        assert.deepEqual(page.troubles, []);
        await page.finish();
        return { parts, times };
      };
      const original = await moving(COURSEWORK.original);
      assert.ok(original.parts.length > 0);
      for (const url of original.parts) assert.match(url, /\/parts\/fbx-[0-9a-f]{16}\.wasm$/);
      const converted = await moving(COURSEWORK.converted);
      assert.deepEqual(converted.parts, []);
      /** @typedef {Awaited<ReturnType<typeof pose>>["nodes"]} Nodes */
      /** The largest distance between nodes of the same name. @type {(a: Nodes, b: Nodes) => number} */
      const apart = (a, b) => Math.max(...a.map(({ name, world }) => largestDifference(world.slice(12), b.find((node) => node.name === name)?.world.slice(12))));
      assert.ok(apart(original.times[0].nodes, original.times[3].nodes) > 1, "it runs");
      for (const [at, expected] of converted.times.entries()) {
        const found = original.times[at];
        assert.equal(found.clip, expected.clip);
        // FBX2glTF adds a node above.
        const off = apart(expected.nodes.filter(({ name }) => name !== "RootNode"), found.nodes);
        assert.ok(off < 6e-4, `moment ${at}: ${off} apart, of a height of 6`);
      }
    });

    test("a .npz file is a link like any other", async () => {
      const files = { "strides.npz": walkingPerson(22), "body.npz": walkingPerson(24), "hands.npz": walkingPerson(52), "positions.npy": walkingPositions(), "objects.npz": PICKLED };
      const page = await site.page({ renderer, link: `model=${site.data("threejs/Xbot.glb")}&motion=${site.data("strides.npz")}&clip=strides&play=0&t=0`, files });
      await whenBorrowed(page, 1);
      assert.deepEqual(requested(page).map((url) => url.replace(/.*\/parts\/|-[0-9a-f]{16}/g, "")), ["npz.wasm"]);
      /** Height of the left knee. */
      const knee = async () => (await pose(page)).nodes.find(({ name }) => name === "mixamorig:LeftLeg")?.world[13] ?? NaN;
      const standing = await knee();
      await apply(page, { t: 0.5 });
      const lifted = await knee();
      assert.ok(lifted - standing > 0.1, `${standing}, then ${lifted}`);
      // The body of the positions has other proportions.
      for (const [name, tolerance] of /** @type {[string, number][]} */ ([["body.npz", 1e-4], ["hands.npz", 1e-4], ["positions.npy", 0.05]])) {
        await apply(page, { motion: [site.data(name)], clip: name.replace(/\..*/, ""), t: 0.5, play: 0 });
        assert.ok(Math.abs((await knee()) - lifted) < tolerance, `${name}: the same stride`);
      }
      await assert.rejects(open(page, site.data("objects.npz")), /objects\.npz: .*pickled Python objects.*numpy\.savez/);
      assert.deepEqual(page.troubles, []);
      await page.finish();
    });

    test("a .x file is a link like any other, as a model and as a motion", async () => {
      const files = { "made.x": MADE_X, "made.png": await png(1, 1, Uint8Array.from([255, 0, 0, 255])) };
      /** @param {string} link */
      const opened = (link) => site.page({ renderer, files, link });
      const made = site.data("made.x");
      const page = await opened(`model=${made}&play=0&t=1`);
      assert.equal(requested(page).length, 1, "once");
      assert.match(requested(page)[0], /\/parts\/x-[0-9a-f]{16}\.wasm$/);
      assert.equal(page.requests.filter((url) => url.endsWith("/made.png")).length, 1, "the texture is found by its base name");
      assert.equal((await stats(page)).backend, renderer);
      const { clip, nodes, meshes } = await pose(page);
      assert.equal(clip, "Lift");
      const chest = nodes.find(({ name }) => name === "chest")?.world.slice(12);
      assert.ok(largestDifference([0, 1, -1, 1], chest) < 1e-5, `a second is 30 ticks: ${chest}`);
      assert.ok(largestDifference([0, 0, 0, 0, 1, -1, 1, 0, 0], meshes[0].positions) < 1e-5, `${meshes[0].positions}`);
      assert.deepEqual(page.troubles, []);
      await page.finish();
      for (const [model, motion] of [
        ["threejs/Xbot.glb", PILOT],
        [PILOT, "cosc422/original/Dwarf/avatar_walk.bvh"],
      ]) {
        const borrowing = await opened(`model=${site.data(model)}&motion=${site.data(motion)}`);
        await whenBorrowed(borrowing, 1);
        assert.equal(requested(borrowing).length, 1);
        assert.deepEqual(borrowing.troubles, []);
        await borrowing.finish();
      }
    });

    test("a page that was built without clang says so of an FBX file, and goes on", async () => {
      const page = await site.page({ renderer, before: withoutFbx });
      await assert.rejects(open(page, site.data(SAMBA)), /Samba_Dancing\.fbx: needs Gaitway's FBX reader, which cannot be loaded: this page was built without it/);
      assert.deepEqual(requested(page), []);
      await open(page, site.data(FOX));
      assert.match((await state(page)).model[0], /Fox-gltfpack/);
      await page.finish();
    });

    const otherVersion = new RegExp(
      "the meshopt decoder is damaged or from another version: " +
        "expected .* SHA-256 begins with [0-9a-f]{16}, found [0-9a-f]{16}; reload the page",
    );
    /** The last member: it never ends. @type {[string, Buffer | null, RegExp, (() => void)?, boolean?][]} */
    const troubles = [
      ["that can't be downloaded", null, /needs Gaitway's meshopt decoder, which cannot be loaded: .*cannot be reached/],
      ["that isn't what the page was built with", module("(nop)"), otherVersion],
      ["that traps", module("(unreachable)"), /meshopt decoder stopped \(.*unreachable.*\)/, withoutHashes],
      ["that panics", module("(unreachable)", "no vertices, src/lib.rs:7:9"), /meshopt decoder stopped \(no vertices, src\/lib\.rs:7:9\)/, withoutHashes],
      ["that never ends", module("(loop (br 0))"), /meshopt decoder stopped \(it took longer than 60 seconds\)/, withoutHashes, true],
      ["that answers nothing", module("(nop)"), /returned an invalid answer/, withoutHashes],
    ];
    for (const [name, replacement, message, before, isEndless = false] of troubles)
      test(`a part ${name} is an error, and the page goes on`, async () => {
        const page = await site.page({ renderer, before });
        if (isEndless) await page.evaluate(withShortMinute);
        await page.route("**/parts/*", (route) => (replacement === null ? route.abort() : route.fulfill({ body: replacement, contentType: "application/wasm" })));
        await assert.rejects(open(page, site.data(FOX)), message);
        assert.equal((await state(page)).model[0], "sample:walker", "the model is still there");
        await page.unroute("**/parts/*");
        await open(page, site.data(FOX));
        assert.match((await state(page)).model[0], /Fox-gltfpack/);
        await page.finish();
      });
  });
