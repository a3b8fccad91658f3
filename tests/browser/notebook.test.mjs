// A notebook that shows a scene: executed without a browser, converted to HTML, and opened.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import path from "node:path";
import { after, before, describe, it } from "node:test";
import { pathToFileURL } from "node:url";
import { dist } from "../three/data.mjs";
import { launch, pose, state, temporaryFolder, watched, whenReady } from "./browser.mjs";

const python = process.env.GAITWAY_PYTHON ?? "python3";
const isThere = spawnSync(python, ["-c", "import gaitway, ipykernel, nbclient, nbconvert"]).status === 0;

/** Executes one cell and writes the notebook as HTML. Arguments: the page's folder, the output. */
const SCRIPT = `
import sys, nbformat
from nbclient import NotebookClient
from nbconvert import HTMLExporter
page, out = sys.argv[1:]
cell = f"import gaitway\\ngaitway.show(gaitway.load_model('sample:mannequin'), gaitway.load_motion('assets/samples/walk.bvh'), view='v=1&t=0.5&play=0', page={page!r})"
notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell)])
NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
[output] = notebook.cells[0].outputs
assert len(nbformat.writes(notebook)) < 3_000_000, len(nbformat.writes(notebook))
# Its own scripts come from the network.
open(out, "w").write(HTMLExporter(template_name="basic").from_notebook_node(notebook)[0])
`;

const folder = temporaryFolder("notebook");
/** @type {import("./browser.mjs").Browser} */
let browser;

before(async () => {
  browser = await launch();
});
after(() => browser.close());

describe("a notebook", { skip: isThere ? false : "ipykernel, nbclient and nbconvert aren't installed (python/requirements-notebook.txt)" }, () => {
  it("displays a scene without a network", async () => {
    const file = path.join(folder, "notebook.html");
    const { status, stderr } = spawnSync(python, ["-c", SCRIPT, dist, file], { encoding: "utf8" });
    assert.equal(status, 0, stderr);
    const page = watched(await browser.newPage({ viewport: { width: 800, height: 600 } }));
    await page.goto(pathToFileURL(file).href);
    await page.locator("iframe").waitFor();
    const frame = page.frames()[1];
    await whenReady(frame);
    const { model, motion, t } = await state(frame);
    assert.deepEqual({ model, motion, t }, { model: ["mannequin.glb"], motion: ["walk.bvh"], t: 0.5 });
    assert.notEqual((await pose(frame)).clip, null, "the borrowed clip");
    assert.deepEqual(page.requests.filter((url) => !/^(blob|data|file|about):/.test(url)), []);
    await page.finish();
  });
});
