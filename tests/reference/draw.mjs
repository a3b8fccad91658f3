// Draws a model with the Khronos glTF Sample Renderer, three.js and three-vrm in Chromium, and with `gaitway render`,
// under the same camera and the same light from an image.
import { execFile } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { promisify } from "node:util";
import { build } from "esbuild";
import sharp from "sharp";
import { serve } from "../../xtask/site/server.mjs";
import { FLAGS, launch } from "../browser/browser.mjs";
import { dataFile, repository } from "../three/data.mjs";
import { program } from "../three/gaitway.mjs";
import { BACKGROUND } from "./colour.mjs";
import { contentOf, keptPictures } from "./kept.mjs";
import { roomImage } from "./room.mjs";

/**
 * What the page draws.
 * @typedef {object} View
 * @property {string} model A URL.
 * @property {string} environment The URL of an .hdr image.
 * @property {boolean} hasLights Whether the model has lights of its own.
 * @property {[number, number]} size In pixels.
 * @property {Triple} eye The camera's position.
 * @property {Triple} target The point that the camera looks at.
 * @property {number} distance From the eye to the target.
 * @property {number} fov The vertical field of view in degrees.
 * @property {{ strength: number, towards: Triple }} [key] A directional light, for three-vrm only: the radiance that it
 *   gives a white surface facing it, and the direction to it.
 * @property {Record<string, number>} [expressions] Weights by name.
 * @property {Triple} [look] The point that the avatar looks at.
 * @property {number} [timeSecs] For how long MToon's texture coordinates have moved.
 */

/**
 * How an avatar is shown. `yaw` is the camera's, in degrees; `bounds` is what the picture shows instead of everything.
 * `hasKey`: whether a directional light is added, for MToon only, since three.js compensates other materials for light
 * that leaves them after several reflections. With `timeSecs`, the file's first clip is at that time.
 * @typedef {Pick<View, "expressions" | "look" | "timeSecs"> & { yaw?: number, bounds?: Bounds, hasKey?: boolean }} Shown
 */

/** @typedef {{ min: Triple, max: Triple }} Bounds */

/** @typedef {import("./colour.mjs").Triple} Triple */

/** Three bytes per pixel, top row first. @typedef {{ width: number, height: number, rgb: Buffer }} Picture */

/** @type {[number, number]} */
const SIZE = [320, 320];
const FOV = 35;
/** The light on MToon; angles in degrees. */
const KEY = { strength: 0.6, yaw: -30, pitch: 40 };

const run = promisify(execFile);

/**
 * Starts the browser. Its renderers filter the environment once, for all pictures.
 * @param {Buffer} [environment] An .hdr image.
 */
export async function startReference(environment = roomImage()) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "gaitway-reference-"));
  await build({
    entryPoints: [path.join(repository, "tests/reference/page.mjs")],
    outfile: path.join(folder, "page.js"),
    bundle: true,
    format: "iife",
    logLevel: "error",
  });
  fs.writeFileSync(path.join(folder, "index.html"), '<!doctype html><script src="page.js"></script>');
  const libraries = path.join(repository, "node_modules/@khronosgroup/gltf-viewer/dist/libs");
  const server = await serve({ "/data/": dataFile(""), "/made/": folder, "/libs/": libraries, "/": folder });
  const browser = await launch();
  const page = await browser.newPage();
  page.setDefaultTimeout(300_000);
  await page.goto(`${server.origin}/index.html`);
  const hdr = path.join(folder, "environment.hdr");
  fs.writeFileSync(hdr, environment);
  // The scripts contain the renderers.
  const kept = keptPictures([browser.version(), ...FLAGS, fs.readFileSync(path.join(folder, "page.js")), environment]);
  /**
   * Draws with one of the page's renderers.
   * @param {keyof Window["reference"]} renderer
   * @param {string} file
   * @param {View} view
   */
  const drawInPage = (renderer, file, view) =>
    kept([renderer, JSON.stringify(view), ...contentOf(file)], async () => {
      const located = { ...view, model: server.origin + view.model, environment: server.origin + view.environment };
      return await page.evaluate(({ renderer, located }) => window.reference[renderer](located), { renderer, located });
    });

  /**
   * @param {string} file
   * @returns {Promise<Record<"gaitway" | "khronos" | "three", Picture>>}
   */
  const draw = async (file) => {
    const { camera, view } = await prepare(file);
    return {
      gaitway: await drawGaitway(file, hdr, camera, folder, words({})),
      khronos: withSrgbCurve(await decoded(await drawInPage("khronos", file, view))),
      three: await decoded(await drawInPage("three", file, view)),
    };
  };

  /**
   * Draws an avatar without springs.
   * @param {string} file
   * @param {Shown} [shown]
   * @returns {Promise<Record<"gaitway" | "vrm", Picture>>}
   */
  const drawAvatar = async (file, shown = {}) => {
    const { camera, view } = await prepare(file, shown);
    const vrm = await decoded(await drawInPage("vrm", file, view));
    return { gaitway: await drawGaitway(file, hdr, camera, folder, words(shown)), vrm };
  };
  const close = async () => {
    await browser.close();
    await server.close();
    fs.rmSync(folder, { recursive: true });
  };
  return { draw, drawAvatar, close, folder };
}

/**
 * Returns the camera, and the view with addresses from the server's root.
 * @param {string} file
 * @param {Shown} [shown]
 */
async function prepare(file, { yaw, bounds: part, hasKey, expressions, look, timeSecs } = {}) {
  const { bounds, lights } = await inspect(file);
  const camera = cameraFor(part ?? bounds, yaw);
  const relative = path.relative(dataFile(""), file);
  const model = relative.startsWith("..") ? `/made/${path.basename(file)}` : `/data/${relative}`;
  const { eye, target, distance } = camera;
  /** @type {View} */
  const view = {
    model,
    environment: "/made/environment.hdr",
    hasLights: lights > 0,
    size: SIZE,
    eye,
    target,
    distance,
    fov: FOV,
    key: hasKey ? { strength: KEY.strength, towards: direction(KEY.yaw, KEY.pitch) } : undefined,
    expressions,
    look,
    timeSecs,
  };
  return { camera, view };
}

/**
 * Returns what the link says about an avatar.
 * @param {Shown} shown
 */
function words({ hasKey, expressions, look, timeSecs }) {
  const words = timeSecs === undefined ? ["clip="] : ["clip=0", `t=${timeSecs}`];
  if (hasKey) words.push(`key=${KEY.strength},${KEY.yaw},${KEY.pitch}`);
  if (look) words.push(`look=${look.join(",")}`);
  if (expressions) {
    const weights = Object.entries(expressions).map(([name, weight]) => `${name}:${weight}`);
    words.push(`expression=${weights.join(",")}`);
  }
  return words;
}

/** @param {string} file */
async function inspect(file) {
  const { stdout } = await run(program, ["inspect", file, "--json"], { maxBuffer: 1 << 28 });
  return JSON.parse(stdout);
}

/**
 * Returns the direction from the model at a yaw and a pitch, in degrees.
 * @param {number} yaw
 * @param {number} pitch
 * @returns {Triple}
 */
function direction(yaw, pitch) {
  const [y, p] = [yaw, pitch].map((degrees) => (degrees * Math.PI) / 180);
  return [Math.sin(y) * Math.cos(p), Math.sin(p), Math.cos(y) * Math.cos(p)];
}

/**
 * Returns a camera in front of the model, a little to the right and above, as near as possible with the whole bounding
 * box in the picture. Yaw and pitch are in degrees.
 * @param {Bounds} bounds
 */
function cameraFor({ min, max }, yaw = 25) {
  const pitch = 15;
  const [y, p] = [yaw, pitch].map((degrees) => (degrees * Math.PI) / 180);
  const away = direction(yaw, pitch);
  const right = [Math.cos(y), 0, -Math.sin(y)];
  const up = [-Math.sin(y) * Math.sin(p), Math.cos(p), -Math.cos(y) * Math.sin(p)];
  /** @type {(component: (axis: number) => number) => Triple} */
  const vector = (component) => [component(0), component(1), component(2)];
  const target = vector((axis) => (min[axis] + max[axis]) / 2);
  const slope = 0.95 * Math.tan((FOV * Math.PI) / 360);
  let distance = 0;
  for (let corner = 0; corner < 8; corner++) {
    const offset = target.map((value, axis) => ((corner >> axis) & 1 ? max : min)[axis] - value);
    /** @param {number[]} axis */
    const along = (axis) => axis.reduce((sum, value, index) => sum + value * offset[index], 0);
    distance = Math.max(distance, along(away) + Math.max(Math.abs(along(right)), Math.abs(along(up))) / slope);
  }
  return { yaw, pitch, distance, target, eye: vector((axis) => target[axis] + distance * away[axis]) };
}

/**
 * @param {string} file
 * @param {string} hdr
 * @param {ReturnType<typeof cameraFor>} camera
 * @param {string} folder
 * @param {string[]} more Keys of the link.
 */
async function drawGaitway(file, hdr, { yaw, pitch, distance, target }, folder, more) {
  const out = path.join(folder, "gaitway.png");
  const camera = [yaw, pitch, distance, ...target].join(",");
  const link = ["show=no-shadow", "background=808080", `fov=${FOV}`, `camera=${camera}`, ...more].join("&");
  await run(program, ["render", file, "--out", out, "--size", SIZE.join("x"), "--environment", hdr, "--view", link]);
  return await decoded(fs.readFileSync(out));
}

/** @param {string | Buffer} image A PNG, or its data URL. */
async function decoded(image) {
  const bytes = typeof image === "string" ? Buffer.from(image.split(",")[1], "base64") : image;
  const { data, info } = await sharp(bytes).removeAlpha().raw().toBuffer({ resolveWithObject: true });
  return { width: info.width, height: info.height, rgb: data };
}

/**
 * Replaces the sample renderer's encoding, a power of 1/2.2, by sRGB's, which is darker for dark colours.
 * @param {Picture} picture
 */
function withSrgbCurve({ rgb, ...size }) {
  /** @param {number} linear */
  const encode = (linear) => (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);
  const curve = Array.from({ length: 256 }, (_, value) => Math.round(255 * encode((value / 255) ** 2.2)));
  // The background is cleared to its colour, not encoded by a shader.
  curve[BACKGROUND] = BACKGROUND;
  return { ...size, rgb: Buffer.from(rgb.map((value) => curve[value])) };
}

/** Encodes a picture as PNG. @param {Picture} picture */
export const encoded = ({ width, height, rgb }) => sharp(rgb, { raw: { width, height, channels: 3 } }).png().toBuffer();
