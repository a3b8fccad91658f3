// The link on the page: shared and opened elsewhere, parts that cannot be had, back and forward, and the page inside another
// one, which never gets to know what a person dropped.
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import { dataFolder, skipWithoutData } from "../three/data.mjs";
import { archive } from "./archive.mjs";
import { BACK_ENDS, apply, drop, fragment, meanDifference, open, picture, pose, share, startSite, state, until, whenShown } from "./browser.mjs";
import { neverAnswers, serve } from "./server.mjs";

const FOX = "khronos/Fox/glTF-Binary/Fox.glb";
const FOX_VERTICES = 1728;
const CESIUM_MAN = "khronos/CesiumMan/glTF-Binary/CesiumMan.glb";
const CESIUM_MAN_VERTICES = 3273;
const XBOT = "threejs/Xbot.glb";
const DANCE = "bvh/cosc422_Dance.bvh";
/** Nothing listens there: browsers refuse to ask some ports, this is none of those. */
const CLOSED = "http://127.0.0.1:9";

const missing = (page) => page.locator("#missing-parts li").allInnerTexts();
const whenMissing = (page) => page.locator("#missing").waitFor({ state: "visible" });
const linkOf = (page) => page.locator("#share-link").inputValue();

/** Waits until this is the model that is shown. */
const whenModel = (page, name) => until(page, async (name) => (await window.gaitway.state()).model.join() === name, name);

for (const renderer of BACK_ENDS)
  describe(`link on ${renderer}`, { skip: skipWithoutData }, () => {
    let site, strict, own, silent, folder;
    before(async () => {
      site = await startSite();
      // Its files are for its own pages alone.
      strict = await serve({ "/": dataFolder });
      silent = await neverAnswers();
      folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-link-"));
      own = await serve({ "/": folder }, { "access-control-allow-origin": "*" });
    });
    after(async () => {
      await site?.close();
      await strict?.close();
      await silent?.close();
      await own?.close();
      if (folder !== undefined) fs.rmSync(folder, { recursive: true });
    });

    const onPage = (name, link, body) =>
      test(name, async () => {
        const page = await site.page({ renderer, link: link() });
        try {
          await body(page);
        } finally {
          await page.finish();
        }
      });

    onPage(
      "names the reason for each part that cannot be had and shows the rest",
      () =>
        fragment([
          ["model", site.data(FOX)],
          ["motion", site.data("bvh/nothing-here.bvh")],
          ["motion", `${strict.origin}/${DANCE}`],
          ["motion", `${CLOSED}/walk.bvh`],
          ["motion", site.data("README.md")],
          ["map", site.data("map-of-nothing.json")],
          ["clip", "Run"],
        ]),
      async (page) => {
        await whenMissing(page);
        const [status, refused, unreachable, unsupported, map, ...others] = await missing(page);
        assert.match(status, /nothing-here\.bvh: .*404.*no such file/);
        assert.match(refused, /cosc422_Dance\.bvh: the site is there.*CORS.*no such file/);
        assert.match(unreachable, /127\.0\.0\.1:9\/walk\.bvh: the site cannot be reached/);
        assert.match(unsupported, /README\.md/);
        assert.match(unsupported, /\.glb/, "what could be read instead");
        assert.match(map, /map-of-nothing\.json: .*404/);
        assert.deepEqual(others, []);
        assert.match(await page.locator("#problem").textContent(), /nothing-here\.bvh/);
        await page.locator("#missing").getByRole("button", { name: "Go on" }).click();
        const { clip, meshes } = await pose(page);
        assert.equal(clip, "Run");
        assert.equal(meshes[0].positions.length, 3 * FOX_VERTICES);
        // Nothing has been set: trying again by reloading is possible.
        assert.match(page.url(), /map-of-nothing/);
      },
    );

    onPage("does not wait for a site that never answers", () => fragment([["model", site.data(FOX)], ["motion", `${silent.origin}/walk.bvh`]]), async (page) => {
      await whenMissing(page);
      assert.match((await missing(page)).join(), /walk\.bvh: nothing has come from the site for 20 seconds/);
      assert.equal((await pose(page)).meshes[0].positions.length, 3 * FOX_VERTICES);
    });

    onPage("shows the motion's own skeleton when the model cannot be had", () => fragment([["model", `${CLOSED}/a.glb`], ["motion", site.data(DANCE)], ["embed", "1"]]), async (page) => {
      await whenMissing(page);
      assert.match((await missing(page)).join(), /^http:\/\/127\.0\.0\.1:9\/a\.glb: the site cannot be reached[^,]*$/);
      const { model, embed } = await state(page);
      assert.deepEqual(model, [site.data(DANCE)]);
      assert.equal(embed, true);
    });

    onPage("tries again", () => fragment([["model", `${own.origin}/late.glb`], ["clip", "Run"], ["t", 0.5], ["play", 0]]), async (page) => {
      await whenMissing(page);
      const again = page.locator("#missing-again");
      await again.click();
      await whenMissing(page);
      fs.copyFileSync(path.join(dataFolder, FOX), path.join(folder, "late.glb"));
      await again.click();
      await whenShown(page, FOX_VERTICES);
      const { clip, time_secs } = await pose(page);
      assert.deepEqual([clip, time_secs], ["Run", 0.5]);
      assert.equal(await page.locator("#missing").isVisible(), false);
      fs.rmSync(path.join(folder, "late.glb"));
    });

    onPage("takes a page of GitHub for the file that it shows", () => "", async (page) => {
      await page.route("https://raw.githubusercontent.com/**", (route) =>
        route.fulfill({ path: path.join(dataFolder, FOX), headers: { "access-control-allow-origin": "*" } }),
      );
      await page.locator("#do-open").focus();
      await page.keyboard.press("Enter");
      await page.locator("#open-url").fill("https://github.com/someone/models/blob/main/a%20fox/Fox.glb?raw=true");
      await page.keyboard.press("Enter");
      await whenShown(page, FOX_VERTICES);
      assert.ok(page.requests.includes("https://raw.githubusercontent.com/someone/models/main/a%20fox/Fox.glb"), page.requests.join("\n"));
      assert.match(await page.locator("#news").textContent(), /3 clips/);
    });

    onPage("is the same scene in another browser", () => fragment([["model", site.data(XBOT)]]), async (page) => {
      await open(page, site.data(DANCE));
      await apply(page, { t: 1.25, play: 0, camera: "30,10,4,0,1,0", show: "skeleton", root: "in-place", feet: "plant", speed: 0.5, exposure: 0.5 });
      await share(page);
      assert.equal(await page.locator("#share-local").isVisible(), false);
      assert.equal(await page.locator("#share-qr svg").count(), 1);
      const link = await linkOf(page);
      assert.ok(!link.includes("renderer"), link);
      const snippet = await page.locator("#share-frame").inputValue();
      assert.match(snippet, /^<iframe src="http:.*&amp;embed=1"/);
      await page.locator("#share-close").click();
      const shown = [await state(page), await pose(page), await picture(page)];
      const other = await site.page({ renderer, link: link.split("#")[1] });
      try {
        assert.deepEqual(await state(other), shown[0]);
        assert.deepEqual(await pose(other), shown[1]);
        assert.equal(meanDifference(await picture(other), shown[2]), 0);
      } finally {
        await other.finish();
      }
    });

    onPage("says which parts a link cannot carry", () => fragment([["model", site.data(XBOT)]]), async (page) => {
      await drop(page, [{ name: "dance.bvh", url: site.data(DANCE) }]);
      await until(page, async () => (await window.gaitway.state()).motion.length === 1);
      await apply(page, { play: 0, t: 1 });
      await share(page);
      assert.match(await page.locator("#share-local").innerText(), /dance\.bvh \(motion\)/);
      // The code is there when it is asked for.
      assert.equal(await page.locator("#share-qr svg").isVisible(), false);
      await page.locator("#share-code summary").click();
      assert.equal(await page.locator("#share-qr svg").isVisible(), true);
      const link = await linkOf(page);
      assert.ok(link.includes("Xbot.glb") && link.includes("motion=file:dance.bvh"), link);
      await page.locator("#share-close").click();
      // The address bar keeps to the same.
      await until(page, () => location.hash.includes("t=1"));
      assert.ok(page.url().includes("motion=file:dance.bvh"), page.url());
    });

    onPage("says when a link is too long for a QR code", () => `model=sample:walker&whatever=${"x".repeat(3000)}`, async (page) => {
      await share(page);
      assert.match(await page.locator("#share-no-qr").innerText(), /\d{4} characters: too long for a QR code/);
      assert.equal(await page.locator("#share-qr svg").count(), 0);
    });

    /** Two models in one file, of which the fox is the first. */
    const TWO = () => archive({ "a/fox.glb": fs.readFileSync(path.join(dataFolder, FOX)), "b/man.glb": fs.readFileSync(path.join(dataFolder, CESIUM_MAN)) });

    onPage("names one of the models of an archive", () => (fs.writeFileSync(path.join(folder, "two.zip"), TWO()), fragment([["model", `${own.origin}/two.zip#!/b/man.glb`]])), async (page) => {
      await whenShown(page, CESIUM_MAN_VERTICES);
      assert.deepEqual((await state(page)).model, [`${own.origin}/two.zip#!/b/man.glb`]);
      await page.goto(page.url().replace("man.glb", "gone.glb"));
      await page.reload();
      await whenMissing(page);
      assert.match((await missing(page)).join(), /two\.zip#!\/b\/gone\.glb: there is no such model in this file; its first one is shown/);
      await whenShown(page, FOX_VERTICES);
      // As an address that is opened, too.
      await page.locator("#missing").press("Escape");
      await open(page, `${own.origin}/two.zip#!/b/man.glb`);
      await whenShown(page, CESIUM_MAN_VERTICES);
    });

    onPage("waits for an archive that is to be brought and shows its model", () => fragment([["model", "file:two.zip#!/b/man.glb"], ["t", 0.5], ["play", 0]]), async (page) => {
      fs.writeFileSync(path.join(folder, "two.zip"), TWO());
      assert.match(await page.locator("#bring-files").innerText(), /^two\.zip \(the model\)$/);
      await page.keyboard.press("Escape");
      await drop(page, [{ name: "two.zip", url: `${own.origin}/two.zip` }]);
      await whenShown(page, CESIUM_MAN_VERTICES);
      assert.deepEqual([(await state(page)).model, (await state(page)).t], [["two.zip#!/b/man.glb"], 0.5]);
      await share(page);
      assert.match(await page.locator("#share-local").innerText(), /two\.zip \(the model\)/);
      assert.ok((await linkOf(page)).includes("model=file:two.zip%23!%2Fb%2Fman.glb"), await linkOf(page));
    });

    onPage("goes back and forward through models, dropped ones too", () => fragment([["model", site.data(FOX)]]), async (page) => {
      const entries = () => page.evaluate(() => history.length);
      await apply(page, { clip: "Run", t: 0.25, play: 0 });
      await until(page, () => location.hash.includes("clip=Run"));
      const before = await entries();
      await drop(page, [{ name: "CesiumMan.glb", url: site.data(CESIUM_MAN) }]);
      await whenShown(page, CESIUM_MAN_VERTICES);
      await apply(page, { t: 0.75, play: 0, exposure: 1 });
      await until(page, () => location.hash.includes("exposure=1"));
      assert.equal(await entries(), before + 1, "one model, one entry; what is set belongs to it");
      await open(page, site.data(XBOT));
      await until(page, () => location.hash.includes("Xbot"));
      assert.equal(await entries(), before + 2);

      await page.goBack();
      await whenShown(page, CESIUM_MAN_VERTICES);
      await until(page, async () => (await window.gaitway.state()).t === 0.75);
      await page.goBack();
      await whenShown(page, FOX_VERTICES);
      await until(page, async () => (await window.gaitway.pose()).clip === "Run");
      assert.equal((await pose(page)).time_secs, 0.25);
      await page.goForward();
      await whenShown(page, CESIUM_MAN_VERTICES);
      await page.goForward();
      await whenModel(page, site.data(XBOT));
      assert.equal(await entries(), before + 2);
      assert.deepEqual(page.troubles, []);
    });

    onPage("follows another link in the address bar", () => fragment([["model", site.data(FOX)]]), async (page) => {
      await page.evaluate((hash) => (location.hash = hash), fragment([["model", site.data(CESIUM_MAN)], ["t", 0.5], ["play", 0]]));
      await whenShown(page, CESIUM_MAN_VERTICES);
      assert.equal((await pose(page)).time_secs, 0.5);
      await page.evaluate((hash) => (location.hash = hash), fragment([["model", site.data("nothing.glb")]]));
      await whenMissing(page);
      assert.match((await missing(page)).join(), /nothing\.glb: .*404/);
      await page.locator("#missing").getByRole("button", { name: "Go on" }).click();
      assert.equal((await pose(page)).meshes[0].positions.length, 3 * CESIUM_MAN_VERTICES, "what was shown stays");
      await page.goBack();
      await page.goBack();
      await whenShown(page, FOX_VERTICES);
    });

    test("answers the page around it, but tells it nothing of dropped files", async () => {
      fs.writeFileSync(path.join(folder, "index.html"), AROUND);
      const context = await site.browser.newContext({ viewport: { width: 700, height: 500 } });
      try {
        const page = await context.newPage();
        page.setDefaultTimeout(60_000);
        const inside = `${site.address}?renderer=${renderer}#${fragment([["model", site.data(FOX)], ["embed", 1], ["play", 0]])}`;
        await page.goto(`${own.origin}/#${encodeURIComponent(inside)}`);
        const call = (...request) => page.evaluate((request) => window.call(...request), request);
        await call("ready");
        const frame = page.frames().find((frame) => frame.url().startsWith(site.address));
        assert.notEqual(new URL(frame.url()).origin, own.origin);

        const { embed, model } = (await call("state")).result;
        assert.deepEqual([embed, model], [true, [site.data(FOX)]]);
        assert.equal((await call("apply", { clip: "Run", t: 0.5 })).error, undefined);
        const { result } = await call("pose");
        assert.deepEqual([result.clip, result.time_secs, result.meshes[0].positions.length], ["Run", 0.5, 3 * FOX_VERTICES]);
        assert.equal((await call("stats")).result.backend, renderer);
        assert.ok((await call("screenshot")).result > 1000, "bytes of a PNG");
        assert.match((await call("apply", { speed: "quickly" })).error, /speed/);
        assert.match((await call("destroy")).error, /there is no such call/);
        assert.match((await call("open", [site.data("nothing.glb")])).error, /404/);
        assert.equal((await call("open", site.data(CESIUM_MAN))).result.vertices, CESIUM_MAN_VERTICES);
        await page.waitForFunction(() => window.events.includes("ready") && window.events.includes("change"));
        // Another frame on the page is not the page around.
        assert.equal(await page.evaluate(() => window.askFromAside("state")), "no answer");

        await drop(frame, [{ name: "Mine.glb", url: site.data(FOX) }]);
        await whenShown(frame, FOX_VERTICES);
        const nothing = { result: undefined, error: undefined };
        const withheld = async () => {
          for (const name of ["state", "pose", "stats", "screenshot"]) {
            const { result, error } = await call(name);
            assert.equal(result, undefined, name);
            assert.match(error, /withheld/, name);
          }
        };
        await withheld();
        assert.deepEqual(await call("apply", { play: 0, exposure: 1 }), nothing);
        assert.match((await call("apply", { clip: "x", speed: "quickly" })).error, /^withheld/);
        // Asking for what is shown by its name gives nothing away either, and neither does the address.
        assert.deepEqual(await call("apply", { model: ["Mine.glb"], motion: [] }), nothing);
        await withheld();
        await page.evaluate((address) => (document.querySelector("iframe").src = address), `${inside.split("#")[0]}#model=Mine.glb&embed=1`);
        await page.waitForTimeout(1000);
        await withheld();
        // A joint map and motion of the person's own stay theirs beside another model.
        await call("open", site.data(XBOT));
        assert.equal((await call("state")).result.model[0], site.data(XBOT), "nothing of the person's is left");
        await drop(frame, [{ name: "mine.bvh", url: site.data(DANCE) }]);
        await until(frame, async () => (await window.gaitway.state()).motion.includes("mine.bvh"));
        await withheld();
        assert.deepEqual(await call("open", site.data(XBOT)), nothing);
        await withheld();
        // Files that come from the page around are its own anyway.
        assert.equal((await page.evaluate((url) => window.openBytes("Fox.glb", url), site.data(FOX))).error, undefined);
        await call("apply", { motion: [] });
        assert.equal((await call("pose")).result.meshes[0].positions.length, 3 * FOX_VERTICES);
      } finally {
        await context.close();
      }
    });
  });

/** A page with Gaitway in a frame, and another frame beside it. The address of the frame is behind the `#`. */
const AROUND = `<!doctype html>
<title>A page about a fox</title>
<iframe width="640" height="440"></iframe>
<iframe id="aside" srcdoc="<p>aside</p>"></iframe>
<script>
  const frame = document.querySelector("iframe");
  const waiting = new Map();
  window.events = [];
  addEventListener("message", async ({ data, source }) => {
    if (source !== frame.contentWindow || data?.gaitway !== 1) return;
    if (data.event !== undefined) return void window.events.push(data.event);
    const { result, error } = data;
    // What Playwright carries over has to be plain.
    waiting.get(data.id)?.({ result: result instanceof Blob ? result.size : result, error });
  });
  let last = 0;
  const post = (call, given) =>
    new Promise((resolve) => {
      last += 1;
      waiting.set(last, resolve);
      frame.contentWindow.postMessage({ gaitway: 1, id: last, call, arguments: given }, "*");
    });
  const started = new Promise((resolve) => frame.addEventListener("load", resolve, { once: true }));
  window.call = async (call, ...given) => (await started, await post(call, given));
  window.openBytes = async (name, url) => await post("open", [{ [name]: await (await fetch(url)).arrayBuffer() }]);
  window.askFromAside = (call) =>
    new Promise((resolve) => {
      const aside = document.getElementById("aside").contentWindow;
      aside.addEventListener("message", () => resolve("an answer"));
      aside.Function("target", "call", "target.postMessage({ gaitway: 1, id: 1, call, arguments: [] }, '*')")(frame.contentWindow, call);
      setTimeout(() => resolve("no answer"), 1000);
    });
  frame.src = decodeURIComponent(location.hash.slice(1));
</script>
`;
