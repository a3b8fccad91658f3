// Grids of spheres in GLBs made in code.

const RINGS = 32;
const SEGMENTS = 64;
/** The rows, top first: linear base colour and metalness. @type {[number, number][]} */
const ROWS = [[1, 1], [0.5, 1], [0.8, 0], [0.2, 0], [0, 0]];
const COLUMNS = 5;

/** Returns positions, which are the normals as well, and triangles. */
function unitSphere() {
  const positions = [];
  const indices = [];
  for (let ring = 0; ring <= RINGS; ring++)
    for (let segment = 0; segment <= SEGMENTS; segment++) {
      const [down, turn] = [(Math.PI * ring) / RINGS, (2 * Math.PI * segment) / SEGMENTS];
      positions.push(Math.sin(down) * Math.cos(turn), Math.cos(down), -Math.sin(down) * Math.sin(turn));
    }
  for (let ring = 0; ring < RINGS; ring++)
    for (let segment = 0; segment < SEGMENTS; segment++) {
      const at = ring * (SEGMENTS + 1) + segment;
      const below = at + SEGMENTS + 1;
      indices.push(at, below, at + 1, at + 1, below, below + 1);
    }
  return { positions: new Float32Array(positions), indices: new Uint32Array(indices) };
}

/** Returns a GLB in which roughness grows to the right, and each row has a material. */
export function sphereGrid() {
  return grid(
    ROWS.map(([color, metallicFactor]) =>
      Array.from({ length: COLUMNS }, (_, column) => {
        const [baseColorFactor, roughnessFactor] = [[color, color, color, 1], column / (COLUMNS - 1)];
        return { pbrMetallicRoughness: { baseColorFactor, metallicFactor, roughnessFactor } };
      }),
    ),
  );
}

/**
 * Returns a GLB with a sphere for each material.
 * @param {object[][]} rows Materials, top row first.
 * @param {object} [more] More members of the document.
 */
export function grid(rows, more) {
  const { positions, indices } = unitSphere();
  const cells = rows.flatMap((materials, row) => materials.map((material, column) => ({ material, row, column })));
  const [min, max] = [[-1, -1, -1], [1, 1, 1]];
  const json = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: cells.map((_, index) => index) }],
    nodes: cells.map(({ row, column }, mesh) => ({ mesh, translation: [2.1 * column, -2.1 * row, 0] })),
    meshes: cells.map((_, material) => ({
      primitives: [{ attributes: { POSITION: 0, NORMAL: 0 }, indices: 1, material }],
    })),
    materials: cells.map(({ material }) => material),
    accessors: [
      { bufferView: 0, componentType: 5126, count: positions.length / 3, type: "VEC3", min, max },
      { bufferView: 1, componentType: 5125, count: indices.length, type: "SCALAR" },
    ],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: positions.byteLength },
      { buffer: 0, byteOffset: positions.byteLength, byteLength: indices.byteLength },
    ],
    buffers: [{ byteLength: positions.byteLength + indices.byteLength }],
    ...more,
  };
  return glb(json, Buffer.concat([Buffer.from(positions.buffer), Buffer.from(indices.buffer)]));
}

/**
 * @param {object} json
 * @param {Buffer} binary Its length is a multiple of 4.
 */
export function glb(json, binary) {
  const text = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([text, Buffer.alloc(-text.length & 3, " ")]);
  const header = Buffer.from("glTF\0\0\0\0\0\0\0\0");
  header.writeUInt32LE(2, 4);
  header.writeUInt32LE(28 + padded.length + binary.length, 8);
  /** @type {(kind: string, content: Buffer) => Buffer} */
  const chunk = (kind, content) => {
    const head = Buffer.from(`\0\0\0\0${kind}`);
    head.writeUInt32LE(content.length, 0);
    return Buffer.concat([head, content]);
  };
  return Buffer.concat([header, chunk("JSON", padded), chunk("BIN\0", binary)]);
}
