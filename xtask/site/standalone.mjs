// Makes the template of self-contained pages that show a scene: Gaitway's page with its scripts, its style and one program in its
// text. web/web-page.js and src/files/web_page.rs add a scene. Such a page reads nothing but its own text, as its policy says.
import zlib from "node:zlib";
import { policyHash } from "./html.mjs";

/** @typedef {{ name: string, role: string, coding: "lzma" | "deflate", packed: Buffer }} Block */

/** @type {(name: string, role: string, content: Buffer | string) => Block} */
export const deflated = (name, role, content) => ({ name, role, coding: "deflate", packed: zlib.deflateRawSync(content, { level: 9 }) });

/** @param {Block} block */
const element = ({ name, role, coding, packed }) => `<script type="application/octet-stream" data-name="${name}" data-role="${role}" data-coding="${coding}">${packed.toString("base64")}</script>\n`;

/**
 * @param {string} page web/index.html.
 * @param {{ style: string, script: string, icon: Buffer, program: Block, bindings: Block, ktx2: Block | undefined }} parts
 */
export function standaloneTemplate(page, { style, script, icon, program, bindings, ktx2 }) {
  const policy = [
    "default-src 'none'",
    // What a page makes of its own text has a blob: URL.
    `script-src ${policyHash(script)} blob: 'wasm-unsafe-eval'`,
    `style-src ${policyHash(style)}`,
    "img-src data: blob:",
    "connect-src blob:",
    "worker-src blob:",
    "base-uri 'none'",
    "form-action 'none'",
  ];
  const head = [
    '<meta charset="utf-8">',
    '<meta name="viewport" content="width=device-width, initial-scale=1, viewport-fit=cover">',
    `<meta http-equiv="Content-Security-Policy" content="${policy.join("; ")}">`,
    '<meta name="color-scheme" content="light dark">',
    '<meta name="generator" content="Gaitway">',
    '<meta property="og:type" content="website">',
    "<!-- scene -->",
    `<link rel="icon" href="data:image/svg+xml;base64,${icon.toString("base64")}" type="image/svg+xml">`,
    `<style>${style}</style>`,
  ];
  const decoder = ktx2 === undefined ? "" : `<!-- ktx2 -->${element(ktx2)}<!-- /ktx2 -->`;
  const body = page.slice(page.indexOf("<body>"), page.indexOf("</body>")).replace('<script src="still.js"></script>', "");
  // Modules run once all of the page is there.
  return `<!doctype html>\n<html lang="en">\n  <head>\n    ${head.join("\n    ")}\n    <script type="module">${script}</script>\n  </head>\n  ${body}${element(program)}${element(bindings)}${decoder}<!-- files --></body>\n</html>\n`;
}
