// Runs in the browser: what the drawings with three.js have in common.
import * as THREE from "three";
import { HDRLoader } from "three/examples/jsm/loaders/HDRLoader.js";
import { BACKGROUND } from "./colour.mjs";

/** @typedef {import("./draw.mjs").View} View */

/**
 * Reads the canvas as a PNG in a data URL.
 * @param {WebGL2RenderingContext} gl
 * @param {View} view
 */
export function pixels(gl, { size: [width, height] }) {
  const rows = new Uint8Array(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rows);
  const image = new ImageData(width, height);
  // WebGL's first row is at the bottom.
  const stride = 4 * width;
  for (let y = 0; y < height; y++) {
    image.data.set(rows.subarray(stride * y, stride * (y + 1)), stride * (height - 1 - y));
  }
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  for (let at = 3; at < image.data.length; at += 4) image.data[at] = 255;
  /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d")).putImageData(image, 0, 0);
  return canvas.toDataURL("image/png");
}

/** @type {ReturnType<typeof startThree> | undefined} */
let stage;

/**
 * Returns the renderer and the environment, as an image and filtered. The same for all pictures.
 * @param {View} view
 */
export const threeStage = (view) => (stage ??= startThree(view));

/** @param {View} view */
async function startThree(view) {
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setSize(...view.size);
  renderer.toneMapping = THREE.NeutralToneMapping;
  // Not a scene background: tone mapping would change it.
  const gray = BACKGROUND / 255;
  renderer.setClearColor(new THREE.Color().setRGB(gray, gray, gray, THREE.SRGBColorSpace));
  const image = await new HDRLoader().loadAsync(view.environment);
  image.mapping = THREE.EquirectangularReflectionMapping;
  const environment = new THREE.PMREMGenerator(renderer).fromEquirectangular(image).texture;
  return { renderer, image, environment };
}

/** @param {View} view */
export function cameraOf(view) {
  const [near, far] = [view.distance / 100, view.distance * 100];
  const camera = new THREE.PerspectiveCamera(view.fov, view.size[0] / view.size[1], near, far);
  camera.position.set(...view.eye);
  camera.lookAt(...view.target);
  camera.updateMatrixWorld();
  return camera;
}
