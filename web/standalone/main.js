// A page that was saved with a scene: the shell of Gaitway's own page, whose files are in the page's text. They get URLs that only
// this page can read, and the shell finds those where the page on a server has the URLs of files.
import { enclosed } from "../shell/enclosed.js";
import { takeBlocks } from "./blocks.js";

/** @typedef {import("./blocks.js").Block} Block */

const TYPES = /** @type {Record<string, string>} */ ({ program: "application/wasm", script: "text/javascript" });

/** @param {Block} block */
const urlOf = ({ role, bytes }) => URL.createObjectURL(new Blob([bytes], { type: TYPES[role] ?? "application/octet-stream" }));

/**
 * @param {string} name
 * @param {object} content
 */
function setMeta(name, content) {
  document.head.append(Object.assign(document.createElement("meta"), { name, content: JSON.stringify(content) }));
}

/** The picture of the scene for previews of links covers the page while it starts. */
function showPicture() {
  const picture = /** @type {HTMLMetaElement | null} */ (document.querySelector('meta[property="og:image"]'));
  const still = /** @type {HTMLImageElement} */ (document.getElementById("loading-still"));
  still.hidden = picture === null;
  if (picture !== null) still.src = picture.content;
}

showPicture();
const blocks = await takeBlocks();
/** @type {(role: string) => Block[]} */
const having = (role) => blocks.filter((block) => block.role === role);
const [program] = having("program");
const [script] = having("script");
setMeta("gaitway-programs", { [program.name]: { script: urlOf(script), wasm: urlOf(program), bytes: program.bytes.length } });
setMeta("gaitway-parts", Object.fromEntries(having("part").map((part) => [part.name, urlOf(part)])));
enclosed.link = /** @type {HTMLMetaElement} */ (document.querySelector('meta[name="gaitway-link"]')).content;
enclosed.sets = ["model", "motion"].map(having).map((set) => set.map(({ name, bytes }) => ({ name, content: new Blob([bytes]) })));
await import("../shell.js");
