// Link cards: a static page for each scene of the gallery and of the documentation, with its own title and picture for previews of
// links, which leads to the scene. `gaitway card` makes them for other links, of the same template.
import fs from "node:fs";
import path from "node:path";
import sharp from "sharp";
import { escaped } from "./html.mjs";
import { linkOf, readDocScenes, stillOf } from "./samples.mjs";

/** @typedef {import("./samples.mjs").LinkParts} LinkParts */

const TEMPLATE = "src/cli/card.html";

/**
 * Writes the cards to a folder of the site.
 * @param {string} dist
 * @param {import("./samples.mjs").Scene[]} scenes The gallery's.
 * @param {string | undefined} url The site's.
 */
export async function putCards(dist, scenes, url) {
  const template = fs.readFileSync(TEMPLATE, "utf8");
  const folder = path.join(dist, "cards");
  fs.mkdirSync(folder, { recursive: true });
  const wanted = [...scenes.map((scene) => ({ ...scene, still: stillOf(scene) })), ...readDocScenes()];
  for (const scene of wanted) {
    // Not every site that shows previews reads WebP.
    const { data, info } = await sharp(scene.still).jpeg({ quality: 85, mozjpeg: true }).toBuffer({ resolveWithObject: true });
    const picture = `${scene.name}.jpg`;
    fs.writeFileSync(path.join(folder, picture), data);
    /** @type {Record<string, string>} */
    const values = {
      title: scene.title,
      text: scene.text,
      picture,
      // Many sites need an absolute URL.
      "picture-url": url === undefined ? picture : new URL(`cards/${picture}`, url).href,
      link: `../#${linkOf(scene)}`,
      width: String(info.width),
      height: String(info.height),
    };
    fs.writeFileSync(path.join(folder, `${scene.name}.html`), template.replaceAll(/\{([\w-]+)\}/g, (_, key) => escaped(values[key])));
  }
}
