// Loads a glTF into three.js in Node, without materials and images, and returns the world positions of every vertex and
// the world matrix of every node, under the file's own indices, in a clip at a time.
import fs from "node:fs";
import path from "node:path";
import * as THREE from "three";
import { MeshoptDecoder } from "three/examples/jsm/libs/meshopt_decoder.module.js";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { readGltf } from "./data.mjs";
import { dracoLoader } from "./draco.mjs";

/** @typedef {import("three/examples/jsm/loaders/GLTFLoader.js").GLTF} GLTF */

// What GLTFLoader needs of a browser.
Object.assign(globalThis, { self: globalThis.self ?? globalThis, ProgressEvent: globalThis.ProgressEvent ?? Event });

/**
 * Returns the document with its buffers embedded, and without anything that only changes its looks.
 * @param {string} file
 */
function documentOf(file) {
  const { json, binary } = readGltf(file);
  /** @param {Buffer} bytes */
  const dataUri = (bytes) => `data:application/octet-stream;base64,${bytes.toString("base64")}`;
  (json.buffers ?? []).forEach((buffer, index) => {
    if (buffer.uri === undefined && index === 0 && binary !== null) buffer.uri = dataUri(binary);
    else if (buffer.uri !== undefined && !buffer.uri.startsWith("data:"))
      buffer.uri = dataUri(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(buffer.uri))));
  });
  delete json.materials;
  delete json.textures;
  delete json.images;
  for (const mesh of json.meshes ?? []) for (const primitive of mesh.primitives) delete primitive.material;
  // Instancing and lights make three.js insert objects of its own between node and mesh.
  for (const node of json.nodes ?? []) delete node.extensions;
  for (const animation of json.animations ?? []) animation.channels = animation.channels.flatMap((channel) => withoutPointer(json, channel));
  return json;
}

/**
 * Returns the ordinary channels equivalent to a pointer to nodes, since three.js ignores KHR_animation_pointer; none
 * for other pointers.
 * @param {import("../types.d.ts").GltfJson} json
 * @param {import("../types.d.ts").GltfChannel} channel
 */
function withoutPointer(json, channel) {
  const pointer = channel.target.extensions?.KHR_animation_pointer?.pointer;
  if (pointer === undefined) return [channel];
  const [, list, index, path, ...rest] = pointer.split("/");
  if (path === undefined || rest.length > 0) return [];
  /** @type {(node: number) => import("../types.d.ts").GltfChannel} */
  const aimedAt = (node) => ({ ...channel, target: { node, path } });
  if (list === "nodes") return [aimedAt(Number(index))];
  const nodes = [...json.nodes.entries()].filter(([, { mesh, weights }]) => list === "meshes" && mesh === Number(index) && weights === undefined);
  return nodes.map(([node]) => aimedAt(node));
}

/**
 * Loads a file; `repair` may correct what GLTFLoader returned.
 * @param {string} file
 * @param {(gltf: GLTF) => void} [repair]
 */
export async function loadScene(file, repair = () => {}) {
  // GLTFLoader takes a parsed document too, which its types don't say.
  const document = /** @type {string} */ (/** @type {unknown} */ (documentOf(file)));
  const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
  loader.setDRACOLoader(/** @type {any} */ (dracoLoader));
  const gltf = await loader.parseAsync(document, "");
  repair(gltf);
  const mixer = new THREE.AnimationMixer(gltf.scene);
  const associations = gltf.parser.associations;

  /** @type {{ node: number, object: THREE.Object3D }[]} */
  const nodes = [];
  /** @type {{ node: number, mesh: number, primitive: number, object: THREE.Mesh }[]} */
  const meshes = [];
  gltf.scene.updateMatrixWorld(true);
  gltf.scene.traverse((object) => {
    const own = associations.get(object);
    if (own?.nodes !== undefined) nodes.push({ node: own.nodes, object });
    if (!isDrawn(object)) return;
    /** @type {THREE.Object3D | null} */
    let holder = object;
    while (holder !== null && associations.get(holder)?.nodes === undefined) holder = holder.parent;
    const node = holder === null ? undefined : associations.get(holder)?.nodes;
    if (node === undefined || own?.meshes === undefined) throw new Error(`${file}: ${object.name} is drawn but not from the file`);
    meshes.push({ node, mesh: own.meshes, primitive: own.primitives ?? 0, object });
  });

  return {
    clips: gltf.animations,
    /**
     * Poses the scene in a clip at a time, played once and held at its end, or in its rest pose.
     * @param {number | null} clip
     * @param {number} timeSecs
     */
    play(clip, timeSecs) {
      mixer.stopAllAction();
      if (clip !== null) {
        const action = mixer.clipAction(gltf.animations[clip]);
        action.setLoop(THREE.LoopOnce, 1);
        action.clampWhenFinished = true;
        action.reset().play();
        mixer.setTime(timeSecs);
      }
      gltf.scene.updateMatrixWorld(true);
    },
    /** Returns the world matrix of every node of the default scene, column-major. */
    nodes: () => nodes.map(({ node, object }) => ({ node, world: object.matrixWorld.elements })),
    /** Returns the world positions of everything drawn. */
    meshes: () => meshes.map(({ object, ...key }) => ({ ...key, positions: worldPositions(object) })),
  };
}

/**
 * Meshes, lines and points.
 * @param {THREE.Object3D} object
 * @returns {object is THREE.Mesh}
 */
const isDrawn = (object) => "geometry" in object;

const vertex = new THREE.Vector3();
const delta = new THREE.Vector3();

/** @param {THREE.Mesh} object */
function worldPositions(object) {
  const { position } = object.geometry.attributes;
  const positions = new Float64Array(position.count * 3);
  for (let index = 0; index < position.count; index++) {
    if (object instanceof THREE.SkinnedMesh && object.skeleton !== undefined) object.getVertexPosition(index, vertex);
    else morphed(object, index);
    vertex.applyMatrix4(object.matrixWorld).toArray(positions, index * 3);
  }
  return positions;
}

/**
 * Does what Mesh.getVertexPosition does, which lines and points lack.
 * @param {THREE.Mesh} object
 * @param {number} index
 */
function morphed(object, index) {
  vertex.fromBufferAttribute(object.geometry.attributes.position, index);
  const targets = object.geometry.morphAttributes.position ?? [];
  targets.forEach((target, number) => {
    const weight = object.morphTargetInfluences?.[number] ?? 0;
    if (weight !== 0) vertex.addScaledVector(delta.fromBufferAttribute(target, index), weight);
  });
}
