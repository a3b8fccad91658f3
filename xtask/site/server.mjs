// A static file server for `cargo xtask serve`, tests and benchmarks. These serve the page from a folder below the root,
// as many hosts do, and the data folder from a second origin that allows cross-origin reads.
import fs from "node:fs";
import http from "node:http";
import path from "node:path";

/** @type {Record<string, string>} */
const TYPES = {
  ".css": "text/css; charset=utf-8",
  ".glb": "model/gltf-binary",
  ".gltf": "model/gltf+json",
  ".html": "text/html; charset=utf-8",
  ".jpg": "image/jpeg",
  ".js": "text/javascript; charset=utf-8",
  ".json": "application/json",
  ".mjs": "text/javascript; charset=utf-8",
  ".png": "image/png",
  ".svg": "image/svg+xml",
  ".webmanifest": "application/manifest+json",
  ".webp": "image/webp",
  ".wasm": "application/wasm",
};

/** Compressed copies that the build puts beside a file. */
const COPIES = [
  { encoding: "br", extension: ".br" },
  { encoding: "gzip", extension: ".gz" },
];

/** @typedef {{ origin: string, close: () => Promise<unknown> }} Server */

/**
 * Serves folders on a port of 127.0.0.1.
 * @param {Record<string, string>} mounts Folders by prefix, with a slash at both ends.
 * @param {Record<string, string>} [headers]
 * @param {number} [port] A free one if absent.
 */
export async function serve(mounts, headers = {}, port = 0) {
  const server = http.createServer((request, response) => {
    if (request.method !== "GET" && request.method !== "HEAD") {
      const allowed = { "content-type": "text/plain", allow: "GET, HEAD", ...headers };
      response.writeHead(405, allowed).end("only GET and HEAD");
      return;
    }
    const file = fileFor(request.url ?? "/", mounts);
    if (file === null) {
      response.writeHead(404, { "content-type": "text/plain", ...headers }).end("not found");
      return;
    }
    const type = TYPES[path.extname(file)] ?? "application/octet-stream";
    const accepted = String(request.headers["accept-encoding"]);
    const copy = COPIES.find(({ encoding, extension }) => accepted.includes(encoding) && fs.existsSync(file + extension));
    const sent = file + (copy?.extension ?? "");
    const size = { "content-length": fs.statSync(sent).size };
    const compressed = copy === undefined ? {} : { "content-encoding": copy.encoding };
    response.writeHead(200, { "content-type": type, ...size, ...compressed, ...headers });
    fs.createReadStream(sent).pipe(response);
  });
  return await listening(server, port);
}

/**
 * Returns the file that a request names, or null. A path can't lead out of its folder.
 * @param {string} target
 * @param {Record<string, string>} mounts
 */
function fileFor(target, mounts) {
  const name = pathOf(target);
  if (name === null) return null;
  const prefix = Object.keys(mounts).find((prefix) => name.startsWith(prefix));
  if (prefix === undefined) return null;
  const root = path.resolve(mounts[prefix]);
  const file = path.join(root, name.slice(prefix.length), name.endsWith("/") ? "index.html" : "");
  return file.startsWith(root + path.sep) && fs.existsSync(file) && fs.statSync(file).isFile() ? file : null;
}

/** @param {string} target */
function pathOf(target) {
  try {
    return decodeURIComponent(new URL(target, "http://host").pathname);
  } catch {
    return null;
  }
}

/** Starts a server that accepts every request and answers none. */
export async function neverAnswers() {
  return await listening(http.createServer(() => {}), 0);
}

/**
 * @param {http.Server} server
 * @param {number} port
 * @returns {Promise<Server>}
 */
async function listening(server, port) {
  await new Promise((resolve, reject) => {
    server.once("error", reject);
    server.listen(port, "127.0.0.1", () => resolve(undefined));
  });
  // A test that fails before it closes its server must not keep the run from ending.
  server.unref();
  return {
    origin: `http://127.0.0.1:${/** @type {import("node:net").AddressInfo} */ (server.address()).port}`,
    close: () => {
      server.closeAllConnections();
      return new Promise((resolve) => server.close(resolve));
    },
  };
}
