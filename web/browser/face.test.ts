// The face of the page: the rail, one sheet at a time, words, fields.

import type { Page } from "playwright-core";
import { afterAll, beforeAll, beforeEach, describe, expect, test } from "vitest";

import type { ViewerState } from "../src/state/state.ts";
import { atRest, change, openBrowser, openViewer, startServer, state, type Browser, type Server } from "./harness.ts";

let server: Server;
let browser: Browser;
let page: Page & { complaints: string[] };
let first: ViewerState;

beforeAll(async () => {
  server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
  browser = await openBrowser({ viewport: { width: 1280, height: 800 } });
  page = await openViewer(browser, server.link);
  first = await state(page);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

beforeEach(async () => {
  await page.setViewportSize({ width: 1280, height: 800 });
  await change(page, { op: "replace", path: "", value: first }, { op: "replace", path: "/view/interface/panels", value: [] });
  await atRest(page);
});

/** Words that nobody understands at once; each has a plain one in its place. */
const UNCLEAR = [
  "Space", "Rays show", "Across it", "Box that is cut out", "Seen", "Usual values", "Points", "Log counts", "Normal width",
  "Reach of occlusion", "Clear below", "own sampling", "End it", "sheets a slice", "texels a pixel",
];

describe("the rail", () => {
  test("opens every panel by one click in a window of 1280 x 800, none below the fold", async () => {
    const icons = page.getByRole("navigation", { name: "Panels" }).locator("[data-opens]");
    const names = await icons.evaluateAll((all) => all.map((one) => (one as HTMLElement).dataset["opens"] ?? ""));
    expect(names.length).toBe(9);
    for (const name of names) {
      await page.locator(`[data-opens="${name}"]`).click();
      const sheet = page.locator(`[data-panel="${name}"]`);
      await sheet.waitFor();
      await expect.poll(() => page.locator("[data-panel]").count()).toBe(1);
      for (const box of [await sheet.boundingBox(), await page.locator(`[data-opens="${name}"]`).boundingBox()]) {
        expect(box?.y ?? -1).toBeGreaterThanOrEqual(0);
        expect((box?.y ?? 0) + (box?.height ?? 900)).toBeLessThanOrEqual(800);
      }
    }
    await page.locator(`[data-opens="${names.at(-1)}"]`).click();
    await expect.poll(() => page.locator("[data-panel]").count()).toBe(0);
  });

  test("Escape closes the sheet, and its icon has the focus", async () => {
    await page.locator('[data-opens="cut"]').click();
    await page.getByRole("checkbox", { name: "Handles in the views" }).focus();
    await page.keyboard.press("Escape");
    await expect.poll(() => page.locator("[data-panel]").count()).toBe(0);
    await expect.poll(() => page.evaluate(() => (document.getElementById("viewer")?.shadowRoot?.activeElement as HTMLElement).dataset["opens"])).toBe("cut");
  });

  test("the picture has the whole window, and no panel has an unclear word", async () => {
    const picture = await page.locator('[data-view="3d"]').boundingBox();
    expect([picture?.width, picture?.height]).toEqual([1280, 800]);
    for (const name of ["function", "layers", "light", "cut", "slices", "measure", "share", "settings"]) {
      await page.locator(`[data-opens="${name}"]`).click();
      const text = await page.locator(`[data-panel="${name}"]`).innerText();
      const lines = text.split("\n").map((line) => line.trim());
      for (const word of UNCLEAR) expect(lines, name).not.toContain(word);
    }
    await page.keyboard.press("?");
    expect(await page.getByRole("dialog").innerText()).not.toContain("End it");
    await page.keyboard.press("Escape");
    expect(page.complaints).toEqual([]);
  });
});
