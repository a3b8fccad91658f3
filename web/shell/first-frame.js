// The first frame is drawn off screen, because compiling the shaders for it takes long and a visible canvas makes the whole page
// wait for it. On WebGL2 shaders are linked inside the frame, which can't be deferred: there the canvas is only hidden.

/** @typedef {import("./types.d.ts").Backend} Backend */

/** WebGPU's default for a canvas, which TypeScript's DOM types don't name. */
const RENDER_ATTACHMENT = 0x10;

/**
 * Redirects WebGPU into a texture that is never presented, until the returned function is called. Presenting would
 * block the browser's graphics process, and with it every page, until all shaders are compiled.
 * @param {HTMLCanvasElement} canvas
 * @param {Backend} backend
 */
export function drawOffScreen(canvas, backend) {
  const context = backend === "webgpu" ? webgpuContext(canvas) : null;
  if (!context?.getConfiguration) return () => {};
  /** @type {GPUTexture | null} */
  let texture = null;
  context.getCurrentTexture = () => {
    const configuration = context.getConfiguration();
    if (configuration === null) throw new Error("the canvas has no WebGPU device");
    const { device, format, usage = RENDER_ATTACHMENT } = configuration;
    const { width, height } = canvas;
    if (texture === null || texture.width !== width || texture.height !== height) {
      texture?.destroy();
      texture = device.createTexture({ size: [width, height], format, usage });
    }
    return texture;
  };
  return () => {
    // The prototype's own method is back.
    Reflect.deleteProperty(context, "getCurrentTexture");
    texture?.destroy();
  };
}

/** @param {HTMLCanvasElement} canvas */
function webgpuContext(canvas) {
  // TypeScript's DOM types lack this kind of context.
  const context = /** @type {unknown} */ (canvas.getContext("webgpu"));
  return /** @type {GPUCanvasContext | null} */ (context);
}
