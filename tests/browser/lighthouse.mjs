// Measures a first visit with Lighthouse: on a desktop, with the program loaded and the first scene moving. Usually,
// a software renderer draws here, which is slower than any graphics card.
import assert from "node:assert/strict";
import lighthouse, { desktopConfig } from "lighthouse";
import { chromium } from "playwright-core";
import { neverAnswers } from "../../xtask/site/server.mjs";
import { FLAGS } from "./browser.mjs";

/**
 * The desktop preset with real network throttling. By default Lighthouse simulates it from a fast load, assuming that
 * the largest image waited for everything that arrived before it, but the still doesn't wait for the program.
 * @type {import("lighthouse").Config}
 */
const CONFIG = { ...desktopConfig, settings: { ...desktopConfig.settings, throttlingMethod: "devtools" } };
const CATEGORIES = ["performance", "accessibility", "best-practices"];
const METRICS = ["first-contentful-paint", "largest-contentful-paint", "total-blocking-time", "cumulative-layout-shift", "speed-index"];

/** Finds a free port: that of a server that has just been closed. */
async function freePort() {
  const server = await neverAnswers();
  await server.close();
  return Number(new URL(server.origin).port);
}

/**
 * Measures once, in a browser that has never seen the page, and prints the result.
 * @param {string} address
 */
export async function measureFirstVisit(address) {
  const port = await freePort();
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: [...FLAGS, `--remote-debugging-port=${port}`] });
  try {
    const measured = await lighthouse(address, { port, output: "json", logLevel: "error", onlyCategories: CATEGORIES }, CONFIG);
    assert.ok(measured !== undefined);
    const { lhr } = measured;
    const scores = Object.fromEntries(CATEGORIES.map((category) => [category, Math.round(100 * (lhr.categories[category].score ?? 0))]));
    const metrics = METRICS.map((metric) => `${lhr.audits[metric].title.toLowerCase()} ${lhr.audits[metric].displayValue}`);
    const lacking = Object.values(lhr.audits).filter(({ score }) => score !== null && score < 0.9);
    const text = `Lighthouse: ${CATEGORIES.map((category) => `${category} ${scores[category]}`).join(", ")} (${metrics.join(", ")})`;
    console.log(text);
    return {
      scores,
      text,
      reasons: lacking.map(({ id, displayValue, details }) => `${id} ${displayValue ?? ""} ${JSON.stringify(details !== undefined && "items" in details ? details.items : []).slice(0, 400)}`).join("\n"),
    };
  } finally {
    await browser.close();
  }
}
