// What is written into HTML.
import crypto from "node:crypto";

/** @type {(text: string) => string} */
export const escaped = (text) => text.replaceAll("&", "&amp;").replaceAll('"', "&quot;").replaceAll("<", "&lt;");

/**
 * Returns the source by which a content security policy allows an inline script or style.
 * @param {string} text
 */
export const policyHash = (text) => `'sha256-${crypto.createHash("sha256").update(text).digest("base64")}'`;
