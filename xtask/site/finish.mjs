// Makes a site of what trunk left: samples with their pictures, icons, manifest and service worker are put beside the page,
// and everything but index.html, manifest.webmanifest and sw.js gets a name with a hash of its content. Arguments: the
// folder, and the address that the site will have (may be left out).
import crypto from "node:crypto";
import fs from "node:fs";
import path from "node:path";
import sharp from "sharp";
import { minify } from "terser";
import { drawPictures } from "./pictures.mjs";
import { readSamples, readScenes } from "./samples.mjs";

const [dist, url] = process.argv.slice(2);
const STILL = "640x480";
/** Behind what is transparent in a picture. */
const STUDIO = "#a3a6ab";
const PREVIEW = { width: 1200, height: 630 };

const hashOf = (...parts) => parts.reduce((hash, part) => hash.update(part), crypto.createHash("sha256")).digest("hex").slice(0, 16);
const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll('"', "&quot;").replaceAll("<", "&lt;");

/** Writes a file as `FOLDER/NAME-HASH.ENDING` and gives that path. */
function put(folder, name, ending, bytes) {
  const file = path.posix.join(folder, `${name}-${hashOf(bytes)}${ending}`);
  fs.mkdirSync(path.join(dist, folder), { recursive: true });
  fs.writeFileSync(path.join(dist, file), bytes);
  return file;
}

function replaced(text, from, to) {
  if (!text.includes(from)) throw new Error(`dist/index.html has no ${from}`);
  return text.replace(from, () => to);
}

/** A style sheet without comments and the blanks between its parts. */
const shortened = (css) => css.replace(/\/\*.*?\*\//gs, "").replace(/\s+/g, " ").replace(/ ?([{};,]) ?/g, "$1").replaceAll(";}", "}").trim();

/** Trunk's names are from before the files were made smaller. */
function renamed(html) {
  for (const file of fs.readdirSync(dist).filter((file) => /\.(js|wasm|css|svg)$/.test(file))) {
    const [, name, rest] = file.match(/^(.*)-[0-9a-f]+((?:_bg)?\.\w+)$/);
    const content = fs.readFileSync(path.join(dist, file));
    const bytes = rest === ".css" ? shortened(content.toString()) : content;
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

const wanted = scenes.map(({ link }) => ({ link, size: STILL }));
// What a shared link to the page itself shows, for as long as there are no samples: the walker.
const first = scenes[0]?.link ?? "model=sample:walker&clip=Walk&t=0.5";
const drawn = drawPictures([...wanted, { link: first, size: `${PREVIEW.width}x${PREVIEW.height}` }], samples);
/** Each scene for the screen while it loads, and as small as on its card. */
const stills = [];
for (const [index, { name }] of scenes.entries()) {
  const webp = async (width) => put("pictures", `${name}-${width}`, ".webp", await sharp(drawn[index]).flatten({ background: STUDIO }).resize(width).webp({ quality: 82, effort: 6 }).toBuffer());
  stills.push({ large: await webp(640), small: await webp(320) });
}
// Not every site that shows previews reads WebP.
const preview = put("pictures", "preview", ".jpg", await sharp(drawn.at(-1)).flatten({ background: STUDIO }).jpeg({ quality: 85, mozjpeg: true }).toBuffer());

const icon = fs.readFileSync("web/icon.svg");
const whole = icon.toString().replace(' rx="7"', "");
// Systems cut a maskable icon to their own shape: what matters lies within its middle 80 %.
const maskable = whole.replace("<g ", '<g transform="translate(16 16) scale(.8) translate(-16 -16)"><g ').replace("</svg>", "</g></svg>");
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
  ({ title, text, link }, index) => `<li>
          <a class="card" href="#${escaped(link)}">
            <img src="${stills[index].small}" srcset="${stills[index].small} 320w, ${stills[index].large} 640w" sizes="12rem" width="320" height="240" alt="" loading="lazy" decoding="async">
            <b>${escaped(title)}</b>
            <small>${escaped(text)}</small>
          </a>
        </li>`,
);
const head = [
  '<link rel="manifest" href="manifest.webmanifest">',
  `<link rel="apple-touch-icon" href="${touchIcon}">`,
  `<meta name="gaitway-samples" content="${escaped(JSON.stringify(addresses))}">`,
  // Many sites want the whole address.
  `<meta property="og:image" content="${escaped(url === undefined ? preview : new URL(preview, url).href)}">`,
  `<meta property="og:image:width" content="${PREVIEW.width}">`,
  `<meta property="og:image:height" content="${PREVIEW.height}">`,
  '<meta property="og:image:alt" content="A character in the middle of a step, in a grey studio">',
  ...(url === undefined ? [] : [`<meta property="og:url" content="${escaped(url)}">`, `<link rel="canonical" href="${escaped(url)}">`]),
];
const index = path.join(dist, "index.html");
let html = renamed(fs.readFileSync(index, "utf8"));
html = replaced(html, "<!-- scenes -->", cards.join("\n        "));
const models = (link) => link.split("&").filter((pair) => pair.startsWith("model=")).join("&");
// Of several scenes of one model the first, which is the plainest.
const pictures = Object.fromEntries(scenes.map(({ link }, index) => [models(link), stills[index].large]).reverse());
html = replaced(html, 'id="loading-still"', `id="loading-still" src="${stills[0]?.large ?? ""}" data-link="${escaped(scenes[0]?.link ?? "")}" data-pictures="${escaped(JSON.stringify(pictures))}"`);
html = replaced(html, "<title>", `${head.join("\n    ")}\n    <title>`);

const files = fs
  .readdirSync(dist, { recursive: true })
  .map((file) => file.split(path.sep).join("/"))
  .filter((file) => fs.statSync(path.join(dist, file)).isFile() && file !== "index.html" && file !== preview)
  .sort();
const version = hashOf(html, files.join("\n"), fs.readFileSync(path.join(dist, "manifest.webmanifest")), fs.readFileSync("web/sw.js"));
fs.writeFileSync(index, replaced(html, "<title>", `<meta name="gaitway-version" content="${version}">\n    <title>`));
const worker = fs.readFileSync("web/sw.js", "utf8").replace('VERSION = ""', `VERSION = "${version}"`).replace("FILES = []", `FILES = ${JSON.stringify(files)}`);
const { code } = await minify(worker, { module: true, compress: true, mangle: true });
fs.writeFileSync(path.join(dist, "sw.js"), code);
