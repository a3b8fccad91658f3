// End-to-end stories on both back ends: one person drops, corrects and shares; another opens the link.
import assert from "node:assert/strict";
import fs from "node:fs";
import { after, before, describe, test } from "node:test";
import { dataFile, skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, apply, controls, drop, fragment, meanDifference, picture, pose, share, startSite, state, stats, toggleInspector, until, untilStill, whenBorrowed, whenModel, whenReady, whenShown } from "./browser.mjs";

const SOLDIER = "threejs/Soldier.glb";
const FOX = "khronos/Fox/glTF-Binary/Fox.glb";
const FOX_VERTICES = 1728;
const CESIUM_MAN = "khronos/CesiumMan/glTF-Binary/CesiumMan.glb";
const CESIUM_MAN_VERTICES = 3273;
const WALK = "bvh/cmu_01_01.bvh";
const DWARF = "cosc422/dwarf.glb";
const AVATAR_WALK = "cosc422/original/Dwarf/avatar_walk.bvh";

/** Maps some of the dwarf's joints to channels of the walk; the arms and the rest play its own clip. */
const DWARF_MAP = {
  gaitway_map: 1,
  joints: {
    ...Object.fromEntries(
      Object.entries({ head: 5, spine1: 4, spine2: 2, lhip: 15, rhip: 18, lknee: 16, rknee: 19, lankle: 17, rankle: 20 }).map(([target, source]) => [target, { source }]),
    ),
    middle: { source: null, unmapped: { clip: 0, hold: "first-key" } },
  },
  unmapped: { clip: 0 },
};

/** @typedef {import("./browser.mjs").TestPage} TestPage */
/** @typedef {Awaited<ReturnType<typeof shown>>} Shown */

/** @param {string} address */
const afterHash = (address) => address.split("#")[1];

/** @param {TestPage} page */
async function sharedLink(page) {
  await share(page);
  const link = await page.locator("#share-link").inputValue();
  await page.locator("#share-close").click();
  return link;
}

/**
 * Returns everything that two pages with the same view have in common.
 * @param {TestPage} page
 */
async function shown(page) {
  await untilStill(page);
  return { state: await state(page), pose: await pose(page), picture: await picture(page) };
}

/**
 * @param {Shown} found
 * @param {Shown} expected
 */
function assertSame(found, expected) {
  assert.deepEqual(found.state, expected.state);
  assert.deepEqual(found.pose, expected.pose);
  assert.equal(meanDifference(found.picture, expected.picture), 0);
}

/** @param {TestPage} page */
const whenAsked = (page) => page.locator("#bring").waitFor({ state: "visible" });

/**
 * Returns a BVH with a chain of 300 joints.
 * @param {number} bend Degrees per joint in the second frame.
 */
function longChain(bend) {
  /** @param {number} index */
  const joint = (index) => {
    const head = index === 0 ? "ROOT" : "JOINT";
    const channels = index === 0 ? "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation" : "CHANNELS 3 Zrotation Xrotation Yrotation";
    return `${head} joint${index}\n{\nOFFSET 0 ${index === 0 ? 0 : 1} 0\n${channels}\n`;
  };
  const count = 300;
  const hierarchy = Array.from({ length: count }, (_, index) => joint(index)).join("");
  const ends = `End Site\n{\nOFFSET 0 1 0\n}\n${"}\n".repeat(count)}`;
  /** @param {number} angle */
  const frame = (angle) => ["0 0 0 0 0 0", ...Array.from({ length: count - 1 }, () => `${angle} 0 0`)].join(" ");
  return `HIERARCHY\n${hierarchy}${ends}MOTION\nFrames: 2\nFrame Time: 0.5\n${frame(0)}\n${frame(bend)}\n`;
}

for (const renderer of BACK_ENDS)
  describe(`story on ${renderer}`, { skip: skipWithoutData }, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => (site = await startSite({ isOffScreen: true, isCalm: true })));
    after(async () => await site?.close());

    /**
     * Tests on a fresh page, which must report no errors.
     * @param {string} name
     * @param {() => string} link
     * @param {(page: TestPage) => Promise<void>} body
     */
    const onPage = (name, link, body) =>
      test(name, async () => {
        const page = await site.page({ renderer, link: link() });
        try {
          await body(page);
          assert.deepEqual(page.troubles, []);
        } finally {
          await page.finish();
        }
      });

    onPage("a soldier and a walk are dropped, corrected, and shared by a link with somebody who has the same files", () => "", async (page) => {
      const files = [
        { name: "Soldier.glb", url: site.data(SOLDIER) },
        { name: "cmu_01_01.bvh", url: site.data(WALK) },
      ];
      await drop(page, files);
      await whenBorrowed(page, 1);
      const { map } = await state(page);
      assert.equal(map.length, 1, "a map is proposed");
      // Makes the left hand follow the right: changes two pairs of the compact form.
      const pairs = map[0].split(",");
      const corrected = [...pairs.slice(0, -2), ...pairs.slice(-2).map((pair) => pair.replace(/-\d+$/, "-3"))].join(",");
      assert.notEqual(corrected, map[0]);
      await apply(page, { map: [corrected], feet: "plant", play: 0, t: 1.5, camera: "40,12,4,0,1,0", show: "grid,skeleton", exposure: 0.5 });
      assert.deepEqual((await state(page)).map, [corrected]);
      // The Motion tab came forward.
      await toggleInspector(page);
      const before = await shown(page);
      assert.ok(before.pose.clip);
      const link = await sharedLink(page);
      assert.match(link, /model=file:Soldier\.glb/);
      assert.match(link, /motion=file:cmu_01_01\.bvh/);

      const other = await site.page({ renderer, link: afterHash(link) });
      try {
        await whenAsked(other);
        assert.deepEqual(await other.locator("#bring-files li").allInnerTexts(), ["Soldier.glb (model)", "cmu_01_01.bvh (motion)"]);
        assert.equal(await other.locator("#bring-sender").isVisible(), true);
        await other.locator("#bring-later").click();
        assert.equal((await state(other)).model.join(), "file:Soldier.glb", "an empty stage awaits it");
        // The files may arrive one at a time.
        await drop(other, files.slice(0, 1));
        await whenModel(other, "Soldier.glb");
        await drop(other, files.slice(1));
        await until(other, async () => (await window.gaitway.state()).t === 1.5);
        // So it does for a motion that arrives alone.
        await toggleInspector(other);
        assertSame(await shown(other), before);
        // After a reload, the address asks for the files again.
        await until(other, () => location.hash.includes("model=file:Soldier.glb") && location.hash.includes("t=1.5"));
        await other.reload();
        await whenReady(other);
        await whenAsked(other);
        assert.deepEqual(await Promise.all(["#bring-sender", "#bring-again"].map((id) => other.locator(id).isVisible())), [false, true]);
        const chooser = other.waitForEvent("filechooser");
        await other.locator("#bring-choose").click();
        // As browsers call a second download. The walk's clip has the name of its file.
        const copies = [[SOLDIER, "Soldier (1).glb"], [WALK, "cmu_01_01 (1).bvh"]];
        await (await chooser).setFiles(copies.map(([file, name]) => ({ name, mimeType: "", buffer: fs.readFileSync(dataFile(file)) })));
        await whenModel(other, "Soldier.glb");
        // The model is shown before the rest of the link. The motion follows it, as one that arrives alone.
        await until(other, async () => (await window.gaitway.state()).t === 1.5);
        await toggleInspector(other);
        assertSame(await shown(other), before);
        assert.deepEqual(other.troubles, []);
      } finally {
        await other.finish();
      }
    });

    onPage("a motion that arrives before its model waits for it, and both are shown as the link says", () => fragment([["model", "file:Soldier.glb"], ["motion", "file:cmu_01_01.bvh"], ["play", 0], ["t", 1]]), async (page) => {
      await whenAsked(page);
      await page.locator("#bring-later").click();
      await drop(page, [{ name: "cmu_01_01.bvh", url: site.data(WALK) }]);
      await whenAsked(page);
      assert.deepEqual(await page.locator("#bring-files li").allInnerTexts(), ["Soldier.glb (model)"]);
      assert.equal(await page.locator("#problem").textContent(), "", "nothing is refused");
      await page.locator("#bring-later").click();
      await drop(page, [{ name: "Soldier.glb", url: site.data(SOLDIER) }]);
      await whenBorrowed(page, 1);
      await until(page, async () => (await window.gaitway.state()).t === 1);
      assert.equal((await state(page)).feet, null, "the link says nothing of feet");
    });

    const TWO_CHARACTERS = () => fragment([["model", "file:Xbot.glb"], ["motion", "file:Soldier.glb"], ["clip", "Walk"], ["mirror", "Walk"], ["play", 0], ["t", 0.5]]);
    onPage("a character that lends its motion arrives together with the model, as a link asks for them", TWO_CHARACTERS, async (page) => {
      await whenAsked(page);
      assert.deepEqual(await page.locator("#bring-files li").allInnerTexts(), ["Xbot.glb (model)", "Soldier.glb (motion)"]);
      await page.locator("#bring-later").click();
      await drop(page, [{ name: "Soldier.glb", url: site.data(SOLDIER) }, { name: "Xbot.glb", url: site.data("threejs/Xbot.glb") }]);
      // The empty stage has the link's view, too, with the names as the link has them.
      await until(page, async () => (await window.gaitway.state()).motion.join() === "Soldier.glb");
      await until(page, async () => (await window.gaitway.state()).t === 0.5);
      const { model, motion, mirror } = /** @type {any} */ (await state(page));
      assert.deepEqual([model, motion, mirror], [["Xbot.glb"], ["Soldier.glb"], ["Walk"]]);
      assert.equal(await page.locator("#missing").isVisible(), false);
      assert.equal(await page.locator("#problem").textContent(), "");
      assert.equal(await controls(page, "button", "Close Soldier.glb").count(), 0, "it isn't another model");
      await until(page, () => location.hash.includes("motion=file:Soldier.glb"));
    });

    const THREE_FILES = () => fragment([["model", "file:Soldier.glb"], ["motion", "file:gone.bvh"], ["motion", "file:cmu_01_01.bvh"], ["clip", "cmu_01_01"], ["play", 0], ["t", 1], ["joint", 5]]);
    onPage("a link is shown as far as its files have arrived, while the page asks for the rest", THREE_FILES, async (page) => {
      await whenAsked(page);
      const entries = await page.evaluate(() => history.length);
      await page.locator("#bring-later").click();
      await drop(page, [{ name: "Soldier.glb", url: site.data(SOLDIER) }]);
      await whenAsked(page);
      assert.deepEqual(await page.locator("#bring-files li").allInnerTexts(), ["gone.bvh (motion)", "cmu_01_01.bvh (motion)"]);
      await page.locator("#bring-later").click();
      // Its clip stands in for that of the motion.
      const { t, joint, clip } = await state(page);
      assert.deepEqual([t, joint, clip], [1, 5, null]);
      await drop(page, [{ name: "cmu_01_01.bvh", url: site.data(WALK) }]);
      await whenAsked(page);
      assert.deepEqual(await page.locator("#bring-files li").allInnerTexts(), ["gone.bvh (motion)"]);
      await page.locator("#bring-later").click();
      await whenBorrowed(page, 1);
      assert.equal((await pose(page)).clip, "cmu_01_01");
      assert.equal((await state(page)).t, 1);
      // The files that have arrived are still there after something else. The page records the view a quarter of a second later.
      await untilStill(page);
      await apply(page, { model: "sample:walker", motion: null });
      await until(page, () => location.hash.includes("walker"));
      await page.goBack();
      await whenAsked(page);
      assert.deepEqual(await page.locator("#bring-files li").allInnerTexts(), ["gone.bvh (motion)"]);
      await page.locator("#bring-later").click();
      await whenBorrowed(page, 1);
      assert.deepEqual(await page.evaluate(() => [history.length - 1, location.hash.match(/file(:|%3A)/g)?.length]), [entries, 3], "the address has the whole link");
    });

    onPage("somebody who opens something else is told what the link asks for, but isn't asked any more", () => fragment([["model", "file:Soldier.glb"], ["exposure", 1]]), async (page) => {
      await whenAsked(page);
      await page.locator("#bring-later").click();
      assert.equal((await state(page)).exposure, 1, "what doesn't depend on the model is applied");
      const said = (/** @type {string} */ id, /** @type {string} */ text) => until(page, ([id, text]) => document.querySelector(id)?.textContent?.includes(text) === true, [id, text]);
      for (const name of ["scene.blend", "photo.png"]) {
        await drop(page, [{ name, text: "not a model" }]);
        await whenAsked(page);
        assert.equal(await page.locator("#bring-others").innerText(), `${name} couldn't be opened.`);
        await page.locator("#bring-later").click();
      }
      await drop(page, [{ name: "Fox.glb", url: site.data(FOX) }]);
      await whenShown(page, FOX_VERTICES);
      await said("#news", "This link needs Soldier.glb. Open a file with that name to see the shared view.");
      assert.equal(await page.locator("#problem").textContent(), "", "nothing went wrong");
      assert.equal(await page.locator("#bring").isVisible(), false);
      await apply(page, { exposure: 0.5 });
      await until(page, () => location.hash.includes("exposure=0.5"));
      await drop(page, [{ name: "scene.blend", text: "BLENDER" }]);
      await said("#problem", "scene.blend");
      assert.equal(await page.locator("#bring").isVisible(), false);
      await drop(page, [{ name: "Soldier - Copy.glb", url: site.data(SOLDIER) }]);
      await whenModel(page, "Soldier.glb");
      await until(page, async () => (await window.gaitway.state()).exposure === 1);
      await until(page, () => location.hash.includes("Soldier.glb"));
      assert.equal(await page.locator("#bring").isVisible(), false);
    });

    onPage("what somebody opens instead of a link's files survives a restart", () => fragment([["model", "file:Soldier.glb"]]), async (page) => {
      await whenAsked(page);
      await page.locator("#bring-later").click();
      await drop(page, [{ name: "Fox.glb", url: site.data(FOX) }]);
      await whenShown(page, FOX_VERTICES);
      await apply(page, { exposure: 0.5 });
      await page.evaluate(() => document.querySelector("canvas")?.dispatchEvent(new Event("webglcontextlost")));
      await page.locator("#stopped-again").click();
      await whenReady(page);
      await whenShown(page, FOX_VERTICES);
      assert.equal((await state(page)).exposure, 0.5);
      assert.equal(await page.locator("#bring").isVisible(), false);
    });

    onPage(
      "the dwarf walks like the avatar from a link, while its arms play its own clip",
      () => fragment([["model", site.data(DWARF)], ["motion", site.data(AVATAR_WALK)], ["map", JSON.stringify(DWARF_MAP)], ["t", 0.4], ["play", 0], ["camera", "30,5,4,0,0.8,0"]]),
      async (page) => {
        const own = await pose(page);
        await apply(page, { clip: "1" });
        assert.notDeepEqual((await pose(page)).nodes, own.nodes);
        const before = await shown(page);
        const link = await sharedLink(page);
        assert.match(link, /map=1\./, "the compact form");
        assert.ok(link.split("&").filter((pair) => !/^(.*#)?(model|motion)=/.test(pair)).join("&").length < 2000, link);
        const other = await site.page({ renderer, link: afterHash(link) });
        try {
          assertSame(await shown(other), before);
        } finally {
          await other.finish();
        }
      },
    );

    onPage("opening is undone and redone", () => fragment([["model", site.data(FOX)], ["clip", "Run"], ["t", 0.25], ["play", 0]]), async (page) => {
      const fox = await shown(page);
      await drop(page, [{ name: "CesiumMan.glb", url: site.data(CESIUM_MAN) }]);
      await whenShown(page, CESIUM_MAN_VERTICES);
      await apply(page, { play: 0, t: 1 });
      await page.locator("canvas").focus();
      await page.keyboard.press("Control+z");
      await whenShown(page, FOX_VERTICES);
      assert.deepEqual((await shown(page)).state, fox.state);
      assert.deepEqual((await pose(page)).nodes, fox.pose.nodes);
      await page.keyboard.press("Control+y");
      await whenShown(page, CESIUM_MAN_VERTICES);
      const { model, t } = await state(page);
      assert.deepEqual([model, t], [["CesiumMan.glb"], 1]);
    });

    onPage("motions add up, and two models arrive at once", () => fragment([["model", site.data("threejs/Xbot.glb")]]), async (page) => {
      await drop(page, [{ name: "a.bvh", url: site.data(WALK) }]);
      await whenBorrowed(page, 1);
      await drop(page, [{ name: "b.bvh", url: site.data("bvh/cosc422_Dance.bvh") }]);
      await whenBorrowed(page, 2);
      const { model, motion, map } = await state(page);
      assert.deepEqual([model.length, motion, map.length], [1, ["a.bvh", "b.bvh"], 2]);
      await drop(page, [
        { name: "Fox.glb", url: site.data(FOX) },
        { name: "CesiumMan.glb", url: site.data(CESIUM_MAN) },
      ]);
      await whenShown(page, FOX_VERTICES);
      assert.match((await page.locator("#news").textContent()) ?? "", /^Opened Fox\.glb\..*CesiumMan\.glb.* 3 clips, 24 joints, 576 triangles\.$/);
    });

    onPage("fifty edits are undone one by one", () => "play=0", async (page) => {
      await page.locator("canvas").focus();
      const steps = [await state(page)];
      for (let edit = 0; edit < 50; edit++) {
        await page.keyboard.press(["s", "g", "w"][edit % 3]);
        const before = JSON.stringify(steps.at(-1));
        await until(page, async (before) => JSON.stringify(await window.gaitway.state()) !== before, before);
        steps.push(await state(page));
      }
      const last = steps.at(-1);
      for (const step of steps.slice(0, -1).reverse()) {
        await page.keyboard.press("Control+z");
        await until(page, async (step) => JSON.stringify(await window.gaitway.state()) === step, JSON.stringify(step));
      }
      await until(page, () => document.querySelector("#news")?.textContent === "Undone: display. Steps left to undo: 0.");
      for (let edit = 0; edit < 50; edit++) await page.keyboard.press("Control+y");
      await until(page, async (last) => JSON.stringify(await window.gaitway.state()) === last, JSON.stringify(last));
    });

    onPage("a map of 300 joints is proposed, edited and shared", () => "play=0", async (page) => {
      /** @type {Record<string, string>} */
      const chains = { "model.bvh": longChain(1), "motion.bvh": longChain(2) };
      /** @param {TestPage} page */
      const serveChains = (page) =>
        page.route("https://chains.example/**", (route) =>
          route.fulfill({ body: chains[new URL(route.request().url()).pathname.slice(1)], headers: { "access-control-allow-origin": "*" } }),
        );
      await serveChains(page);
      await apply(page, { model: ["https://chains.example/model.bvh"], motion: ["https://chains.example/motion.bvh"], play: 0 });
      const { map } = await state(page);
      assert.equal(map[0].split(",").length, 300);
      const edited = map[0].replace(",5-5,", ",5-7,");
      assert.notEqual(edited, map[0]);
      await apply(page, { map: [edited], clip: "1", t: 0.5, joint: 5 });
      const before = await shown(page);
      console.log(`# ${renderer}, 300 joints: ${(await stats(page)).cpu_ms.toFixed(1)} ms of CPU time per frame`);
      const link = await sharedLink(page);
      assert.ok(link.length < 4000, `${link.length} characters`);
      // Any link, so that the gallery stays hidden.
      const other = await site.page({ renderer, link: "play=0" });
      try {
        await serveChains(other);
        await other.evaluate((link) => void (location.hash = link), afterHash(link));
        await until(other, async () => (await window.gaitway.state()).joint === 5);
        assertSame(await shown(other), before);
      } finally {
        await other.finish();
      }
    });
  });
