// The dialog with the link: to copy, as a QR code, and as the HTML that puts it into another page.

const byId = (id) => document.getElementById(id);

/** Names of files that came with one of the link. */
const MOST_BESIDE = 4;
const ROLES = { model: "the model", motion: "motion" };

addEventListener("gaitway:share", ({ detail: { address, embedded, local, qr } }) => {
  byId("share-local").hidden = local.length === 0;
  byId("share-files").replaceChildren(
    ...local.map(({ key, name, beside }) => {
      const item = document.createElement("li");
      const [most, more] = [beside.slice(0, MOST_BESIDE), beside.length - MOST_BESIDE];
      const others = most.length === 0 ? "" : `, with ${most.join(", ")}${more > 0 ? ` and ${more} more` : ""}`;
      item.textContent = `${name} (${ROLES[key]})${others}`;
      return item;
    }),
  );
  byId("share-link").value = address;
  byId("share-frame").value = frame(embedded);
  // What has to be dropped is on a computer rather than on a phone; and there is no room for both.
  byId("share-code").open = local.length === 0;
  byId("share-no-qr").hidden = qr !== null;
  byId("share-no-qr").textContent = `The link has ${address.length} characters: too long for a QR code that a camera can read.`;
  byId("share-qr").replaceChildren(...(qr === null ? [] : [picture(qr)]));
  byId("share-qr").hidden = qr === null;
  byId("share-said").textContent = "";
  if (!byId("share").open) byId("share").showModal();
  copy("share-link", "Link copied.", "");
});

/** The HTML of a frame that shows an address. */
function frame(address) {
  const escaped = address.replaceAll("&", "&amp;").replaceAll('"', "&quot;");
  return `<iframe src="${escaped}" title="Gaitway" width="640" height="480" style="border: 0"></iframe>`;
}

/** Four modules of quiet around, as the standard has it. */
const QUIET = 4;

/** A picture of rows of `0` and `1`. */
function picture(qr) {
  const rows = qr.split("\n");
  const size = rows.length + 2 * QUIET;
  const dark = rows.flatMap((row, y) => [...row.matchAll(/1+/g)].map(({ index, 0: run }) => `M${index + QUIET} ${y + QUIET}h${run.length}v1h-${run.length}z`));
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", `0 0 ${size} ${size}`);
  svg.setAttribute("shape-rendering", "crispEdges");
  const path = document.createElementNS(svg.namespaceURI, "path");
  path.setAttribute("d", dark.join(""));
  svg.append(path);
  return svg;
}

async function copy(id, done, failed) {
  const field = byId(id);
  field.select();
  try {
    await navigator.clipboard.writeText(field.value);
    byId("share-said").textContent = done;
  } catch {
    // Not allowed, or the page did not come over https.
    byId("share-said").textContent = failed !== "" && document.execCommand("copy") ? done : failed;
  }
}

byId("share-copy").addEventListener("click", () => copy("share-link", "Link copied.", "The browser does not let a page copy; the link is selected: copy it with the keyboard."));
byId("share-copy-frame").addEventListener("click", () => copy("share-frame", "HTML copied.", "The browser does not let a page copy; the text is selected: copy it with the keyboard."));
byId("share-code").querySelector("summary").addEventListener("click", () => requestAnimationFrame(() => byId("share-code").scrollIntoView({ block: "center" })));
