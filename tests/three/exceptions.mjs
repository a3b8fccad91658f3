// Departures of three.js from glTF 2.0. Each entry cites the specification and repairs the loaded scene before it
// serves as a reference. An entry that is no longer needed fails the test.

/** @typedef {import("three/examples/jsm/loaders/GLTFLoader.js").GLTF} GLTF */

/**
 * `repair` gets what GLTFLoader returns, before anything is played.
 * @type {{ files: string[], repair: (gltf: GLTF) => void, because: string }[]}
 */
export const exceptions = [
  {
    files: [
      "asset-generator/Positive/Animation_SamplerType/Animation_SamplerType_01.gltf",
      "khronos/AnimatedTriangle/glTF/AnimatedTriangle.gltf",
      "khronos/AnimatedTriangle/glTF-Embedded/AnimatedTriangle.gltf",
      "compressed/RobotExpressive-gltfpack-meshopt.glb",
    ],
    repair: ({ animations }) => {
      for (const { name, values } of animations.flatMap(({ tracks }) => tracks))
        if (name.endsWith(".quaternion")) for (let at = 0; at < values.length; at += 4) normalize(/** @type {Float32Array} */ (values).subarray(at, at + 4));
    },
    because:
      "glTF 2.0, 3.5.3: `rotation` is a unit quaternion value. Keys stored as bytes, rounded to 0.707 or compressed are not quite of unit length, and three.js scales by their length.",
  },
];

/** @param {Float32Array} values */
function normalize(values) {
  const length = Math.hypot(...values);
  for (const at of values.keys()) values[at] /= length;
}
