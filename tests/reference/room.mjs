// A room with soft lamps as an .hdr image made in code. No lamp is as small and bright as the sun, since the sample
// renderer filters such lights poorly.

const WIDTH = 1024;
const HEIGHT = 512;

/** @typedef {import("./colour.mjs").Triple} Triple */

/**
 * Lamps: direction, cosines of the angles between which the edge fades out, radiance.
 * @type {{ towards: Triple, inner: number, outer: number, light: Triple }[]}
 */
const LAMPS = [
  { towards: [-0.48, 0.72, 0.5], inner: 0.92, outer: 0.85, light: [5, 4.8, 4.5] },
  { towards: [0.9, 0.25, 0.36], inner: 0.8, outer: 0.65, light: [0.9, 1, 1.1] },
  { towards: [-0.7, 0.1, -0.7], inner: 0.95, outer: 0.9, light: [3, 3.4, 4] },
  { towards: [0.6, 0.4, -0.69], inner: 0.96, outer: 0.93, light: [4, 3.6, 3] },
];

/**
 * @param {number} edge
 * @param {number} end
 * @param {number} value
 */
function smoothstep(edge, end, value) {
  const t = Math.min(Math.max((value - edge) / (end - edge), 0), 1);
  return t * t * (3 - 2 * t);
}

/** Returns what a direction emits. @param {Triple} direction */
function radiance([x, y, z]) {
  const slope = y > 0 ? [0.1, 0.11, 0.14] : [0.1, 0.12, 0.16];
  const walls = [0.25, 0.26, 0.28].map((level, channel) => level + slope[channel] * y);
  return walls.map((wall, channel) =>
    LAMPS.reduce((sum, { towards, inner, outer, light }) => {
      const facing = (x * towards[0] + y * towards[1] + z * towards[2]) / Math.hypot(...towards);
      return sum + light[channel] * smoothstep(outer, inner, facing);
    }, wall),
  );
}

/**
 * Encodes a colour as RGBE: three mantissas and their common exponent.
 * @param {number[]} color
 */
function rgbe([r, g, b]) {
  const exponent = Math.ceil(Math.log2(Math.max(r, g, b)));
  return [r, g, b].map((value) => Math.min(Math.round((value * 256) / 2 ** exponent), 255)).concat(exponent + 128);
}

/** Returns the bytes of the image, whose centre is at +X. */
export function roomImage() {
  const header = Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${HEIGHT} +X ${WIDTH}\n`);
  const rows = [header];
  for (let row = 0; row < HEIGHT; row++) {
    const down = (Math.PI * (row + 0.5)) / HEIGHT;
    const texels = Array.from({ length: WIDTH }, (_, column) => {
      const turn = 2 * Math.PI * ((column + 0.5) / WIDTH - 0.5);
      return rgbe(radiance([Math.sin(down) * Math.cos(turn), Math.cos(down), Math.sin(down) * Math.sin(turn)]));
    });
    rows.push(Buffer.from([2, 2, WIDTH >> 8, WIDTH & 255]));
    // Component by component, in runs of at most 128 literal bytes.
    for (let component = 0; component < 4; component++)
      for (let from = 0; from < WIDTH; from += 128) {
        const run = texels.slice(from, from + 128);
        rows.push(Buffer.from([128, ...run.map((texel) => texel[component])]));
      }
  }
  return Buffer.concat(rows);
}
