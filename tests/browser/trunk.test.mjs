// Trunk.toml's hook, called as trunk calls it: the page is the one that xtask has built, and reloads itself if trunk asks for that.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { test } from "node:test";
import { serve } from "../../xtask/site/server.mjs";
import { dist, repository } from "../three/data.mjs";
import { launch, watched } from "./browser.mjs";

/** What trunk replaces in each answer. */
const NONCE = "{{__TRUNK NONCE__}}";
const SCRIPT = `<script nonce="${NONCE}">document.documentElement.dataset.reloads = "yes";</script>`;

/** @param {string} folder */
const filesIn = (folder) => fs.readdirSync(folder, { recursive: true, encoding: "utf8" }).filter((name) => fs.statSync(path.join(folder, name)).isFile()).sort();

/** @param {string} folder */
function callHook(folder) {
  const [, command, list] = /\[\[hooks\]\]\nstage = "post_build"\ncommand = "(\w+)"\ncommand_arguments = (\[.*\])/.exec(fs.readFileSync("Trunk.toml", "utf8")) ?? [];
  // A quick build has one program for both back ends. Nothing is compiled, since that page is there.
  const programs = filesIn(dist).flatMap((name) => /^web(?:gpu|gl2)-(\w+)\.wasm$/.exec(name)?.[1] ?? []);
  const profile = programs[0] === programs[1] ? "debug" : "release";
  const variables = { TRUNK_PROFILE: profile, TRUNK_STAGING_DIR: folder, TRUNK_PUBLIC_URL: "/" };
  execFileSync(command, JSON.parse(list), { cwd: repository, env: { ...process.env, ...variables }, stdio: ["ignore", "ignore", "inherit"] });
}

test("trunk serves and builds the page of xtask", async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-trunk-"));
  const index = path.join(folder, "index.html");
  fs.writeFileSync(index, fs.readFileSync("web/index.html", "utf8").replace("</body>", `${SCRIPT}</body>`));
  callHook(folder);
  assert.deepEqual(filesIn(folder), filesIn(dist));
  const differing = filesIn(dist).filter((name) => !fs.readFileSync(path.join(folder, name)).equals(fs.readFileSync(path.join(dist, name))));
  assert.deepEqual(differing.filter((name) => !/^(index\.html|sw\.js)(\.br|\.gz)?$/.test(name)), []);
  const html = fs.readFileSync(index, "utf8");
  assert.equal(html.replace(SCRIPT, "").replace(` 'nonce-${NONCE}'`, ""), fs.readFileSync(path.join(dist, "index.html"), "utf8"));

  fs.writeFileSync(index, html.replaceAll(NONCE, "bm9uY2U="));
  // Trunk doesn't serve them, and they still have the mark.
  for (const ending of [".br", ".gz"]) fs.rmSync(index + ending, { force: true });
  const site = await serve({ "/": folder });
  const browser = await launch();
  try {
    const page = watched(await browser.newPage());
    await page.goto(`${site.origin}/`, { waitUntil: "domcontentloaded" });
    assert.equal(await page.evaluate(() => document.documentElement.dataset.reloads), "yes", "the page's policy lets trunk's script run");
  } finally {
    await browser.close();
    await site.close();
    fs.rmSync(folder, { recursive: true });
  }
});
