// Runs in the browser: draws a VRM file, or a glTF with MToon, with three-vrm.
import { MToonMaterial, VRMLoaderPlugin } from "@pixiv/three-vrm";
import * as THREE from "three";
import { LightProbeGenerator } from "three/examples/jsm/lights/LightProbeGenerator.js";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { cameraOf, pixels, threeStage } from "./stage.mjs";

/** @typedef {import("./draw.mjs").View} View */

/** @type {Promise<THREE.LightProbe> | undefined} */
let environmentProbe;

/**
 * Projects the environment onto spherical harmonics.
 * @param {View} view
 */
async function probeOf(view) {
  const { renderer, image } = await threeStage(view);
  const cube = new THREE.WebGLCubeRenderTarget(128, { type: THREE.HalfFloatType });
  return LightProbeGenerator.fromCubeRenderTarget(renderer, cube.fromEquirectangularTexture(renderer, image));
}

/**
 * Returns the ambient light of a material with this `giEqualizationFactor`, which three-vrm reads but doesn't apply:
 * the irradiance, mixed with the mean of its values from above and from below.
 * @param {THREE.LightProbe} environment
 * @param {number} equalization
 */
function equalized(environment, equalization) {
  const probe = new THREE.LightProbe(environment.sh.clone());
  const [above, below] = [1, -1].map((y) => {
    return environment.sh.getIrradianceAt(new THREE.Vector3(0, y, 0), new THREE.Vector3());
  });
  // The irradiance of a constant coefficient.
  const even = above.add(below).divideScalar(2 * 0.886227);
  probe.sh.coefficients.forEach((coefficient, index) => {
    coefficient.lerp(index === 0 ? even : new THREE.Vector3(), equalization);
  });
  return probe;
}

/**
 * Returns the MToon material of a mesh, or undefined. An outline is a second material.
 * @param {THREE.Mesh} mesh
 * @returns {MToonMaterial | undefined}
 */
function toonOf({ material }) {
  const first = Array.isArray(material) ? material[0] : material;
  return first instanceof MToonMaterial ? first : undefined;
}

/** @param {View} view */
async function loadAvatar(view) {
  const loader = new GLTFLoader();
  loader.register((parser) => new VRMLoaderPlugin(parser));
  const { scene: model, userData } = await loader.loadAsync(view.model);
  /** @type {import("@pixiv/three-vrm").VRM | undefined} */
  const vrm = userData.vrm;
  for (const [name, weight] of Object.entries(view.expressions ?? {})) vrm?.expressionManager?.setValue(name, weight);
  if (view.look && vrm?.lookAt) {
    vrm.lookAt.target = new THREE.Object3D();
    vrm.lookAt.target.position.set(...view.look);
    vrm.lookAt.target.updateMatrixWorld();
  }
  model.updateMatrixWorld();
  // Not `vrm.update`, which swings the springs.
  vrm?.humanoid.update();
  vrm?.lookAt?.update(0);
  vrm?.expressionManager?.update();
  vrm?.nodeConstraintManager?.update();
  for (const material of vrm?.materials ?? []) if (material instanceof MToonMaterial) material.update(view.timeSecs ?? 0);
  return model;
}

/** @param {View} view */
export async function drawVrm(view) {
  const { renderer, environment } = await threeStage(view);
  const probe = await (environmentProbe ??= probeOf(view));
  const model = await loadAvatar(view);
  const scene = new THREE.Scene();
  scene.add(model);
  if (view.key) {
    // Irradiance π gives a white diffuse surface radiance 1.
    const light = new THREE.DirectionalLight("white", Math.PI * view.key.strength);
    light.position.set(...view.key.towards);
    scene.add(light);
  }
  /** @type {THREE.Mesh[]} */
  const meshes = [];
  model.traverse((object) => {
    if (object instanceof THREE.Mesh) meshes.push(object);
  });
  const camera = cameraOf(view);
  // MToon ignores environment maps, other materials would add the probe to theirs, and a probe lights the whole scene:
  // meshes that need different ambient light are drawn one group after the other.
  const groups = Map.groupBy(meshes, (mesh) => toonOf(mesh)?.giEqualizationFactor);
  for (const [equalization, group] of groups) {
    for (const mesh of meshes) mesh.layers.set(group.includes(mesh) ? 0 : 1);
    const ambient = equalization === undefined ? undefined : equalized(probe, equalization);
    scene.environment = ambient ? null : environment;
    if (ambient) scene.add(ambient);
    renderer.render(scene, camera);
    renderer.autoClear = false;
    ambient?.removeFromParent();
  }
  renderer.autoClear = true;
  return pixels(/** @type {WebGL2RenderingContext} */ (renderer.getContext()), view);
}
