import assert from "node:assert";
import { test } from "node:test";
import { deltaE2000, labFromSrgb } from "./colour.mjs";

// From the table of test data in Sharma, Wu, Dalal 2005.
/** @type {[[number, number, number], [number, number, number], number][]} */
const PAIRS = [
  [[50, 2.6772, -79.7751], [50, 0, -82.7485], 2.0425],
  [[50, -1.3802, -84.2814], [50, 0, -82.7485], 1],
  [[50, 0, 0], [50, -1, 2], 2.3669],
  [[50, 2.49, -0.001], [50, -2.49, 0.0011], 7.2195],
  [[50, -0.001, 2.49], [50, 0.0009, -2.49], 4.8045],
  [[50, 2.5, 0], [73, 25, -18], 27.1492],
  [[60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644],
  [[22.7233, 20.0904, -46.694], [23.0331, 14.973, -42.5619], 2.0373],
  [[90.8027, -2.0831, 1.441], [91.1528, -1.6435, 0.0447], 1.4441],
  [[2.0776, 0.0795, -1.135], [0.9033, -0.0636, -0.5514], 0.9082],
];

test("CIEDE2000 gives the published differences in either order", () => {
  for (const [one, other, expected] of PAIRS) {
    assert.ok(Math.abs(deltaE2000(one, other) - expected) < 5e-5, `${one} ${other}: ${deltaE2000(one, other)}`);
    assert.ok(Math.abs(deltaE2000(other, one) - expected) < 5e-5, `${other} ${one}: ${deltaE2000(other, one)}`);
  }
});

test("sRGB white, black and red have their known L*a*b* values", () => {
  /** @type {[[number, number, number], [number, number, number]][]} */
  const pairs = [[[255, 255, 255], [100, 0, 0]], [[0, 0, 0], [0, 0, 0]], [[255, 0, 0], [53.24, 80.09, 67.2]]];
  for (const [rgb, expected] of pairs) {
    const lab = labFromSrgb(rgb);
    assert.ok(lab.every((value, axis) => Math.abs(value - expected[axis]) < 0.02), `${rgb}: ${lab}`);
  }
});
