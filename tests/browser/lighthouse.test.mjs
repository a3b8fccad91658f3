// A first visit as Lighthouse sees it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { dist } from "../three/data.mjs";
import { measureFirstVisit } from "./lighthouse.mjs";
import { serve } from "./server.mjs";

const MIN_SCORE = 90;
/** Other work on the machine only makes it slower, so the best attempt counts. */
const MAX_ATTEMPTS = 3;

test("Lighthouse: accessibility and best practices; performance, which depends on the machine, is only printed", async () => {
  const site = await serve({ "/some/folder/": dist });
  try {
    const address = `${site.origin}/some/folder/`;
    let best = await measureFirstVisit(address);
    for (let attempt = 1; attempt < MAX_ATTEMPTS && best.lowest < MIN_SCORE; attempt++) {
      const found = await measureFirstVisit(address);
      if (found.lowest > best.lowest) best = found;
    }
    for (const category of ["accessibility", "best-practices"]) assert.ok(best.scores[category] >= MIN_SCORE, `${category}: ${best.text}\n${best.reasons}`);
  } finally {
    await site.close();
  }
});
