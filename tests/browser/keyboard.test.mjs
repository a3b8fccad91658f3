// The page without a pointer: by keyboard, and by what browsers tell assistive technology.
import assert from "node:assert/strict";
import fs from "node:fs";
import { after, before, describe } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, control, eventually, fragment, onOneBackEnd, startSite, state, until, untilStill, whenBorrowed, whenModel } from "./browser.mjs";

const SOLDIER = "threejs/Soldier.glb";
const WALK = "bvh/cmu_01_01.bvh";
const AXE = fs.readFileSync(new URL("../../node_modules/axe-core/axe.min.js", import.meta.url), "utf8");

/** @typedef {import("./browser.mjs").TestPage} TestPage */

/** @param {TestPage} page */
const whenMirrored = (page) => page.locator("#mirror button").first().waitFor({ state: "attached" });

/**
 * Returns the ids of the panels' controls, in reading order. Those of a list count as one: its arrow keys lead to them.
 * @param {TestPage} page
 */
const controlIds = (page) =>
  page.evaluate(() => {
    /** @type {Map<Element, string[]>} */
    const ids = new Map();
    for (const control of /** @type {NodeListOf<HTMLElement>} */ (document.querySelectorAll("#mirror :is(button, input, [tabindex])"))) {
      const place = control.closest("[role=tablist], [role=tree], [role=radiogroup], [role=grid]") ?? control;
      ids.set(place, [...(ids.get(place) ?? []), control.dataset.id ?? ""]);
    }
    return [...ids.values()];
  });

/**
 * Returns the name and id of the focused element, whether its ring is visible, and whether it is one of the panels' controls.
 * @param {TestPage} page
 */
const focused = (page) =>
  page.evaluate(() => {
    const element = document.activeElement;
    if (!(element instanceof HTMLElement) || element === document.body) return null;
    const { width, height } = element.getBoundingClientRect();
    return {
      name: element.getAttribute("aria-label") ?? element.textContent?.trim() ?? "",
      isSeen: element.matches(":focus-visible") && getComputedStyle(element).outlineStyle !== "none" && width > 0 && height > 0,
      isMirrored: element.closest("#mirror") !== null,
      id: element.dataset.id ?? "",
    };
  });

/**
 * Presses Tab until this has the keyboard.
 * @param {TestPage} page
 * @param {RegExp} name
 */
async function tabTo(page, name) {
  for (let press = 0; press < 200; press++) {
    await page.keyboard.press("Tab");
    if (name.test((await focused(page))?.name ?? "")) return;
  }
  assert.fail(`Tab doesn't lead to ${name}`);
}

/**
 * Types a URL into the dialog for opening.
 * @param {TestPage} page
 * @param {string} url
 */
async function typeUrl(page, url) {
  await page.locator("#open").waitFor({ state: "visible" });
  for (let press = 0; press < 20 && !(await page.locator("#open-url").evaluate((field) => field === document.activeElement)); press++) await page.keyboard.press("Tab");
  await page.keyboard.type(url);
  await page.keyboard.press("Enter");
}

for (const renderer of BACK_ENDS)
  describe(`keyboard and assistive technology on ${renderer}`, { skip: skipWithoutData }, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => (site = await startSite({ isOffScreen: true })));
    after(async () => await site?.close());

    const once = onOneBackEnd(renderer);
    /**
     * @param {string} name
     * @param {() => string} link
     * @param {(page: TestPage) => Promise<void>} body
     */
    const onPage = (name, link, body) =>
      once(name, async () => {
        const page = await site.page({ renderer, link: link(), viewport: { width: 1440, height: 900 } });
        try {
          await whenMirrored(page);
          await body(page);
          assert.deepEqual(page.troubles, []);
        } finally {
          await page.finish();
        }
      });

    onPage("Tab visits every control once, shows where it is, and leaves the page", () => "play=0", async (page) => {
      await page.locator("canvas").focus();
      /** @type {{ name: string, id: string }[]} */
      const visited = [];
      for (let press = 0; press < 300; press++) {
        await page.keyboard.press("Tab");
        const at = await focused(page);
        if (at === null || !at.isMirrored) break;
        assert.ok(at.isSeen, `no focus ring on ${at.name}`);
        visited.push(at);
      }
      const controls = await controlIds(page);
      const places = visited.map(({ id }) => controls.findIndex((ids) => ids.includes(id)));
      const names = visited.map(({ name }) => name);
      assert.equal(await page.locator("#mirror").evaluate((mirror) => mirror.scrollTop), 0, "the rings are over the controls");
      assert.deepEqual(places, [...controls.keys()], `each control once, in order: ${names.join(", ")}`);
      for (const name of [/^Play/, /^Time/, /Open/, /Share/]) assert.ok(names.some((stop) => name.test(stop)), `${name} in ${names.join(", ")}`);
      await page.locator("canvas").focus();
      await page.keyboard.press("Shift+Tab");
      assert.equal((await focused(page))?.isMirrored, true, "backwards, too");
    });

    onPage("undo in a number field takes back what was entered", () => "model=sample:pilot&joint=2&play=0", async (page) => {
      await control(page, "checkbox", "Pose manually").press("Enter");
      const field = control(page, "spinbutton", "Rotation X");
      const before = await field.inputValue();
      await field.fill("45");
      await field.press("Enter");
      await until(page, async () => (await window.gaitway.state()).pose !== "");
      await field.press("Control+z");
      await until(page, async () => (await window.gaitway.state()).pose === "");
      await eventually(async () => (await field.inputValue()) === before, "the field shows it");
      await page.keyboard.press("Tab");
      await page.waitForTimeout(500);
      assert.equal((await state(page)).pose, "", "leaving the field enters nothing");
    });

    onPage("undo and deleting a word in a text field happen once", () => "model=sample:pilot&play=0", async (page) => {
      const field = control(page, "textbox", /^Search/);
      // The field shows what the program has once it is left.
      const leave = async () => {
        await page.keyboard.press("Tab");
        await page.waitForTimeout(300);
        return await field.inputValue();
      };
      await field.focus();
      await page.keyboard.type("left upper arm");
      await page.keyboard.press("Control+Backspace");
      assert.equal(await field.inputValue(), "left upper ");
      assert.equal(await leave(), "left upper ");
      await field.focus();
      await page.keyboard.type("leg");
      await page.keyboard.press("Control+z");
      const undone = await field.inputValue();
      assert.equal(await leave(), undone);
    });

    onPage("what an input method enters comes after what was typed", () => "model=sample:pilot&play=0", async (page) => {
      const field = control(page, "textbox", /^Search/);
      const box = (await field.boundingBox()) ?? assert.fail("a field");
      await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
      await until(page, () => document.activeElement?.parentElement?.id === "stage" && document.activeElement instanceof HTMLInputElement);
      const method = await page.context().newCDPSession(page);
      await page.keyboard.type("le");
      await method.send("Input.insertText", { text: "ft" });
      await page.keyboard.type(" h");
      await method.send("Input.imeSetComposition", { text: "a", selectionStart: 1, selectionEnd: 1 });
      await method.send("Input.insertText", { text: "an" });
      await page.keyboard.type("d");
      await eventually(async () => (await field.inputValue()) === "left hand");
    });

    onPage("after Enter or Escape, a text field shows what the program has, and typing goes on", () => "model=sample:pilot&play=0", async (page) => {
      await control(page, "tab", "Motion").press("Enter");
      const field = control(page, "textbox", "Clip name");
      const isShown = (/** @type {string} */ name) => eventually(async () => (await field.inputValue()) === name, name);
      const isNamed = (/** @type {string} */ name) => until(page, async (name) => (await window.gaitway.state()).rename.some((renamed) => renamed.endsWith(`:${name}`)), name);
      await field.focus();
      await page.keyboard.press("Control+A");
      // The spaces around a name don't count.
      await page.keyboard.type(" Stroll ");
      await page.keyboard.press("Enter");
      await isNamed("Stroll");
      await isShown("Stroll");
      await page.keyboard.type("s");
      await page.keyboard.press("Enter");
      await isNamed("Strolls");
      await page.keyboard.type("!");
      await page.keyboard.press("Escape");
      await isShown("Strolls");
      await page.keyboard.type("?");
      await page.keyboard.press("Enter");
      await isNamed("Strolls?");
    });

    onPage("keys reach the program while nothing has the focus", () => "play=0", async (page) => {
      assert.equal(await focused(page), null);
      await page.keyboard.press("Space");
      await until(page, async () => (await window.gaitway.state()).play);
      await page.locator("canvas").evaluate((canvas) => canvas.blur());
      await page.keyboard.press("?");
      await page.locator("#mirror [role=dialog]").waitFor({ state: "attached" });
      await page.keyboard.press("Escape");
      await page.locator("#mirror [role=dialog]").waitFor({ state: "detached" });
      await page.keyboard.press("Tab");
      assert.equal((await focused(page))?.id, (await controlIds(page))[0][0], "Tab begins with the first control");
    });

    onPage("a menu is walked through and left by keys while nothing moves", () => "play=0", async (page) => {
      await tabTo(page, /^Export/);
      await page.keyboard.press("Enter");
      await until(page, () => document.activeElement?.closest("#mirror > [role=group]") !== null);
      const first = await focused(page);
      for (const [key, step] of /** @type {const} */ ([["ArrowDown", 1], ["ArrowDown", 2], ["ArrowDown", 3], ["ArrowUp", 2], ["ArrowUp", 1]])) {
        await untilStill(page);
        await page.keyboard.press(key);
        const isAway = (/** @type {readonly [string, number]} */ [id, step]) => {
          const entries = /** @type {HTMLElement[]} */ ([...(document.activeElement?.parentElement?.children ?? [])]);
          return entries[entries.findIndex((entry) => entry.dataset.id === id) + step] === document.activeElement;
        };
        await until(page, isAway, /** @type {const} */ ([first?.id ?? "", step]));
      }
      const entry = control(page, "button", "Image and video settings…");
      await entry.press("Enter");
      await entry.waitFor({ state: "detached" });
      await until(page, () => /^Export/.test(document.activeElement?.getAttribute("aria-label") ?? ""));
    });

    onPage("a character is opened, walks, and is shared without a pointer", () => "play=0", async (page) => {
      await page.keyboard.press("Control+o");
      await typeUrl(page, site.data(SOLDIER));
      await whenModel(page, site.data(SOLDIER));
      await tabTo(page, /^Borrow/);
      await page.keyboard.press("Enter");
      await typeUrl(page, site.data(WALK));
      await whenBorrowed(page, 1);
      await tabTo(page, /^Time$/);
      await page.keyboard.press("Home");
      await until(page, async () => (await window.gaitway.state()).t === 0);
      await page.keyboard.press("ArrowRight");
      await until(page, async () => (await window.gaitway.state()).t > 0);
      await tabTo(page, /^Play$/);
      await page.keyboard.press("Enter");
      await until(page, async () => (await window.gaitway.state()).play);
      await tabTo(page, /^Export/);
      await page.keyboard.press("Enter");
      await until(page, () => /\.glb|PNG|clip/i.test(document.activeElement?.getAttribute("aria-label") ?? ""));
      await page.keyboard.press("Escape");
      await until(page, () => /^Export/.test(document.activeElement?.getAttribute("aria-label") ?? ""));
      const entry = control(page, "button", "Image and video settings…");
      await entry.waitFor({ state: "detached" });
      await page.keyboard.press("Enter");
      await entry.waitFor({ state: "attached" });
      await tabTo(page, /^Share/);
      await entry.waitFor({ state: "detached" });
      assert.match((await focused(page))?.name ?? "", /^Share/, "Tab closes the menu that it leaves");
      await page.keyboard.press("Enter");
      await page.locator("#share").waitFor({ state: "visible" });
      const link = await page.locator("#share-link").inputValue();
      assert.match(link, /model=.*Soldier\.glb.*motion=.*cmu_01_01\.bvh/);
    });

    onPage("a menu that opens late leaves the focus where it went meanwhile", () => "play=0", async (page) => {
      const opener = control(page, "button", "Export");
      await opener.focus();
      await untilStill(page);
      await opener.evaluate((button) => {
        /** @type {HTMLElement} */ (button).click();
        /** @type {HTMLElement | null} */ (document.querySelector('#mirror [aria-label^="Share"]'))?.focus();
      });
      await page.locator("#mirror > [role=group]").waitFor({ state: "attached" });
      await untilStill(page);
      assert.match((await focused(page))?.name ?? "", /^Share/);
      await page.keyboard.press("Enter");
      await page.locator("#share").waitFor({ state: "visible" });
    });

    onPage("nothing under the help has the keyboard, which comes back where it was", () => "play=0", async (page) => {
      await control(page, "button", "Export").focus();
      await page.keyboard.press("?");
      await control(page, "button", "Close help").waitFor({ state: "attached" });
      const reachable = () => page.locator("#mirror button, #mirror input, #mirror [tabindex]").evaluateAll((stops) => stops.filter((stop) => stop.closest("[inert]") === null).map((stop) => stop.ariaLabel));
      assert.deepEqual(await reachable(), ["Close help"]);
      await page.keyboard.press("Tab");
      assert.equal(await page.evaluate(() => document.activeElement?.closest("#stage") ?? null), null, "it leaves the program");
      await control(page, "button", "Close help").focus();
      await page.keyboard.press("Escape");
      await until(page, () => document.activeElement?.getAttribute("aria-label") === "Export");
      assert.ok((await reachable()).length > 10);
      // Keys that mean nothing to a button are the viewer's.
      await page.keyboard.press("w");
      await until(page, async () => (await window.gaitway.state()).show.includes("wireframe"));
    });

    onPage("high contrast leaves the mirror invisible", () => "play=0", async (page) => {
      await page.emulateMedia({ forcedColors: "active" });
      const visible = await page.evaluate(() => [...document.querySelectorAll("#mirror *")].filter((element) => getComputedStyle(element).color !== "rgba(0, 0, 0, 0)").map(({ outerHTML }) => outerHTML));
      assert.equal(await page.evaluate(() => matchMedia("(forced-colors: active)").matches), true);
      assert.deepEqual(visible, []);
    });

    onPage("the panels are read and operated through the mirror", () => fragment([["model", site.data(SOLDIER)], ["motion", site.data(WALK)], ["play", 0]]), async (page) => {
      await control(page, "tab", "Scene").press("Enter");
      await eventually(async () => (await control(page, "tab", "Scene").getAttribute("aria-selected")) === "true");
      const joint = control(page, "treeitem", /Hips/);
      await joint.press("Enter");
      await until(page, async () => (await window.gaitway.state()).joint !== null);
      for (const [key, index] of /** @type {const} */ ([["End", -1], ["Home", 0]])) {
        await untilStill(page);
        await page.keyboard.press(key);
        await until(page, (index) => [...document.querySelectorAll("#mirror [role=treeitem]")].at(index) === document.activeElement, index);
      }
      // Arrow keys move the program's focus, and the keyboard follows.
      await control(page, "tab", "Scene").press("ArrowRight");
      await until(page, () => document.activeElement?.getAttribute("aria-label") === "Display");
      await eventually(async () => (await control(page, "tab", "Display").getAttribute("aria-selected")) === "true");
      await control(page, "tab", "Display").press("Home");
      await eventually(async () => (await control(page, "tab", "Scene").getAttribute("aria-selected")) === "true");
      await control(page, "tab", "Camera").press("Enter");
      const light = page.locator("#mirror").getByRole("radiogroup", { name: "Light", exact: true });
      await light.getByRole("radio").first().waitFor({ state: "attached" });
      const exposure = control(page, "slider", /Exposure/);
      await exposure.press("ArrowRight");
      await until(page, async () => (await window.gaitway.state()).exposure !== 0);
      await eventually(async () => Number(await exposure.inputValue()) !== 0);
      await control(page, "slider", "Time").fill("0.5");
      await until(page, async () => Math.abs((await window.gaitway.state()).t - 0.5) < 0.02);
      await control(page, "tab", "Motion").press("Enter");
      const cell = control(page, "gridcell", /Hips/).first();
      await cell.press("Enter");
      // The open row's controls divide the table.
      await until(page, () => document.querySelectorAll("[role=grid]").length === 2);
      await cell.press("ArrowDown");
      await until(page, () => document.activeElement?.role === "gridcell" && !/Hips/.test(document.activeElement.ariaLabel ?? ""));
    });

    onPage("axe finds nothing wrong", () => fragment([["model", site.data(SOLDIER)], ["motion", site.data(WALK)], ["play", 0]]), async (page) => {
      for (const tab of ["Scene", "Display", "Info", "Camera", "Motion"]) {
        await control(page, "tab", tab).press("Enter");
        await eventually(async () => (await control(page, "tab", tab).getAttribute("aria-selected")) === "true");
        const violations = await page.evaluate(`${AXE}; axe.run(document, { resultTypes: ["violations"] }).then(({ violations }) => violations.map(({ id, nodes }) => id + ": " + nodes.slice(0, 3).map(({ html }) => html).join(" ")))`);
        assert.deepEqual(violations, [], tab);
      }
    });
  });
