// The three.js side of the comparison, called by run.mjs through `window.bench`.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";
import * as SkeletonUtils from "three/addons/utils/SkeletonUtils.js";

const bytesOf = async (url) => await (await fetch(url)).arrayBuffer();
const parse = (bytes) => new GLTFLoader().parseAsync(bytes, "");

/** Characters of one file, each at its own phase of a clip, and the skeletons that one frame has to update. */
async function crowd(url, clipName, count) {
  const gltf = await parse(await bytesOf(url));
  // Clones bind unnamed nodes by uuid and would stand still.
  let unnamed = 0;
  gltf.scene.traverse((object) => (object.name ||= `unnamed${unnamed++}`));
  const clip = gltf.animations.find(({ name }) => name === clipName);
  return Array.from({ length: count }, (_, index) => {
    const model = SkeletonUtils.clone(gltf.scene);
    const mixer = new THREE.AnimationMixer(model);
    mixer.clipAction(clip).play();
    mixer.setTime((clip.duration * index) / count);
    // Meshes of one skin share their skeleton in the file; clone() copies it for each, which would count against three.js.
    const skeletons = new Map();
    model.traverse((object) => object.isSkinnedMesh && skeletons.set(object.skeleton.bones[0], object.skeleton));
    return { model, mixer, skeletons: [...skeletons.values()] };
  });
}

let characters = [];
let retargeting;
let screen = null;

function newScreen() {
  const renderer = new THREE.WebGLRenderer({ antialias: false });
  renderer.setSize(innerWidth, innerHeight);
  document.body.replaceChildren(renderer.domElement);
  const scene = new THREE.Scene();
  scene.add(new THREE.DirectionalLight(0xffffff, 2));
  const camera = new THREE.PerspectiveCamera(35, innerWidth / innerHeight, 0.1, 1000);
  camera.position.set(1.2, 1.6, 5);
  return { renderer, scene, camera, shown: [] };
}

window.bench = {
  async prepareCharacters(url, clipName, count) {
    characters = await crowd(url, clipName, count);
    return characters[0].skeletons.reduce((sum, { bones }) => sum + bones.length, 0);
  },

  /** Microseconds per character-frame: AnimationMixer, updateMatrixWorld, Skeleton.update. */
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

  async prepareRetarget(modelUrl, motionUrl, clipName) {
    const [model, motion] = [await parse(await bytesOf(modelUrl)), await parse(await bytesOf(motionUrl))];
    const largest = ({ scene }) => {
      const meshes = [];
      scene.updateMatrixWorld(true);
      scene.traverse((object) => object.isSkinnedMesh && meshes.push(object));
      return meshes.sort((a, b) => b.skeleton.bones.length - a.skeleton.bones.length)[0];
    };
    retargeting = { target: largest(model), source: largest(motion), clip: motion.animations.find(({ name }) => name === clipName) };
  },

  /** Milliseconds of SkeletonUtils.retargetClip. */
  retarget(rounds) {
    const { target, source, clip } = retargeting;
    const start = performance.now();
    for (let round = 0; round < rounds; round++)
      SkeletonUtils.retargetClip(target, source, clip, { hip: "mixamorigHips", getBoneName: ({ name }) => name });
    return (performance.now() - start) / rounds;
  },

  /** Milliseconds of GLTFLoader.parse from bytes in memory, textures included. */
  async load(url) {
    const bytes = await bytesOf(url);
    const start = performance.now();
    await parse(bytes);
    return performance.now() - start;
  },

  /** Milliseconds from bytes in memory to the return of the call that draws them, in an animation frame. */
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

  /** Draws a file's clip without end: image-based light, a key light with a soft shadow on the ground, neutral tone mapping. */
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
    gltf.scene.traverse((object) => (object.castShadow = object.isMesh === true));
    scene.add(gltf.scene, new THREE.GridHelper(10, 10));
    const ground = new THREE.Mesh(new THREE.PlaneGeometry(10, 10).rotateX(-Math.PI / 2), new THREE.ShadowMaterial({ opacity: 0.4 }));
    ground.receiveShadow = true;
    const light = new THREE.DirectionalLight(0xffffff, 2);
    light.position.set(1, 2, 1.5);
    light.castShadow = true;
    light.shadow.mapSize.set(1024, 1024);
    scene.add(ground, light);
    const camera = new THREE.PerspectiveCamera(35, innerWidth / innerHeight, 0.1, 100);
    camera.position.set(1.2, 1.6, 3.2);
    camera.lookAt(0, 0.9, 0);
    const mixer = new THREE.AnimationMixer(gltf.scene);
    mixer.clipAction(gltf.animations.find(({ name }) => name === clipName)).play();
    const clock = performance.now();
    renderer.setAnimationLoop(() => {
      mixer.setTime((performance.now() - clock) / 1000);
      renderer.render(scene, camera);
    });
  },
};
