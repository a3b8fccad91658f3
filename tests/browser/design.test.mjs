// One design: what surrounds the canvas has the font, colours and text sizes of the panels in it.
import assert from "node:assert/strict";
import fs from "node:fs";
import { after, before, describe, test } from "node:test";
import sharp from "sharp";
import { BACK_ENDS, control, eventually, startServer, startSite, state, until, whenModel } from "./browser.mjs";

const THEME = fs.readFileSync("web/theme.css", "utf8");
const SIZES = ["small", "body", "heading"].map((name) => value(name));
const DESKTOP = { width: 1280, height: 720 };
const PHONE = { width: 390, height: 844 };

/** @param {string} name */
function value(name) {
  const found = THEME.match(new RegExp(`--${name}: (.*);`));
  assert.ok(found !== null, `web/theme.css has no ${name}`);
  return found[1];
}

/**
 * @param {string} name
 * @param {"light" | "dark"} scheme
 */
const color = (name, scheme) => value(name).match(/#[0-9a-f]{6}/g)?.[scheme === "light" ? 0 : 1] ?? "";

/** Returns the font sizes of all visible texts around the canvas, and the font that they ask for. */
function textsOfPage() {
  const visible = [...document.querySelectorAll("body *:not(#mirror *, script, style)")].filter(
    (element) => element.checkVisibility() && [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent?.trim() !== ""),
  );
  const styles = visible.map((element) => getComputedStyle(element));
  return { count: visible.length, sizes: [...new Set(styles.map(({ fontSize }) => fontSize))], fonts: [...new Set(styles.map(({ fontFamily }) => fontFamily.split(",")[0]))] };
}

for (const renderer of BACK_ENDS)
  describe(`design on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => void (site = await startSite({ isCalm: true })));
    after(() => site?.close());

    for (const viewport of [DESKTOP, PHONE])
      test(`page and panels share font, colours and sizes of text (${viewport.width} × ${viewport.height})`, async () => {
        const page = await site.page({ renderer, link: "", viewport });
        await until(page, () => [...document.fonts].some(({ family, status }) => family === "Gaitway" && status === "loaded"));
        assert.equal(page.requests.some((url) => /\.(ttf|woff2?)$/.test(url)), false, "the program contains the font");
        await page.locator("#gallery-own").click();
        const { count, sizes, fonts } = await page.evaluate(textsOfPage);
        assert.ok(count > 10, `${count} texts`);
        assert.deepEqual(sizes.filter((size) => !SIZES.includes(size)), []);
        assert.deepEqual(fonts, ["Gaitway"]);
        await page.locator("#open-cancel").click();
        for (const scheme of /** @type {const} */ (["light", "dark"])) {
          await page.emulateMedia({ colorScheme: scheme });
          // Between the header's buttons, and in the row of samples.
          const samples = await page.locator("#gallery").boundingBox();
          assert.ok(samples !== null);
          const pixel = async (/** @type {number} */ y) => {
            const png = await page.screenshot({ clip: { x: 2, y, width: 1, height: 1 } });
            const { data } = await sharp(png).removeAlpha().raw().toBuffer({ resolveWithObject: true });
            return `#${data.toString("hex", 0, 3)}`;
          };
          for (const y of [2, samples.y + 4]) await eventually(async () => (await pixel(y)) === color("panel", scheme), `${scheme} panels at ${y}`);
        }
        assert.deepEqual(page.troubles, []);
        await page.finish();
      });

    test("what a finger presses on a phone is high enough", async () => {
      const page = await site.page({ renderer, link: "", viewport: PHONE });
      const least = Number.parseInt(value("touch"), 10);
      const controls = await page.evaluate(() =>
        [...document.querySelectorAll("#gallery :is(a, button), #mirror button")].map((control) => ({ name: control.getAttribute("aria-label") ?? control.textContent, height: control.getBoundingClientRect().height })),
      );
      assert.ok(controls.length > 10, `${controls.length} controls`);
      assert.deepEqual(controls.filter(({ height }) => height < least), []);
      assert.deepEqual(page.troubles, []);
      await page.finish();
    });

    test("a load that the server doesn't answer yet is shown and can be cancelled", async () => {
      let isAsked = false;
      const silent = await startServer(() => (isAsked = true));
      const page = await site.page({ renderer });
      const opened = page.evaluate((url) => window.gaitway.open(url).then(() => "opened", ({ message }) => message), `${silent.address}/silent.glb`);
      await page.locator("#mirror").getByText("Opening silent.glb").first().waitFor({ state: "attached" });
      assert.ok(isAsked);
      await control(page, "button", "Cancel").press("Enter");
      assert.equal(await opened, "Opening was cancelled.");
      await until(page, () => document.querySelector("#mirror")?.textContent?.includes("silent.glb") === false);
      assert.deepEqual(page.troubles, []);
      silent.close();
      await page.finish();
    });

    test("a long load says how far it is and can be cancelled", async () => {
      let isClosed = false;
      const slow = await startServer((_, response) => {
        response.writeHead(200, { "access-control-allow-origin": "*", "content-length": 4_000_000 });
        response.write(Buffer.alloc(1_000_000));
        response.on("close", () => (isClosed = true));
      });
      const page = await site.page({ renderer });
      const before = await state(page);
      const opened = page.evaluate((url) => window.gaitway.open(url).then(() => "opened", ({ message }) => message), `${slow.address}/large.glb`);
      await page.locator("#mirror").getByText("1.0 of 4.0 MB", { exact: true }).waitFor({ state: "attached" });
      await control(page, "button", "Cancel").press("Enter");
      assert.equal(await opened, "Opening was cancelled.");
      await until(page, () => document.querySelector("#mirror")?.textContent?.includes("4.0 MB") === false);
      assert.deepEqual((await state(page)).model, before.model, "nothing else has changed");
      await eventually(() => isClosed, "the download should end");
      await page.evaluate(() => window.gaitway.open("sample:creature"));
      await whenModel(page, "sample:creature");
      assert.deepEqual(page.troubles, []);
      slow.close();
      await page.finish();
    });
  });
