// CIEDE2000, the perceived difference of two colours: about 1 is just noticeable side by side. Formula and names:
// Sharma, Wu, Dalal, "The CIEDE2000 color-difference formula", Color Research and Application 30, 2005.

/** @typedef {[number, number, number]} Triple */
/** @typedef {import("./draw.mjs").Picture} Picture */

/** The value of all three components of the background. */
export const BACKGROUND = 128;

const RADIANS = Math.PI / 180;

/** @param {number} value An sRGB component from 0 to 255. */
const linear = (value) => (value <= 10.31475 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4);

/** @param {number} t */
const labCurve = (t) => (t > 216 / 24389 ? Math.cbrt(t) : (24389 / 27 * t + 16) / 116);

/**
 * Converts sRGB from 0 to 255 to CIE L*a*b* under D65.
 * @param {ArrayLike<number>} rgb
 * @param {number} [at]
 * @returns {Triple}
 */
export function labFromSrgb(rgb, at = 0) {
  const [r, g, b] = [linear(rgb[at]), linear(rgb[at + 1]), linear(rgb[at + 2])];
  const x = labCurve((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
  const y = labCurve(0.2126729 * r + 0.7151522 * g + 0.072175 * b);
  const z = labCurve((0.0193339 * r + 0.119192 * g + 0.9503041 * b) / 1.08883);
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

/**
 * @param {number} b
 * @param {number} a
 */
const hueDegrees = (b, a) => (a === 0 && b === 0 ? 0 : (Math.atan2(b, a) / RADIANS + 360) % 360);

/**
 * Returns the difference of two L*a*b* colours.
 * @param {Triple} lab1
 * @param {Triple} lab2
 */
export function deltaE2000([l1, a1, b1], [l2, a2, b2]) {
  const c7 = ((Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2) ** 7;
  const stretch = 1.5 - 0.5 * Math.sqrt(c7 / (c7 + 25 ** 7));
  const [c1, c2] = [Math.hypot(a1 * stretch, b1), Math.hypot(a2 * stretch, b2)];
  const [h1, h2] = [hueDegrees(b1, a1 * stretch), hueDegrees(b2, a2 * stretch)];
  const isGrey = c1 * c2 === 0;
  const turn = isGrey ? 0 : ((h2 - h1 + 540) % 360) - 180;
  const hue = 2 * Math.sqrt(c1 * c2) * Math.sin((turn / 2) * RADIANS);
  const [l, c] = [(l1 + l2) / 2, (c1 + c2) / 2];
  const h = isGrey ? h1 + h2 : (h1 + turn / 2 + 360) % 360;
  /** @param {number} degrees */
  const cos = (degrees) => Math.cos(degrees * RADIANS);
  const t = 1 - 0.17 * cos(h - 30) + 0.24 * cos(2 * h) + 0.32 * cos(3 * h + 6) - 0.2 * cos(4 * h - 63);
  const sl = 1 + (0.015 * (l - 50) ** 2) / Math.sqrt(20 + (l - 50) ** 2);
  const sc = 1 + 0.045 * c;
  const sh = 1 + 0.015 * c * t;
  const theta = 60 * Math.exp(-(((h - 275) / 25) ** 2));
  const rotation = -2 * Math.sqrt(c ** 7 / (c ** 7 + 25 ** 7)) * Math.sin(theta * RADIANS);
  const [dl, dc, dh] = [(l2 - l1) / sl, (c2 - c1) / sc, hue / sh];
  return Math.sqrt(dl * dl + dc * dc + dh * dh + rotation * dc * dh);
}

/**
 * Returns the mean difference over the object, and the object's share of the picture. Its outline is left out: how far
 * pixels are covered there depends on where a graphics driver puts its samples.
 * @param {Picture} one
 * @param {Picture} other
 */
export function meanDifference(one, other) {
  const inside = insideOf(one, other);
  let sum = 0;
  for (const at of inside) sum += deltaE2000(labFromSrgb(one.rgb, 3 * at), labFromSrgb(other.rgb, 3 * at));
  return { mean: sum / Math.max(inside.length, 1), share: inside.length / (one.width * one.height) };
}

/**
 * Returns the indices of the pixels that, with all their neighbours, show the object in both pictures.
 * @param {Picture} one
 * @param {Picture} other
 */
function insideOf(one, other) {
  const { width, height } = one;
  /** @type {(picture: Picture, at: number) => boolean} */
  const isDrawn = ({ rgb }, at) => [0, 1, 2].some((channel) => Math.abs(rgb[3 * at + channel] - BACKGROUND) > 1);
  const isObject = Array.from({ length: width * height }, (_, at) => isDrawn(one, at) && isDrawn(other, at));
  return [...isObject.keys()].filter((at) => {
    const [x, y] = [at % width, Math.floor(at / width)];
    if (x === 0 || y === 0 || x === width - 1 || y === height - 1) return false;
    return [-1, 0, 1].every((down) => [-1, 0, 1].every((right) => isObject[at + down * width + right]));
  });
}

/** @param {number[]} values */
export const average = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
