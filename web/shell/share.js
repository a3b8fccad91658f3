// The share dialog: the link to copy, as a QR code, and as HTML that embeds it in another page.
import { byId, button, copyText, dialog, field, listOf, messageOf, showList } from "./dom.js";
import { parts } from "./parts.js";
import { program } from "./running.js";
import { performs } from "./session.js";
import { OWN_PARAMETERS } from "./viewer.js";

/**
 * Returns the address of the page with a link.
 * @param {string} link
 */
export function addressOf(link) {
  const page = new URL(location.href);
  OWN_PARAMETERS.forEach((name) => page.searchParams.delete(name));
  page.hash = "";
  return `${page.href}#${link}`;
}

/**
 * Shows the dialog for a link and copies it.
 * @param {{ link: string, embedded: string, files: string[] }} shared
 */
function share({ link, embedded, files }) {
  const address = addressOf(link);
  byId("share-local").hidden = files.length === 0;
  showList("share-files", files);
  tellUnlisted();
  field("share-link").value = address;
  field("share-frame").value = frameHtml(addressOf(embedded));
  // A phone that scans the code hardly has the files, and there is no room for both.
  byId("share-code", HTMLDetailsElement).open = files.length === 0;
  showCode(address);
  byId("share-said").textContent = "";
  if (!dialog("share").open) dialog("share").showModal();
  copy("share-link", "Link copied.", "");
}

/** Tells which open models the link leaves out. */
function tellUnlisted() {
  if (program.app === null) return;
  /** @type {{ model: string, unlisted: string[] }} */
  const { model, unlisted } = JSON.parse(program.app.summary());
  byId("share-unlisted").hidden = unlisted.length === 0;
  byId("share-unlisted").textContent = `The link shows ${model}, without ${listOf(unlisted)}.`;
}

/**
 * Returns the HTML of a frame that shows an address.
 * @param {string} address
 */
function frameHtml(address) {
  const escaped = address.replaceAll("&", "&amp;").replaceAll('"', "&quot;");
  return `<iframe src="${escaped}" title="Gaitway" width="640" height="480" style="border: 0"></iframe>`;
}

/** @param {string} address */
async function showCode(address) {
  const { code, problem } = await parts.convert("qr", new TextEncoder().encode(address)).then(
    (bytes) => ({ code: new TextDecoder().decode(bytes), problem: "" }),
    (error) => ({ code: undefined, problem: messageOf(error) }),
  );
  // Another link may be shown by now.
  if (field("share-link").value !== address) return;
  byId("share-no-qr").hidden = code !== undefined;
  byId("share-no-qr").textContent = `This link has no QR code: ${problem}.`;
  byId("share-qr").replaceChildren(...(code === undefined ? [] : [codeImage(code)]));
  byId("share-qr").hidden = code === undefined;
}

/** The quiet zone that the standard asks for, in modules. */
const QUIET = 4;

/**
 * Draws a QR code given as rows of `0` and `1`.
 * @param {string} code
 */
function codeImage(code) {
  const rows = code.split("\n");
  const size = rows.length + 2 * QUIET;
  const dark = rows.flatMap((row, y) => [...row.matchAll(/1+/g)].map(({ index, 0: run }) => `M${index + QUIET} ${y + QUIET}h${run.length}v1h-${run.length}z`));
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", `0 0 ${size} ${size}`);
  svg.setAttribute("shape-rendering", "crispEdges");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", dark.join(""));
  svg.append(path);
  return svg;
}

/**
 * Copies a field and says so.
 * @param {string} id
 * @param {string} done
 * @param {string} failed Empty: don't insist.
 */
async function copy(id, done, failed) {
  byId("share-said").textContent = (await copyText(field(id), failed !== "")) ? done : failed;
}

performs({ share, visit: ({ link }) => void window.open(addressOf(link), "_blank", "noopener") });

button("share-copy").addEventListener("click", () => copy("share-link", "Link copied.", "Couldn't copy the link. It is selected: copy it with the keyboard."));
button("share-copy-frame").addEventListener("click", () => copy("share-frame", "Embed code copied.", "Couldn't copy the embed code. It is selected: copy it with the keyboard."));
byId("share-code-toggle").addEventListener("click", () => requestAnimationFrame(() => byId("share-code").scrollIntoView({ block: "center" })));
// The system's own sheet, where there is one.
button("share-native").hidden = !("share" in navigator);
button("share-native").addEventListener("click", () => navigator.share({ title: document.title, url: field("share-link").value }).catch(() => {}));
