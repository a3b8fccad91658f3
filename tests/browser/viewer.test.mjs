// The element `<gaitway-viewer>` as it comes from npm: packed, unpacked, and used on a page that is served beside it.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { after, before, describe, test } from "node:test";
import { pathToFileURL } from "node:url";
import zlib from "node:zlib";
import { assemble } from "../../xtask/site/npm.mjs";
import { serve } from "../../xtask/site/server.mjs";
import { dist } from "../three/data.mjs";
import { BACK_ENDS, drop, eventually, launch, reportPolicyViolations, stats, temporaryFolder, until, watched, whenReady } from "./browser.mjs";

/** @typedef {import("../../npm/viewer/gaitway.d.ts").GaitwayViewer} GaitwayViewer */
/** @typedef {import("./browser.mjs").TestPage} TestPage */

/** Bytes of the module, compressed. */
const MAX_MODULE = 6 * 1024;

const folder = temporaryFolder("viewer");
const installed = path.join(folder, "node_modules/gaitway");
/** Hosts keep files whose names have a hash. */
const HEADERS = { "cache-control": "max-age=3600" };

/** @type {Awaited<ReturnType<typeof serve>>} */
let site;
/** The same package on another origin. @type {Awaited<ReturnType<typeof serve>>} */
let elsewhere;
/** @type {import("playwright-core").Browser} */
let browser;
/** @type {import("playwright-core").BrowserContext} */
let context;

before(async () => {
  const assembled = path.join(folder, "assembled");
  assemble(dist, assembled);
  execFileSync("npm", ["pack", "--silent", "--pack-destination", folder], { cwd: assembled });
  const archive = fs.readdirSync(folder).find((name) => name.endsWith(".tgz"));
  fs.mkdirSync(installed, { recursive: true });
  execFileSync("tar", ["xf", path.join(folder, String(archive)), "-C", installed, "--strip-components=1"]);
  for (const sample of ["pilot", "morphs"]) fs.copyFileSync(`assets/samples/${sample}.glb`, path.join(folder, `${sample}.glb`));
  fs.copyFileSync("assets/samples/morphs.glb", path.join(folder, "two, three.glb"));
  fs.copyFileSync("assets/gallery/pilot.webp", path.join(folder, "poster.webp"));
  site = await serve({ "/": folder }, HEADERS);
  elsewhere = await serve({ "/gaitway/": installed, "/": dist }, { ...HEADERS, "access-control-allow-origin": "*" });
  browser = await launch();
  context = await browser.newContext({ viewport: { width: 800, height: 600 }, deviceScaleFactor: 0.25 });
});

after(async () => {
  await browser?.close();
  await Promise.all([site?.close(), elsewhere?.close()]);
});

/**
 * Opens a page with the module and this body, whose events of viewers are counted in `window.seen`.
 * @param {string} body
 * @param {() => void} [early] Runs before the scripts, in frames as well.
 */
async function opened(body, early = () => {}) {
  fs.writeFileSync(path.join(folder, "page.html"), `<!doctype html><title>around</title><link rel="icon" href="data:,"><style>body { margin: 0 } gaitway-viewer { width: 400px }</style>
<script>
  window.seen = [];
  // The window hears no load events of the document.
  for (const type of ["progress", "load", "change", "error"]) document.addEventListener(type, (event) => event.target.localName === "gaitway-viewer" && seen.push({ type, id: event.target.id, detail: event.detail }), true);
</script>
<script type="module" src="node_modules/gaitway/viewer/gaitway.js"></script>${body}`);
  const page = watched(await context.newPage(), true);
  page.setDefaultTimeout(60_000);
  await page.addInitScript(early);
  await page.goto(`${site.origin}/page.html?${Math.random()}`);
  return page;
}

/**
 * What the page has heard of a viewer.
 * @param {TestPage} page
 * @param {string} type
 * @param {string} [id]
 * @returns {Promise<any[]>}
 */
const heard = (page, type, id = "viewer") => page.evaluate(([type, id]) => /** @type {any} */ (window).seen.filter((/** @type {any} */ event) => event.type === type && event.id === id).map((/** @type {any} */ { detail }) => detail), [type, id]);

/**
 * @param {TestPage} page
 * @param {string} [id]
 */
const loaded = (page, id = "viewer", times = 1) => eventually(async () => (await heard(page, "load", id)).length >= times, `${id} should load`);

/**
 * Calls a method of a viewer.
 * @param {TestPage} page
 * @param {"state" | "apply" | "play" | "pause" | "toLink" | "pose"} method
 * @param {unknown[]} given
 * @returns {Promise<any>}
 */
const call = (page, method, ...given) => page.evaluate(([method, given]) => /** @type {any} */ (document.getElementById("viewer"))[method](...given), /** @type {const} */ ([method, given]));

/**
 * @param {TestPage} page
 * @param {string} name
 * @param {string | null} value
 */
const set = (page, name, value) => page.evaluate(([name, value]) => {
  const viewer = /** @type {HTMLElement} */ (document.getElementById("viewer"));
  if (value === null) viewer.removeAttribute(/** @type {string} */ (name));
  else viewer.setAttribute(/** @type {string} */ (name), value);
}, [name, value]);

/** @param {TestPage} page */
const frameOf = (page, index = 0) => page.frames()[1 + index];

/**
 * Counts the colors of the screen where a viewer is.
 * @param {TestPage} page
 */
async function colorsOnScreen(page) {
  const png = await page.locator("#viewer").screenshot();
  return await page.evaluate(async (base64) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
    const drawing = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    drawing?.drawImage(bitmap, 0, 0);
    return new Set(new Uint32Array(drawing?.getImageData(0, 0, bitmap.width, bitmap.height).data.buffer ?? new ArrayBuffer(0))).size;
  }, png.toString("base64"));
}

test("the module is small, and importing it on a server does nothing", () => {
  const module = path.join(installed, "viewer/gaitway.js");
  const size = zlib.gzipSync(fs.readFileSync(module)).length;
  assert.ok(size <= MAX_MODULE, `${size} bytes`);
  const script = `const before = Object.keys(globalThis).length; const { GaitwayViewer } = await import(${JSON.stringify(pathToFileURL(module).href)}); console.log(typeof GaitwayViewer, Object.keys(globalThis).length - before)`;
  assert.equal(execFileSync(process.execPath, ["--input-type=module", "-e", script], { encoding: "utf8" }), "function 0\n");
});

test("the package has its types and licences, and nothing of a site's own", () => {
  const { exports, version } = JSON.parse(fs.readFileSync(path.join(installed, "package.json"), "utf8"));
  for (const file of [exports["."].types, exports["."].default, exports["./react"].types, "index.html", "LICENSE-MIT", "LICENSE-APACHE", "README.md"]) assert.ok(fs.existsSync(path.join(installed, file)), file);
  assert.ok(fs.readFileSync("Cargo.toml", "utf8").includes(`version = "${version}"`));
  assert.deepEqual(fs.readdirSync(installed).filter((name) => /^(sw|manifest|icons)/.test(name)), []);
});

test("every key of a link has an attribute", async () => {
  const keys = [...fs.readFileSync("docs/links.md", "utf8").matchAll(/^\| `(\w+)` \|/gm)].map(([, key]) => key);
  const table = keys.slice(0, keys.indexOf("embed") + 1);
  const { GaitwayViewer } = await import(pathToFileURL(path.join(installed, "viewer/gaitway.js")).href);
  const others = { v: undefined, play: "autoplay", pose: "joints", hidden: "hide", key: "key-light", embed: "controls" };
  const expected = table.map((key) => (key in others ? others[/** @type {keyof typeof others} */ (key)] : key)).filter((name) => name !== undefined);
  assert.deepEqual(expected.filter((name) => !GaitwayViewer.observedAttributes.includes(name)), []);
});

for (const renderer of BACK_ENDS)
  describe(`a viewer on ${renderer}`, () => {
    /** @type {TestPage} */
    let page;

    before(async () => {
      page = await opened(`<gaitway-viewer id="viewer" renderer="${renderer}" model="pilot.glb" clip="run" autoplay="0" alt="A pilot" poster="poster.webp"></gaitway-viewer>`);
      await loaded(page);
    });

    after(() => page.finish());

    test("shows the model of its attributes, and says so", async () => {
      assert.equal((await heard(page, "load")).length, 1);
      const progress = (await heard(page, "progress")).map(({ progress }) => progress);
      assert.ok(progress.length > 1 && progress.every((value, at) => value >= (progress[at - 1] ?? 0) && value <= 1), progress.join());
      assert.deepEqual(await heard(page, "error"), []);
      const { model, clip, play, embed } = await call(page, "state");
      assert.deepEqual({ model, clip, play, embed }, { model: [`${site.origin}/pilot.glb`], clip: "run", play: false, embed: "viewport" });
      assert.equal((await stats(frameOf(page))).backend, renderer);
      assert.equal(await frameOf(page).evaluate(() => window.frameElement?.getAttribute("title")), "A pilot");
      assert.ok((await colorsOnScreen(page)) > 100);
    });

    test("has the methods of the page", async () => {
      const before = await call(page, "pose");
      await call(page, "apply", { t: 0.2 });
      assert.notDeepEqual((await call(page, "pose")).meshes[0].positions.slice(0, 30), before.meshes[0].positions.slice(0, 30));
      assert.ok((await heard(page, "change")).length > 0);
      await call(page, "play");
      assert.equal((await call(page, "state")).play, true);
      await call(page, "pause");
      assert.equal((await call(page, "state")).play, false);
      const link = new URL(await call(page, "toLink"));
      assert.equal(`${link.origin}${link.pathname}${link.search}`, `${site.origin}/node_modules/gaitway/index.html`);
      assert.match(link.hash, /model=http.*pilot\.glb.*clip=run/);
      assert.doesNotMatch(link.hash, /embed/);
      const bytes = await page.evaluate(async () => (await (/** @type {GaitwayViewer} */ (document.getElementById("viewer")).screenshot())).type);
      assert.equal(bytes, "image/png");
      await assert.rejects(call(page, "apply", { t: "soon" }), /t=soon/);
    });

    test("applies changed attributes without loading the page again", async () => {
      const frame = frameOf(page);
      await set(page, "clip", "idle");
      await eventually(async () => (await call(page, "state")).clip === "idle", "the clip should change");
      await set(page, "controls", "");
      await eventually(async () => (await call(page, "state")).embed === "transport", "the transport should come");
      await set(page, "controls", null);
      await set(page, "clip", null);
      await page.evaluate(() => {
        const viewer = /** @type {GaitwayViewer} */ (document.getElementById("viewer"));
        viewer.model = "nowhere.glb";
        return Promise.resolve().then(() => (viewer.model = ["two, three.glb"]));
      });
      await loaded(page, "viewer", 2);
      assert.deepEqual((await call(page, "state")).model, [`${site.origin}/two,%20three.glb`]);
      assert.equal(frameOf(page), frame);
      assert.deepEqual(await heard(page, "error"), []);
      assert.equal(await page.evaluate(() => history.length), 2);
    });

    test("opens what a script has", async () => {
      const { clips } = await page.evaluate(async () => {
        const content = await (await fetch("pilot.glb")).arrayBuffer();
        return await /** @type {GaitwayViewer} */ (document.getElementById("viewer")).open({ "mine.glb": content });
      });
      assert.ok(clips.length > 1);
      await loaded(page, "viewer", 3);
    });

    test("starts again after it was moved, and leaves nothing behind", async () => {
      await page.evaluate(() => {
        const viewer = /** @type {GaitwayViewer} */ (document.getElementById("viewer"));
        document.body.append(document.createElement("section"));
        viewer.model = "pilot.glb";
        viewer.remove();
        document.querySelector("section")?.append(viewer);
      });
      await loaded(page, "viewer", 4);
      assert.equal(page.frames().length, 2);
      assert.deepEqual((await call(page, "state")).model, [`${site.origin}/pilot.glb`]);
      const stored = await page.evaluate(async () => [localStorage.length, sessionStorage.length, document.cookie, (await caches.keys()).length, (await indexedDB.databases()).length, (await navigator.serviceWorker.getRegistrations()).length]);
      assert.deepEqual(stored, [0, 0, "", 0, 0, 0]);
      // The browser reports the request for nowhere.glb, unless it was cancelled in time.
      assert.deepEqual(page.troubles.filter((text) => !text.includes("404")), []);
    });
  });

describe("viewers", () => {
  /** Downloads of programs that came from the server, of all frames. @param {TestPage} page */
  const downloads = async (page) => {
    const counts = await Promise.all(page.frames().slice(1).map((frame) => frame.evaluate(() => performance.getEntriesByType("resource").filter((entry) => entry.name.endsWith(".wasm") && /** @type {PerformanceResourceTiming} */ (entry).transferSize > 0).length)));
    return counts.reduce((sum, count) => sum + count, 0);
  };

  test("share their downloads, and wait out of sight if they are lazy", async () => {
    const one = (/** @type {string} */ id, /** @type {string} */ more) => `<gaitway-viewer id="${id}" renderer="webgl2" model="morphs.glb" ${more}></gaitway-viewer>`;
    const page = await opened(`${one("viewer", "")}${one("second", 'autoplay="0"')}<div style="height: 3000px"></div>${one("late", 'loading="lazy"')}`);
    await Promise.all([loaded(page), loaded(page, "second")]);
    // The back end's tests have downloaded it before.
    assert.equal(await downloads(page), 0);
    assert.equal(page.frames().length, 3);
    assert.deepEqual(await heard(page, "progress", "late"), []);
    await page.evaluate(() => document.getElementById("late")?.scrollIntoView());
    await loaded(page, "late");
    await page.finish();
  });

  test("draw nothing out of sight, but answer", async () => {
    for (const base of ["", `base="${elsewhere.origin}/gaitway"`]) {
      const page = await opened(`<div style="height: 3000px"></div><gaitway-viewer id="viewer" renderer="webgl2" ${base} model="sample:walker"></gaitway-viewer>`);
      await loaded(page);
      const frame = frameOf(page);
      /** @param {number} millis */
      const drawn = async (millis) => {
        const { frames } = await stats(frame);
        await new Promise((resolve) => setTimeout(resolve, millis));
        return (await stats(frame)).frames - frames;
      };
      await eventually(async () => (await drawn(300)) <= 1, `${base} should stop drawing`);
      await call(page, "apply", { t: 0.4, play: false });
      assert.equal((await call(page, "state")).t, 0.4);
      await call(page, "play");
      await page.evaluate(() => document.getElementById("viewer")?.scrollIntoView());
      await eventually(async () => (await drawn(300)) > 1, `${base} should draw again`);
      await page.finish();
    }
  });

  test("show a poster until they are pressed, by keyboard too", async () => {
    const page = await opened('<input id="first"><gaitway-viewer id="viewer" renderer="webgl2" model="pilot.glb" clip="run" controls poster="poster.webp" reveal="interaction" alt="A pilot"></gaitway-viewer>');
    await page.locator("#first").focus();
    await page.keyboard.press("Tab");
    const poster = await colorsOnScreen(page);
    assert.ok(poster > 100);
    assert.equal(page.frames().length, 1);
    await page.keyboard.press("Enter");
    await loaded(page);
    // The keyboard is in the viewer now.
    await eventually(() => frameOf(page).evaluate(() => document.hasFocus()), "the viewer should have the focus");
    const { play } = await call(page, "state");
    await page.keyboard.press("Space");
    await eventually(async () => (await call(page, "state")).play === !play, "Space should stop the clip");
    await frameOf(page).locator("#mirror").getByRole("button", { name: /Play|Pause/ }).first().waitFor({ state: "attached" });
    await page.finish();
  });

  test("open what is asked of them before they are there", async () => {
    const page = await opened("");
    const { clips, state } = await page.evaluate(async () => {
      await customElements.whenDefined("gaitway-viewer");
      const viewer = /** @type {GaitwayViewer} */ (document.createElement("gaitway-viewer"));
      Object.assign(viewer, { id: "viewer", renderer: "webgl2", loading: "lazy" });
      const opened = viewer.open("pilot.glb");
      document.body.append(viewer);
      const { clips } = await opened;
      return { clips, state: await viewer.state() };
    });
    assert.ok(clips.length > 1);
    assert.ok(state.model.includes(`${site.origin}/pilot.glb`));
    assert.equal((await heard(page, "load")).length, 1);
    await page.finish();
  });

  test("leave out only the malformed ones of attributes that are set together", async () => {
    const page = await opened('<gaitway-viewer id="viewer" renderer="webgl2" model="pilot.glb" clip="run" autoplay="0"></gaitway-viewer>');
    await loaded(page);
    /** @param {Record<string, string | null>} values */
    const setAll = (values) => page.evaluate((values) => void Object.assign(document.getElementById("viewer") ?? {}, values), values);
    await setAll({ clip: "idle", background: "purple" });
    await eventually(async () => (await call(page, "state")).clip === "idle", "the clip should change");
    await setAll({ t: "soon", background: "blue", clip: "expressions", fov: "20", model: "morphs.glb" });
    await loaded(page, "viewer", 2);
    const { model, clip, fov, background, t } = await call(page, "state");
    assert.deepEqual({ model, clip, fov, background, t }, { model: [`${site.origin}/morphs.glb`], clip: "expressions", fov: 20, background: "studio", t: 0 });
    const errors = await heard(page, "error");
    assert.deepEqual(errors.map(({ code }) => code), ["malformed", "malformed", "malformed"]);
    assert.deepEqual(errors.map(({ message }) => message.split(":")[0]).sort(), ["background=blue", "background=purple", "t=soon"]);
    await page.finish();
  });

  test("say what is wrong", async () => {
    const page = await opened('<gaitway-viewer id="viewer" renderer="webgl2" model="none.glb" poster="poster.webp"></gaitway-viewer><gaitway-viewer id="lost" base="nowhere" model="pilot.glb"></gaitway-viewer>');
    await eventually(async () => (await heard(page, "error")).length > 0 && (await heard(page, "error", "lost")).length > 0, "both should report an error");
    const [[{ code, message }], [lost]] = [await heard(page, "error"), await heard(page, "error", "lost")];
    assert.deepEqual([code, lost.code], ["not-found", "not-found"]);
    assert.match(message, /none\.glb/);
    await page.locator("#viewer [role=alert]").getByText("none.glb").waitFor();
    // Another one that isn't there, and the first one again.
    for (const name of ["gone.glb", "none.glb"]) {
      await set(page, "model", name);
      await page.locator("#viewer [role=alert]").getByText(name).waitFor();
    }
    assert.deepEqual((await heard(page, "error")).map(({ code }) => code), ["not-found", "not-found", "not-found"]);
    assert.deepEqual(await heard(page, "load"), []);
    await set(page, "model", "pilot.glb");
    await loaded(page);
    await page.locator("#viewer [role=alert]").waitFor({ state: "hidden" });
    assert.equal(await page.locator("#viewer [role=alert]").textContent(), "");
    await page.finish();
  });

  test("report what can't be used by events, and not over the picture", async () => {
    const page = await opened('<gaitway-viewer id="viewer" renderer="webgl2" model="pilot.glb" clip="Nope" background="purple" autoplay="0"></gaitway-viewer>');
    await loaded(page);
    await set(page, "clip", "Nada");
    await eventually(async () => (await heard(page, "error")).length === 2, "the clip should be reported");
    await set(page, "motion", "gone.bvh");
    await loaded(page, "viewer", 2);
    await set(page, "model", "gone.glb");
    await eventually(async () => (await heard(page, "error")).some(({ message }) => message.includes("gone.glb")), "the model should be reported");
    const errors = await heard(page, "error");
    assert.match(errors[0].message, /background=purple[^]*Nope/);
    assert.match(errors[1].message, /Nada/);
    assert.ok(errors.every(({ code }) => ["malformed", "not-found"].includes(code)), JSON.stringify(errors));
    // What the program shows is read out.
    await new Promise((resolve) => setTimeout(resolve, 500));
    assert.equal(await frameOf(page).locator("#news").textContent(), "");
    assert.doesNotMatch(String(await frameOf(page).locator("#problem").textContent()), /gone\.glb/);
    await page.finish();
  });

  test("name only ways out that visitors have", async () => {
    // The page's own server lets no other origin read its models.
    const one = (/** @type {string} */ id, /** @type {string} */ more) => `<gaitway-viewer id="${id}" renderer="webgl2" base="${elsewhere.origin}/gaitway/" model="pilot.glb" ${more}></gaitway-viewer>`;
    const page = await opened(`${one("viewer", "")}${one("second", "drop")}`);
    await eventually(async () => (await heard(page, "error")).length > 0 && (await heard(page, "error", "second")).length > 0, "both should report an error");
    const [[still], [dropping]] = [await heard(page, "error"), await heard(page, "error", "second")];
    assert.deepEqual([still.code, dropping.code], ["cross-origin", "cross-origin"]);
    assert.match(still.message, /pilot\.glb.*CORS.*no such file$/);
    assert.match(dropping.message, /download the file and drop it here/);
    await page.finish();
  });

  test("keep the poster without graphics", async () => {
    const page = await opened('<gaitway-viewer id="viewer" model="pilot.glb" poster="poster.webp"></gaitway-viewer>', () => {
      Object.defineProperty(navigator, "gpu", { value: undefined });
      HTMLCanvasElement.prototype.getContext = () => null;
    });
    await eventually(async () => (await heard(page, "error")).length > 0, "it should report an error");
    assert.equal((await heard(page, "error"))[0].code, "no-graphics");
    assert.ok(await page.evaluate(() => {
      const poster = document.getElementById("viewer")?.shadowRoot?.querySelector("img");
      return poster?.checkVisibility() && poster.naturalWidth > 0;
    }));
    await page.finish();
  });

  test("take dropped files only if they may, and then keep them", async () => {
    const page = await opened('<gaitway-viewer id="viewer" renderer="webgl2" model="morphs.glb" autoplay="0"></gaitway-viewer>');
    await loaded(page);
    const file = [{ name: "mine.glb", url: `${site.origin}/pilot.glb` }];
    await drop(frameOf(page), file);
    await new Promise((resolve) => setTimeout(resolve, 300));
    assert.deepEqual((await call(page, "state")).model, [`${site.origin}/morphs.glb`]);
    await set(page, "drop", "");
    await loaded(page, "viewer", 2);
    await drop(frameOf(page), file);
    await until(frameOf(page), async () => (await window.gaitway.state()).model.join().includes("mine.glb"));
    await assert.rejects(call(page, "state"), /withheld/);
    await assert.rejects(call(page, "toLink"), /withheld/);
    await page.finish();
  });

  test("are defined once, whatever is imported", async () => {
    const page = await opened('<script type="module" src="node_modules/gaitway/viewer/gaitway.js?other"></script><gaitway-viewer id="viewer" reveal="interaction" model="pilot.glb"></gaitway-viewer>');
    await page.locator("#viewer").getByRole("button").waitFor();
    const isSame = await page.evaluate(async () => {
      const [one, other] = await Promise.all(["", "?other"].map((version) => import(`${location.origin}/node_modules/gaitway/viewer/gaitway.js${version}`)));
      return one.GaitwayViewer === other.GaitwayViewer;
    });
    assert.ok(isSame);
    assert.deepEqual(page.troubles, []);
    await page.finish();
  });
});

test("the live examples run under their policy", async () => {
  const page = watched(await context.newPage(), true);
  await page.addInitScript(reportPolicyViolations);
  await page.goto(`${elsewhere.origin}/viewer/`);
  await page.locator("gaitway-viewer").first().locator(".shown").waitFor({ state: "attached" });
  const code = await page.locator("figure pre").allTextContents();
  assert.equal(code.length, await page.locator("gaitway-viewer").count());
  assert.ok(code.every((text) => /gaitway-viewer|viewer\./.test(text)), code.join("\n"));
  await whenReady(frameOf(page));
  const scripted = page.locator("#scripted");
  await scripted.scrollIntoViewIfNeeded();
  for (const clip of ["idle", "expressions", "idle"]) {
    await eventually(() => scripted.evaluate(async (viewer) => (await /** @type {GaitwayViewer} */ (viewer).state()).clip).then((shown) => shown === clip), `${clip} should be shown`);
    await page.locator("#other").click();
  }
  // One of them shows a model that isn't there.
  assert.deepEqual(page.troubles.filter((text) => !text.includes("404")), []);
  await page.finish();
});
