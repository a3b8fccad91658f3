// A first visit as Lighthouse sees it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { serve } from "../../xtask/site/server.mjs";
import { dist } from "../three/data.mjs";
import { BACK_ENDS } from "./browser.mjs";
import { measureFirstVisit } from "./lighthouse.mjs";

const MIN_SCORE = 90;

for (const renderer of BACK_ENDS)
  test(`Lighthouse on ${renderer}: accessibility and best practices; performance, which depends on the machine, is only printed`, async () => {
    const site = await serve({ "/some/folder/": dist });
    try {
      const { scores, text, reasons } = await measureFirstVisit(`${site.origin}/some/folder/?renderer=${renderer}`);
      for (const category of ["accessibility", "best-practices"]) assert.ok(scores[category] >= MIN_SCORE, `${category}: ${text}\n${reasons}`);
    } finally {
      await site.close();
    }
  });
