// Checking an export: channels, hidden nodes and materials, lints and lists, on both back ends.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { UPPER, triangle } from "../three/triangle.mjs";
import { BACK_ENDS, apply, colorsOf, eventually, meanDifference, open, picture, startSite, state, stats, untilStill } from "./browser.mjs";

const CHANNELS = ["base-color", "normal", "tangent", "roughness", "metallic", "occlusion", "emissive", "uv", "vertex-color", "influences", "wireframe"];
/** Nothing but the character, from its front. */
const LINK = "v=1&model=sample:walker&play=0&show=no-shadow&background=ffffff";
/** Nodes of the walker with its body and its eyes. */
const [BODY, EYES] = [22, 23];

/**
 * Counts the pixels that are not the white background.
 * @param {import("./browser.mjs").Image} image
 */
const covered = ({ rgba }) => {
  let count = 0;
  for (let at = 0; at < rgba.length; at += 4) if (rgba[at] < 250 || rgba[at + 1] < 250 || rgba[at + 2] < 250) count += 1;
  return count;
};

for (const renderer of BACK_ENDS)
  describe(`checking an export on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => void (site = await startSite({ isOffScreen: true, pixelRatio: 0.5 })));
    after(() => site?.close());

    /**
     * @param {string} name
     * @param {(page: import("./browser.mjs").TestPage) => Promise<void>} body
     */
    const onPage = (name, body) =>
      test(name, async () => {
        const page = await site.page({ renderer, link: LINK });
        try {
          await body(page);
          assert.deepEqual(page.troubles, []);
        } finally {
          await page.finish();
        }
      });

    onPage("every channel is drawn, differs from the lit picture, and ignores light", async (page) => {
      const lit = await picture(page);
      for (const channel of CHANNELS) {
        await apply(page, { channel });
        const shown = await picture(page);
        assert.ok(meanDifference(shown, lit) > 1, `${channel} should differ from the lit picture`);
        await apply(page, { exposure: 3, tonemap: "aces", light: "hard" });
        assert.equal(meanDifference(await picture(page), shown), 0, `${channel} should ignore light and exposure`);
        await apply(page, { exposure: null, tonemap: null, light: null });
      }
      // The metallic channel of a robot without metal is black, its occlusion white.
      await apply(page, { channel: "metallic" });
      const black = await picture(page);
      assert.ok(covered(black) > 5000 && colorsOf(black) < 300, "only black, white and smooth edges");
    });

    onPage("a key cycles through the channels, and Shift goes back", async (page) => {
      await page.locator("canvas").focus();
      for (const channel of CHANNELS.slice(0, 3)) {
        await page.keyboard.press("v");
        await eventually(async () => (await state(page)).channel === channel, channel);
      }
      await page.keyboard.press("Shift+V");
      await eventually(async () => (await state(page)).channel === CHANNELS[1], CHANNELS[1]);
    });

    onPage("hidden nodes and materials are neither drawn nor in the saved picture, and come back", async (page) => {
      await untilStill(page);
      const whole = await picture(page);
      const { triangles } = await stats(page);
      await apply(page, { hidden: `${BODY}` });
      const eyes = await picture(page);
      assert.ok(covered(eyes) > 0 && covered(eyes) < 0.1 * covered(whole), "only the eyes");
      assert.ok((await stats(page)).triangles < triangles);
      await apply(page, { hidden: `${BODY},${EYES}` });
      assert.equal(covered(await picture(page)), 0);
      assert.equal((await stats(page)).triangles, 0);
      await apply(page, { hidden: "m0" });
      const withoutShell = covered(await picture(page));
      assert.ok(withoutShell > 0 && withoutShell < covered(whole));
      await apply(page, { hidden: null });
      assert.equal(meanDifference(await picture(page), whole), 0);
    });

    test("a model's lints are in the inspect document", async () => {
      const page = await site.page({ renderer, link: LINK, files: { "uneven.gltf": JSON.stringify(uneven()) } });
      try {
        const { warnings } = await open(page, "https://files.example/uneven.gltf");
        assert.deepEqual(warnings.map(({ code, where }) => [code, where]), [["scale-non-uniform", "nodes[0]"]]);
      } finally {
        await page.finish();
      }
    });
  });

/** A skinned triangle whose upper joint scales unevenly. */
function uneven() {
  const { document } = triangle();
  Object.assign(document.nodes[UPPER], { scale: [1, 2, 1] });
  return document;
}
