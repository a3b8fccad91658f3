// The step of action.yml: runs `gaitway inspect` on the models of the repository in the current folder, annotates its findings, draws
// the models that have changed, and writes a summary. Inputs are the variables that action.yml sets. It needs Node.js and git alone.
import { execFile } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { promisify } from "node:util";

const { env } = process;
const [GAITWAY, FAIL_ON, PICTURES] = [env.GAITWAY ?? "gaitway", env.FAIL_ON ?? "error", env.PICTURES ?? "changed"];
const IGNORED = new Set((env.IGNORE ?? "").split(/[\s,]+/));
const BRANCH = env.PICTURES_BRANCH ?? "";
const FOLDER = env.PICTURES_FOLDER ?? "gaitway-pictures";
const SIZE = "640x480";
const WIDTH_IN_SUMMARY = 320;
/** A summary may have a megabyte: what has no room is still annotated and in the log. */
const MAX_FINDINGS_IN_SUMMARY = 1000;
/** Software renders a picture in a second or more. */
const MAX_PICTURES = 60;

/**
 * @typedef {{ code: string, message: string, where?: string }} Finding
 * @typedef {{ files: string[], joints: number, triangles: number, clips: { duration_secs: number }[], warnings: Finding[] }} Report
 * @typedef {{ file: string, report?: Report, error?: Omit<Finding, "code">, picture?: string, noPicture?: string }} Model
 */

const run = promisify(execFile);
const PIPED = { maxBuffer: 1 << 28 };

/** @param {string[]} args @param {Record<string, string>} [variables] */
async function git(args, variables = {}) {
  return (await run("git", args, { ...PIPED, env: { ...env, ...variables } })).stdout;
}

/** Runs a function on all values, as many at a time as there are cores. @template T @param {T[]} values @param {(value: T) => Promise<void>} f */
async function forEach(values, f) {
  const rest = values.values();
  const worker = async () => {
    for (const value of rest) await f(value);
  };
  await Promise.all(Array.from({ length: os.availableParallelism() }, worker));
}

/** Returns the tracked files that the patterns match. */
async function models() {
  const patterns = (env.FILES ?? "").split("\n").map((line) => line.trim()).filter(Boolean);
  if (patterns.length === 0) throw new Error("files: expected at least one pattern");
  return (await git(["--icase-pathspecs", "ls-files", "-z", "--", ...patterns])).split("\0").filter(Boolean);
}

/** Returns the files that the push or pull request has changed; undefined if that is unknown, as for a new branch. */
async function changedFiles() {
  const base = env.BASE ?? "";
  if (/^0*$/.test(base)) return undefined;
  try {
    // A checkout has one commit, unless it was asked for more.
    await git(["cat-file", "-e", base]).catch(() => git(["fetch", "--quiet", "--depth=1", "origin", base]));
    return new Set((await git(["diff", "-z", "--name-only", "--no-renames", base, "HEAD"])).split("\0").filter(Boolean));
  } catch {
    return undefined;
  }
}

/** Returns a file as an argument: here, a name such as `sample:fox.glb` is a file. @param {string} file */
const local = (file) => `./${file}`;

/** @param {string} file @returns {Promise<Model>} */
async function inspect(file) {
  try {
    const { stdout } = await run(GAITWAY, ["inspect", "--json", "--", local(file)], PIPED);
    /** @type {Report} */
    const report = JSON.parse(stdout);
    return { file, report: { ...report, warnings: report.warnings.filter(({ code }) => !IGNORED.has(code)) } };
  } catch (error) {
    const { stdout, message } = /** @type {{ stdout?: string, message: string }} */ (error);
    // Without a document, the program itself is at fault.
    if (!stdout) throw new Error(`${GAITWAY} inspect ${file}: ${message}`, { cause: error });
    const failure = JSON.parse(stdout).error;
    const prefix = `${path.posix.basename(file)}: `;
    return { file, error: { ...failure, message: failure.message.startsWith(prefix) ? failure.message.slice(prefix.length) : failure.message } };
  }
}

/** Returns whether one of the files that a model consists of has changed. @param {Model} model @param {Set<string> | undefined} changed */
function hasChanged({ file, report }, changed) {
  const files = (report?.files ?? []).map((name) => path.posix.join(path.posix.dirname(file), name));
  return changed === undefined || [file, ...files].some((name) => changed.has(name));
}

/** Draws a model in the middle of its first clip, or in its rest pose. @param {Model} model */
async function draw(model) {
  const name = `${model.file}.png`;
  const out = path.join(FOLDER, name);
  fs.mkdirSync(path.dirname(out), { recursive: true });
  const [clip] = model.report?.clips ?? [];
  const time = clip === undefined ? [] : ["--clip", "0", "--time", String(clip.duration_secs / 2)];
  try {
    await run(GAITWAY, ["render", "--out", out, "--size", SIZE, ...time, "--", local(model.file)], PIPED);
    model.picture = name;
  } catch (error) {
    model.noPicture = /** @type {{ stderr?: string }} */ (error).stderr?.trim() || String(error);
  }
}

/**
 * Adds a commit with the pictures to their branch, without a work tree. Returns the URL that they are below; undefined without a
 * branch, or if this run may not push, as for a pull request from a fork.
 * @param {Model[]} drawn
 */
async function publish(drawn) {
  if (BRANCH === "" || drawn.length === 0) return undefined;
  const index = { GIT_INDEX_FILE: path.resolve(FOLDER, "..", `gaitway-index-${process.pid}`) };
  try {
    for (const { picture } of drawn) {
      const blob = (await git(["hash-object", "-w", path.join(FOLDER, String(picture))])).trim();
      await git(["update-index", "--add", "--cacheinfo", `100644,${blob},${picture}`], index);
    }
    return `${env.GITHUB_SERVER_URL}/${env.GITHUB_REPOSITORY}/raw/${await push((await git(["write-tree"], index)).trim())}`;
  } catch (error) {
    annotate("warning", { title: "Pictures" }, `couldn't push to the branch ${BRANCH}: ${/** @type {{ stderr?: string }} */ (error).stderr ?? error}`);
    return undefined;
  } finally {
    fs.rmSync(index.GIT_INDEX_FILE, { force: true });
  }
}

/** Pushes a commit of a tree; again if another run has pushed at the same time. @param {string} tree */
async function push(tree, attempts = 4) {
  const isNew = (await git(["ls-remote", "origin", `refs/heads/${BRANCH}`])) === "";
  if (!isNew) await git(["fetch", "--quiet", "--depth=1", "origin", `refs/heads/${BRANCH}`]);
  const parent = isNew ? [] : ["-p", (await git(["rev-parse", "FETCH_HEAD"])).trim()];
  const author = ["-c", "user.name=Gaitway", "-c", "user.email=gaitway@users.noreply.github.com"];
  const commit = (await git([...author, "commit-tree", tree, ...parent, "-m", `Pictures of ${env.GITHUB_SHA}`])).trim();
  try {
    await git(["push", "--quiet", "origin", `${commit}:refs/heads/${BRANCH}`]);
  } catch (error) {
    if (attempts === 1) throw error;
    return push(tree, attempts - 1);
  }
  return commit;
}

/** @param {string} text */
const data = (text) => text.replaceAll("%", "%25").replaceAll("\r", "%0D").replaceAll("\n", "%0A");
/** @param {string} text */
const property = (text) => data(text).replaceAll(":", "%3A").replaceAll(",", "%2C");

/** @param {"error" | "warning"} kind @param {Record<string, string>} properties @param {string} message */
function annotate(kind, properties, message) {
  const list = Object.entries(properties).map(([name, value]) => `${name}=${property(value)}`);
  console.log(`::${kind} ${list.join(",")}::${data(message.trim())}`);
}

/**
 * Returns the properties of an annotation; those of text files have a line.
 * @param {string} file
 * @param {string} title
 * @param {Omit<Finding, "code">} finding
 * @returns {Record<string, string>}
 */
function properties(file, title, { where }) {
  const [, line] = /^line (\d+)/.exec(where ?? "") ?? [];
  return line === undefined ? { file, title } : { file, line, title };
}

/** Escapes a text, since file names and messages may contain anything. @param {string} text */
const html = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;").replaceAll('"', "&quot;").replaceAll("\n", " ");

/** @param {Model} model */
function row({ file, report, error }) {
  const result = error === undefined ? `${report?.warnings.length || ""}` : "can't be read";
  const cells = [html(file), report?.triangles || "", report?.joints ?? "", report?.clips.length ?? "", result];
  return `<tr>${cells.map((cell) => `<td>${cell}</td>`).join("")}</tr>`;
}

/** @param {string | undefined} url @returns {(model: Model) => string} */
const figure = (url) => ({ file, picture, noPicture }) => {
  if (picture === undefined) return `<p>${html(file)}: ${html(noPicture ?? "")}</p>`;
  if (url === undefined) return "";
  const source = `${url}/${picture.split("/").map(encodeURIComponent).join("/")}`;
  return `<p><a href="${source}"><img src="${source}" width="${WIDTH_IN_SUMMARY}" alt="${html(file)}"></a><br>${html(file)}</p>`;
};

/** @param {Model[]} models @param {Model[]} chosen @param {number} left How many more would have a picture. @param {string | undefined} url */
function summary(models, chosen, left, url) {
  const findings = models.flatMap(({ file, report, error }) => [
    ...(error === undefined ? [] : [`<li>${html(file)}: ${html(error.message)}</li>`]),
    ...(report?.warnings ?? []).map(({ code, message }) => `<li>${html(file)}: ${html(message)} (${code})</li>`),
  ]);
  const shown = findings.slice(0, MAX_FINDINGS_IN_SUMMARY);
  if (shown.length < findings.length) shown.push(`<li>and ${findings.length - shown.length} more</li>`);
  const head = ["Model", "Triangles", "Joints", "Clips", "Findings"].map((title) => `<th>${title}</th>`).join("");
  const table = `<table><tr>${head}</tr>${models.map(row).join("")}</table>`;
  const sections = [`## Models\n`, models.length === 0 ? "No model was found." : table];
  if (shown.length > 0) sections.push(`<h3>Findings</h3><ul>${shown.join("")}</ul>`);
  sections.push(...chosen.map(figure(url)));
  if (left > 0) sections.push(`<p>${left} more models have changed; no more than ${MAX_PICTURES} are drawn.</p>`);
  return `${sections.filter(Boolean).join("\n")}\n\n`;
}

/** @param {string | undefined} file @param {string} text */
function append(file, text) {
  if (file) fs.appendFileSync(file, text);
}

/** @param {string} name @param {string} value @param {string[]} allowed */
function require(name, value, allowed) {
  if (!allowed.includes(value)) throw new Error(`${name}: expected ${allowed.join(", ")}, found ${value}`);
}

async function main() {
  require("fail-on", FAIL_ON, ["error", "warning", "never"]);
  require("pictures", PICTURES, ["changed", "all", "none"]);
  const files = await models();
  /** @type {Map<string, Model>} */
  const found = new Map(files.map((file) => [file, { file }]));
  await forEach(files, async (file) => void found.set(file, await inspect(file)));
  const checked = [...found.values()];
  const changed = PICTURES === "changed" ? await changedFiles() : undefined;
  const readable = PICTURES === "none" ? [] : checked.filter((model) => model.report && hasChanged(model, changed));
  const chosen = readable.slice(0, MAX_PICTURES);
  await forEach(chosen, draw);
  const drawn = chosen.filter(({ picture }) => picture !== undefined);
  const url = await publish(drawn);
  for (const { file, report, error } of checked) {
    if (error !== undefined) annotate("error", properties(file, "Can't be read", error), error.message);
    for (const finding of report?.warnings ?? []) annotate("warning", properties(file, finding.code, finding), finding.message);
  }
  const errors = checked.filter(({ error }) => error !== undefined).length;
  const warnings = checked.reduce((sum, { report }) => sum + (report?.warnings.length ?? 0), 0);
  console.log(`${checked.length} models: ${errors} can't be read, ${warnings} findings in the others, ${drawn.length} pictures`);
  append(env.GITHUB_STEP_SUMMARY, summary(checked, chosen, readable.length - chosen.length, url));
  append(env.GITHUB_OUTPUT, `errors=${errors}\nwarnings=${warnings}\npictures=${drawn.length}\n`);
  const failures = { error: errors, warning: errors + warnings, never: 0 }[FAIL_ON] ?? 0;
  process.exitCode = failures > 0 ? 1 : 0;
}

await main().catch((error) => {
  annotate("error", { title: "Gaitway" }, error.message);
  process.exitCode = 1;
});
