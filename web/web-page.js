// The dialog that saves a page with a scene inside, and the page itself: a template of the build (xtask/site/standalone.mjs) with the
// program, to which title, picture, link and files are added. src/files/web_page.rs writes the same for the command line.

/** @typedef {import("./shell/types.d.ts").Backend} Backend */
/** @typedef {import("./shell/types.d.ts").PageFile} PageFile */
/** @typedef {import("./shell/types.d.ts").PageScene} PageScene */

/**
 * What the page around the dialog does.
 * @typedef {object} Host
 * @property {(backend: Backend) => Promise<string>} template
 * @property {() => Promise<Uint8Array<ArrayBuffer>>} screenshot A PNG.
 * @property {(name: string, content: Blob) => void} save
 * @property {(text: string) => void} notify
 */

const PICTURE_WIDTH = 800;
/** JPEG has no transparency. */
const STUDIO = "#a3a6ab";

/** @param {string} text */
const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll('"', "&quot;").replaceAll("<", "&lt;");

/**
 * Returns bytes compressed and in base64. The browser does both off the main thread, which a large file would block.
 * @param {Uint8Array<ArrayBuffer>} bytes
 */
async function packed(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  const content = await new Response(stream).blob();
  const reader = new FileReader();
  const read = new Promise((resolve, reject) => Object.assign(reader, { onload: resolve, onerror: () => reject(reader.error) }));
  reader.readAsDataURL(content);
  await read;
  const url = /** @type {string} */ (reader.result);
  return url.slice(url.indexOf(",") + 1);
}

/**
 * Returns the elements that hold files.
 * @param {PageScene} scene
 */
async function blocksOf({ model, motion }) {
  const block = (/** @type {string} */ role) => async (/** @type {PageFile} */ [name, bytes]) => {
    return `<script type="application/octet-stream" data-name="${escaped(name)}" data-role="${role}" data-coding="deflate">${await packed(bytes)}</script>\n`;
  };
  return await Promise.all([...model.map(block("model")), ...motion.map(block("motion"))]);
}

/**
 * Returns the picture of the scene as a data URL.
 * @param {Uint8Array<ArrayBuffer>} png
 */
async function pictureOf(png) {
  const image = await createImageBitmap(new Blob([png], { type: "image/png" }));
  const scale = Math.min(1, PICTURE_WIDTH / image.width);
  const [width, height] = [image.width, image.height].map((pixels) => Math.round(pixels * scale));
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  context.fillStyle = STUDIO;
  context.fillRect(0, 0, width, height);
  context.drawImage(image, 0, 0, width, height);
  return canvas.toDataURL("image/jpeg", 0.8);
}

/**
 * Returns the page.
 * @param {string} template
 * @param {{ title: string, picture: string, link: string, blocks: string[], hasKtx2: boolean }} scene
 */
export function pageOf(template, { title, picture, link, blocks, hasKtx2 }) {
  const whole = hasKtx2 ? template : template.replace(/<!-- ktx2 -->[^]*<!-- \/ktx2 -->/, "");
  const [before, middle, after] = whole.split(/<!-- scene -->|<!-- files -->/);
  const head = [
    `<title>${escaped(title)}</title>`,
    `<meta name="gaitway-link" content="${escaped(link)}">`,
    `<meta property="og:title" content="${escaped(title)}">`,
    `<meta property="og:image" content="${picture}">`,
  ];
  return new Blob([before, head.join("\n    "), middle, ...blocks, after], { type: "text/html" });
}

const DIALOG = `
  <h1 id="page-title">Save as a web page</h1>
  <p>One file that shows this scene, with its model and motions inside. A double click opens it, without a network. Those who get it can take the files out.</p>
  <div class="field">
    <label for="page-name">Title</label>
    <input id="page-name" type="text" autocomplete="off">
  </div>
  <div><label><input type="radio" name="page-backend" value="webgl2" checked> For every current browser</label></div>
  <div><label><input type="radio" name="page-backend" value="webgpu"> For browsers with WebGPU: a smaller file</label></div>
  <p id="page-size" role="status"></p>
  <form method="dialog" class="buttons">
    <button type="submit">Cancel</button>
    <button id="page-save" type="button" class="chief">Save</button>
  </form>`;

/**
 * Returns a function that does a task once, and retries it when called after a failure.
 * @template T
 * @param {string} failure What to say if it fails.
 * @param {() => Promise<T>} task
 */
function once(failure, task) {
  /** @type {Promise<T> | undefined} */
  let done;
  return () =>
    (done ??= Promise.resolve().then(task).catch((error) => {
      done = undefined;
      throw new Error(`${failure} (${error instanceof Error ? error.message : error})`, { cause: error });
    }));
}

/** @type {(parent: Element, selector: string) => any} */
const find = (parent, selector) => parent.querySelector(selector);

/**
 * Shows the dialog. Resolves once it is there.
 * @param {PageScene} scene
 * @param {Host} host
 */
export async function showDialog(scene, host) {
  const dialog = document.createElement("dialog");
  dialog.id = "web-page";
  dialog.setAttribute("aria-labelledby", "page-title");
  dialog.innerHTML = DIALOG;
  document.body.append(dialog);
  dialog.addEventListener("close", () => dialog.remove());
  dialog.showModal();
  const [name, size, save] = ["#page-name", "#page-size", "#page-save"].map((selector) => find(dialog, selector));
  name.value = scene.title;
  const blocks = once("Couldn't compress the files.", () => blocksOf(scene));
  const picture = once("Couldn't draw the picture.", async () => pictureOf(await host.screenshot()));
  const template = (/** @type {Backend} */ backend) => once("Couldn't download the program. Check the connection.", () => host.template(backend));
  const templates = { webgl2: template("webgl2"), webgpu: template("webgpu") };
  /** @type {() => Promise<Blob>} */
  const page = async () => {
    /** @type {Backend} */
    const backend = find(dialog, ":checked").value;
    const [program, files, image] = await Promise.all([templates[backend](), blocks(), picture()]);
    return pageOf(program, { ...scene, title: name.value, blocks: files, picture: image });
  };
  const write = async () => {
    const file = `${scene.title.replace(/\.\w+$/, "")}.html`;
    host.save(file, await page());
    dialog.close();
    host.notify(`Saved ${file}.`);
  };
  const measure = async () => {
    save.disabled = true;
    size.textContent = "Preparing…";
    try {
      const { size: bytes } = await page();
      size.textContent = `Size: ${(bytes / 1e6).toFixed(1)} MB`;
      [save.textContent, save.onclick] = ["Save", write];
    } catch (error) {
      size.textContent = /** @type {Error} */ (error).message;
      [save.textContent, save.onclick] = ["Try again", measure];
    }
    save.disabled = false;
  };
  for (const choice of dialog.querySelectorAll("input[type=radio]")) choice.addEventListener("change", measure);
  await measure();
}
