// What the page makes of the Khronos validator's findings (web/validator).
import assert from "node:assert/strict";
import fs from "node:fs";
import { test } from "node:test";
import { MEANINGS } from "../../web/validator/meanings.js";
import { userOf } from "../../web/validator/places.js";
import { validate } from "../../web/validator/report.js";
import { BODY, LOWER, triangle } from "./triangle.mjs";

const NOTHING = { counts: [0, 0, 0, 0], isTruncated: false, groups: [] };
const WEIGHTS = "/meshes/0/primitives/0/attributes/WEIGHTS_0";

const unread = async () => assert.fail("there is nothing else to read");

/**
 * @param {unknown} document
 * @param {(uri: string) => Promise<Uint8Array>} readFile
 */
const report = (document, readFile = unread) => validate(new TextEncoder().encode(JSON.stringify(document)), readFile);

test("a valid file has no findings", async () => {
  assert.deepEqual(await report(triangle().document), NOTHING);
});

test("findings are grouped, errors first, and lead to what nodes use", async () => {
  const { document } = triangle({ weight: 0.5, turn: 2 });
  const { counts, groups } = await report({ ...document, extensionsUsed: ["EXT_unknown"], meshes: [{ ...document.meshes[0], odd: 1 }] });
  assert.deepEqual(counts, [2, 1, 1, 0]);
  const found = groups.map(({ severity, code, count, findings }) => [severity, code, count, findings.map(({ place }) => place)]);
  assert.deepEqual(found, [
    [0, "ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION", 1, [`/nodes/${LOWER}`]],
    [0, "ACCESSOR_WEIGHTS_NON_NORMALIZED", 1, [WEIGHTS]],
    [1, "UNEXPECTED_PROPERTY", 1, ["/meshes/0/odd"]],
    [2, "UNSUPPORTED_EXTENSION", 1, ["/extensionsUsed/0"]],
  ]);
  assert.match(groups[1].findings[0].text, new RegExp(`^${WEIGHTS}: .* sum: 0\\.5`));
});

test("codes are explained in plain words", async () => {
  const { groups } = await report(triangle({ weight: 0.5 }).document);
  assert.deepEqual(groups.map(({ code, meaning }) => [code, meaning]), [["ACCESSOR_WEIGHTS_NON_NORMALIZED", "Joint weights of a vertex don't add up to 1"]]);
  const listed = fs.readFileSync("node_modules/gltf-validator/ISSUES.md", "utf8");
  for (const [code, meaning] of Object.entries(MEANINGS)) {
    assert.ok(listed.includes(`|${code}|`), `the validator has no ${code}`);
    assert.match(meaning, /^[A-Z][^_]*[^.]$/, code);
  }
  const aboutCharacters = [...listed.matchAll(/^\|((?:SKIN|ANIMATION|NODE)_\w+)\|/gm)].map(([, code]) => code);
  assert.ok(aboutCharacters.length > 10);
  assert.deepEqual(aboutCharacters.filter((code) => !(code in MEANINGS)), [], "codes about skins, clips and nodes");
});

test("other files are read by their URIs, and a missing one is a finding", async () => {
  const { document, bytes } = triangle({ uri: "sub%20folder/a.bin" });
  /** @type {string[]} */
  const asked = [];
  const read = async (/** @type {string} */ uri) => {
    asked.push(uri);
    return new Uint8Array(bytes);
  };
  assert.deepEqual([await report(document, read), asked], [NOTHING, ["sub%20folder/a.bin"]]);
  const { groups } = await report(document, () => Promise.reject(new Error("not there")));
  assert.deepEqual(groups.map(({ code, findings }) => [code, findings[0].text]), [["IO_ERROR", "/buffers/0/uri: not there"]]);
});

test("long texts are cut, and of many findings with one code only the first are listed", async () => {
  const { document } = triangle();
  const nodes = [...document.nodes, ...Array.from({ length: 50 }, () => ({ odd: 1 }))];
  const images = [{ uri: `data:image/none;base64,${"A".repeat(5000)}!` }];
  const { groups } = await report({ ...document, nodes, images });
  const odd = groups.find(({ code }) => code === "UNEXPECTED_PROPERTY");
  assert.deepEqual([odd?.count, odd?.findings.length, odd?.findings[0].place], [50, 20, `/nodes/${BODY + 1}/odd`]);
  assert.ok(groups.flatMap(({ findings }) => findings).every(({ text }) => text.length < 400));
});

test("a broken container has findings by byte, and bytes that are not glTF are an error", async () => {
  const header = new Uint8Array(new Uint32Array([0x46546c67, 2, 12]).buffer);
  const { counts, groups } = await validate(header, unread);
  assert.ok(counts[0] > 0);
  assert.match(groups[0].findings[0].text, /^byte \d+: /);
  await assert.rejects(validate(new Uint8Array([1, 2, 3]), unread), (error) => /could not detect/.test(String(error)));
});

test("a place leads to a node, or to what nodes use", () => {
  const { document } = triangle();
  const [mesh] = document.meshes;
  const whole = {
    ...document,
    nodes: [...document.nodes, { camera: 1 }],
    cameras: [{}, {}],
    meshes: [mesh, { primitives: [{ attributes: {}, indices: 6, targets: [{ POSITION: 7 }], material: 8 }] }],
    accessors: [...document.accessors, { bufferView: 5 }, {}],
    images: [{}, { bufferView: 6 }],
    samplers: [{}, {}],
    textures: [{ source: 0 }, { sampler: 1, extensions: { KHR_texture_basisu: { source: 1 } } }],
    materials: [{}, { extensions: { KHR_materials_sheen: { sheenColorTexture: { index: 1 } } } }],
    animations: [
      ...document.animations,
      { samplers: [{}], channels: [{ sampler: 0, target: { extensions: { KHR_animation_pointer: { pointer: "/materials/1/alphaCutoff" } } } }] },
      { channels: [{ target: { extensions: { KHR_animation_pointer: { pointer: "/animations/2" } } } }] },
    ],
  };
  const sheen = "/materials/1/extensions/KHR_materials_sheen/sheenColorTexture/index";
  for (const [place, expected] of Object.entries({
    "/accessors/0/max": "/meshes/0/primitives/0/attributes/POSITION",
    "/accessors/3": "/skins/0/inverseBindMatrices",
    "/accessors/5/count": `/nodes/${LOWER}`,
    "/accessors/6": "/meshes/1/primitives/0/indices",
    "/accessors/7": "/meshes/1/primitives/0/targets/0/POSITION",
    "/accessors/8": "/accessors/8",
    "/bufferViews/1/byteLength": WEIGHTS,
    "/bufferViews/5": "/meshes/1/primitives/0/indices",
    "/bufferViews/6": sheen,
    "/images/1": sheen,
    "/images/0": "/textures/0/source",
    "/samplers/1/wrapS": sheen,
    "/textures/1": sheen,
    "/cameras/1": "/nodes/3/camera",
    "/animations/0": `/nodes/${LOWER}`,
    "/animations/0/samplers/0/output": `/nodes/${LOWER}`,
    "/animations/0/channels/0/target/path": `/nodes/${LOWER}`,
    "/animations/1/channels/0": "/materials/1/alphaCutoff",
    "/animations/2/channels/0": "/animations/2/channels/0",
    "/animations/9/channels/0": "/animations/9/channels/0",
    "/nodes/2/scale": "/nodes/2/scale",
    "/meshes/0/name": "/meshes/0/name",
    "/extensionsUsed/0": "/extensionsUsed/0",
    "": "",
  }))
    assert.equal(userOf(whole, place), expected, place);
  assert.equal(userOf(null, "/accessors/0"), "/accessors/0");
});
