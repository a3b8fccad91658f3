// What still.js finds in a link before the program has loaded. No browser: the script runs against stubs.
import assert from "node:assert/strict";
import fs from "node:fs";
import { test } from "node:test";
import vm from "node:vm";

const script = fs.readFileSync("web/still.js", "utf8");
/** @type {{ link: string, models: string[], samples: string[] }[]} */
const cases = JSON.parse(fs.readFileSync("crates/scene/tests/scene/early.json", "utf8"));
const names = [...new Set(cases.flatMap(({ samples }) => samples))];

/**
 * Returns a link's cover image, and the files preloaded before and after part of the program has arrived.
 * @param {string} link
 */
function early(link) {
  const still = {
    hidden: false,
    src: "",
    dataset: { images: JSON.stringify(Object.fromEntries(names.map((name) => [`sample:${name}`, `${name}.webp`]))), link: "model=sample:pilot" },
    getAttribute: () => still.src,
  };
  /** @type {Record<string, () => void>} */
  const listeners = {};
  /** @type {string[]} */
  const files = [];
  // A page of its own, not a frame.
  const window = {};
  vm.runInNewContext(script, {
    window,
    parent: window,
    document: {
      getElementById: () => still,
      querySelector: () => ({ content: JSON.stringify(Object.fromEntries(names.map((name) => [name, [name]]))) }),
      createElement: () => ({}),
      head: { append: (/** @type {{ href: string }[]} */ ...links) => files.push(...links.map(({ href }) => href)) },
    },
    location: { hash: link === "" ? "" : `#${link}` },
    addEventListener: (/** @type {string} */ name, /** @type {() => void} */ listener) => (listeners[name] = listener),
    URL,
  });
  const samples = files.splice(0);
  listeners["gaitway:part-loaded"]();
  return { image: still.hidden ? null : still.src, samples, models: files };
}

test("the script that runs first finds what the program will load", () => {
  for (const { link, models, samples } of cases) {
    const found = early(link);
    assert.deepEqual(found.samples.sort(), link === "" ? ["pilot"] : samples, link);
    assert.deepEqual(found.models, models.filter((model) => model.startsWith("https:")), link);
    const [model, other] = link === "" ? ["sample:pilot"] : models;
    const isKnown = other === undefined && model?.startsWith("sample:");
    assert.equal(found.image, isKnown ? `${model.slice("sample:".length)}.webp` : null, link);
  }
});

test("a link can't have it load any number of files", () => {
  const models = Array.from({ length: 1000 }, (_, index) => `https://a.example/${index}.glb`);
  assert.deepEqual(early(models.map((model) => `model=${model}`).join("&")).models, models.slice(0, 8));
});
