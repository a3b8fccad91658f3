// Writes animated GIFs: 256 colours for each frame, dithered, since the background and the shading of a character are gradients.
//! Contains gifenc (MIT), Copyright (c) 2017 Matt DesLauriers
import { GIFEncoder, applyPalette, quantize } from "gifenc";

/** Edge of the pattern of thresholds, in pixels. */
const PATTERN_SIZE = 8;
/** How far dithering moves a channel, about as far as two of 256 colours are from each other. */
const DITHERED_BY = 8;
const MAX_COLORS = 256;
/** Pixels with less alpha are transparent: a GIF knows nothing in between. */
const MIN_ALPHA = 128;

/**
 * Returns what adds a frame to a GIF that plays forever, and what completes it.
 * @param {{ width: number, height: number, framesPerSec: number, isTransparent: boolean }} video At most 50 frames per second.
 * @returns {{ add: (rgba: Uint8Array<ArrayBuffer>) => void, finish: () => Uint8Array<ArrayBuffer> }} Takes RGBA rows from the top, with straight alpha.
 */
export function animatedGif({ width, height, framesPerSec, isTransparent }) {
  const gif = GIFEncoder();
  let count = 0;
  /** In hundredths of a second. @param {number} frame */
  const start = (frame) => Math.round((100 * frame) / framesPerSec);
  return {
    add: (rgba) => {
      const palette = quantize(isTransparent ? opaque(rgba) : rgba, isTransparent ? MAX_COLORS - 1 : MAX_COLORS);
      const indices = applyPalette(dithered(rgba, width), palette);
      const delay = 10 * (start(count + 1) - start(count));
      count++;
      if (!isTransparent) return gif.writeFrame(indices, width, height, { palette, delay });
      const transparentIndex = palette.length;
      for (let pixel = 0; pixel < indices.length; pixel++) if (rgba[4 * pixel + 3] < MIN_ALPHA) indices[pixel] = transparentIndex;
      // Otherwise a frame would be drawn over the one before.
      const dispose = 2;
      gif.writeFrame(indices, width, height, { palette: [...palette, [0, 0, 0]], delay, transparent: true, transparentIndex, dispose });
    },
    finish: () => {
      gif.finish();
      return gif.bytes();
    },
  };
}

/**
 * Returns the pixels that are opaque; a black one if there are none.
 * @param {Uint8Array<ArrayBuffer>} rgba
 */
function opaque(rgba) {
  const pixels = new Uint32Array(rgba.buffer).filter((_, pixel) => rgba[4 * pixel + 3] >= MIN_ALPHA);
  return new Uint8Array(pixels.length === 0 ? new ArrayBuffer(4) : pixels.buffer);
}

/**
 * Adds a pattern, which stays where it is from frame to frame (noise, or errors passed on to neighbours, would flicker).
 * @param {Uint8Array} rgba
 * @param {number} width
 */
function dithered(rgba, width) {
  // Clamps what becomes less than 0 or more than 255.
  const result = new Uint8ClampedArray(rgba.length);
  for (let at = 0; at < rgba.length; at++) {
    const pixel = at >> 2;
    const threshold = THRESHOLDS[(Math.floor(pixel / width) % PATTERN_SIZE) * PATTERN_SIZE + ((pixel % width) % PATTERN_SIZE)];
    result[at] = (at & 3) === 3 ? rgba[at] : rgba[at] + DITHERED_BY * threshold;
  }
  return result;
}

/** Bayer's pattern, -0.5 to 0.5. */
const THRESHOLDS = Float32Array.from({ length: PATTERN_SIZE * PATTERN_SIZE }, (_, index) => {
  let [x, y, rank] = [index % PATTERN_SIZE, Math.floor(index / PATTERN_SIZE), 0];
  for (let bits = PATTERN_SIZE; bits > 1; bits >>= 1) {
    rank = 4 * rank + 2 * ((x ^ y) & 1) + (y & 1);
    x >>= 1;
    y >>= 1;
  }
  return rank / PATTERN_SIZE ** 2 - 0.5;
});
