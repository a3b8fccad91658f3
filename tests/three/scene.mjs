// A glTF file in three.js, in Node: everything that moves is loaded, materials and images are left out. Gives the world
// positions of every vertex and the world matrix of every node, by the file's own numbers, in a clip at a time.
import fs from "node:fs";
import path from "node:path";
import * as THREE from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { readGltf } from "./data.mjs";

// What GLTFLoader expects of a browser.
globalThis.self ??= globalThis;
globalThis.ProgressEvent ??= class extends Event {
  constructor(type, values) {
    super(type);
    Object.assign(this, values);
  }
};

/** The document with its buffers inside and without anything that is only looks. */
function documentOf(file) {
  const { json, binary } = readGltf(file);
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
  // Only the core is compared: instancing and lights add objects of three's own between node and mesh.
  for (const node of json.nodes ?? []) delete node.extensions;
  return json;
}

/** `repair`, if given, may mend what GLTFLoader made. */
export async function loadScene(file, repair = () => {}) {
  const gltf = await new GLTFLoader().parseAsync(documentOf(file), "");
  repair(gltf);
  const mixer = new THREE.AnimationMixer(gltf.scene);
  const associations = gltf.parser.associations;

  const nodes = [];
  const meshes = [];
  gltf.scene.updateMatrixWorld(true);
  gltf.scene.traverse((object) => {
    const own = associations.get(object);
    if (own?.nodes !== undefined) nodes.push({ node: own.nodes, object });
    if (object.geometry === undefined) return;
    let holder = object;
    while (associations.get(holder)?.nodes === undefined) holder = holder.parent;
    meshes.push({ node: associations.get(holder).nodes, mesh: own.meshes, primitive: own.primitives ?? 0, object });
  });

  return {
    clips: gltf.animations,
    /** Puts the scene into a clip (an index) at a time, played once and held at its end; null: the rest pose. */
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
    /** `{node, world}` of every node of the default scene, column-major. */
    nodes: () => nodes.map(({ node, object }) => ({ node, world: object.matrixWorld.elements })),
    /** `{node, mesh, primitive, positions}` of everything drawn, in world space. */
    meshes: () => meshes.map(({ object, ...key }) => ({ ...key, positions: worldPositions(object) })),
  };
}

const vertex = new THREE.Vector3();
const delta = new THREE.Vector3();

function worldPositions(object) {
  const { position } = object.geometry.attributes;
  const positions = new Float64Array(position.count * 3);
  for (let index = 0; index < position.count; index++) {
    if (object.isSkinnedMesh && object.skeleton !== undefined) object.getVertexPosition(index, vertex);
    else morphed(object, index);
    vertex.applyMatrix4(object.matrixWorld).toArray(positions, index * 3);
  }
  return positions;
}

/** Mesh.getVertexPosition, which lines and points lack. */
function morphed(object, index) {
  vertex.fromBufferAttribute(object.geometry.attributes.position, index);
  const targets = object.geometry.morphAttributes.position ?? [];
  targets.forEach((target, number) => {
    const weight = object.morphTargetInfluences[number];
    if (weight !== 0) vertex.addScaledVector(delta.fromBufferAttribute(target, index), weight);
  });
}
