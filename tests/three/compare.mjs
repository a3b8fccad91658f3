// What three.js shows against what a pose document says.
import assert from "node:assert/strict";

/** What differs most between what three.js shows now and a pose document: `{difference, what, vertices}`. Both must draw the same things. */
export function largestDifference(scene, posed, diagonal) {
  const worst = { difference: 0, what: "nothing", vertices: 0 };
  const note = (difference, what) => !(difference <= worst.difference) && Object.assign(worst, { difference, what });

  const world = new Map(posed.nodes.map((entry) => [entry.node, entry.world]));
  for (const reference of scene.nodes()) {
    assert.ok(world.has(reference.node), `node ${reference.node} is missing`);
    note(matrixDifference(world.get(reference.node), reference.world, diagonal), `matrix of node ${reference.node}`);
  }

  const key = ({ node, mesh, primitive }) => `mesh ${mesh}.${primitive} on node ${node}`;
  const positions = new Map(posed.meshes.map((entry) => [key(entry), entry.positions]));
  const references = scene.meshes();
  assert.deepEqual([...positions.keys()].sort(), references.map(key).sort(), "what is drawn");
  for (const reference of references) {
    const found = positions.get(key(reference));
    assert.equal(found.length, reference.positions.length, `number of vertices of ${key(reference)}`);
    note(largestDistance(found, reference.positions) / diagonal, key(reference));
    worst.vertices += found.length / 3;
  }
  return worst;
}

/** NaN where either holds one, so that every comparison with it fails. */
export function largestDistance(a, b) {
  let largest = 0;
  for (let at = 0; at < b.length; at += 3) {
    const distance = Math.hypot(a[at] - b[at], a[at + 1] - b[at + 1], a[at + 2] - b[at + 2]);
    if (!(distance <= largest)) largest = distance;
    if (Number.isNaN(largest)) return NaN;
  }
  return largest;
}

/** The origin in diagonals, the axes in lengths of the longest one. */
function matrixDifference(a, b, diagonal) {
  const longest = Math.max(...[0, 4, 8].map((at) => Math.hypot(b[at], b[at + 1], b[at + 2])), 1e-6);
  return Math.max(
    largestDistance(a.slice(12, 15), b.slice(12, 15)) / diagonal,
    ...[0, 4, 8].map((at) => largestDistance(a.slice(at, at + 3), b.slice(at, at + 3)) / longest),
  );
}

/** The box around lists of points. */
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
