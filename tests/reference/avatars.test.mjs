// Compares pictures of VRM files and of MToon with three-vrm's, drawn in the same run: same camera, same lights, Khronos
// PBR Neutral, in the rest pose and without springs. The difference is CIEDE2000 over the object.
import assert from "node:assert";
import { after, before, describe, test } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { avatars } from "./avatars.mjs";
import { average, meanDifference } from "./colour.mjs";
import { startReference } from "./draw.mjs";

/** @type {Awaited<ReturnType<typeof startReference>>} */
let reference;

/**
 * Draws an avatar and checks that expressions, gaze and time change Gaitway's picture as much as three-vrm's.
 * @param {import("./avatars.mjs").Avatar} avatar
 */
async function difference({ name, file, shown }) {
  const pictures = await reference.drawAvatar(file, shown);
  const { mean, share } = meanDifference(pictures.gaitway, pictures.vrm);
  assert.ok(share > 0.005, `${name}: almost nothing is drawn`);
  if (shown.expressions || shown.look || shown.timeSecs) {
    const neutral = await reference.drawAvatar(file, { ...shown, expressions: undefined, look: undefined, timeSecs: undefined });
    const ours = meanDifference(pictures.gaitway, neutral.gaitway).mean;
    const theirs = meanDifference(pictures.vrm, neutral.vrm).mean;
    assert.ok(theirs > 0.5, `${name}: three-vrm's picture doesn't change`);
    assert.ok(Math.abs(Math.log(ours / theirs)) < Math.log(1.3), `${name}: changes by ${ours}, three-vrm's by ${theirs}`);
  }
  return mean;
}

describe("pictures against three-vrm", { skip: skipWithoutData }, () => {
  before(async () => {
    reference = await startReference();
  });
  after(() => reference.close());

  test("VRM files and MToon", async () => {
    const differences = [];
    for (const avatar of avatars(reference.folder)) {
      const mean = await difference(avatar);
      console.log(`${avatar.name}: ${mean.toFixed(2)}`);
      differences.push({ ...avatar, mean });
    }
    for (const { name, mean, limit } of differences) assert.ok(mean <= limit, `${name}: ${mean}`);
    const mean = average(differences.map(({ mean }) => mean));
    console.log(`on average ${mean.toFixed(2)}`);
    assert.ok(mean <= 3, `${mean}`);
  });
});
