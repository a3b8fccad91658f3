// Validates a glTF file with the Khronos validator, and finds the object that leads to the node of each finding.
import { validateBytes } from "gltf-validator";
import { MEANINGS } from "./meanings.js";
import { userOf } from "./places.js";

/** @typedef {import("gltf-validator").Issue} Issue */

/**
 * As `ValidatorReport` in crates/scene/src/editor/validation.rs reads it.
 * @typedef {object} Report
 * @property {number[]} counts Of errors, warnings, infos and hints.
 * @property {boolean} isTruncated The validator stopped at its limit.
 * @property {Group[]} groups Errors first.
 */

/**
 * The findings with one code, of which only the first are listed. `meaning` is the code in plain words, or empty; `place` is a
 * JSON pointer.
 * @typedef {{ severity: number, code: string, meaning: string, count: number, findings: { text: string, place: string }[] }} Group
 */

/** The validator stops at this many findings, so that a broken file can't exhaust memory. */
const MAX_FINDINGS = 20_000;
const MAX_LISTED = 20;
/** Messages quote URIs, which may be data. */
const MAX_LETTERS = 300;

/**
 * @param {Uint8Array} bytes A .gltf or .glb.
 * @param {(uri: string) => Promise<Uint8Array>} readFile Reads a file that it refers to.
 * @returns {Promise<Report>}
 */
export async function validate(bytes, readFile) {
  const { issues } = await validateBytes(bytes, { maxIssues: MAX_FINDINGS, externalResourceFunction: readFile });
  const document = json(bytes);
  /** @type {Map<string, Group>} */
  const groups = new Map();
  for (const issue of issues.messages) {
    const { severity, code, pointer = "" } = issue;
    const group = groups.get(`${severity} ${code}`) ?? { severity, code, meaning: MEANINGS[code] ?? "", count: 0, findings: [] };
    groups.set(`${severity} ${code}`, group);
    group.count += 1;
    if (group.count <= MAX_LISTED) group.findings.push({ text: text(issue), place: wellFormed(userOf(document, pointer)) });
  }
  return {
    counts: [issues.numErrors, issues.numWarnings, issues.numInfos, issues.numHints],
    isTruncated: issues.truncated,
    groups: [...groups.values()].sort((a, b) => a.severity - b.severity),
  };
}

/** @param {Issue} issue */
function text({ message, pointer, offset }) {
  // An error of `readFile`; the validator takes any script for Node's.
  const whole = message.replace(/^Node Exception: (Error: )?/, "");
  const cut = whole.length > MAX_LETTERS ? `${whole.slice(0, MAX_LETTERS)}…` : whole;
  const where = pointer || (offset === undefined ? "" : `byte ${offset}`);
  return wellFormed(where === "" ? cut : `${where}: ${cut}`);
}

/**
 * Replaces halves of surrogate pairs, which aren't JSON for the app.
 * @param {string} text
 */
const wellFormed = (text) => text.replace(/\p{Surrogate}/gu, "\uFFFD");

const GLB_MAGIC = 0x46546c67;
const GLB_HEADER_BYTES = 20;

/**
 * Returns the JSON of a .gltf or .glb; null if it is broken.
 * @param {Uint8Array} bytes
 */
function json(bytes) {
  try {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const isGlb = view.getUint32(0, true) === GLB_MAGIC;
    const range = isGlb ? bytes.subarray(GLB_HEADER_BYTES, GLB_HEADER_BYTES + view.getUint32(12, true)) : bytes;
    return JSON.parse(new TextDecoder().decode(range));
  } catch {
    return null;
  }
}
