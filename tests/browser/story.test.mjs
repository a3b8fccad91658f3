// Whole stories on both back ends: what somebody brings along, mends and hands on, and what the other sees of it.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, apply, drop, fragment, meanDifference, picture, pose, share, startSite, state, stats, until, untilStill, whenReady, whenShown } from "./browser.mjs";

const SOLDIER = "threejs/Soldier.glb";
const FOX = "khronos/Fox/glTF-Binary/Fox.glb";
const FOX_VERTICES = 1728;
const CESIUM_MAN = "khronos/CesiumMan/glTF-Binary/CesiumMan.glb";
const CESIUM_MAN_VERTICES = 3273;
const WALK = "bvh/cmu_01_01.bvh";
const DWARF = "cosc422/dwarf.glb";
const AVATAR_WALK = "cosc422/original/Dwarf/avatar_walk.bvh";

/** Which of the dwarf's joints follow which channel of the walk; its arms and the rest do what its own clip has. */
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

const afterHash = (address) => address.split("#")[1];

async function sharedLink(page) {
  await share(page);
  const link = await page.locator("#share-link").inputValue();
  await page.locator("#share-close").click();
  return link;
}

/** All that two pages show alike: the state, the numbers, the picture. */
async function shown(page) {
  await untilStill(page);
  return { state: await state(page), pose: await pose(page), picture: await picture(page) };
}

function assertSame(found, expected) {
  assert.deepEqual(found.state, expected.state);
  assert.deepEqual(found.pose, expected.pose);
  assert.equal(meanDifference(found.picture, expected.picture), 0);
}

const whenAsked = (page) => page.locator("#bring").waitFor({ state: "visible" });

/** Waits until as many motions are borrowed from. */
const whenBorrowed = (page, count) => until(page, async (count) => (await window.gaitway.state()).motion.length === count, count);

/** Chains of 300 joints that know each other by name. */
function longChain(bend) {
  const joint = (index) => {
    const head = index === 0 ? "ROOT" : "JOINT";
    const channels = index === 0 ? "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation" : "CHANNELS 3 Zrotation Xrotation Yrotation";
    return `${head} joint${index}\n{\nOFFSET 0 ${index === 0 ? 0 : 1} 0\n${channels}\n`;
  };
  const count = 300;
  const hierarchy = Array.from({ length: count }, (_, index) => joint(index)).join("");
  const ends = `End Site\n{\nOFFSET 0 1 0\n}\n${"}\n".repeat(count)}`;
  const frame = (angle) => ["0 0 0 0 0 0", ...Array.from({ length: count - 1 }, () => `${angle} 0 0`)].join(" ");
  return `HIERARCHY\n${hierarchy}${ends}MOTION\nFrames: 2\nFrame Time: 0.5\n${frame(0)}\n${frame(bend)}\n`;
}

for (const renderer of BACK_ENDS)
  describe(`story on ${renderer}`, { skip: skipWithoutData }, () => {
    let site;
    before(async () => (site = await startSite()));
    after(async () => await site?.close());

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

    onPage("a soldier and a walk are dropped, mended, and handed on by a link to somebody who has the same files", () => "", async (page) => {
      const files = [
        { name: "Soldier.glb", url: site.data(SOLDIER) },
        { name: "cmu_01_01.bvh", url: site.data(WALK) },
      ];
      await drop(page, files);
      await whenBorrowed(page, 1);
      const { map } = await state(page);
      assert.equal(map.length, 1, "a map is proposed");
      // The left hand is to follow the right: two pairs of the compact form are changed.
      const pairs = map[0].split(",");
      const mended = [...pairs.slice(0, -2), ...pairs.slice(-2).map((pair) => pair.replace(/-\d+$/, "-3"))].join(",");
      assert.notEqual(mended, map[0]);
      await apply(page, { map: [mended], feet: "plant", play: 0, t: 1.5, camera: "40,12,4,0,1,0", show: "grid,skeleton", exposure: 0.5 });
      assert.deepEqual((await state(page)).map, [mended]);
      const before = await shown(page);
      assert.ok(before.pose.clip.length > 0);
      const link = await sharedLink(page);
      assert.match(link, /model=file:Soldier\.glb/);
      assert.match(link, /motion=file:cmu_01_01\.bvh/);

      const other = await site.page({ renderer, link: afterHash(link) });
      try {
        await whenAsked(other);
        assert.deepEqual(await other.locator("#bring-files li").allInnerTexts(), ["Soldier.glb (the model)", "cmu_01_01.bvh (motion)"]);
        await other.getByRole("button", { name: "Not now" }).click();
        assert.match((await state(other)).model.join(), /^(sample:.*)?$/, "the sample meanwhile");
        // One after the other is as good as both at once.
        await drop(other, files.slice(0, 1));
        await until(other, async () => (await window.gaitway.state()).model.join() === "Soldier.glb");
        await drop(other, files.slice(1));
        await until(other, async () => (await window.gaitway.state()).t === 1.5);
        assertSame(await shown(other), before);
        // The address asks again for what nobody keeps.
        await until(other, () => location.hash.includes("model=file:Soldier.glb") && location.hash.includes("t=1.5"));
        await other.reload();
        await whenReady(other);
        await whenAsked(other);
        await other.getByRole("button", { name: "Not now" }).click();
        await drop(other, files);
        await until(other, async () => (await window.gaitway.state()).t === 1.5);
        assertSame(await shown(other), before);
        assert.deepEqual(other.troubles, []);
      } finally {
        await other.finish();
      }
    });

    onPage("somebody who opens something else is not asked any more", () => fragment([["model", "file:Soldier.glb"], ["exposure", 1]]), async (page) => {
      await whenAsked(page);
      await page.getByRole("button", { name: "Not now" }).click();
      assert.equal((await state(page)).exposure, 1, "what does not hang on the model is there");
      await drop(page, [{ name: "Fox.glb", url: site.data(FOX) }]);
      await whenShown(page, FOX_VERTICES);
      await drop(page, [{ name: "Soldier.glb", url: site.data(SOLDIER) }]);
      await until(page, async () => (await window.gaitway.state()).model.join() === "Soldier.glb");
      await until(page, () => location.hash.includes("Soldier.glb"));
      assert.equal(await page.locator("#bring").isVisible(), false);
    });

    onPage(
      "the dwarf walks like the avatar, given as a link, while its arms do their own",
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

    onPage("what was opened is taken back and done again", () => fragment([["model", site.data(FOX)], ["clip", "Run"], ["t", 0.25], ["play", 0]]), async (page) => {
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

    onPage("motions add up, and two models come at once", () => fragment([["model", site.data("threejs/Xbot.glb")]]), async (page) => {
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
      assert.match(await page.locator("#news").textContent(), /Fox/);
    });

    onPage("fifty edits are taken back one by one", () => "play=0", async (page) => {
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
      for (let edit = 0; edit < 50; edit++) await page.keyboard.press("Control+y");
      await until(page, async (last) => JSON.stringify(await window.gaitway.state()) === last, JSON.stringify(last));
    });

    onPage("a map of 300 joints is proposed, edited and handed on", () => "play=0", async (page) => {
      const chains = { "model.bvh": longChain(1), "motion.bvh": longChain(2) };
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
      console.log(`# ${renderer}, 300 joints: ${(await stats(page)).cpu_ms.toFixed(1)} ms of the processor in a frame`);
      const link = await sharedLink(page);
      assert.ok(link.length < 4000, `${link.length} characters`);
      // Any link, so that there is no gallery.
      const other = await site.page({ renderer, link: "play=0" });
      try {
        await serveChains(other);
        await other.evaluate((link) => (location.hash = link), afterHash(link));
        await until(other, async () => (await window.gaitway.state()).joint === 5);
        assertSame(await shown(other), before);
      } finally {
        await other.finish();
      }
    });
  });
