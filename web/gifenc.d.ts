// The parts of gifenc, which comes without types, that the page uses.
declare module "gifenc" {
  type Palette = number[][];
  interface Frame {
    palette: Palette;
    /** Milliseconds. */
    delay: number;
    transparent?: boolean;
    transparentIndex?: number;
    /** What becomes of the frame before the next one: 2 clears it. */
    dispose?: number;
  }
  /** Returns an encoder of GIFs that play forever. */
  export function GIFEncoder(): {
    writeFrame(indices: Uint8Array, width: number, height: number, frame: Frame): void;
    finish(): void;
    bytes(): Uint8Array<ArrayBuffer>;
  };
  /** Returns at most this many colours for RGBA pixels. */
  export function quantize(rgba: Uint8Array | Uint8ClampedArray, maxColors: number): Palette;
  /** Returns each pixel's index into the palette. */
  export function applyPalette(rgba: Uint8Array | Uint8ClampedArray, palette: Palette): Uint8Array;
}
