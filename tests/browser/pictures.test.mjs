// Rendering: the two back ends agree, and on both, with every skinning method, the model's silhouette matches the
// numbers of `pose()`. So numbers and images can only be wrong together.
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import sharp from "sharp";
import { deltaE2000, labFromSrgb } from "../reference/colour.mjs";
import { dataFile, skipWithoutData } from "../three/data.mjs";
import { run } from "../three/gaitway.mjs";
import { BACK_ENDS, apply, colorsOf, meanDifference, open, picture, pose, startSite } from "./browser.mjs";
import { cameraFor, cameraText, maskOf, overlap, rasterize, trianglesOf } from "./silhouette.mjs";

const MIN_OVERLAP = 0.97;
/** Of 255, over the whole image. */
const MAX_DIFFERENCE = 0.5;
/** CIEDE2000, over the whole image. */
const MAX_COLOR_DIFFERENCE = 0.5;
const FOV_DEGREES = 35;
const MODES = ["linear", "rigid", "dual-quaternion"];

const SKY = "materials/bevy/spiaggia_di_mondello_1k.hdr";

/** @typedef {{ name: string, file: string, clip: string, t: number, light?: string }} Shown */

/** `blended`: vertices have several influences, so the three methods give three shapes. */
const MODELS = [
  { name: "Fox", file: "khronos/Fox/glTF-Binary/Fox.glb", clip: "Run", t: 0.5, yaw: 60, blended: true },
  { name: "CesiumMan", file: "khronos/CesiumMan/glTF-Binary/CesiumMan.glb", clip: "0", t: 0.7, yaw: 30, blended: true },
  { name: "Soldier", file: "threejs/Soldier.glb", clip: "Run", t: 0.35, yaw: 200, blended: true },
  { name: "dwarf", file: "cosc422/dwarf.glb", clip: "0", t: 1, yaw: 30, blended: false },
];

/** Not skinned, so only compared between the back ends. @type {Shown[]} */
const MORE_PICTURES = [
  { name: "AnimatedMorphCube", file: "khronos/AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb", clip: "0", t: 1.5 },
  { name: "RobotExpressive", file: "threejs/RobotExpressive.glb", clip: "Wave", t: 0.6 },
  { name: "TextureSettingsTest", file: "khronos/TextureSettingsTest/glTF-Binary/TextureSettingsTest.glb", clip: "", t: 0 },
  { name: "Material_AlphaBlend", file: "asset-generator/Positive/Material_AlphaBlend/Material_AlphaBlend_05.gltf", clip: "", t: 0 },
  { name: "animation_pointer", file: "blender-io/24_animation_pointer/24_animation_pointer.gltf", clip: "0", t: 2.5 },
  { name: "Node_NegativeScale", file: "asset-generator/Positive/Node_NegativeScale/Node_NegativeScale_08.gltf", clip: "", t: 0 },
];

/** In the light of an .hdr image, which is also the background. @type {Shown[]} */
const LIT_PICTURES = [
  { name: "glass-table", file: "materials/playcanvas/glass-table.glb", clip: "", t: 0, light: SKY },
  { name: "cryptovoxels", file: "vrm/vrm0_cryptovoxels.vrm", clip: "", t: 0, light: SKY },
  { name: "ClearCoatTest", file: "materials/playcanvas/ClearCoatTest.glb", clip: "", t: 0, light: SKY },
  { name: "MToon", file: "materials/three-vrm/materials-mtoon/cube.gltf", clip: "", t: 0, light: SKY },
];

/**
 * Draws a model with `gaitway render` as the page shows it, and returns three bytes per pixel.
 * @param {Shown} model
 * @param {{ width: number, height: number }} size
 */
async function renderNatively({ file, clip, t, light }, { width, height }) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-"));
  const out = path.join(folder, "picture.png");
  const background = light === undefined ? "studio" : "environment";
  const options = ["--out", out, "--size", `${width}x${height}`, "--view", `clip=${clip}&t=${t}&background=${background}`];
  if (light !== undefined) options.push("--environment", dataFile(light));
  const { status, stderr } = await run("render", dataFile(file), ...options);
  assert.equal(status, 0, stderr);
  const rgb = await sharp(out).removeAlpha().raw().toBuffer();
  fs.rmSync(folder, { recursive: true });
  return rgb;
}

/**
 * Returns the mean CIEDE2000.
 * @param {import("./browser.mjs").Image} image
 * @param {Buffer} rgb
 */
function colorDifference({ width, height, rgba }, rgb) {
  let sum = 0;
  for (let at = 0; at < width * height; at++) sum += deltaE2000(labFromSrgb(rgba, 4 * at), labFromSrgb(rgb, 3 * at));
  return sum / (width * height);
}

describe("pictures", { skip: skipWithoutData }, () => {
  /** @type {import("./browser.mjs").Site} */
  let site;
  /** One page for each back end, in which one model is opened after the other. @type {Map<string, import("./browser.mjs").TestPage>} */
  const pages = new Map();
  before(async () => {
    site = await startSite({ isOffScreen: true, pixelRatio: 0.5 });
    for (const renderer of BACK_ENDS) pages.set(renderer, await site.page({ renderer }));
  });
  after(() => site?.close());

  /**
   * Opens a model in the page of a back end.
   * @param {import("./browser.mjs").Backend} renderer
   * @param {string} file
   * @param {object} view
   */
  async function opened(renderer, file, view) {
    const page = /** @type {import("./browser.mjs").TestPage} */ (pages.get(renderer));
    await open(page, site.data(file));
    await apply(page, { play: 0, ...view });
    return page;
  }

  /** @type {Shown[]} */
  const compared = [...MODELS, ...MORE_PICTURES, ...LIT_PICTURES];
  for (const model of compared)
    test(`${model.name}: the back ends and the command line agree`, async () => {
      const pictures = [];
      for (const renderer of BACK_ENDS) {
        const light = model.light === undefined ? { light: "studio", background: "studio" } : { light: site.data(model.light), background: "environment" };
        const page = await opened(renderer, model.file, { clip: model.clip, t: model.t, ...light });
        pictures.push(await picture(page));
        assert.deepEqual(page.troubles, []);
      }
      assert.ok(colorsOf(pictures[0]) > 64, "something should be drawn");
      const difference = meanDifference(pictures[0], pictures[1]);
      assert.ok(difference <= MAX_DIFFERENCE, `mean difference ${difference} of 255`);
      const toNative = colorDifference(pictures[0], await renderNatively(model, pictures[0]));
      assert.ok(toNative <= MAX_COLOR_DIFFERENCE, `mean CIEDE2000 to the command line ${toNative}`);
      const [between, native] = [difference.toFixed(4), toNative.toFixed(4)];
      console.log(`${model.name}: mean difference ${between} of 255, CIEDE2000 to the command line ${native}`);
    });

  for (const renderer of BACK_ENDS)
    for (const model of MODELS)
      test(`${model.name} on ${renderer}: silhouettes match the numbers`, async () => {
        const triangles = trianglesOf(dataFile(model.file));
        const page = await opened(renderer, model.file, { clip: model.clip, t: model.t, show: "no-shadow", background: "transparent", fov: FOV_DEGREES });
        const camera = cameraFor(await pose(page), model.yaw, 12, FOV_DEGREES);
        /** @type {Uint8Array[]} */
        const drawn = [];
        /** @type {Uint8Array[]} */
        const expected = [];
        for (const skinning of MODES) {
          await apply(page, { skinning, camera: cameraText(camera) });
          const shown = await picture(page);
          drawn.push(maskOf(shown));
          expected.push(rasterize(await pose(page), triangles, camera, shown.width, shown.height));
        }
        MODES.forEach((skinning, mode) => {
          const matches = expected.map((mask) => overlap(drawn[mode], mask));
          console.log(`${model.name} on ${renderer}, ${skinning}: overlap ${matches[mode].toFixed(4)} (numbers of ${MODES.join(", ")}: ${matches.map((match) => match.toFixed(4)).join(", ")})`);
          assert.ok(matches[mode] >= MIN_OVERLAP, `${skinning}: overlap ${matches[mode]}`);
          // The other methods' numbers must match less well, or the test can't tell the methods apart.
          if (model.blended) matches.forEach((match, other) => assert.ok(other === mode || match < matches[mode], `${skinning} looks like ${MODES[other]}`));
        });
        assert.deepEqual(page.troubles, []);
      });
});
