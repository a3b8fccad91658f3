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
/** Whatever else the machine does makes it slower, never faster: the best of these counts. */
const MOST_ATTEMPTS = 3;
/**
 * The desktop preset with its network really as slow as that. By default the slowness is worked out from a fast load, on the
 * assumption that all that arrived before the largest picture was waited for; but the still picture waits for no program.
 */
const CONFIG = { ...desktopConfig, settings: { ...desktopConfig.settings, throttlingMethod: "devtools" } };
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

test("Lighthouse: accessibility and best practices; performance, which is a matter of the machine, is printed", async () => {
  const site = await serve({ "/some/folder/": dist });
  try {
    let best = null;
    for (let attempt = 0; attempt < MOST_ATTEMPTS && (best === null || best.least < LEAST); attempt++) {
      const found = await measure(`${site.origin}/some/folder/`);
      console.log(found.text);
      if (best === null || found.least > best.least) best = found;
    }
    for (const category of ["accessibility", "best-practices"]) assert.ok(best.scores[category] >= LEAST, `${category}: ${best.text}\n${best.reasons}`);
  } finally {
    await site.close();
  }
});

/** In a browser of its own, which knows nothing of the page. */
async function measure(address) {
  const port = await freePort();
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: [...FLAGS, `--remote-debugging-port=${port}`] });
  try {
    const { lhr } = await lighthouse(address, { port, output: "json", logLevel: "error", onlyCategories: CATEGORIES }, CONFIG);
    const scores = Object.fromEntries(CATEGORIES.map((category) => [category, Math.round(100 * lhr.categories[category].score)]));
    const metrics = METRICS.map((metric) => `${lhr.audits[metric].title.toLowerCase()} ${lhr.audits[metric].displayValue}`);
    const lacking = Object.values(lhr.audits).filter(({ score }) => score !== null && score < 0.9);
    return {
      scores,
      least: Math.min(...Object.values(scores)),
      text: `Lighthouse: ${CATEGORIES.map((category) => `${category} ${scores[category]}`).join(", ")} (${metrics.join(", ")})`,
      reasons: lacking.map(({ id, displayValue, details }) => `${id} ${displayValue ?? ""} ${JSON.stringify(details?.items ?? []).slice(0, 400)}`).join("\n"),
    };
  } finally {
    await browser.close();
  }
}
