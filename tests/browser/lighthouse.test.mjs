// How the page does by Lighthouse's measure, as somebody first comes: on a desktop, with the program loaded and the first
// scene moving. Here a processor does the drawing, which is slower than any graphics card.
import assert from "node:assert/strict";
import net from "node:net";
import { test } from "node:test";
import lighthouse, { desktopConfig } from "lighthouse";
import { chromium } from "playwright-core";
import { FLAGS, dist } from "./browser.mjs";
import { serve } from "./server.mjs";

const LEAST = 90;
const CATEGORIES = ["performance", "accessibility", "best-practices"];
const METRICS = ["first-contentful-paint", "largest-contentful-paint", "total-blocking-time", "cumulative-layout-shift", "speed-index"];

/** A port that nobody listens on. */
const freePort = () =>
  new Promise((resolve) => {
    const server = net.createServer().listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });

test("Lighthouse: performance, accessibility and best practices", async () => {
  const site = await serve({ "/some/folder/": dist });
  const port = await freePort();
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: [...FLAGS, `--remote-debugging-port=${port}`] });
  try {
    const options = { port, output: "json", logLevel: "error", onlyCategories: CATEGORIES };
    const { lhr } = await lighthouse(`${site.origin}/some/folder/`, options, desktopConfig);
    for (const metric of METRICS) console.log(`${lhr.audits[metric].title}: ${lhr.audits[metric].displayValue}`);
    const scores = Object.fromEntries(CATEGORIES.map((category) => [category, Math.round(100 * lhr.categories[category].score)]));
    console.log(`Lighthouse: ${CATEGORIES.map((category) => `${category} ${scores[category]}`).join(", ")}`);
    const failed = Object.values(lhr.audits).filter(({ score }) => score !== null && score < 0.9);
    const reasons = failed.map(({ id, displayValue, details }) => `${id} ${displayValue ?? ""} ${JSON.stringify(details?.items ?? []).slice(0, 400)}`).join("\n");
    for (const category of CATEGORIES) assert.ok(scores[category] >= LEAST, `${category}: ${scores[category]}\n${reasons}`);
  } finally {
    await browser.close();
    await site.close();
  }
});
