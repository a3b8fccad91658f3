// Prints a software bill of materials (CycloneDX 1.6) of what a release is built from: the Rust packages of the program, the Python
// package and the page with its parts, as Cargo.lock has them, and the npm packages that ship with the page, as package-lock.json has
// them. Cargo has no command for that, and npm's own rejects a package without a version, which the root has.
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

const ROOT = path.join(import.meta.dirname, "..");
/** Tools of the build, which ship with nothing. */
const TOOLS = ["xtask"];

/**
 * @typedef {{ id: string, name: string, version: string, license: string | null, source: string | null }} Package
 * @typedef {{ id: string, deps: { pkg: string, dep_kinds: { kind: string | null }[] }[] }} Node
 * @typedef {{ type: string, name: string, version: string, purl: string, licenses?: { expression: string }[], hashes?: { alg: string, content: string }[] }} Component
 */

/** Older manifests write “or” as a slash. @type {(license: string | null | undefined) => { licenses?: { expression: string }[] }} */
const licences = (license) => (license ? { licenses: [{ expression: license.replaceAll("/", " OR ").replaceAll(/ +/g, " ") }] } : {});

/** @returns {{ version: string, components: Component[] }} */
function rust() {
  const text = execFileSync("cargo", ["metadata", "--locked", "--format-version", "1", "--all-features"], { cwd: ROOT, maxBuffer: 1 << 28, encoding: "utf8", stdio: ["ignore", "pipe", "inherit"] });
  /** @type {{ packages: Package[], workspace_members: string[], resolve: { nodes: Node[] } }} */
  const { packages, workspace_members: members, resolve } = JSON.parse(text);
  const byId = new Map(packages.map((item) => [item.id, item]));
  const nodes = new Map(resolve.nodes.map((node) => [node.id, node]));
  const shipped = new Set(members.filter((id) => !TOOLS.includes(byId.get(id)?.name ?? "")));
  // What is added to a set while it is walked is walked, too.
  for (const id of shipped) for (const { pkg, dep_kinds: kinds } of nodes.get(id)?.deps ?? []) if (kinds.some(({ kind }) => kind !== "dev")) shipped.add(pkg);
  const components = packages.filter(({ id, source }) => shipped.has(id) && source !== null).map(({ name, version, license }) => ({ type: "library", name, version, purl: `pkg:cargo/${name}@${version}`, ...licences(license) }));
  return { version: packages.find(({ name }) => name === "gaitway")?.version ?? "", components };
}

/** @returns {Component[]} */
function npm() {
  /** @type {{ packages: Record<string, { version: string, dev?: boolean, license?: string, integrity: string }> }} */
  const { packages } = JSON.parse(fs.readFileSync(path.join(ROOT, "package-lock.json"), "utf8"));
  const shipped = Object.entries(packages).filter(([folder, { dev }]) => folder !== "" && dev !== true);
  return shipped.map(([folder, { version, license, integrity }]) => {
    const name = folder.slice(folder.lastIndexOf("node_modules/") + "node_modules/".length);
    const hashes = [{ alg: "SHA-512", content: Buffer.from(integrity.replace("sha512-", ""), "base64").toString("hex") }];
    return { type: "library", name, version, purl: `pkg:npm/${name.replace("@", "%40")}@${version}`, ...licences(license), hashes };
  });
}

const { version, components } = rust();
const ordered = [...components, ...npm()].sort((one, other) => (one.purl < other.purl ? -1 : 1));
const metadata = { component: { type: "application", name: "gaitway", version, purl: `pkg:cargo/gaitway@${version}` } };
console.log(JSON.stringify({ bomFormat: "CycloneDX", specVersion: "1.6", version: 1, metadata, components: ordered }, null, 2));
