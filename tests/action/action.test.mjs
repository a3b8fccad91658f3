// The step of action.yml in a repository with models, as GitHub would run it: annotations, the summary, pictures, and what fails.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, beforeEach, describe, test } from "node:test";
import { fileURLToPath } from "node:url";

const ROOT = fileURLToPath(new URL("../..", import.meta.url));
const SCRIPT = path.join(ROOT, ".github/action/check.mjs");
const CLI = process.env.GAITWAY_CLI ?? path.join(ROOT, "target/debug/gaitway");
const WALK = path.join(ROOT, "assets/samples/walk.bvh");

/** A triangle whose buffer is a file of its own. */
const TRIANGLE = {
  asset: { version: "2.0" },
  scene: 0,
  scenes: [{ nodes: [0] }],
  nodes: [{ mesh: 0 }],
  meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
  accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] }],
  bufferViews: [{ buffer: 0, byteLength: 36 }],
  buffers: [{ uri: "triangle.bin", byteLength: 36 }],
};

/** @type {string} */
let folder;
/** @type {string} */
let repository;
/** @type {string} */
let base;
before(() => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-action-"));
  repository = path.join(folder, "repository");
  git(folder, "init", "--quiet", "--bare", "origin.git");
  git(folder, "init", "--quiet", "repository");
  git(repository, "remote", "add", "origin", "../origin.git");
  write("models/triangle.gltf", JSON.stringify(TRIANGLE));
  write("models/triangle.bin", new Uint8Array(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer));
  write("old, and fine.bvh", fs.readFileSync(WALK));
  write("notes.txt", "no model");
  base = commit();
  // A warning, and a file beside a model that changed alone.
  write("Moved.BVH", fs.readFileSync(WALK, "utf8").replace(/Frames: .*/, "Frames: 9999"));
  write("models/triangle.bin", new Uint8Array(new Float32Array([0, 0, 0, 2, 0, 0, 0, 1, 0]).buffer));
  commit();
});
beforeEach(() => fs.rmSync(path.join(folder, "pictures"), { recursive: true, force: true }));
after(() => fs.rmSync(folder, { recursive: true, force: true }));

/** @param {string} file @param {string | Uint8Array} content */
function write(file, content) {
  fs.mkdirSync(path.dirname(path.join(repository, file)), { recursive: true });
  fs.writeFileSync(path.join(repository, file), content);
}

/** @param {string} where @param {...string} args */
function git(where, ...args) {
  return execFileSync("git", ["-c", "user.name=Test", "-c", "user.email=test@example.org", ...args], { cwd: where, encoding: "utf8" }).trim();
}

function commit() {
  git(repository, "add", "--all");
  git(repository, "commit", "--quiet", "--message", "models");
  return git(repository, "rev-parse", "HEAD");
}

/** @param {Record<string, string>} inputs */
function action(inputs) {
  const files = { GITHUB_STEP_SUMMARY: path.join(folder, "summary.md"), GITHUB_OUTPUT: path.join(folder, "output") };
  for (const file of Object.values(files)) fs.rmSync(file, { force: true });
  const variables = { GAITWAY: CLI, FILES: "*.gltf\n*.bvh\n", IGNORE: "unit-guessed", BASE: base, PICTURES_FOLDER: path.join(folder, "pictures"), ...files };
  const place = { GITHUB_SERVER_URL: "https://example.org", GITHUB_REPOSITORY: "someone/models", GITHUB_SHA: "0123abc" };
  const options = { cwd: repository, encoding: /** @type {const} */ ("utf8"), env: { ...process.env, ...variables, ...place, ...inputs } };
  const { status, stdout, stderr } = spawnSync(process.execPath, [SCRIPT], options);
  const read = (/** @type {string} */ file) => (fs.existsSync(file) ? fs.readFileSync(file, "utf8") : "");
  return { status, stdout, stderr, summary: read(files.GITHUB_STEP_SUMMARY), output: read(files.GITHUB_OUTPUT) };
}

function pictures() {
  const all = fs.readdirSync(path.join(folder, "pictures"), { recursive: true, encoding: "utf8" });
  return all.filter((name) => name.endsWith(".png")).map((name) => name.split(path.sep).join("/")).sort();
}

describe("action.yml", () => {
  test("warnings are annotations, and only models that changed are drawn", () => {
    const { status, stdout, stderr, summary, output } = action({});
    assert.equal(status, 0, stdout + stderr);
    assert.match(stdout, /^::warning file=Moved\.BVH,line=\d+,title=bvh-motion::.*9999/m);
    assert.doesNotMatch(stdout, /^::error/m);
    assert.deepEqual(pictures(), ["Moved.BVH.png", "models/triangle.gltf.png"]);
    assert.match(output, /^errors=0\nwarnings=1\npictures=2\n$/);
    assert.match(summary, /<td>old, and fine\.bvh<\/td>/);
    assert.match(summary, /<td>models\/triangle\.gltf<\/td><td>1<\/td>/);
    assert.doesNotMatch(summary, /<img/);
  });

  test("a finding fails if it is asked to", () => {
    assert.equal(action({ FAIL_ON: "warning", PICTURES: "none" }).status, 1);
  });

  test("with a branch, the summary shows what was pushed", () => {
    const inputs = { PICTURES_BRANCH: "pictures", FILES: "*.gltf" };
    for (const count of [1, 2]) {
      const { status, stdout, stderr, summary } = action(inputs);
      assert.equal(status, 0, stdout + stderr);
      const sha = git(path.join(folder, "origin.git"), "rev-parse", "pictures");
      assert.ok(summary.includes(`<img src="https://example.org/someone/models/raw/${sha}/models/triangle.gltf.png"`), summary + stdout);
      assert.equal(git(path.join(folder, "origin.git"), "ls-tree", "-r", "--name-only", sha), "models/triangle.gltf.png");
      assert.equal(git(path.join(folder, "origin.git"), "rev-list", "--count", sha), String(count));
    }
    assert.equal(git(repository, "status", "--porcelain"), "");
  });

  test("a branch that can't be pushed is a warning", () => {
    const { status, stdout, summary } = action({ PICTURES_BRANCH: "not..a-branch", FILES: "*.gltf" });
    assert.equal(status, 0);
    assert.match(stdout, /^::warning title=Pictures::couldn't push/m);
    assert.doesNotMatch(summary, /<img/);
  });

  test("a file that can't be read fails and is named, whatever it is called", () => {
    const name = "a <b>,%.gltf";
    write(name, JSON.stringify(TRIANGLE));
    git(repository, "add", "--all");
    try {
      const { status, stdout, summary } = action({ PICTURES: "none" });
      assert.equal(status, 1);
      assert.match(stdout, /^::error file=a <b>%2C%25\.gltf,title=Can't be read::.*triangle\.bin/m);
      assert.match(summary, /<td>a &lt;b&gt;,%\.gltf<\/td>.*can't be read/);
      assert.equal(action({ PICTURES: "none", FAIL_ON: "never" }).status, 0);
    } finally {
      git(repository, "rm", "--quiet", "--force", "--", name);
    }
  });

  test("wrong inputs are named", () => {
    for (const [input, message] of /** @type {const} */ ([[{ FAIL_ON: "x" }, "fail-on: expected error"], [{ FILES: " \n" }, "files: expected"], [{ GAITWAY: "/nowhere" }, "ENOENT"]])) {
      const { status, stdout } = action(input);
      assert.equal(status, 1);
      assert.ok(stdout.includes(message) && stdout.startsWith("::error"), stdout);
    }
  });
});
