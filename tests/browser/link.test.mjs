// Links on the page: shared and opened elsewhere, with parts that can't be loaded, back and forward, and the page
// embedded in another one, which never learns what the user dropped. What happens in which order is tested without a browser, in
// crates/session.
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import { neverAnswers, serve } from "../../xtask/site/server.mjs";
import { dataFile, skipWithoutData } from "../three/data.mjs";
import { triangle } from "../three/triangle.mjs";
import { archive } from "./archive.mjs";
import { BACK_ENDS, PIXEL_RATIO, apply, drop, eventually, fragment, meanDifference, onOneBackEnd, open, toggleInspector, picture, pose, resize, share, startSite, state, until, untilStill, whenBorrowed, whenModel, whenReady, whenShown, withLessPatience } from "./browser.mjs";

const FOX = "khronos/Fox/glTF-Binary/Fox.glb";
const FOX_VERTICES = 1728;
const CESIUM_MAN = "khronos/CesiumMan/glTF-Binary/CesiumMan.glb";
const CESIUM_MAN_VERTICES = 3273;
const XBOT = "threejs/Xbot.glb";
const DANCE = "bvh/cosc422_Dance.bvh";
/** A PNG of one pixel. */
const PIXEL = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";
/** Nothing listens there, and browsers don't block the port. */
const CLOSED = "http://127.0.0.1:9";

/** @typedef {import("./browser.mjs").TestPage} TestPage */
/** @typedef {import("../types.d.ts").Reply} Reply */

/** @param {TestPage} page */
const missing = (page) => page.locator("#missing-parts li").allInnerTexts();
/** @param {TestPage} page */
const whenMissing = (page) => page.locator("#missing").waitFor({ state: "visible" });
/** @param {TestPage} page */
const linkOf = (page) => page.locator("#share-link").inputValue();

/**
 * Stops the program as a trap does.
 * @param {TestPage} page
 */
const stop = (page) => page.evaluate(() => void dispatchEvent(new ErrorEvent("error", { error: new WebAssembly.RuntimeError("unreachable") })));
/** @param {TestPage} page */
async function restart(page) {
  await page.locator("#stopped-again").click();
  await whenReady(page);
}
/** @param {TestPage} page */
async function stopAndRestart(page) {
  await stop(page);
  await restart(page);
}

for (const renderer of BACK_ENDS)
  describe(`link on ${renderer}`, { skip: skipWithoutData }, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    /** @type {Record<"strict" | "own" | "silent", import("../../xtask/site/server.mjs").Server>} */
    let servers;
    /** @type {string} */
    let folder;
    before(async () => {
      site = await startSite({ isOffScreen: true, isCalm: true });
      folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-link-"));
      servers = {
        // Without CORS headers.
        strict: await serve({ "/": dataFile("") }),
        own: await serve({ "/": folder }, { "access-control-allow-origin": "*" }),
        silent: await neverAnswers(),
      };
    });
    after(async () => {
      await site?.close();
      for (const server of Object.values(servers ?? {})) await server.close();
      if (folder !== undefined) fs.rmSync(folder, { recursive: true });
    });

    /** Only the picture depends on the back end. */
    const once = onOneBackEnd(renderer);

    /**
     * @param {() => string} link
     * @param {(page: TestPage) => Promise<void>} body
     * @param {() => void} [before] Runs in the page before its scripts.
     */
    const withPage = (link, body, before) => async () => {
      const page = await site.page({ renderer, link: link(), before });
      try {
        await body(page);
      } finally {
        await page.finish();
      }
    };

    /** @type {(name: string, ...given: Parameters<typeof withPage>) => void} */
    const onPage = (name, ...given) => once(name, withPage(...given));

    onPage(
      "gives the reason for each part that can't be loaded and shows the rest",
      () =>
        fragment([
          ["model", site.data(FOX)],
          ["motion", site.data("bvh/nothing-here.bvh")],
          ["motion", `${servers.strict.origin}/${DANCE}`],
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
        assert.match(unsupported, /\.glb/, "which types can be read");
        assert.match(map, /map-of-nothing\.json: .*404/);
        assert.deepEqual(others, []);
        assert.match((await page.locator("#problem").textContent()) ?? "", /nothing-here\.bvh/);
        await page.locator("#missing-continue").click();
        const { clip, meshes } = await pose(page);
        assert.equal(clip, "Run");
        assert.equal(meshes[0].positions.length, 3 * FOX_VERTICES);
        // Nothing has been set, so reloading tries again.
        assert.match(page.url(), /map-of-nothing/);
      },
    );

    onPage(
      "names each value that it can't use",
      () =>
        fragment([
          ["model", "sample:pilot"],
          ["speed", "fast"],
          ["t", "noon"],
        ]),
      async (page) => {
        await until(page, () => document.querySelector("#news")?.textContent !== "");
        const notice = (await page.locator("#news").textContent()) ?? "";
        assert.match(notice, /speed/);
        assert.match(notice, /noon/);
      },
    );

    const silentMotion = () => fragment([["model", site.data(FOX)], ["motion", `${servers.silent.origin}/walk.bvh`]]);
    const showsTheRest = async (/** @type {TestPage} */ page) => {
      await whenMissing(page);
      assert.match((await missing(page)).join(), /walk\.bvh: nothing has come from the site for 20 seconds/);
      assert.equal((await pose(page)).meshes[0].positions.length, 3 * FOX_VERTICES);
    };
    onPage("doesn't wait for a site that never answers", silentMotion, showsTheRest, withLessPatience);

    onPage("shows the motion's own skeleton when the model can't be loaded", () => fragment([["model", `${CLOSED}/a.glb`], ["motion", site.data(DANCE)], ["embed", "1"]]), async (page) => {
      await whenMissing(page);
      assert.match(await page.locator("#missing-title").innerText(), /^The model in this link/);
      assert.match((await missing(page)).join(), /^http:\/\/127\.0\.0\.1:9\/a\.glb: the site cannot be reached[^,]*$/);
      const { model, embed } = await state(page);
      assert.deepEqual(model, [site.data(DANCE)]);
      assert.equal(embed, true);
    });

    onPage("says what is wrong if its model is a web page", () => fragment([["model", site.address]]), async (page) => {
      await whenMissing(page);
      assert.match(await page.locator("#missing-title").innerText(), /^The model in this link/);
      assert.match((await missing(page)).join(), /^folder: HTML files cannot be read; this is a web page; use the address of the file itself/);
      assert.doesNotMatch(await page.locator("#missing-rest").innerText(), /is shown/);
    });

    const twoModels = () => fragment([["model", site.data(FOX)], ["model", `${servers.own.origin}/gone.glb`], ["play", 0]]);
    onPage("shows one of two models and names the missing one", twoModels, async (page) => {
      await whenMissing(page);
      const [gone, ...others] = await missing(page);
      assert.match(gone, /gone\.glb: .*404/);
      assert.deepEqual(others, []);
      await page.locator("#missing-continue").click();
      await whenShown(page, FOX_VERTICES);
    });

    onPage("tries again", () => fragment([["model", `${servers.own.origin}/late.glb`], ["clip", "Run"], ["t", 0.5], ["play", 0]]), async (page) => {
      await whenMissing(page);
      const again = page.locator("#missing-again");
      await again.click();
      await whenMissing(page);
      fs.copyFileSync(dataFile(FOX), path.join(folder, "late.glb"));
      await again.click();
      await whenShown(page, FOX_VERTICES);
      const { clip, time_secs } = await pose(page);
      assert.deepEqual([clip, time_secs], ["Run", 0.5]);
      assert.equal(await page.locator("#missing").isVisible(), false);
      fs.rmSync(path.join(folder, "late.glb"));
    });

    onPage("takes a GitHub page for the file that it shows", () => "", async (page) => {
      await page.route("https://raw.githubusercontent.com/**", (route) =>
        route.fulfill({ path: dataFile(FOX), headers: { "access-control-allow-origin": "*" } }),
      );
      await page.keyboard.press("Control+o");
      await page.locator("#open-url").fill("https://github.com/someone/models/blob/main/a%20fox/Fox.glb?raw=true");
      await page.keyboard.press("Enter");
      await whenShown(page, FOX_VERTICES);
      assert.ok(page.requests.includes("https://raw.githubusercontent.com/someone/models/main/a%20fox/Fox.glb"), page.requests.join("\n"));
      assert.match((await page.locator("#news").textContent()) ?? "", /3 clips/);
    });

    const theSame = async (/** @type {TestPage} */ page) => {
      await open(page, site.data(DANCE));
      await apply(page, { t: 1.25, play: 0, camera: "30,10,4,0,1,0", show: "skeleton", root: "in-place", feet: "plant", speed: 0.5, exposure: 0.5 });
      await share(page);
      assert.equal(await page.locator("#share-local").isVisible(), false);
      await page.locator("#share-qr svg").waitFor({ state: "attached" });
      const link = await linkOf(page);
      assert.ok(!link.includes("renderer"), link);
      const snippet = await page.locator("#share-frame").inputValue();
      assert.match(snippet, /^<iframe src="http:.*&amp;embed=1"/);
      await page.locator("#share-close").click();
      const shown = { state: await state(page), pose: await pose(page), picture: await picture(page) };
      const other = await site.page({ renderer, link: link.split("#")[1] });
      try {
        assert.deepEqual(await state(other), shown.state);
        assert.deepEqual(await pose(other), shown.pose);
        // Borrowing opened it on the first page.
        await toggleInspector(other);
        assert.equal(meanDifference(await picture(other), shown.picture), 0);
      } finally {
        await other.finish();
      }
    };
    test("is the same scene in another browser", withPage(() => fragment([["model", site.data(XBOT)]]), theSame));

    onPage("says which files a link can't include", () => fragment([["model", site.data(XBOT)]]), async (page) => {
      await drop(page, [{ name: "dance.bvh", url: site.data(DANCE) }]);
      await whenBorrowed(page, 1);
      await apply(page, { play: 0, t: 1 });
      await share(page);
      assert.match(await page.locator("#share-local").innerText(), /dance\.bvh \(motion\)/);
      // The QR code is collapsed, but drawn.
      await page.locator("#share-qr svg").waitFor({ state: "hidden" });
      await page.locator("#share-code-toggle").click();
      await page.locator("#share-qr svg").waitFor({ state: "visible" });
      const link = await linkOf(page);
      assert.ok(link.includes("Xbot.glb") && link.includes("motion=file:dance.bvh"), link);
      await page.locator("#share-close").click();
      // The address bar shows the same link.
      await until(page, () => location.hash.includes("t=1"));
      assert.ok(page.url().includes("motion=file:dance.bvh"), page.url());
    });

    onPage("can be copied on a phone held sideways", () => fragment([["model", site.data(XBOT)]]), async (page) => {
      await drop(page, [{ name: "dance.bvh", url: site.data(DANCE) }]);
      await whenBorrowed(page, 1);
      await apply(page, { play: 0 });
      await resize(page, 844, 390);
      await share(page);
      const isCovered = () => {
        const button = /** @type {HTMLElement} */ (document.querySelector("#share-copy"));
        const { left, top, bottom } = button.getBoundingClientRect();
        return [top + 1, bottom - 1].some((y) => document.elementFromPoint(left + 9, y) !== button);
      };
      assert.equal(await page.evaluate(isCovered), false, "all of the button should be in sight");
    });

    onPage("says when a link is too long for a QR code", () => `model=sample:walker&whatever=${"x".repeat(3000)}`, async (page) => {
      await share(page);
      await page.locator("#share-no-qr").waitFor({ state: "visible" });
      assert.match(await page.locator("#share-no-qr").innerText(), /\d{4} characters, too many for a QR code/);
      assert.equal(await page.locator("#share-qr svg").count(), 0);
    });

    /** An archive of two models, the fox first. */
    const TWO = () => archive({ "a/fox.glb": fs.readFileSync(dataFile(FOX)), "b/man.glb": fs.readFileSync(dataFile(CESIUM_MAN)) });

    onPage("names one model of an archive", () => (fs.writeFileSync(path.join(folder, "two.zip"), TWO()), fragment([["model", `${servers.own.origin}/two.zip#!/b/man.glb`]])), async (page) => {
      await whenShown(page, CESIUM_MAN_VERTICES);
      assert.deepEqual((await state(page)).model, [`${servers.own.origin}/two.zip#!/b/man.glb`]);
      await page.goto(page.url().replace("man.glb", "gone.glb"));
      await page.reload();
      await whenMissing(page);
      assert.match((await missing(page)).join(), /two\.zip#!\/b\/gone\.glb: there is no such model in this file; its first one is shown/);
      await whenShown(page, FOX_VERTICES);
      // Also when opened as a URL.
      await page.locator("#missing").press("Escape");
      await open(page, `${servers.own.origin}/two.zip#!/b/man.glb`);
      await whenShown(page, CESIUM_MAN_VERTICES);
    });

    onPage("shares what it still lacks along with the view", () => "model=sample:pilot&motion=file:walk.bvh&clip=run&fov=20&play=0&camera=10,5,30,9,1,9", async (page) => {
      await page.keyboard.press("Escape");
      await page.locator("#mirror").getByText(/^This link needs walk\.bvh\. Open a file with that name to see the shared view\.$/).waitFor({ state: "attached" });
      await page.keyboard.press("Control+o");
      assert.match(await page.locator("#open-what").innerText(), /^This link needs walk\.bvh\./);
      await page.keyboard.press("Escape");
      await apply(page, { fov: 30 });
      await share(page);
      assert.match(await page.locator("#share-local").innerText(), /walk\.bvh \(motion\)/);
      const link = await linkOf(page);
      // The camera would look at where nobody is without the motion.
      assert.equal((await state(page)).camera, "auto");
      for (const part of ["motion=file:walk.bvh", "clip=run", "fov=30", "camera=10,5,30,9,1,9"]) assert.ok(link.includes(part), `${part} in ${link}`);
    });

    onPage("says what a link needs after “Not now”, not whenever the dialog has closed", () => "model=sample:pilot&motion=file:walk.bvh&play=0", async (page) => {
      const said = (/** @type {RegExp} */ text) => eventually(async () => text.test((await page.locator("#news").textContent()) ?? ""));
      // As if it had been closed and asked again within a frame, and a file chooser were cancelled.
      await page.evaluate(() => {
        document.getElementById("bring")?.dispatchEvent(new Event("close"));
        document.getElementById("bring-chosen")?.dispatchEvent(new Event("cancel", { bubbles: true }));
      });
      await untilStill(page);
      assert.equal(await page.locator("#news").textContent(), "");
      await page.locator("#bring-later").click();
      await said(/^This link needs walk\.bvh\./);
    });

    onPage("goes back from a program that has stopped to files that the page holds", () => "model=sample:walker&play=0", async (page) => {
      await drop(page, [{ name: "Fox.glb", url: site.data(FOX) }]);
      await whenModel(page, "Fox.glb");
      await until(page, () => location.hash.includes("Fox.glb"));
      await drop(page, [{ name: "CesiumMan.glb", url: site.data(CESIUM_MAN) }]);
      await until(page, () => location.hash.includes("CesiumMan.glb"));
      await stop(page);
      await page.goBack();
      await restart(page);
      assert.deepEqual((await state(page)).model, ["Fox.glb"]);
      await whenShown(page, FOX_VERTICES);
      assert.equal(await page.locator("#bring").isVisible(), false);
      // What has been gone to once isn't gone to again.
      await drop(page, [{ name: "Man.glb", url: site.data(CESIUM_MAN) }]);
      await whenModel(page, "Man.glb");
      await stopAndRestart(page);
      assert.deepEqual((await state(page)).model, ["Man.glb"]);
    });

    onPage("waits for an archive that the user has to bring and shows its model", () => fragment([["model", "file:two.zip#!/b/man.glb"], ["t", 0.5], ["play", 0]]), async (page) => {
      fs.writeFileSync(path.join(folder, "two.zip"), TWO());
      assert.match(await page.locator("#bring-files").innerText(), /^two\.zip \(model\)$/);
      await page.keyboard.press("Escape");
      await drop(page, [{ name: "two.zip", url: `${servers.own.origin}/two.zip` }]);
      await whenShown(page, CESIUM_MAN_VERTICES);
      assert.deepEqual([(await state(page)).model, (await state(page)).t], [["two.zip#!/b/man.glb"], 0.5]);
      await share(page);
      assert.match(await page.locator("#share-local").innerText(), /two\.zip \(model\)/);
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
      assert.equal(await entries(), before + 1, "one entry per model, including what is set");
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

      // Forward before anything of what lies behind is drawn.
      await page.goBack();
      await whenShown(page, CESIUM_MAN_VERTICES);
      await page.evaluate(() => {
        addEventListener("popstate", () => history.forward(), { once: true });
        history.back();
      });
      await page.waitForTimeout(1000);
      assert.deepEqual((await state(page)).model, ["CesiumMan.glb"]);
      assert.ok(page.url().includes("CesiumMan.glb"), page.url());
      assert.deepEqual(page.troubles, []);
    });

    once("downloads a model once, whatever its address", async () => {
      fs.copyFileSync(dataFile(FOX), path.join(folder, "red+fox.glb"));
      // Unescaped, as some people write it.
      const page = await site.page({ renderer, link: `model=${servers.own.origin}/red+fox.glb&play=0` });
      await whenShown(page, FOX_VERTICES);
      assert.equal(page.requests.filter((url) => url.endsWith(".glb")).length, 1, page.requests.join());
      assert.deepEqual(page.troubles, []);
      await page.finish();
    });

    const TWO_LOCAL = () => fragment([["model", "file:Fox.glb"], ["model", "file:CesiumMan.glb"], ["clip", "Run"], ["t", 0.5], ["play", 0]]);
    onPage("waits for two models and shows the first", TWO_LOCAL, async (page) => {
      await page.locator("#bring-later").click();
      await drop(page, [{ name: "CesiumMan.glb", url: site.data(CESIUM_MAN) }, { name: "Fox.glb", url: site.data(FOX) }]);
      await until(page, async () => (await window.gaitway.pose()).clip === "Run");
      await whenShown(page, FOX_VERTICES);
      assert.deepEqual((await state(page)).model, ["Fox.glb", "CesiumMan.glb"]);
      assert.equal((await pose(page)).time_secs, 0.5);
      assert.equal(await page.locator("#missing").isVisible(), false);
    });

    const NOTHING = { result: undefined, error: undefined, code: undefined };

    /** Embeds a page with the fox in another one. `call` is that one's, and `withheld` checks that it learns nothing. */
    async function embedded() {
      fs.writeFileSync(path.join(folder, "index.html"), AROUND);
      const context = await site.browser.newContext({ viewport: { width: 700, height: 500 }, deviceScaleFactor: PIXEL_RATIO });
      const page = await context.newPage();
      page.setDefaultTimeout(60_000);
      const inside = `${site.address}?renderer=${renderer}#${fragment([["model", site.data(FOX)], ["embed", 1], ["play", 0]])}`;
      await page.goto(`${servers.own.origin}/#${encodeURIComponent(inside)}`);
      /** @type {(...request: unknown[]) => Promise<Reply>} */
      const call = (...request) => page.evaluate((request) => window.call(...request), request);
      await call("ready");
      const frame = page.frames().find((frame) => frame.url().startsWith(site.address));
      assert.ok(frame !== undefined);
      assert.notEqual(new URL(frame.url()).origin, servers.own.origin);
      const withheld = async () => {
        for (const name of ["state", "pose", "stats", "screenshot"]) {
          const { result, error } = await call(name);
          assert.equal(result, undefined, name);
          assert.match(error ?? "", /withheld/, name);
        }
      };
      return { context, page, inside, call, frame, withheld };
    }

    once("answers the page around it, but tells it nothing about dropped files", async () => {
      const { context, page, inside, call, frame, withheld } = await embedded();
      try {
        const { embed, model } = (await call("state")).result;
        assert.deepEqual([embed, model], [true, [site.data(FOX)]]);
        assert.equal((await call("apply", { clip: "Run", t: 0.5 })).error, undefined);
        const { result } = await call("pose");
        assert.deepEqual([result.clip, result.time_secs, result.meshes[0].positions.length], ["Run", 0.5, 3 * FOX_VERTICES]);
        assert.equal((await call("stats")).result.backend, renderer);
        assert.ok((await call("screenshot")).result > 1000, "bytes of a PNG");
        assert.match((await call("apply", { speed: "quickly" })).error ?? "", /speed/);
        assert.match((await call("destroy")).error ?? "", /there is no such call/);
        const { error = "", code } = await call("open", [site.data("nothing.glb")]);
        assert.match(`${code}: ${error}`, /^not-found: .*404/);
        assert.equal((await call("open", site.data(CESIUM_MAN))).result.vertices, CESIUM_MAN_VERTICES);
        await page.waitForFunction(() => window.events.includes("ready") && window.events.includes("change"));
        // A sibling frame is not the parent page.
        assert.equal(await page.evaluate(() => window.askFromAside("state")), "no answer");

        await drop(frame, [{ name: "Mine.glb", url: site.data(FOX) }]);
        await whenShown(frame, FOX_VERTICES);
        await withheld();
        assert.deepEqual(await call("apply", { play: 0, exposure: 1 }), NOTHING);
        assert.match((await call("apply", { clip: "x", speed: "quickly" })).error ?? "", /^withheld/);
        // Requesting the shown files by name reveals nothing either, nor does the URL.
        assert.deepEqual(await call("apply", { model: ["Mine.glb"], motion: [] }), NOTHING);
        await withheld();
        await page.evaluate((address) => document.querySelector("iframe")?.setAttribute("src", address), `${inside.split("#")[0]}#model=Mine.glb&embed=1`);
        // The address names a file that isn't there.
        await frame.locator("#missing").waitFor({ state: "visible" });
        await withheld();
        await frame.locator("#missing-continue").click();
        // Private motion stays private beside another model.
        await call("open", site.data(XBOT));
        assert.equal((await call("state")).result.model[0], site.data(XBOT), "nothing private is left");
        await drop(frame, [{ name: "mine.bvh", url: site.data(DANCE) }]);
        await until(frame, async () => (await window.gaitway.state()).motion.includes("mine.bvh"));
        await withheld();
        assert.deepEqual(await call("open", site.data(XBOT)), NOTHING);
        await withheld();
        // Files sent by the parent page aren't private.
        assert.equal((await page.evaluate((url) => window.openBytes("Fox.glb", url), site.data(FOX))).error, undefined);
        // What was set beside private files is: their clips and joint maps.
        await call("apply", { motion: [] });
        await withheld();
        await call("open", site.data(XBOT));
        await page.evaluate((url) => window.openBytes("Fox.glb", url), site.data(FOX));
        assert.equal((await call("pose")).result.meshes[0].positions.length, 3 * FOX_VERTICES);
      } finally {
        await context.close();
      }
    });

    once("leaves the keyboard to the page around it until the user comes in", async () => {
      /** @param {string} link */
      const inside = (link) => `${site.address.replace("127.0.0.1", "localhost")}?renderer=${renderer}#${fragment([["model", link], ["embed", 1], ["play", 0]])}`;
      for (const { model, dialog } of [{ model: "sample:walker" }, { model: "file:Mine.glb", dialog: "#bring" }, { model: `${CLOSED}/a.glb`, dialog: "#missing" }]) {
        const html = `<!doctype html><title>Around</title><input><div style="height: 900px"></div><iframe width="640" height="440" src="${inside(model).replaceAll("&", "&amp;")}"></iframe>`;
        fs.writeFileSync(path.join(folder, "writing.html"), html);
        const context = await site.browser.newContext({ viewport: { width: 700, height: 500 }, deviceScaleFactor: PIXEL_RATIO });
        try {
          const page = await context.newPage();
          await page.goto(`${servers.own.origin}/writing.html`);
          await page.locator("input").focus();
          const frame = page.frames()[1];
          await until(frame, () => window.gaitway !== undefined);
          await frame.evaluate(async () => void (await window.gaitway.ready));
          if (dialog !== undefined) await frame.locator(dialog).waitFor({ state: "visible" });
          await page.keyboard.type("wgt");
          assert.deepEqual(await page.evaluate(() => [document.activeElement?.tagName, document.querySelector("input")?.value, scrollY]), ["INPUT", "wgt", 0], model);
          if (dialog === undefined) continue;
          assert.equal(await frame.locator(`${dialog}:modal`).count(), 0);
          await frame.locator(`${dialog} h1`).click();
          await frame.locator(`${dialog}:modal`).waitFor();
          await frame.locator(`${dialog} button[type=submit]`).first().click();
          await frame.locator(dialog).waitFor({ state: "hidden" });
        } finally {
          await context.close();
        }
      }
    });

    once("leaves scrolling to the page around it", async () => {
      const inside = `${site.address}?renderer=${renderer}#${fragment([["model", "sample:walker"], ["embed", 1], ["play", 0]])}`;
      fs.writeFileSync(path.join(folder, "scrolling.html"), `<!doctype html><title>Around</title><style>body { margin: 0; height: 2000px }</style><iframe width="640" height="400" src="${inside.replaceAll("&", "&amp;")}"></iframe>`);
      const context = await site.browser.newContext({ viewport: { width: 700, height: 500 }, deviceScaleFactor: PIXEL_RATIO, hasTouch: true });
      try {
        const page = await context.newPage();
        await page.goto(`${servers.own.origin}/scrolling.html`);
        const frame = page.frames()[1];
        await until(frame, () => window.gaitway !== undefined);
        await frame.evaluate(async () => void (await window.gaitway.ready));
        const camera = async () => (await state(frame)).camera;
        const before = await camera();
        /** The page has scrolled and doesn't go on. */
        const whenScrolled = () =>
          until(page, async () => {
            const before = scrollY;
            await new Promise((resolve) => setTimeout(resolve, 200));
            return before !== 0 && scrollY === before;
          });
        const toTop = () => page.evaluate(() => scrollTo(0, 0));
        await page.mouse.move(300, 150);
        await page.mouse.wheel(0, 200);
        await whenScrolled();
        await toTop();
        const client = await context.newCDPSession(page);
        /** @param {number} right @param {number} down */
        const swipe = async (right, down) => {
          const at = (/** @type {number} */ share) => [{ x: 300 + share * right, y: 200 + share * down }];
          await client.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: at(0) });
          for (const share of [0.2, 0.4, 0.6, 0.8, 1]) await client.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: at(share) });
          await client.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
        };
        await swipe(0, -150);
        await whenScrolled();
        await toTop();
        const { x, y, width, height } = (await frame.locator("#mirror button[aria-label=Play]").boundingBox()) ?? assert.fail("no button");
        await page.touchscreen.tap(x + width / 2, y + height / 2);
        await until(frame, async () => (await window.gaitway.state()).play);
        assert.equal(await camera(), before, "neither is the view's, nor does it hold a finger");
        await frame.evaluate(() => window.gaitway.apply({ play: 0 }));
        await swipe(150, 0);
        await until(frame, async (before) => (await window.gaitway.state()).camera !== before, before);
        assert.equal(await page.evaluate(() => scrollY), 0);
        // The tap has brought the user in: the wheel zooms.
        await page.mouse.click(300, 150);
        await until(frame, () => document.hasFocus());
        const turned = await camera();
        await page.mouse.wheel(0, 200);
        await until(frame, async (turned) => (await window.gaitway.state()).camera !== turned, turned);
        assert.equal(await page.evaluate(() => scrollY), 0);
      } finally {
        await context.close();
      }
    });

    once("doesn't let the page around it read a dropped model by adding a file to it", async () => {
      const { context, page, call, frame, withheld } = await embedded();
      try {
        const { bytes, document: plain } = triangle({ uri: "body.bin" });
        const lacksImage = { ...plain, images: [{ uri: "skin.png" }], textures: [{ source: 0 }], materials: [{ emissiveTexture: { index: 0 } }] };
        await drop(frame, [
          { name: "own.gltf", text: JSON.stringify(lacksImage) },
          { name: "body.bin", url: `data:application/octet-stream;base64,${bytes.toString("base64")}` },
        ]);
        await whenModel(frame, "own.gltf");
        await page.evaluate((url) => window.openBytes("skin.png", url), `data:image/png;base64,${PIXEL}`);
        await withheld();
        assert.deepEqual(await call("apply", { model: ["own.gltf"], motion: [] }), NOTHING);
        await withheld();
      } finally {
        await context.close();
      }
    });
  });

/** A page that embeds Gaitway, at the URL after the `#`, beside another frame. */
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
    const { result, error, code } = data;
    // Playwright returns plain values only.
    waiting.get(data.id)?.({ result: result instanceof Blob ? result.size : result, error, code });
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
  // Answers come in order, so one to the aside would arrive before the one to this page.
  window.askFromAside = async (call) => {
    const aside = document.getElementById("aside").contentWindow;
    let answer = "no answer";
    aside.addEventListener("message", () => (answer = "an answer"));
    aside.Function("target", "call", "target.postMessage({ gaitway: 1, id: 1, call, arguments: [] }, '*')")(frame.contentWindow, call);
    await post(call, []);
    await new Promise(requestAnimationFrame);
    return answer;
  };
  frame.src = decodeURIComponent(location.hash.slice(1));
</script>
`;
