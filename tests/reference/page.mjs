// Runs in the browser: draws a glTF with the Khronos glTF Sample Renderer, three.js or three-vrm, under the same camera
// and the same light from an image.
import { GltfState, GltfView, ResourceLoader } from "@khronosgroup/gltf-viewer/dist/gltf-viewer.module.js";
import * as THREE from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { BACKGROUND } from "./colour.mjs";
import { cameraOf, pixels, threeStage } from "./stage.mjs";
import { drawVrm } from "./vrm.mjs";

/** @typedef {import("./draw.mjs").View} View */
/** @typedef {Record<"khronos" | "three" | "vrm", (view: View) => Promise<string>>} Reference */

/**
 * Builds the directional albedo of the Charlie sheen lobe by N·V and roughness, a lookup table that the sample
 * renderer's package lacks (KHR_materials_sheen, "albedo-scaling technique").
 */
async function sheenAlbedoImage() {
  const size = 64;
  const canvas = new OffscreenCanvas(size, size);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const image = context.createImageData(size, size);
  for (let y = 0; y < size; y++)
    for (let x = 0; x < size; x++) {
      const at = 4 * (y * size + x);
      const value = sheenAlbedo((x + 0.5) / size, (y + 0.5) / size);
      image.data.set([255 * value, 255 * value, 255 * value, 255], at);
    }
  context.putImageData(image, 0, 0);
  return URL.createObjectURL(await canvas.convertToBlob({ type: "image/png" }));
}

/**
 * Integrates the lobe over the hemisphere, uniformly in direction.
 * @param {number} normalView
 * @param {number} roughness
 */
function sheenAlbedo(normalView, roughness) {
  const alpha = Math.max(roughness * roughness, 1e-3);
  const view = [Math.sqrt(1 - normalView * normalView), 0, normalView];
  const steps = 24;
  let sum = 0;
  for (let i = 0; i < steps; i++)
    for (let j = 0; j < 2 * steps; j++) {
      const z = (i + 0.5) / steps;
      const turn = (Math.PI * (j + 0.5)) / steps;
      const radius = Math.sqrt(1 - z * z);
      const light = [radius * Math.cos(turn), radius * Math.sin(turn), z];
      const half = [light[0] + view[0], light[1] + view[1], light[2] + view[2]];
      const normalHalf = half[2] / Math.hypot(...half);
      const sin = Math.sqrt(Math.max(1 - normalHalf * normalHalf, 0));
      const distribution = ((2 + 1 / alpha) * sin ** (1 / alpha)) / (2 * Math.PI);
      const visibility = 1 / ((1 + charlieLambda(z, alpha) + charlieLambda(normalView, alpha)) * 4 * z * normalView);
      sum += distribution * Math.min(visibility, 1) * z;
    }
  return Math.min((sum * 2 * Math.PI) / (2 * steps * steps), 1);
}

/**
 * Returns the masking of Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF", 2017.
 * @param {number} cos
 * @param {number} alpha
 */
function charlieLambda(cos, alpha) {
  const t = (1 - alpha) ** 2;
  /** @type {(from: number, to: number) => number} */
  const mix = (from, to) => from + (to - from) * (1 - t);
  const [a, b, c] = [mix(25.3245, 21.5473), mix(3.32435, 3.82987), mix(0.16801, 0.19823)];
  const [d, e] = [mix(-1.27393, -1.9776), mix(-4.85967, -4.32054)];
  /** @param {number} x */
  const level = (x) => a / (1 + b * x ** c) + d * x + e;
  return Math.exp(cos < 0.5 ? level(cos) : 2 * level(0.5) - level(1 - cos));
}

/** @param {View} view */
function canvasContext({ size: [width, height] }) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const context = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
  return /** @type {WebGL2RenderingContext} */ (context);
}

/** @type {ReturnType<typeof startKhronos> | undefined} */
let khronosStage;

/** @param {View} view */
async function startKhronos(view) {
  const gl = canvasContext(view);
  const gltfView = new GltfView(gl);
  // Not `createResourceLoader`, which needs libraries for Draco and KTX2.
  const loader = new ResourceLoader(gltfView, "/libs/");
  const environment = await loader.loadEnvironment(view.environment, { lut_sheen_E_file: await sheenAlbedoImage() });
  return { gl, view: gltfView, loader, environment };
}

/** @param {View} view */
async function drawKhronos(view) {
  const stage = await (khronosStage ??= startKhronos(view));
  const state = stage.view.createState();
  state.environment = stage.environment;
  state.gltf = await stage.loader.loadGltf(view.model);
  state.sceneIndex = state.gltf.scene ?? 0;
  state.animationIndices = [];
  const settings = state.renderingParameters;
  settings.clearColor = [BACKGROUND, BACKGROUND, BACKGROUND, 255].map((value) => value / 255);
  settings.renderEnvironmentMap = false;
  settings.usePunctual = view.hasLights;
  settings.useIBL = true;
  settings.toneMap = GltfState.ToneMaps.KHR_PBR_NEUTRAL;
  // The centre of the image is at +X, as in three.js.
  settings.environmentRotation = 0;
  const camera = state.userCamera;
  camera.perspective.aspectRatio = view.size[0] / view.size[1];
  camera.setVerticalFoV((view.fov * Math.PI) / 180);
  camera.perspective.znear = view.distance / 100;
  camera.perspective.zfar = view.distance * 100;
  const eye = new THREE.Vector3(...view.eye);
  const matrix = new THREE.Matrix4().lookAt(eye, new THREE.Vector3(...view.target), new THREE.Vector3(0, 1, 0));
  matrix.setPosition(eye);
  camera.transform = new Float32Array(matrix.elements);
  // The first frame compiles shaders and uploads textures; the second one is complete.
  stage.view.renderFrame(state, ...view.size);
  stage.view.renderFrame(state, ...view.size);
  return pixels(stage.gl, view);
}

/** @param {View} view */
async function drawThree(view) {
  const { renderer, environment } = await threeStage(view);
  const { scene: model } = await new GLTFLoader().loadAsync(view.model);
  const scene = new THREE.Scene();
  scene.environment = environment;
  scene.add(model);
  renderer.render(scene, cameraOf(view));
  return pixels(/** @type {WebGL2RenderingContext} */ (renderer.getContext()), view);
}

Object.assign(window, { reference: { khronos: drawKhronos, three: drawThree, vrm: drawVrm } });
