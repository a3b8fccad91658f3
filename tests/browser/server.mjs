// Static files over HTTP for the tests: the built page as any host would serve it, from a folder that is not the root, and
// the data folder from a second origin that allows others to read it.
import fs from "node:fs";
import http from "node:http";
import path from "node:path";

const TYPES = {
  ".css": "text/css",
  ".glb": "model/gltf-binary",
  ".gltf": "model/gltf+json",
  ".html": "text/html",
  ".js": "text/javascript",
  ".json": "application/json",
  ".mjs": "text/javascript",
  ".png": "image/png",
  ".svg": "image/svg+xml",
  ".webmanifest": "application/manifest+json",
  ".webp": "image/webp",
  ".wasm": "application/wasm",
};

/** What the build puts beside a file for hosts that send it compressed. */
const COPIES = [
  { encoding: "br", ending: ".br" },
  { encoding: "gzip", ending: ".gz" },
];

/**
 * Serves `mounts` (`{prefix: folder}`, prefixes with a slash at both ends) on a free port of 127.0.0.1.
 * Gives `{origin, close}`.
 */
export async function serve(mounts, headers = {}) {
  const server = http.createServer((request, response) => {
    const name = decodeURIComponent(new URL(request.url, "http://host").pathname);
    const prefix = Object.keys(mounts).find((prefix) => name.startsWith(prefix));
    const root = prefix === undefined ? null : path.resolve(mounts[prefix]);
    let file = root === null ? null : path.join(root, name.slice(prefix.length));
    if (file !== null && name.endsWith("/")) file = path.join(file, "index.html");
    if (file === null || !file.startsWith(root) || !fs.existsSync(file) || !fs.statSync(file).isFile()) {
      response.writeHead(404, { "content-type": "text/plain", ...headers }).end("not found");
      return;
    }
    const type = TYPES[path.extname(file)] ?? "application/octet-stream";
    const copy = COPIES.find(({ encoding, ending }) => (request.headers["accept-encoding"] ?? "").includes(encoding) && fs.existsSync(file + ending));
    const [sent, compressed] = copy === undefined ? [file, {}] : [file + copy.ending, { "content-encoding": copy.encoding }];
    response.writeHead(200, { "content-type": type, "content-length": fs.statSync(sent).size, ...compressed, ...headers });
    fs.createReadStream(sent).pipe(response);
  });
  return await listening(server);
}

/** A server that takes every question and answers none: `{origin, close}`. */
export async function neverAnswers() {
  return await listening(http.createServer(() => {}));
}

async function listening(server) {
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  // A test that fails before it closes its server must not keep the whole run from ending.
  server.unref();
  return {
    origin: `http://127.0.0.1:${server.address().port}`,
    close: () => {
      server.closeAllConnections();
      return new Promise((resolve) => server.close(resolve));
    },
  };
}
