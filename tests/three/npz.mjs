// Builds .npz and .npy files as NumPy does: see numpy.lib.format.
import { archive } from "../browser/archive.mjs";

/**
 * @param {number[]} shape
 * @param {Float64Array | Buffer} values
 * @param {string} [kind] NumPy's name for what they are.
 */
function npy(shape, values, kind = "<f8") {
  const header = `{'descr': '${kind}', 'fortran_order': False, 'shape': (${shape.map((side) => `${side},`).join("")}), }`;
  const padded = `${header.padEnd(64 * Math.ceil((11 + header.length) / 64) - 11)}\n`;
  const length = Buffer.alloc(2);
  length.writeUInt16LE(padded.length);
  return Buffer.concat([Buffer.from("\x93NUMPY\x01\x00", "latin1"), length, Buffer.from(padded), Buffer.from(values.buffer, values.byteOffset, values.byteLength)]);
}

/**
 * A person in AMASS's form, Z up, for a second of 20 frames: both thighs swing by up to 60° around the body's X axis, the left
 * one leading.
 * @param {number} joints 22, 24, 52 or 55.
 */
export function walkingPerson(joints) {
  const frames = 21;
  const poses = new Float64Array(frames * 3 * joints);
  const trans = new Float64Array(frames * 3);
  for (let frame = 0; frame < frames; frame++) {
    const swing = (Math.PI / 3) * Math.sin((Math.PI * frame) / (frames - 1));
    poses.set([Math.PI / 2, 0, 0, -swing, 0, 0, swing, 0, 0], frame * 3 * joints);
    trans.set([0, -0.05 * frame, 0.95], 3 * frame);
  }
  return archive({
    "poses.npy": npy([frames, 3 * joints], poses),
    "trans.npy": npy([frames, 3], trans),
    "mocap_framerate.npy": npy([], Float64Array.of(20)),
  });
}

/** Where the joints of HumanML3D's body are in a T-pose. */
const STANDING = [
  [0, 0.95, 0], [0.1, 0.86, 0], [-0.1, 0.86, 0], [0, 1.07, -0.02], [0.1, 0.46, 0], [-0.1, 0.46, 0], [0, 1.2, 0], [0.1, 0.05, -0.03],
  [-0.1, 0.05, -0.03], [0, 1.26, 0], [0.1, 0, 0.1], [-0.1, 0, 0.1], [0, 1.46, -0.02], [0.08, 1.38, 0], [-0.08, 1.38, 0], [0, 1.56, 0.02],
  [0.18, 1.4, 0], [-0.18, 1.4, 0], [0.45, 1.4, 0], [-0.45, 1.4, 0], [0.7, 1.4, 0], [-0.7, 1.4, 0],
];

/** Positions alone, as MDM has them: joints × 3 × frames. Both legs swing by up to 60° from the hips, the left one leading. */
export function walkingPositions() {
  const frames = 21;
  const values = new Float64Array(22 * 3 * frames);
  for (let frame = 0; frame < frames; frame++) {
    const swing = (Math.PI / 3) * Math.sin((Math.PI * frame) / (frames - 1));
    for (const [joint, [x, y, z]] of STANDING.entries()) {
      const leg = [4, 7, 10].includes(joint) ? -1 : [5, 8, 11].includes(joint) ? 1 : 0;
      const [sin, cos] = [Math.sin(leg * swing), Math.cos(leg * swing)];
      const hip = leg === 0 ? 0 : 0.86;
      const at = [x, hip + cos * (y - hip) - sin * z, sin * (y - hip) + cos * z + 0.05 * frame];
      at.forEach((value, axis) => (values[(3 * joint + axis) * frames + frame] = value));
    }
  }
  return npy([22, 3, frames], values);
}

/** An archive with a Python object, `None`, in place of numbers. */
export const PICKLED = archive({ "poses.npy": npy([], Buffer.from("\x80\x04N.", "latin1"), "|O") });
