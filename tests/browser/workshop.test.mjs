// Edited motions on each back end: changed clips, kept contacts, pins and gazes, and what is saved of them.
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { skipWithoutData } from "../three/data.mjs";
import { BACK_ENDS, apply, centreOf, control, controls, eventually, resize, savedBy, startSite, state, toggleInspector, until, untilStill, whenBorrowed, whenReady } from "./browser.mjs";

const WALKER = "model=sample:walker&clip=Walk&play=0";
/** Height of the walker, and duration of its walk. */
const HEIGHT_METRES = 1.76;
const WALK_SECS = 16 / 15;
const WALKER_CLIPS = 3;
/** Joints of the walker, by index in the file. */
const HEAD = 5;
const LEFT_HAND = 9;
const LEFT_FOOT = 16;
/** Nodes of the walker that its clips don't carry. */
const FIXED = ["Root", "Body", "Eyes"];

const MALE = "mesh2motion/human-male.glb";
const PUSH_UP = "mesh2motion/retarget/mixamo-original-rig.glb";

/** In metres, or as an entry of a rotation matrix. */
const ROUNDING = 1e-6;

/** @typedef {import("./browser.mjs").TestPage} TestPage */
/** World matrices, column by column, by the joint's name. @typedef {Record<string, number[]>} Joints */

/**
 * Applies keys of the link and returns the joints that are then shown.
 * @param {TestPage} page
 * @param {object} partial
 * @returns {Promise<Joints>}
 */
const joints = (page, partial) =>
  page.evaluate(async (partial) => {
    await window.gaitway.apply(partial);
    const { nodes } = await window.gaitway.pose();
    return Object.fromEntries(nodes.map(({ name, world }) => [name, world]));
  }, partial);

/** @param {number[]} world */
const position = (world) => world.slice(12, 15);
/** @type {(a: number[], b: number[]) => number} */
const distance = (a, b) => Math.hypot(...a.map((value, axis) => value - b[axis]));
/** @type {(values: number[]) => number} */
const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

/**
 * Returns the largest difference between entries of corresponding matrices.
 * @param {Joints} actual
 * @param {Joints} expected
 * @param {string[]} [names]
 */
function difference(actual, expected, names = Object.keys(expected)) {
  return Math.max(...names.flatMap((name) => expected[name].map((value, at) => Math.abs(actual[name][at] - value))));
}

/**
 * Returns the largest distance between the positions of these joints, in metres.
 * @type {(a: Joints, b: Joints, names: string[]) => number}
 */
const furthestJoint = (a, b, names) => Math.max(...names.map((name) => distance(position(a[name]), position(b[name]))));

/**
 * Returns the largest angle between these joints, in degrees: the Frobenius norm of two rotations' difference is √8 · sin(angle / 2).
 * @type {(a: Joints, b: Joints, names: string[]) => number}
 */
function largestAngle(a, b, names) {
  const norms = names.map((name) => distance(a[name].slice(0, 11), b[name].slice(0, 11)));
  return (360 / Math.PI) * Math.asin(Math.max(...norms) / Math.sqrt(8));
}

/**
 * Reflects a pose across the plane X = 0, which swaps left and right. At rest, the walker's joints aren't rotated.
 * @param {Joints} pose
 * @returns {Joints}
 */
function reflected(pose) {
  const other = (/** @type {string} */ name) => name.replace(/Left|Right/, (side) => (side === "Left" ? "Right" : "Left"));
  const isAlongX = (/** @type {number} */ at) => at % 4 === 0;
  const reflect = (/** @type {number[]} */ world) => world.map((value, at) => (isAlongX(at) === at < 4 ? value : -value));
  return Object.fromEntries(Object.keys(pose).map((name) => [name, reflect(pose[other(name)])]));
}

/**
 * Turns what the clip carries about the vertical through a point, counter-clockwise seen from above, then moves it.
 * @param {Joints} pose
 * @param {number[]} pivot
 * @param {{ degrees: number, x: number, z: number }} path
 * @returns {Joints}
 */
function placed(pose, [px, , pz], { degrees, x, z }) {
  const [sin, cos] = [Math.sin((degrees * Math.PI) / 180), Math.cos((degrees * Math.PI) / 180)];
  const turn = (/** @type {number[]} */ [x, y, z, w]) => [cos * x + sin * z, y, cos * z - sin * x, w];
  /** @param {number[]} world */
  const place = (world) => {
    const [ax, ay, az] = turn([world[12] - px, world[13], world[14] - pz, 1]);
    return [...[0, 4, 8].flatMap((at) => turn(world.slice(at, at + 4))), ax + px + x, ay, az + pz + z, 1];
  };
  return Object.fromEntries(Object.entries(pose).map(([name, world]) => [name, FIXED.includes(name) ? world : place(world)]));
}

/**
 * Changes of the walk and what each pose of the changed clip is, made of poses of the original.
 * @type {{ mirror?: string, change?: string, expected: (original: (t: number) => Promise<Joints>, t: number) => Promise<Joints> }[]}
 */
const CHANGES = [
  { mirror: "Walk", expected: async (original, t) => reflected(await original(t)) },
  { change: "Walk:reverse", expected: (original, t) => original(WALK_SECS - t) },
  { change: "Walk:speed:1.6", expected: (original, t) => original(1.6 * t) },
  { change: "Walk:trim:0.25:0.75", expected: (original, t) => original(0.25 + t) },
  { change: "Walk:trim:0.2:0.8,reverse,speed:0.5", expected: (original, t) => original(0.8 - 0.5 * t) },
  {
    mirror: "Walk",
    change: "Walk:offset:1:-2,turn:70",
    expected: async (original, t) => placed(reflected(await original(t)), position(reflected(await original(0)).Hips), { degrees: 70, x: 1, z: -2 }),
  },
];

/**
 * Returns the angle between a head's line of sight, its Z axis, and the direction of a point, in degrees.
 * @param {number[]} head
 * @param {number[]} point
 */
function gazeError(head, point) {
  const [ahead, towards] = [head.slice(8, 11), point.map((value, axis) => value - position(head)[axis])];
  const dot = ahead.reduce((sum, value, axis) => sum + value * towards[axis], 0);
  const cross = [0, 1, 2].map((axis) => ahead[(axis + 1) % 3] * towards[(axis + 2) % 3] - ahead[(axis + 2) % 3] * towards[(axis + 1) % 3]);
  return (Math.atan2(Math.hypot(...cross), dot) * 180) / Math.PI;
}

/**
 * Opens a part of the Motion tab; without a borrowed motion, there is only one.
 * @param {TestPage} page
 * @param {string} [part]
 */
async function showMotionTab(page, part) {
  await resize(page, 1280, 800);
  await toggleInspector(page);
  await control(page, "tab", "Motion").press("Enter");
  if (part !== undefined) await control(page, "radio", part).press("Enter");
}

/**
 * Presses a switch and waits until it is on or off.
 * @param {TestPage} page
 * @param {string} name
 * @param {boolean} isOn
 */
async function flip(page, name, isOn) {
  const box = controls(page, "checkbox", name, true);
  await box.press("Enter");
  await eventually(async () => (await box.getAttribute("aria-checked")) === String(isOn), `${name}: ${isOn}`);
}

/**
 * Types a number into a field and waits until the view has it: while the field has the focus, its cursor blinks.
 * @param {TestPage} page
 * @param {string} name
 * @param {string} text
 * @param {"change" | "layers"} key
 * @param {string} expected The first value of the key.
 */
async function enter(page, name, text, key, expected) {
  const number = control(page, "spinbutton", name);
  await number.fill(text);
  await number.press("Enter");
  await until(page, async ([key, expected]) => (await window.gaitway.state())[/** @type {"change" | "layers"} */ (key)][0] === expected, [key, expected]);
}

/** @param {TestPage} page */
async function undo(page) {
  await page.locator("canvas").focus();
  await page.keyboard.press("Control+z");
  await untilStill(page);
}

/**
 * Saves something from the header's menu, and waits until that has closed.
 * @param {TestPage} page
 * @param {string} entry
 */
async function exported(page, entry) {
  await control(page, "button", "Export").press("Enter");
  const file = await savedBy(page, entry);
  await control(page, "button", entry).waitFor({ state: "detached" });
  return file;
}

/**
 * Opens a saved file.
 * @param {TestPage} page
 * @param {{ name: string, bytes: Buffer }} file
 */
const reopen = (page, { name, bytes }) =>
  page.evaluate(async ({ name, base64 }) => {
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    return await window.gaitway.open({ [name]: bytes.buffer });
  }, { name, base64: bytes.toString("base64") });

for (const renderer of BACK_ENDS)
  describe(`workshop on ${renderer}`, () => {
    /** @type {import("./browser.mjs").Site} */
    let site;
    before(async () => (site = await startSite({ isOffScreen: true })));
    after(() => site?.close());

    /**
     * Tests on a fresh page, which must report no errors.
     * @param {string} name
     * @param {{ data?: boolean, link: (site: import("./browser.mjs").Site) => string, deviceScaleFactor?: number }} options
     * @param {(page: TestPage) => Promise<void>} body
     */
    const onPage = (name, { data = false, link, deviceScaleFactor }, body) =>
      test(name, { skip: data ? skipWithoutData : false }, async () => {
        const page = await site.page({ renderer, link: link(site), deviceScaleFactor });
        try {
          await body(page);
          assert.deepEqual(page.troubles, []);
        } finally {
          await page.finish();
        }
      });

    onPage("a changed clip has the poses of the original, mirrored or at other times or places", { link: () => WALKER }, async (page) => {
      /** @type {Record<number, Joints>} */
      const poses = {};
      const original = async (/** @type {number} */ t) => (poses[t] ??= await joints(page, { mirror: null, change: null, t }));
      for (const { mirror = null, change = null, expected } of CHANGES) {
        const what = [mirror, change].join(" ");
        for (const t of [0.05, 0.3]) {
          const changed = await joints(page, { mirror, change, t });
          const error = difference(changed, await expected(original, t));
          assert.ok(error < ROUNDING, `${what}: off by ${error} at ${t} s`);
          assert.ok(difference(changed, await original(t)) > 0.05, `${what}: differs from the original at ${t} s`);
        }
      }
      await apply(page, { change: "Walk:trim:0.25:0.75", t: 0.6 });
      const wrapped = await page.evaluate(async () => (await window.gaitway.pose()).time_secs);
      assert.ok(Math.abs(wrapped - 0.1) < ROUNDING, `half a second repeats: ${wrapped}`);
    });

    onPage("a link makes a part of a clip loopable: its ends meet halfway", { link: () => `${WALKER}&change=Walk:trim:0.1:0.5,loop:0.1` }, async (page) => {
      /** @type {Joints[]} */
      const looped = [];
      // Just before the end, which repeats the start.
      for (const t of [0, 0.4 - 1e-5, 0.2]) looped.push(await joints(page, { t }));
      /** @type {Joints[]} */
      const cut = [];
      for (const t of [0.1, 0.5, 0.3]) cut.push(await joints(page, { change: null, t }));
      const [seam, middle] = [difference(looped[1], looped[0]), difference(looped[2], cut[2])];
      assert.ok(difference(cut[1], cut[0]) > 0.5 && seam < 1e-3, `ends ${seam} apart`);
      assert.ok(middle < ROUNDING, `the middle stays: ${middle}`);
      const halfway = position(cut[0].Hips).map((value, axis) => (value + cut[1].Hips[12 + axis]) / 2);
      assert.ok(distance(position(looped[0].Hips), halfway) < ROUNDING);
    });

    onPage("the Motion tab mirrors a clip, undo restores it, and so does mirroring what was saved", { link: () => "model=sample:pilot&clip=walk&play=0&t=0.3" }, async (page) => {
      const original = await joints(page, {});
      const names = Object.keys(original);
      await showMotionTab(page);
      await flip(page, "Mirror", true);
      const mirrored = await joints(page, {});
      // Unlike the walker's, the pilot's joints are rotated at rest.
      assert.ok(furthestJoint(mirrored, reflected(original), names) < 1e-4);
      assert.ok(furthestJoint(mirrored, original, names) > 0.05);
      const saved = await exported(page, "Save GLB");
      assert.equal(saved.name, "Pilot-walk.glb");
      await undo(page);
      assert.deepEqual(await joints(page, {}), original);
      await flip(page, "Mirror", true);
      await flip(page, "Mirror", false);
      assert.deepEqual(await joints(page, {}), original, "off again");
      const { clips } = await reopen(page, saved);
      assert.deepEqual([clips.length, clips.at(-1)?.name], [7, "walk (changed)"]);
      assert.ok(difference(await joints(page, { clip: "walk (changed)", t: 0.3, play: 0 }), mirrored) < ROUNDING);
      assert.ok(difference(await joints(page, { mirror: "walk (changed)" }), original) < ROUNDING);
    });

    onPage("a clip is edited by the controls of the Motion tab, decimals after a comma", { link: () => WALKER }, async (page) => {
      await showMotionTab(page);
      await flip(page, "Reverse", true);
      await enter(page, "Clip speed value", "1,6", "change", "Walk:reverse,speed:1.6");
      await enter(page, "Turn path value", "-70", "change", "Walk:reverse,speed:1.6,turn:-70");
      await enter(page, "Move along X value", "−1.5", "change", "Walk:reverse,speed:1.6,offset:-1.5:0,turn:-70");
      await flip(page, "Make loopable", true);
      await until(page, async () => (await window.gaitway.state()).change.length === 1);
      assert.deepEqual((await state(page)).change, ["Walk:reverse,speed:1.6,loop:0.2,offset:-1.5:0,turn:-70"]);
      await page.locator("#mirror").getByText(/^The ends were 0\.0° and 0\.0 cm apart/).waitFor();
      const edited = await joints(page, { t: 0.3 });
      const linked = await joints(page, { change: "Walk:reverse,speed:1.6,loop:0.2,offset:-1.5:0,turn:-70" });
      assert.ok(difference(edited, linked) < ROUNDING);
      const speed = control(page, "spinbutton", "Clip speed value");
      await speed.fill("fast");
      await speed.press("Enter");
      await eventually(async () => (await speed.inputValue()) === "1.6", "the number is back");
      await control(page, "button", "Reset clip").press("Enter");
      await until(page, async () => (await window.gaitway.state()).change.length === 0);
      // What vanished under the keyboard hands it to what is near.
      await until(page, () => document.activeElement?.closest("#mirror") !== null && document.activeElement?.getAttribute("role") !== "img");
    });

    onPage("a layer is added and set by the controls of the Motion tab", { link: () => WALKER }, async (page) => {
      await showMotionTab(page);
      await control(page, "button", "Add layer").press("Enter");
      await until(page, async () => (await window.gaitway.state()).layers.length === 1);
      await control(page, "button", /^Layer's clip/).press("Enter");
      const wave = page.locator("#mirror > [role=group]").getByRole("button", { name: "Wave", exact: true });
      await wave.waitFor({ state: "attached" });
      await wave.press("Enter");
      await wave.waitFor({ state: "detached" });
      /** @param {string} name */
      const whenFocused = (name) => until(page, (name) => document.activeElement?.getAttribute("aria-label") === name, name);
      await whenFocused("Layer's clip Wave");
      await page.keyboard.press("Enter");
      await whenFocused("Wave");
      await page.keyboard.press("Escape");
      await whenFocused("Layer's clip Wave");
      const upperBody = "torso:head:left-arm:right-arm";
      await page.locator("#mirror").getByRole("group", { name: "Layer 1: Wave" }).getByLabel("Layer weight value").waitFor({ state: "attached" });
      await enter(page, "Layer weight value", "0,5", "layers", `Wave:weight:0.5,mask:${upperBody}`);
      await enter(page, "Layer start value", "0.25", "layers", `Wave:weight:0.5,start:0.25,mask:${upperBody}`);
      await control(page, "radio", "Add to rest").press("Enter");
      const expected = "Wave:weight:0.5,start:0.25,additive:rest,mask:left-arm:right-arm";
      for (const [part, then] of [["Torso", expected.replace("left", "head:left")], ["Head", expected]]) {
        await controls(page, "button", part, true).press("Enter");
        await until(page, async (then) => (await window.gaitway.state()).layers[0] === then, then);
      }
      const layered = await joints(page, { t: 0.7 });
      const linked = await joints(page, { layers: expected });
      assert.deepEqual(layered, linked);
      const plain = await joints(page, { layers: null });
      assert.ok(furthestJoint(layered, plain, ["RightHand"]) > 0.02 && furthestJoint(layered, plain, ["Head", "LeftFoot"]) < ROUNDING);
      await apply(page, { layers: expected });
      await control(page, "button", "Remove layer").press("Enter");
      await whenFocused("Add layer");
      assert.deepEqual((await state(page)).layers, []);
    });

    onPage("a finger on a slider scrolls up and down and drags sideways", { link: () => WALKER }, async (page) => {
      await page.setViewportSize({ width: 390, height: 844 });
      const session = await page.context().newCDPSession(page);
      /** @type {(x: number, y: number, across: number, down: number) => Promise<void>} */
      const swipe = async (x, y, across, down) => {
        /** @type {(type: "touchStart" | "touchMove" | "touchEnd", share?: number) => Promise<void>} */
        const touch = async (type, share) => {
          const touchPoints = share === undefined ? [] : [{ x: x + share * across, y: y + share * down }];
          await session.send("Input.dispatchTouchEvent", { type, touchPoints });
        };
        await touch("touchStart", 0);
        for (const share of [0.25, 0.5, 0.75, 1]) await touch("touchMove", share);
        await touch("touchEnd");
        await untilStill(page);
      };
      await untilStill(page);
      const { x, y } = await centreOf(control(page, "button", "Inspector"));
      await swipe(x, y, 0, 0);
      await control(page, "tab", "Motion").press("Enter");
      await untilStill(page);
      const speed = page.locator("#mirror").getByRole("slider", { name: "Clip speed" });
      const before = await centreOf(speed);
      await swipe(before.x - 60, before.y, 0, -100);
      const scrolled = await centreOf(speed);
      assert.ok(Math.abs(before.y - 100 - scrolled.y) < 2, `scrolled from ${before.y} to ${scrolled.y}`);
      assert.deepEqual((await state(page)).change, []);
      await swipe(scrolled.x - 60, scrolled.y, 80, 4);
      assert.match((await state(page)).change.join(), /^Walk:speed:/);
      assert.deepEqual(await centreOf(speed), scrolled);
    });

    onPage("pins are made in the Scene tab: a foot to a point, a head to the camera", { link: () => `${WALKER}&t=0.3` }, async (page) => {
      await resize(page, 1280, 800);
      await toggleInspector(page);
      await control(page, "tab", "Scene").press("Enter");
      for (const [joint, goal, pin] of /** @type {const} */ ([[LEFT_FOOT, "To a point", /^\d+:at:/], [HEAD, "Camera", new RegExp(`^${HEAD}:look:camera$`)]])) {
        const before = await joints(page, {});
        await apply(page, { joint });
        await untilStill(page);
        await control(page, "radio", goal).press("Enter");
        await until(page, async (source) => (await window.gaitway.state()).pin.some((pin) => new RegExp(source).test(pin)), pin.source);
        const pinned = await joints(page, {});
        if (joint === LEFT_FOOT) {
          // It is where it was, and stays there.
          assert.ok(furthestJoint(pinned, before, ["LeftFoot"]) < 2e-3);
          const later = await joints(page, { t: 0.6 });
          assert.ok(furthestJoint(later, pinned, ["LeftFoot"]) < 1e-5 && furthestJoint(later, pinned, ["RightFoot"]) > 0.05);
          await apply(page, { t: 0.3 });
        } else {
          assert.ok(largestAngle(pinned, before, ["Head"]) > 5);
        }
      }
      await control(page, "tab", "Motion").press("Enter");
      await control(page, "button", "Remove pin of Head").press("Enter");
      await until(page, async () => (await window.gaitway.state()).pin.length === 1);
      await until(page, () => document.activeElement?.getAttribute("aria-label") === "Remove pin of LeftFoot");
    });

    onPage("clips are cut out of one, listed, saved and in the link", { link: () => `${WALKER}&range=0.25,0.75` }, async (page) => {
      const original = await joints(page, { t: 0.5 });
      await showMotionTab(page);
      const cut = async (/** @type {string} */ name) => {
        await control(page, "button", "Trim to a new clip").press("Enter");
        await until(page, async (name) => (await window.gaitway.state()).clip === name, name);
      };
      await cut("Walk part 1");
      await control(page, "button", /^Walk part 1/).waitFor();
      assert.ok(difference(await joints(page, { t: 0.25 }), original) < ROUNDING);
      const saved = await exported(page, "Save GLB");
      await apply(page, { clip: "Walk", range: "0,0.2" });
      await cut("Walk part 2");
      await control(page, "button", "Remove this clip").press("Enter");
      await until(page, async () => (await window.gaitway.state()).copy.length === 1);
      await until(page, () => document.activeElement?.closest("#mirror") !== null && document.activeElement?.getAttribute("role") !== "img");
      await undo(page);
      await apply(page, { clip: "Walk part 2" });
      const { copy, change } = await state(page);
      assert.deepEqual([copy, change], [["Walk part 1:Walk", "Walk part 2:Walk"], ["Walk part 1:trim:0.25:0.75", "Walk part 2:trim:0:0.2"]]);
      await until(page, () => location.hash.includes("copy=Walk%20part%202:Walk"));
      await page.reload();
      await whenReady(page);
      assert.ok(difference(await joints(page, { clip: "Walk part 1", t: 0.25 }), original) < ROUNDING, "the link has it");
      // The walker has no file, so what was saved is a motion.
      const { borrowed_clips } = await reopen(page, saved);
      assert.deepEqual(borrowed_clips?.map(({ name }) => name), ["Walk part 1"]);
    });

    const pushUp = (/** @type {import("./browser.mjs").Site} */ site) => `model=${encodeURIComponent(site.data(PUSH_UP))}&play=0`;
    onPage("hands that do a push-up are kept on the ground, and nothing but arms moves", { data: true, link: pushUp }, async (page) => {
      const wrists = ["hand_l", "hand_r"];
      const times = [2.5, 3, 3.5];
      /** @param {object} partial */
      const during = async (partial) => {
        const shown = [];
        for (const t of times) shown.push(await joints(page, { ...partial, t }));
        return shown;
      };
      const source = (await during({})).map((pose) => [pose["mixamorig:LeftHand"][13], pose["mixamorig:RightHand"][13]]);
      await apply(page, { model: [site.data(MALE)], motion: [site.data(PUSH_UP)], clip: "mixamo.com", feet: "plant", play: 0 });
      await whenBorrowed(page, 1);
      const [off, keep] = [await during({ contacts: "off" }), await during({ contacts: "keep" })];
      // Model and source are equally tall.
      const [before, kept] = [off, keep].map((poses) => mean(poses.flatMap((pose, at) => wrists.map((name, side) => Math.abs(pose[name][13] - source[at][side])))));
      assert.ok(before > 0.04 && kept < 0.015, `${before} m and ${kept} m from the source's height`);
      const isArm = (/** @type {string} */ name) => /^(upperarm|lowerarm|hand|index|middle|ring|pinky|thumb)_/.test(name);
      const others = Object.keys(off[0]).filter((name) => !isArm(name));
      assert.ok(others.length > 20);
      for (const at of times.keys()) assert.ok(difference(keep[at], off[at], others) < ROUNDING, `others at ${times[at]} s`);
      assert.deepEqual(await during({ contacts: "off" }), off);
      await showMotionTab(page, "Options");
      await flip(page, "Keep contacts of hands and knees", true);
      assert.deepEqual(await during({}), keep);
      await flip(page, "Keep contacts of hands and knees", false);
      assert.deepEqual(await during({}), off);
    });

    onPage("a head looks at a point or the camera, and a pinned hand follows a joint, only as long as its pin holds", { link: () => WALKER }, async (page) => {
      const free = await joints(page, { t: 0.3 });
      const point = [2, 0.5, 1.5];
      const looking = await joints(page, { pin: `${HEAD}:look:${point}` });
      const [without, error] = [gazeError(free.Head, point), gazeError(looking.Head, point)];
      assert.ok(without > 30 && error < 0.01, `${without}° and ${error}° from the point`);
      for (const [yaw, pitch] of [[40, 10], [-60, -5]]) {
        const watched = await joints(page, { pin: `${HEAD}:look:camera`, camera: `${yaw},${pitch},3,0,1.2,0` });
        const [y, p] = [yaw, pitch].map((degrees) => (degrees * Math.PI) / 180);
        const eye = [3 * Math.sin(y) * Math.cos(p), 1.2 + 3 * Math.sin(p), 3 * Math.cos(y) * Math.cos(p)];
        assert.ok(gazeError(watched.Head, eye) < 0.01, `${gazeError(watched.Head, eye)}° from the camera at ${yaw}°`);
      }
      const offset = [0.1, -0.1, 0.25];
      const pin = `${LEFT_HAND}:joint:${HEAD},${offset}@0.3,0.6,0.1`;
      for (const [t, holds] of /** @type {const} */ ([[0.15, false], [0.3, true], [0.45, true], [0.6, true], [0.75, false]])) {
        const [unpinned, pinned] = [await joints(page, { pin: null, t }), await joints(page, { pin })];
        const { Head } = unpinned;
        const goal = [0, 1, 2].map((axis) => offset.reduce((sum, value, column) => sum + value * Head[4 * column + axis], Head[12 + axis]));
        if (holds) assert.ok(distance(position(pinned.LeftHand), goal) < 1e-5, `${t} s: at the head`);
        else assert.deepEqual(pinned, unpinned, `${t} s: free`);
      }
      const [from, blended] = [await joints(page, { pin: null, t: 0.65 }), await joints(page, { pin })];
      const held = await joints(page, { pin: pin.split("@")[0] });
      const [moved, left] = [from, held].map(({ LeftHand }) => distance(position(blended.LeftHand), position(LeftHand)));
      assert.ok(moved > 0.1 && left > 0.1, `blended out halfway: ${moved} m and ${left} m`);
    });

    const DISTANCE = 3;
    const AT = [0.35, 1.1, 0.2];
    const handle = () => `${WALKER}&t=0.3&camera=0,0,${DISTANCE},0,1,0&fov=40&pin=${LEFT_HAND}:at:${AT}`;
    // A handle moves by whole pixels.
    onPage("a pin's handle is dragged in the plane of the viewport, which is undone in one step", { link: handle, deviceScaleFactor: 1 }, async (page) => {
      const before = await joints(page, {});
      const viewport = await controls(page, "img", "Viewport", true).boundingBox();
      assert.ok(viewport !== null);
      // The camera looks along -Z at a point 1 m above the ground.
      const metresPerPixel = (2 * Math.tan((20 * Math.PI) / 180) * (DISTANCE - AT[2])) / viewport.height;
      const at = { x: viewport.x + viewport.width / 2 + AT[0] / metresPerPixel, y: viewport.y + viewport.height / 2 - (AT[1] - 1) / metresPerPixel };
      const press = { x: Math.round(at.x), y: Math.round(at.y) };
      await page.mouse.move(press.x, press.y);
      // egui finds what is under the pointer in the previous frame.
      await untilStill(page);
      await page.mouse.down();
      await untilStill(page);
      let [pin] = (await state(page)).pin;
      for (const share of [0.5, 0.75, 1]) {
        await page.mouse.move(press.x - 40 * share, press.y - 32 * share);
        await until(page, async (earlier) => (await window.gaitway.state()).pin[0] !== earlier, pin);
        [pin] = (await state(page)).pin;
      }
      await page.mouse.up();
      await untilStill(page);
      const goal = (pin.split(":at:")[1] ?? "").split(",").map(Number);
      const expected = [AT[0] - 40 * metresPerPixel, AT[1] + 32 * metresPerPixel, AT[2]];
      assert.ok(distance(goal, expected) < 1.5e-3, `${pin} instead of ${expected}`);
      const { LeftHand } = await joints(page, {});
      assert.ok(distance(position(LeftHand), goal) < 1e-5);
      await undo(page);
      assert.deepEqual(await joints(page, {}), before);
    });

    onPage("a mirrored clip with a layer and a pin is saved in each format as it is shown", { link: () => WALKER }, async (page) => {
      const plain = await joints(page, { t: 0.45 });
      // The layer ends with the clip.
      const edits = { mirror: "Walk", layers: "Wave:speed:2.625,mask:right-arm", pin: `${LEFT_HAND}:at:0.35,1.1,0.2` };
      // A BVH only has frames, 30 a second; the last time is between two of them.
      const times = [3, 14, 19, 27, 13.5].map((frame) => frame / 30);
      /** @type {Joints[]} */
      const shown = [];
      for (const t of times) shown.push(await joints(page, { ...edits, t }));
      const names = Object.keys(plain).filter((name) => !FIXED.includes(name));
      for (const edited of ["RightHand", "LeftHand", "LeftFoot"]) assert.ok(furthestJoint(shown[1], plain, [edited]) > 0.05, edited);
      const glb = await exported(page, "Save clip (GLB)");
      const bvh = await exported(page, "Save clip (BVH)");
      const vrma = await exported(page, "Save clip (VRMA)");
      assert.deepEqual([glb, bvh, vrma].map(({ name }) => name), ["Walker-Walk-clip.glb", "Walker-Walk.bvh", "Walker-Walk.vrma"]);
      // None of these files has a mesh, so the walker borrows their motion.
      await apply(page, { mirror: null, layers: null, pin: null });
      for (const [index, file] of [glb, bvh, vrma].entries()) {
        const { borrowed_clips: borrowed = [] } = await reopen(page, file);
        assert.equal(borrowed.length, index + 1);
        for (const [at, t] of times.slice(0, file === bvh ? -1 : undefined).entries()) {
          const again = await joints(page, { clip: String(WALKER_CLIPS + index), t, play: 0 });
          const [metres, degrees] = [furthestJoint(again, shown[at], names), largestAngle(again, shown[at], names)];
          // Twice the limits of one edit, for a layer and a pin.
          assert.ok(metres < 2 * 1e-4 * HEIGHT_METRES && degrees < 2 * 0.05, `${file.name}: off by ${1000 * metres} mm and ${degrees}° at ${t} s`);
        }
      }
    });
  });
