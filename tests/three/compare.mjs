// Compares a scene in three.js with a pose document.
import assert from "node:assert/strict";

/** @typedef {import("../../web/shell/types.d.ts").PoseDocument} PoseDocument */
/** @typedef {Awaited<ReturnType<typeof import("./scene.mjs").loadScene>>} Scene */
/** @typedef {ArrayLike<number> & { slice(start: number, end: number): ArrayLike<number> }} Numbers */

/**
 * Returns the largest difference between the scene's current pose and a pose document. Both must draw the same things.
 * @param {Scene} scene
 * @param {PoseDocument} posed
 * @param {number} diagonal Of the rest bounds.
 */
export function largestDifference(scene, posed, diagonal) {
  const worst = { difference: 0, what: "nothing", vertices: 0 };
  /** @type {(difference: number, what: string) => void} */
  const note = (difference, what) => {
    // NaN is worse than any number.
    if (!(difference <= worst.difference)) Object.assign(worst, { difference, what });
  };

  const world = new Map(posed.nodes.map((entry) => [entry.node, entry.world]));
  for (const reference of scene.nodes()) {
    const found = world.get(reference.node);
    assert.ok(found !== undefined, `node ${reference.node} is missing`);
    note(matrixDifference(found, reference.world, diagonal), `matrix of node ${reference.node}`);
  }

  /** @type {(drawn: { node: number, mesh: number, primitive: number }) => string} */
  const key = ({ node, mesh, primitive }) => `mesh ${mesh}.${primitive} on node ${node}`;
  const positions = new Map(posed.meshes.map((entry) => [key(entry), entry.positions]));
  const references = scene.meshes();
  assert.deepEqual([...positions.keys()].sort(), references.map(key).sort(), "what is drawn");
  for (const reference of references) {
    const found = positions.get(key(reference)) ?? [];
    assert.equal(found.length, reference.positions.length, `number of vertices of ${key(reference)}`);
    note(largestDistance(found, reference.positions) / diagonal, key(reference));
    worst.vertices += found.length / 3;
  }
  return worst;
}

/**
 * Returns the largest distance between two lists of points; NaN if either contains one, so that every comparison fails.
 * @param {ArrayLike<number>} a
 * @param {ArrayLike<number>} b
 */
export function largestDistance(a, b) {
  let largest = 0;
  for (let at = 0; at < b.length; at += 3) {
    const distance = Math.hypot(a[at] - b[at], a[at + 1] - b[at + 1], a[at + 2] - b[at + 2]);
    if (!(distance <= largest)) largest = distance;
    if (Number.isNaN(largest)) return NaN;
  }
  return largest;
}

/**
 * Measures the origin in diagonals, and the axes relative to the longest one.
 * @param {Numbers} a
 * @param {Numbers} b
 * @param {number} diagonal
 */
function matrixDifference(a, b, diagonal) {
  const longest = Math.max(...[0, 4, 8].map((at) => Math.hypot(b[at], b[at + 1], b[at + 2])), 1e-6);
  return Math.max(
    largestDistance(a.slice(12, 15), b.slice(12, 15)) / diagonal,
    ...[0, 4, 8].map((at) => largestDistance(a.slice(at, at + 3), b.slice(at, at + 3)) / longest),
  );
}

/**
 * Returns the bounding box of lists of points.
 * @param {ArrayLike<number>[]} lists
 */
export function boundsOf(lists) {
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  for (const list of lists)
    for (let at = 0; at < list.length; at++) {
      min[at % 3] = Math.min(min[at % 3], list[at]);
      max[at % 3] = Math.max(max[at % 3], list[at]);
    }
  return { min, max };
}
