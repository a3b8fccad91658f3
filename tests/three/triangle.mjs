// A glTF without a single finding of the Khronos validator, and the same with mistakes.

/** Nodes: two joints, and the skinned triangle. */
export const [UPPER, LOWER, BODY] = [0, 1, 2];

/**
 * A triangle on two joints, of which a clip turns the lower one.
 * @param {{ weight?: number, turn?: number, uri?: string }} [mistakes] A weight other than 1, a rotation that isn't of unit
 *   length, and the URI of the buffer, which otherwise is a data URI.
 */
export function triangle({ weight = 1, turn = 1, uri } = {}) {
  const positions = [0, 0, 0, 1, 0, 0, 0, 1, 0];
  const weights = [1, 0, 0, 0, 1, 0, 0, 0, weight, 0, 0, 0];
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const floats = [...positions, ...weights, ...identity, ...identity, 0, 1, 0, 0, 0, 1, 0, 0, 0, turn];
  const bytes = Buffer.concat([Buffer.from(new Float32Array(floats).buffer), Buffer.from([0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])]);
  const [vertices, float] = [{ target: 34962 }, { componentType: 5126 }];
  const document = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [UPPER, BODY] }],
    nodes: [{ name: "Upper", children: [LOWER] }, { name: "Lower" }, { name: "Body", mesh: 0, skin: 0 }],
    skins: [{ joints: [UPPER, LOWER], inverseBindMatrices: 3 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, WEIGHTS_0: 1, JOINTS_0: 2 } }] }],
    animations: [{ name: "Turn", samplers: [{ input: 4, output: 5 }], channels: [{ sampler: 0, target: { node: LOWER, path: "rotation" } }] }],
    accessors: [
      { bufferView: 0, ...float, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] },
      { bufferView: 1, ...float, count: 3, type: "VEC4" },
      { bufferView: 4, componentType: 5121, count: 3, type: "VEC4" },
      { bufferView: 2, ...float, count: 2, type: "MAT4" },
      { bufferView: 3, ...float, count: 2, type: "SCALAR", min: [0], max: [1] },
      { bufferView: 3, byteOffset: 8, ...float, count: 2, type: "VEC4" },
    ],
    bufferViews: [
      { buffer: 0, byteLength: 36, ...vertices },
      { buffer: 0, byteOffset: 36, byteLength: 48, ...vertices },
      { buffer: 0, byteOffset: 84, byteLength: 128 },
      { buffer: 0, byteOffset: 212, byteLength: 40 },
      { buffer: 0, byteOffset: 252, byteLength: 12, ...vertices },
    ],
    buffers: [{ byteLength: bytes.length, uri: uri ?? `data:application/octet-stream;base64,${bytes.toString("base64")}` }],
  };
  return { bytes, document, text: JSON.stringify(document) };
}
