// A reporter for Node's tests that prints which failed, with what error, and how long each file took, the longest first.
import path from "node:path";
import { repository } from "./three/data.mjs";

/** @param {AsyncIterable<import("node:test/reporters").TestEvent>} events */
export default async function* times(events) {
  /** @type {Map<string, number>} */
  const millis = new Map();
  /** @type {string[]} */
  const failures = [];
  for await (const { type, data } of events) {
    // Suites fail for what is in them.
    if (type === "test:fail" && data.details.type !== "suite") {
      const { error } = data.details;
      const { stack = error.message } = error.cause instanceof Error ? error.cause : error;
      const lines = stack.split("\n").filter((line) => !/^ +at .*node:/.test(line));
      failures.push([`${data.file && path.relative(repository, data.file)}: ${data.name}`, ...lines].join("\n    "));
    }
    // Suites and tests at a file's top level, which include everything nested.
    if ((type !== "test:pass" && type !== "test:fail") || data.nesting > 0 || data.file === undefined) continue;
    const file = path.relative(repository, data.file);
    millis.set(file, (millis.get(file) ?? 0) + data.details.duration_ms);
  }
  if (failures.length > 0) yield `\nFailed:\n  ${failures.join("\n  ")}\n`;
  yield "\nWhere the time of Node's tests went:\n";
  for (const [file, took] of [...millis].sort(([, a], [, b]) => b - a)) yield `${(took / 1000).toFixed(1).padStart(8)} s  ${file}\n`;
}
