// Rasterizes the silhouette that a model must have from world positions, the file's indices and a camera alone. It
// shares no code with the renderer.
import { readGltf } from "../three/data.mjs";

/** @typedef {import("../../web/shell/types.d.ts").PoseDocument} PoseDocument */
/** @typedef {{ indices: ArrayLike<number> | null, doubleSided: boolean }} Triangles */
/**
 * @typedef {object} Camera
 * @property {number} yawDegrees
 * @property {number} pitchDegrees
 * @property {number} distance
 * @property {number[]} target
 * @property {number} fovDegrees
 */

/** @type {Record<number, Uint8ArrayConstructor | Uint16ArrayConstructor | Uint32ArrayConstructor>} */
const INDEX_ARRAYS = { 5121: Uint8Array, 5123: Uint16Array, 5125: Uint32Array };

/**
 * Returns the triangles of every primitive of a GLB by `"mesh.primitive"`.
 * @param {string} file
 */
export function trianglesOf(file) {
  const { json, binary } = readGltf(file);
  /** @type {Map<string, Triangles>} */
  const triangles = new Map();
  json.meshes.forEach((mesh, meshIndex) =>
    mesh.primitives.forEach((primitive, primitiveIndex) => {
      if ((primitive.mode ?? 4) !== 4) throw new Error("only triangle lists can be rasterized");
      const doubleSided = json.materials?.[primitive.material ?? -1]?.doubleSided === true;
      triangles.set(`${meshIndex}.${primitiveIndex}`, { indices: indicesOf(json, binary, primitive.indices), doubleSided });
    }),
  );
  return triangles;
}

/**
 * @param {import("../types.d.ts").GltfJson} json
 * @param {Buffer | null} binary
 * @param {number | undefined} accessorIndex
 */
function indicesOf(json, binary, accessorIndex) {
  if (accessorIndex === undefined || binary === null) return null;
  const accessor = json.accessors[accessorIndex];
  const view = json.bufferViews[accessor.bufferView];
  const Elements = INDEX_ARRAYS[accessor.componentType];
  const start = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
  return new Elements(Uint8Array.from(binary.subarray(start, start + accessor.count * Elements.BYTES_PER_ELEMENT)).buffer);
}

/**
 * Returns a camera that sees all of a pose document from the given direction.
 * @param {PoseDocument} posed
 * @param {number} yawDegrees
 * @param {number} pitchDegrees
 * @param {number} fovDegrees
 * @returns {Camera}
 */
export function cameraFor(posed, yawDegrees, pitchDegrees, fovDegrees) {
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  for (const { positions } of posed.meshes)
    for (let at = 0; at < positions.length; at++) {
      min[at % 3] = Math.min(min[at % 3], positions[at]);
      max[at % 3] = Math.max(max[at % 3], positions[at]);
    }
  const radius = Math.hypot(...min.map((low, axis) => max[axis] - low)) / 2;
  const distance = radius / Math.sin((fovDegrees * Math.PI) / 360);
  return { yawDegrees, pitchDegrees, distance, target: min.map((low, axis) => (low + max[axis]) / 2), fovDegrees };
}

/**
 * The camera as a link writes it.
 * @param {Camera} camera
 */
export const cameraText = ({ yawDegrees, pitchDegrees, distance, target }) => [yawDegrees, pitchDegrees, distance, ...target].join(",");

/**
 * Returns one byte per pixel, 1 where a triangle covers the pixel's center. Rows run from the top.
 * @param {PoseDocument} posed
 * @param {Map<string, Triangles>} triangles
 * @param {Camera} camera
 * @param {number} width
 * @param {number} height
 */
export function rasterize(posed, triangles, camera, width, height) {
  const mask = new Uint8Array(width * height);
  const project = projector(camera, width, height);
  for (const { mesh, primitive, positions } of posed.meshes) {
    const { indices, doubleSided } = triangles.get(`${mesh}.${primitive}`) ?? { indices: null, doubleSided: false };
    const screen = new Float64Array((positions.length / 3) * 2);
    for (let vertex = 0; vertex * 3 < positions.length; vertex++) screen.set(project(positions, vertex * 3), vertex * 2);
    const count = indices === null ? positions.length / 3 : indices.length;
    /** @param {number} at */
    const corner = (at) => 2 * (indices === null ? at : indices[at]);
    for (let at = 0; at + 2 < count; at += 3) {
      const [a, b, c] = [corner(at), corner(at + 1), corner(at + 2)];
      fill(mask, width, height, doubleSided, screen[a], screen[a + 1], screen[b], screen[b + 1], screen[c], screen[c + 1]);
    }
  }
  return mask;
}

/**
 * Projects world positions to pixels from the top left. Yaw 0 looks from +Z, 90 from +X; positive pitch from above.
 * @param {Camera} camera
 * @param {number} width
 * @param {number} height
 * @returns {(positions: number[], at: number) => [number, number]}
 */
function projector({ yawDegrees, pitchDegrees, distance, target, fovDegrees }, width, height) {
  const [yaw, pitch] = [(yawDegrees * Math.PI) / 180, (pitchDegrees * Math.PI) / 180];
  const back = [Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch), Math.cos(yaw) * Math.cos(pitch)];
  const right = [Math.cos(yaw), 0, -Math.sin(yaw)];
  const up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2], back[0] * right[1] - back[1] * right[0]];
  const pixels = height / 2 / Math.tan((fovDegrees * Math.PI) / 360);
  return (positions, at) => {
    const [x, y, z] = [positions[at] - target[0], positions[at + 1] - target[1], positions[at + 2] - target[2]];
    const depth = distance - (back[0] * x + back[1] * y + back[2] * z);
    const across = right[0] * x + right[1] * y + right[2] * z;
    const upwards = up[0] * x + up[1] * y + up[2] * z;
    return [width / 2 + (pixels * across) / depth, height / 2 - (pixels * upwards) / depth];
  };
}

/**
 * Fills a triangle. Front faces are counterclockwise, so their area is negative on a screen with Y down.
 * @param {Uint8Array} mask
 * @param {number} width
 * @param {number} height
 * @param {boolean} doubleSided
 * @param {number} ax
 * @param {number} ay
 * @param {number} bx
 * @param {number} by
 * @param {number} cx
 * @param {number} cy
 */
function fill(mask, width, height, doubleSided, ax, ay, bx, by, cx, cy) {
  const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  if (area === 0 || (area > 0 && !doubleSided)) return;
  const sign = Math.sign(area);
  const left = Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5));
  const right = Math.min(width - 1, Math.floor(Math.max(ax, bx, cx) - 0.5));
  const top = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5));
  const bottom = Math.min(height - 1, Math.floor(Math.max(ay, by, cy) - 0.5));
  for (let row = top; row <= bottom; row++)
    for (let column = left; column <= right; column++) {
      const [x, y] = [column + 0.5, row + 0.5];
      if (
        sign * ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) >= 0 &&
        sign * ((cx - bx) * (y - by) - (cy - by) * (x - bx)) >= 0 &&
        sign * ((ax - cx) * (y - cy) - (ay - cy) * (x - cx)) >= 0
      )
        mask[row * width + column] = 1;
    }
}

/**
 * Returns where an image with a transparent background shows something.
 * @param {import("./browser.mjs").Image} image
 */
export const maskOf = ({ rgba }) => Uint8Array.from({ length: rgba.length / 4 }, (_, pixel) => (rgba[pixel * 4 + 3] >= 128 ? 1 : 0));

/**
 * Returns the intersection over union of two masks; 0 if both are empty, so that an empty image proves nothing.
 * @param {Uint8Array} a
 * @param {Uint8Array} b
 */
export function overlap(a, b) {
  let both = 0;
  let either = 0;
  for (let at = 0; at < a.length; at++) {
    both += a[at] & b[at];
    either += a[at] | b[at];
  }
  return either === 0 ? 0 : both / either;
}
