// Turns what trunk left into a site: adds samples with their images, icons, manifest and service worker, and names everything
// but index.html, manifest.webmanifest and sw.js after a hash of its content. Arguments: the folder, and the URL that the
// site will have (optional).
import crypto from "node:crypto";
import fs from "node:fs";
import path from "node:path";
import { transform } from "esbuild";
import sharp from "sharp";
import { renderScenes } from "./pictures.mjs";
import { linkOf, readSamples, readScenes } from "./samples.mjs";

const [dist, url] = process.argv.slice(2);
const STILL = "640x480";
/** The background of transparent images. */
const STUDIO = "#a3a6ab";
const PREVIEW = { width: 1200, height: 630 };

/** @type {(...parts: (string | Buffer)[]) => string} */
const hashOf = (...parts) => parts.reduce((hash, part) => hash.update(part), crypto.createHash("sha256")).digest("hex").slice(0, 16);
/** @type {(text: string) => string} */
const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll('"', "&quot;").replaceAll("<", "&lt;");

/**
 * Writes a file as `FOLDER/NAME-HASH.EXTENSION` and returns that path.
 * @param {string} folder
 * @param {string} name
 * @param {string} extension
 * @param {string | Buffer} bytes
 */
function put(folder, name, extension, bytes) {
  const file = path.posix.join(folder, `${name}-${hashOf(bytes)}${extension}`);
  fs.mkdirSync(path.join(dist, folder), { recursive: true });
  fs.writeFileSync(path.join(dist, file), bytes);
  return file;
}

/**
 * @param {string} text
 * @param {string} from
 * @param {string} to
 */
function replaced(text, from, to) {
  if (!text.includes(from)) throw new Error(`dist/index.html: expected ${from}`);
  return text.replace(from, () => to);
}

/** @param {string} css */
const minifiedCss = async (css) => (await transform(css, { loader: "css", minify: true })).code;

/**
 * Renames trunk's files, whose hashes are from before they were minified.
 * @param {string} html
 */
async function renamed(html) {
  for (const file of fs.readdirSync(dist).filter((file) => /\.(js|wasm|css|svg)$/.test(file))) {
    const [, name, rest] = file.match(/^(.*)-[0-9a-f]+((?:_bg)?\.\w+)$/) ?? ["", file, ""];
    if (rest === "") throw new Error(`dist/${file}: expected a name with a hash`);
    const content = fs.readFileSync(path.join(dist, file));
    const bytes = rest === ".css" ? await minifiedCss(content.toString()) : content;
    fs.rmSync(path.join(dist, file));
    html = html.replaceAll(file, put("", name, rest, bytes));
  }
  return html;
}

const samples = readSamples();
const scenes = readScenes(samples);
const addresses = Object.fromEntries(
  Object.entries(samples).map(([name, files]) => [name, files.map((file) => put("samples", name, path.extname(file), fs.readFileSync(file)))]),
);

/** The preview of the page itself; without samples, the generated walker. */
const preview = { ...(scenes[0] ?? { model: "sample:walker", view: "clip=Walk&t=0.5" }), size: `${PREVIEW.width}x${PREVIEW.height}` };
const rendered = renderScenes([...scenes.map((scene) => ({ ...scene, size: STILL })), preview], samples);
/**
 * Each scene as it covers the loading page, and as small as on its card.
 * @type {{ large: string, small: string }[]}
 */
const stills = [];
for (const [index, { name }] of scenes.entries()) {
  /** @param {number} width */
  const webp = async (width) => put("pictures", `${name}-${width}`, ".webp", await sharp(rendered[index]).flatten({ background: STUDIO }).resize(width).webp({ quality: 82, effort: 6 }).toBuffer());
  stills.push({ large: await webp(640), small: await webp(320) });
}
// Not every site that shows previews reads WebP.
const previewFile = put("pictures", "preview", ".jpg", await sharp(rendered.at(-1)).flatten({ background: STUDIO }).jpeg({ quality: 85, mozjpeg: true }).toBuffer());

const icon = fs.readFileSync("web/icon.svg");
const whole = icon.toString().replace(' rx="7"', "");
// Systems crop a maskable icon to their own shape, but never its middle 80 %.
const maskable = whole.replace("<g ", '<g transform="translate(16 16) scale(.8) translate(-16 -16)"><g ').replace("</svg>", "</g></svg>");
/** @type {(svg: string | Buffer, size: number) => Promise<Buffer>} */
const png = (svg, size) => sharp(Buffer.from(svg), { density: (72 * size) / 32 }).resize(size).png({ compressionLevel: 9 }).toBuffer();
const icons = [
  { src: put("icons", "icon-192", ".png", await png(icon, 192)), sizes: "192x192", type: "image/png" },
  { src: put("icons", "icon-512", ".png", await png(icon, 512)), sizes: "512x512", type: "image/png" },
  { src: put("icons", "maskable-512", ".png", await png(maskable, 512)), sizes: "512x512", type: "image/png", purpose: "maskable" },
];
const touchIcon = put("icons", "touch-180", ".png", await png(whole, 180));
const manifest = JSON.parse(fs.readFileSync("web/manifest.webmanifest", "utf8"));
fs.writeFileSync(path.join(dist, "manifest.webmanifest"), JSON.stringify({ ...manifest, icons }));

const cards = scenes.map(
  (scene, index) => `<li>
          <a class="card" href="#${escaped(linkOf(scene))}">
            <img src="${stills[index].small}" srcset="${stills[index].small} 320w, ${stills[index].large} 640w" sizes="12rem" width="320" height="240" alt="" loading="lazy" decoding="async">
            <b>${escaped(scene.title)}</b>
            <small>${escaped(scene.text)}</small>
          </a>
        </li>`,
);
const head = [
  '<link rel="manifest" href="manifest.webmanifest">',
  `<link rel="apple-touch-icon" href="${touchIcon}">`,
  `<meta name="gaitway-samples" content="${escaped(JSON.stringify(addresses))}">`,
  // Many sites need an absolute URL.
  `<meta property="og:image" content="${escaped(url === undefined ? previewFile : new URL(previewFile, url).href)}">`,
  `<meta property="og:image:width" content="${PREVIEW.width}">`,
  `<meta property="og:image:height" content="${PREVIEW.height}">`,
  '<meta property="og:image:alt" content="A character in the middle of a step, in a grey studio">',
  ...(url === undefined ? [] : [`<meta property="og:url" content="${escaped(url)}">`, `<link rel="canonical" href="${escaped(url)}">`]),
];
const index = path.join(dist, "index.html");
let html = await renamed(fs.readFileSync(index, "utf8"));
html = replaced(html, "<!-- scenes -->", cards.join("\n        "));
// Of several scenes with one model the first, which is the plainest.
const images = Object.fromEntries(scenes.map(({ model }, index) => [model, stills[index].large]).reverse());
const firstLink = scenes.length === 0 ? "" : linkOf(scenes[0]);
html = replaced(html, 'id="loading-still"', `id="loading-still" src="${stills[0]?.large ?? ""}" data-link="${escaped(firstLink)}" data-images="${escaped(JSON.stringify(images))}"`);
html = replaced(html, "<title>", `${head.join("\n    ")}\n    <title>`);

const files = fs
  .readdirSync(dist, { recursive: true, encoding: "utf8" })
  .map((file) => file.split(path.sep).join("/"))
  .filter((file) => fs.statSync(path.join(dist, file)).isFile() && file !== "index.html" && file !== previewFile)
  .sort();
const version = hashOf(html, files.join("\n"), fs.readFileSync(path.join(dist, "manifest.webmanifest")), fs.readFileSync("web/sw.js"));
fs.writeFileSync(index, replaced(html, "<title>", `<meta name="gaitway-version" content="${version}">\n    <title>`));
const worker = fs.readFileSync("web/sw.js", "utf8").replace('VERSION = ""', `VERSION = "${version}"`).replace("FILES = []", `FILES = ${JSON.stringify(files)}`);
const { code } = await transform(worker, { minify: true, format: "iife", target: "es2022" });
fs.writeFileSync(path.join(dist, "sw.js"), code);
