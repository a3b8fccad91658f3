// Rendering: the two back ends agree, and on both, with every skinning method, the model's silhouette matches the numbers of
// `pose()`. So numbers and images can only be wrong together.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { dataFile, skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, apply, colorsOf, meanDifference, open, picture, pose, startSite } from "./browser.mjs";
import { cameraFor, cameraText, maskOf, overlap, rasterize, trianglesOf } from "./silhouette.mjs";

const MIN_OVERLAP = 0.97;
/** Of 255, over the whole image. */
const MAX_DIFFERENCE = 0.5;
const FOV_DEGREES = 35;
const MODES = ["linear", "rigid", "dual-quaternion"];

/** `blended`: vertices have several influences, so the three methods give three shapes. */
const MODELS = [
  { name: "Fox", file: "khronos/Fox/glTF-Binary/Fox.glb", clip: "Run", t: 0.5, yaw: 60, blended: true },
  { name: "CesiumMan", file: "khronos/CesiumMan/glTF-Binary/CesiumMan.glb", clip: "0", t: 0.7, yaw: 30, blended: true },
  { name: "Soldier", file: "threejs/Soldier.glb", clip: "Run", t: 0.35, yaw: 200, blended: true },
  { name: "dwarf", file: "cosc422/dwarf.glb", clip: "0", t: 1, yaw: 30, blended: false },
];

/** Not skinned, so only compared between the back ends. */
const MORE_PICTURES = [
  { name: "AnimatedMorphCube", file: "khronos/AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb", clip: "0", t: 1.5 },
  { name: "RobotExpressive", file: "threejs/RobotExpressive.glb", clip: "Wave", t: 0.6 },
  { name: "TextureSettingsTest", file: "khronos/TextureSettingsTest/glTF-Binary/TextureSettingsTest.glb", clip: "", t: 0 },
  { name: "Material_AlphaBlend", file: "asset-generator/Positive/Material_AlphaBlend/Material_AlphaBlend_05.gltf", clip: "", t: 0 },
  { name: "Node_NegativeScale", file: "asset-generator/Positive/Node_NegativeScale/Node_NegativeScale_08.gltf", clip: "", t: 0 },
];

describe("pictures", { skip: skipWithoutData }, () => {
  /** @type {import("./browser.mjs").Site} */
  let site;
  before(async () => (site = await startSite()));
  after(() => site?.close());

  for (const model of [...MODELS, ...MORE_PICTURES])
    test(`${model.name}: the back ends agree`, async () => {
      const pictures = [];
      for (const renderer of BACK_ENDS) {
        const page = await site.page({ renderer });
        await open(page, site.data(model.file));
        await apply(page, { clip: model.clip, t: model.t, play: 0 });
        pictures.push(await picture(page));
        assert.deepEqual(page.troubles, []);
        await page.finish();
      }
      assert.ok(colorsOf(pictures[0]) > 64, "something should be drawn");
      const difference = meanDifference(pictures[0], pictures[1]);
      assert.ok(difference <= MAX_DIFFERENCE, `mean difference ${difference} of 255`);
      console.log(`${model.name}: mean difference ${difference.toFixed(4)} of 255`);
    });

  for (const renderer of BACK_ENDS)
    for (const model of MODELS)
      test(`${model.name} on ${renderer}: silhouettes match the numbers`, async () => {
        const triangles = trianglesOf(dataFile(model.file));
        const page = await site.page({ renderer });
        await open(page, site.data(model.file));
        await apply(page, { clip: model.clip, t: model.t, play: 0, show: "no-shadow", background: "transparent", fov: FOV_DEGREES });
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
          // The other methods' numbers must match less well, or the methods were never told apart.
          if (model.blended) matches.forEach((match, other) => assert.ok(other === mode || match < matches[mode], `${skinning} looks like ${MODES[other]}`));
        });
        assert.deepEqual(page.troubles, []);
        await page.finish();
      });
});
