// Makes the site: the page with its scripts and styles, the programs, samples with their images, icons, manifest and
// service worker, link cards, and the element with its examples. Everything but index.html, manifest.webmanifest, sw.js, cards,
// viewer/gaitway.js and viewer/index.html is named after a hash of its content.
// Arguments: the folder of the site, that of the programs, and the URL that the site will have (optional).
import crypto from "node:crypto";
import fs from "node:fs";
import path from "node:path";
import { build, transform } from "esbuild";
import sharp from "sharp";
import { putCards } from "./cards.mjs";
import { escaped, policyHash } from "./html.mjs";
import { PREVIEW, linkOf, readSamples, readScenes, stillOf } from "./samples.mjs";
import { deflated, standaloneTemplate } from "./standalone.mjs";

const [dist, programs, url] = process.argv.slice(2);
/** What every browser with WebAssembly SIMD understands. */
const TARGET = "es2022";

/** @type {(...parts: (string | Buffer)[]) => string} */
const hashOf = (...parts) => parts.reduce((hash, part) => hash.update(part), crypto.createHash("sha256")).digest("hex").slice(0, 16);

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
  if (!text.includes(from)) throw new Error(`expected ${from} in the page`);
  return text.replace(from, () => to);
}

/** @param {string} file */
const text = (file) => fs.readFileSync(file, "utf8");

/** @type {(file: string, options: import("esbuild").TransformOptions) => Promise<string>} */
const minified = async (file, options) => (await transform(text(file), { minify: true, ...options })).code;

/**
 * Bundles modules into one file, so that they take one request.
 * @param {string} entry
 * @param {import("esbuild").Format} format
 * @param {string} js What to append.
 */
async function bundled(entry, format = "esm", js = "") {
  const { outputFiles } = await build({ entryPoints: [entry], bundle: true, format, footer: { js }, minify: true, target: TARGET, write: false, logLevel: "warning" });
  return outputFiles[0].text;
}

/**
 * Puts a program and its script in place, and returns what the shell needs to know about it.
 * @param {string} backend
 */
async function putProgram(backend) {
  const wasm = fs.readFileSync(path.join(programs, `${backend}.wasm`));
  const script = await minified(path.join(programs, `${backend}.js`), { target: TARGET });
  return { script: put("", backend, ".js", script), wasm: put("", backend, ".wasm", wasm), bytes: wasm.length };
}

/** @returns {Record<string, string>} */
function putParts() {
  const folder = path.join(programs, "parts");
  const names = fs.readdirSync(folder).filter((file) => file.endsWith(".wasm")).map((file) => path.parse(file).name);
  return Object.fromEntries(names.map((name) => [name, put("parts", name, ".wasm", fs.readFileSync(path.join(folder, `${name}.wasm`)))]));
}

/**
 * Returns the template of self-contained pages that show a scene, with one program.
 * @param {string} backend
 */
async function standalone(backend) {
  const wasm = path.join(programs, `${backend}.wasm`);
  // Packing takes time, which a quick build doesn't.
  const isPacked = fs.existsSync(`${wasm}.lzma`);
  /** @type {import("./standalone.mjs").Block} */
  const program = isPacked ? { name: backend, role: "program", coding: "lzma", packed: fs.readFileSync(`${wasm}.lzma`) } : deflated(backend, "program", fs.readFileSync(wasm));
  const bindings = deflated(backend, "script", await minified(path.join(programs, `${backend}.js`), { target: TARGET }));
  const decoder = path.join(programs, "parts/ktx2.wasm");
  const ktx2 = fs.existsSync(decoder) ? deflated("ktx2", "part", fs.readFileSync(decoder)) : undefined;
  return standaloneTemplate(text("web/index.html"), { style, script: await bundled("web/standalone/main.js"), icon, program, bindings, ktx2 });
}

fs.rmSync(dist, { recursive: true, force: true });
const [webgpu, webgl2] = await Promise.all(["webgpu", "webgl2"].map(putProgram));
// With the licences of the validator and its dependencies, as they require.
const licences = ["LICENSE", "NOTICES"].map((file) => text(`node_modules/gltf-validator/${file}`));
const validator = await bundled("web/validator/worker.js", "iife", `/*!\n${licences.join("\n")}*/`);
const icon = fs.readFileSync("web/icon.svg");
const style = await bundled("web/shell.css");
const templates = Object.fromEntries(
  await Promise.all(["webgpu", "webgl2"].map(async (backend) => [`standalone-${backend}`, put("parts", `standalone-${backend}`, ".html", await standalone(backend))])),
);
const parts = { ...putParts(), video: put("parts", "video", ".js", await bundled("web/video.js")), "web-page": put("parts", "web-page", ".js", await bundled("web/web-page.js")), validator: put("parts", "validator", ".js", validator), ...templates };
const samples = readSamples();
const scenes = readScenes(samples);
const addresses = Object.fromEntries(
  Object.entries(samples).map(([name, files]) => [name, files.map((file) => put("samples", name, path.extname(file), fs.readFileSync(file)))]),
);

/**
 * Each scene as it covers the loading page, and as small as on its card.
 * @type {{ large: string, small: string }[]}
 */
const stills = [];
for (const scene of scenes) {
  const still = fs.readFileSync(stillOf(scene));
  const small = await sharp(still).resize(320).webp({ quality: 82, effort: 6 }).toBuffer();
  stills.push({ large: put("pictures", `${scene.name}-640`, ".webp", still), small: put("pictures", `${scene.name}-320`, ".webp", small) });
}
const previewFile = put("pictures", "preview", ".jpg", fs.readFileSync(PREVIEW.file));

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

await putCards(dist, scenes, url);
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
  `<meta name="gaitway-programs" content="${escaped(JSON.stringify({ webgpu, webgl2 }))}">`,
  `<meta name="gaitway-parts" content="${escaped(JSON.stringify(parts))}">`,
  `<meta name="gaitway-samples" content="${escaped(JSON.stringify(addresses))}">`,
  // Many sites need an absolute URL.
  `<meta property="og:image" content="${escaped(url === undefined ? previewFile : new URL(previewFile, url).href)}">`,
  `<meta property="og:image:width" content="${PREVIEW.width}">`,
  `<meta property="og:image:height" content="${PREVIEW.height}">`,
  '<meta property="og:image:alt" content="A character in the middle of a step, in a grey studio">',
  ...(url === undefined ? [] : [`<meta property="og:url" content="${escaped(url)}">`, `<link rel="canonical" href="${escaped(url)}">`]),
];
const index = path.join(dist, "index.html");
let html = text("web/index.html");
const iconFile = put("", "icon", ".svg", icon);
html = replaced(html, 'href="icon.svg"', `href="${iconFile}"`);
html = replaced(html, 'href="shell.css"', `href="${put("", "shell", ".css", style)}"`);
html = replaced(html, 'src="shell.js"', `src="${put("", "shell", ".js", await bundled("web/shell.js"))}"`);
html = replaced(html, 'src="still.js"', `src="${put("", "still", ".js", await minified("web/still.js", { target: TARGET }))}"`);
const start = await bundled("web/start.js", "iife");
html = replaced(html, '<script src="start.js"></script>', `<script>${start}</script>`);
// The policy allows no other script in the page's text.
html = replaced(html, "script-src 'self'", `script-src 'self' ${policyHash(start)}`);
html = replaced(html, "<!-- scenes -->", cards.join("\n        "));
// Of several scenes with one model the first, which is the plainest.
const images = Object.fromEntries(scenes.map(({ model }, index) => [model, stills[index].large]).reverse());
const firstLink = scenes.length === 0 ? "" : linkOf(scenes[0]);
html = replaced(html, 'id="loading-still"', `id="loading-still" data-link="${escaped(firstLink)}" data-images="${escaped(JSON.stringify(images))}"`);
html = replaced(html, "<title>", `${head.join("\n    ")}\n    <title>`);

fs.mkdirSync(path.join(dist, "viewer"));
fs.writeFileSync(path.join(dist, "viewer/gaitway.js"), await bundled("npm/viewer/gaitway.js"));
fs.writeFileSync(path.join(dist, "viewer/index.html"), await examples());

/** Returns the page of the element's live examples. What it shows as code is the code that runs. */
async function examples() {
  let html = text("web/examples/index.html");
  const page = (/** @type {string} */ file) => path.posix.join("..", file);
  html = replaced(html, 'href="icon.svg"', `href="${page(iconFile)}"`);
  html = replaced(html, 'href="examples.css"', `href="${page(put("viewer", "examples", ".css", await bundled("web/examples/examples.css")))}"`);
  html = replaced(html, 'src="examples.js"', `src="${page(put("viewer", "examples", ".js", await minified("web/examples/examples.js", { target: TARGET })))}"`);
  html = html.replace(/"picture:(\w+)"/g, (_, name) => `"${page(stills[scenes.findIndex((scene) => scene.name === name)].large)}"`);
  const script = text("web/examples/examples.js").split("\n// Shown on the page.\n")[1];
  html = replaced(html, "<!-- script -->", escaped(script.trim()));
  return html.replace(/<figure>\n([^]*?)\n\s*<pre><!-- markup --><\/pre>/g, (whole, markup) => whole.replace("<!-- markup -->", () => escaped(unindented(markup))));
}

/** @param {string} markup */
function unindented(markup) {
  const indent = /^ */.exec(markup)?.[0] ?? "";
  return markup.split("\n").map((line) => line.replace(indent, "")).join("\n");
}

const files = fs
  .readdirSync(dist, { recursive: true, encoding: "utf8" })
  .map((file) => file.split(path.sep).join("/"))
  .filter((file) => fs.statSync(path.join(dist, file)).isFile() && file !== previewFile && !/^(parts|cards|viewer)\//.test(file) && !file.endsWith(".wasm") && ![webgpu.script, webgl2.script].includes(file))
  .sort();
const version = hashOf(html, files.join("\n"), fs.readFileSync(path.join(dist, "manifest.webmanifest")), fs.readFileSync("web/sw.js"));
fs.writeFileSync(index, replaced(html, "<title>", `<meta name="gaitway-version" content="${version}">\n    <title>`));
const stored = { webgpu: [webgpu.script, webgpu.wasm], webgl2: [webgl2.script, webgl2.wasm] };
const storedParts = Object.fromEntries(Object.entries(parts).map(([name, file]) => [`parts/${name}`, [file]]));
const worker = text("web/sw.js").replace('VERSION = ""', `VERSION = "${version}"`).replace("FILES = []", `FILES = ${JSON.stringify(files)}`).replace("PROGRAMS = {}", `PROGRAMS = ${JSON.stringify(stored)}`).replace("PARTS = {}", `PARTS = ${JSON.stringify(storedParts)}`);
const { code } = await transform(worker, { minify: true, format: "iife", target: TARGET });
fs.writeFileSync(path.join(dist, "sw.js"), code);
