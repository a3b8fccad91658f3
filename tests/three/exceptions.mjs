// Where three.js departs from glTF 2.0: each entry cites the sentence, and how its numbers are repaired before they are a
// reference. An entry that is no longer needed fails the test.

/** `{files, repair, because}`; `repair` is called with what GLTFLoader gives, before anything is played. */
export const exceptions = [
  {
    files: [
      "asset-generator/Positive/Animation_SamplerType/Animation_SamplerType_01.gltf",
      "khronos/AnimatedTriangle/glTF/AnimatedTriangle.gltf",
      "khronos/AnimatedTriangle/glTF-Embedded/AnimatedTriangle.gltf",
    ],
    repair: ({ animations }) => {
      for (const { name, values } of animations.flatMap(({ tracks }) => tracks))
        if (name.endsWith(".quaternion")) for (let at = 0; at < values.length; at += 4) normalize(values.subarray(at, at + 4));
    },
    because:
      "glTF 2.0, 3.5.3: `rotation` is a unit quaternion value. Keys stored as bytes, or as 0.707, are not quite, and three.js scales by what is missing.",
  },
];

function normalize(values) {
  const length = Math.hypot(...values);
  for (const at of values.keys()) values[at] /= length;
}
