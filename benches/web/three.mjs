// The three.js side of the comparison, which run.mjs calls through `window.bench`.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";
import * as SkeletonUtils from "three/addons/utils/SkeletonUtils.js";

/** @typedef {{ model: THREE.Object3D, mixer: THREE.AnimationMixer, skeletons: THREE.Skeleton[] }} Character */

/** @param {string} url */
const bytesOf = async (url) => await (await fetch(url)).arrayBuffer();
/** @param {ArrayBuffer} bytes */
const parse = (bytes) => new GLTFLoader().parseAsync(bytes, "");

/**
 * @param {THREE.AnimationClip[]} clips
 * @param {string} name
 */
function clipNamed(clips, name) {
  const clip = clips.find((clip) => clip.name === name);
  if (clip === undefined) throw new Error(`no clip ${name}`);
  return clip;
}

/**
 * Returns copies of a file's character, each at its own phase of a clip, with the skeletons that a frame has to update.
 * @param {string} url
 * @param {string} clipName
 * @param {number} count
 * @returns {Promise<Character[]>}
 */
async function crowd(url, clipName, count) {
  const gltf = await parse(await bytesOf(url));
  // Clones bind unnamed nodes by uuid and would stand still.
  let unnamed = 0;
  gltf.scene.traverse((object) => (object.name ||= `unnamed${unnamed++}`));
  const clip = clipNamed(gltf.animations, clipName);
  return Array.from({ length: count }, (_, index) => {
    const model = SkeletonUtils.clone(gltf.scene);
    const mixer = new THREE.AnimationMixer(model);
    mixer.clipAction(clip).play();
    mixer.setTime((clip.duration * index) / count);
    // Meshes of one skin share their skeleton in the file; clone() copies it for each, which would count against
    // three.js.
    /** @type {Map<THREE.Bone, THREE.Skeleton>} */
    const skeletons = new Map();
    model.traverse((object) => object instanceof THREE.SkinnedMesh && skeletons.set(object.skeleton.bones[0], object.skeleton));
    return { model, mixer, skeletons: [...skeletons.values()] };
  });
}

/** @type {Character[]} */
let characters = [];
/** @type {{ target: THREE.SkinnedMesh, source: THREE.SkinnedMesh, clip: THREE.AnimationClip }} */
let retargeting;
/** @type {ReturnType<typeof newScreen> | null} */
let screen = null;

function newScreen() {
  const renderer = new THREE.WebGLRenderer({ antialias: false });
  renderer.setSize(innerWidth, innerHeight);
  document.body.replaceChildren(renderer.domElement);
  const scene = new THREE.Scene();
  scene.add(new THREE.DirectionalLight(0xffffff, 2));
  const camera = new THREE.PerspectiveCamera(35, innerWidth / innerHeight, 0.1, 1000);
  camera.position.set(1.2, 1.6, 5);
  return { renderer, scene, camera, shown: /** @type {THREE.Object3D[]} */ ([]) };
}

const bench = {
  /**
   * @param {string} url
   * @param {string} clipName
   * @param {number} count
   */
  async prepareCharacters(url, clipName, count) {
    characters = await crowd(url, clipName, count);
    return characters[0].skeletons.reduce((sum, { bones }) => sum + bones.length, 0);
  },

  /**
   * Measures AnimationMixer, updateMatrixWorld and Skeleton.update, in microseconds per character-frame.
   * @param {number} frames
   */
  characters(frames) {
    const start = performance.now();
    for (let frame = 0; frame < frames; frame++)
      for (const { model, mixer, skeletons } of characters) {
        mixer.update(1 / 60);
        model.updateMatrixWorld();
        for (const skeleton of skeletons) skeleton.update();
      }
    return ((performance.now() - start) * 1000) / (frames * characters.length);
  },

  /**
   * @param {string} modelUrl
   * @param {string} motionUrl
   * @param {string} clipName
   */
  async prepareRetarget(modelUrl, motionUrl, clipName) {
    const [model, motion] = [await parse(await bytesOf(modelUrl)), await parse(await bytesOf(motionUrl))];
    /** @param {{ scene: THREE.Group }} gltf */
    const largest = ({ scene }) => {
      /** @type {THREE.SkinnedMesh[]} */
      const meshes = [];
      scene.updateMatrixWorld(true);
      scene.traverse((object) => object instanceof THREE.SkinnedMesh && meshes.push(object));
      return meshes.sort((a, b) => b.skeleton.bones.length - a.skeleton.bones.length)[0];
    };
    retargeting = { target: largest(model), source: largest(motion), clip: clipNamed(motion.animations, clipName) };
  },

  /**
   * Measures SkeletonUtils.retargetClip, in milliseconds.
   * @param {number} rounds
   */
  retarget(rounds) {
    const { target, source, clip } = retargeting;
    const start = performance.now();
    for (let round = 0; round < rounds; round++)
      SkeletonUtils.retargetClip(target, source, clip, { hip: "mixamorigHips", getBoneName: ({ name }) => name });
    return (performance.now() - start) / rounds;
  },

  /**
   * Measures GLTFLoader.parse from bytes in memory, including textures, in milliseconds.
   * @param {string} url
   */
  async load(url) {
    const bytes = await bytesOf(url);
    const start = performance.now();
    await parse(bytes);
    return performance.now() - start;
  },

  /**
   * Measures from bytes in memory until the call that draws them in an animation frame returns, in milliseconds.
   * @param {string} url
   */
  async open(url) {
    const bytes = await bytesOf(url);
    screen ??= newScreen();
    const start = performance.now();
    const { scene } = await parse(bytes);
    await new Promise((resolve) => requestAnimationFrame(resolve));
    screen.scene.remove(...screen.shown);
    screen.scene.add(...(screen.shown = [scene]));
    screen.renderer.render(screen.scene, screen.camera);
    return performance.now() - start;
  },

  /**
   * Plays a file's clip in a loop with image-based light, a key light with a soft shadow on the ground and neutral tone
   * mapping.
   * @param {string} url
   * @param {string} clipName
   * @param {number} samples
   */
  async draw(url, clipName, samples) {
    const renderer = new THREE.WebGLRenderer({ antialias: samples > 1 });
    renderer.setSize(innerWidth, innerHeight);
    renderer.toneMapping = THREE.NeutralToneMapping;
    renderer.shadowMap.enabled = true;
    document.body.replaceChildren(renderer.domElement);
    const scene = new THREE.Scene();
    scene.background = new THREE.Color(0x8a8d92);
    scene.environment = new THREE.PMREMGenerator(renderer).fromScene(new RoomEnvironment()).texture;
    const gltf = await parse(await bytesOf(url));
    gltf.scene.traverse((object) => (object.castShadow = object instanceof THREE.Mesh));
    scene.add(gltf.scene, new THREE.GridHelper(10, 10));
    const ground = new THREE.Mesh(new THREE.PlaneGeometry(10, 10).rotateX(-Math.PI / 2), new THREE.ShadowMaterial({ opacity: 0.4 }));
    ground.receiveShadow = true;
    const light = new THREE.DirectionalLight(0xffffff, 2);
    light.position.set(1, 2, 1.5);
    light.castShadow = true;
    // As large as Gaitway's on a software adapter.
    light.shadow.mapSize.set(512, 512);
    scene.add(ground, light);
    const camera = new THREE.PerspectiveCamera(35, innerWidth / innerHeight, 0.1, 100);
    camera.position.set(1.2, 1.6, 3.2);
    camera.lookAt(0, 0.9, 0);
    const mixer = new THREE.AnimationMixer(gltf.scene);
    mixer.clipAction(clipNamed(gltf.animations, clipName)).play();
    const clock = performance.now();
    renderer.setAnimationLoop(() => {
      mixer.setTime((performance.now() - clock) / 1000);
      renderer.render(scene, camera);
    });
  },
};

/** @typedef {typeof bench} Bench */

window.bench = bench;
