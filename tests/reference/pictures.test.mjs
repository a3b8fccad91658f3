// Compares pictures with the Khronos glTF Sample Renderer's, drawn in the same run: same camera, same light from an
// image, Khronos PBR Neutral. The difference is CIEDE2000 over the object; three.js's is printed beside it.
import assert from "node:assert";
import fs from "node:fs";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import { dataFile, skipWithoutData } from "../three/data.mjs";
import { average, meanDifference } from "./colour.mjs";
import { startReference } from "./draw.mjs";
import { sphereGrid } from "./spheres.mjs";

/** Files without material extensions. */
const CORE = [
  "cosc422/ArmyPilot.glb",
  "cosc422/dwarf.glb",
  "kaykit/Knight.glb",
  "khronos/BrainStem/glTF-Binary/BrainStem.glb",
  "khronos/CesiumMan/glTF-Binary/CesiumMan.glb",
  "khronos/Duck/glTF-Binary/Duck.glb",
  "khronos/Fox/glTF-Binary/Fox.glb",
  "khronos/Monster/glTF-Binary/Monster.glb",
  "khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb",
  "khronos/TwoSidedPlane/glTF/TwoSidedPlane.gltf",
  "materials/babylon/PBR_Spheres.glb",
  "materials/bevy/alien.glb",
  "materials/bevy/cakeBirthday.glb",
  "mesh2motion/human-male.glb",
  "misc/TRex.glb",
  "misc/godot_mannequiny.glb",
  "misc/godot_robot_player.glb",
  "threejs/Horse.glb",
  "threejs/RobotExpressive.glb",
  "threejs/Soldier.glb",
  "threejs/Xbot.glb",
];

/**
 * Files with material extensions. Without materials/babylon/emoji_heart.glb: the sample renderer reads its specular
 * colours as linear, but KHR_materials_pbrSpecularGlossiness says that they are sRGB.
 */
const EXTENSIONS = [
  "blender-io/24_animation_pointer/24_animation_pointer.gltf",
  "materials/babylon/Sheen/Cloth.gltf",
  "materials/babylon/shaderBall/BabylonShaderBall_Simple.gltf",
  "materials/playcanvas/AnisotropyStrengthTest.glb",
  "materials/playcanvas/AttenuationTest.glb",
  "materials/playcanvas/ClearCoatTest.glb",
  "materials/playcanvas/SpecularTest.glb",
  "materials/playcanvas/glass-table.glb",
];

/** @type {Awaited<ReturnType<typeof startReference>>} */
let reference;

/** @param {string} file */
async function compare(file) {
  const { gaitway, khronos, three } = await reference.draw(file);
  const { mean, share } = meanDifference(gaitway, khronos);
  assert.ok(share > 0.005, `${file}: almost nothing is drawn`);
  const ofThree = meanDifference(three, khronos).mean;
  console.log(`${path.basename(file)}: ${mean.toFixed(2)} (three.js ${ofThree.toFixed(2)})`);
  return { mean, ofThree };
}

/**
 * @param {string[]} names
 * @param {{ onAverage: number, each: number }} limits
 */
async function compareAll(names, limits) {
  const differences = [];
  for (const name of names) differences.push({ name, ...(await compare(dataFile(name))) });
  for (const { name, mean } of differences) assert.ok(mean <= limits.each, `${name}: ${mean}`);
  const mean = average(differences.map(({ mean }) => mean));
  const ofThree = average(differences.map(({ ofThree }) => ofThree));
  console.log(`on average ${mean.toFixed(2)} (three.js ${ofThree.toFixed(2)})`);
  assert.ok(mean <= limits.onAverage, `${mean}`);
  assert.ok(mean < ofThree, `three.js is closer: ${ofThree} instead of ${mean}`);
}

describe("pictures against the Khronos glTF Sample Renderer", { skip: skipWithoutData }, () => {
  before(async () => {
    reference = await startReference();
  });
  after(() => reference.close());

  test("spheres of every roughness, white to black, metal and dielectric", async () => {
    const file = path.join(reference.folder, "spheres.glb");
    fs.writeFileSync(file, sphereGrid());
    const { mean, ofThree } = await compare(file);
    assert.ok(mean <= 1, `${mean}`);
    assert.ok(mean < ofThree, `three.js is closer: ${ofThree} instead of ${mean}`);
  });

  test("files without material extensions", () => compareAll(CORE, { onAverage: 1.5, each: 4 }));

  test("files with material extensions", () => compareAll(EXTENSIONS, { onAverage: 2, each: 4 }));
});
