// The legend: rows that fit, the rest counted, and a click that hides a label in space and on slices.

import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, beforeEach, expect, test } from "vitest";

import { atRest, change, folder, openBrowser, openPanel, openViewer, pixels, python, startServer, state, type Browser, type Server } from "./harness.ts";

const N_LABELS = 54;

let server: Server;
let browser: Browser;
let page: Page & { complaints: string[] };

beforeAll(async () => {
  const where = folder();
  // Label n fills the n-th block of 6 x 6 x 6 samples; the first one is large, and in the middle.
  python(
    `import numpy as np
z, y, x = np.indices((40, 40, 40))
scan = ((z - 20) ** 2 + (y - 20) ** 2 + (x - 20) ** 2 < 320).astype(np.uint8) * 90 + np.random.default_rng(0).integers(0, 40, z.shape, np.uint8)
labels = (1 + (z // 10) * 16 + (y // 10) * 4 + x // 10).clip(0, ${N_LABELS}).astype(np.uint8)
labels[16:24, 16:24, 16:24] = 1
for name, samples in (("scan", scan), ("labels", labels)):
    header = "NRRD0004\\ntype: uint8\\ndimension: 3\\nspace: right-anterior-superior\\nsizes: 40 40 40\\nspace directions: (1,0,0) (0,1,0) (0,0,1)\\nspace origin: (0,0,0)\\nkinds: domain domain domain\\nencoding: raw\\n\\n"
    open(name + ".nrrd", "wb").write(header.encode() + samples.tobytes())`,
    where,
  );
  server = await startServer(join(where, "scan.nrrd"), "--labels", join(where, "labels.nrrd"));
  browser = await openBrowser({ viewport: { width: 1280, height: 800 } });
  page = await openViewer(browser, server.link);
});

beforeEach(async () => {
  await page.setViewportSize({ width: 1280, height: 800 });
  await change(page, { op: "replace", path: "/view/interface/panels", value: [] });
  await atRest(page);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

test("54 labels: 12 rows, 42 more, never over the letters of directions", async () => {
  const legend = page.getByRole("list", { name: "Legend" });
  expect(await legend.getByRole("listitem").count()).toBe(13);
  await legend.getByRole("button", { name: `42 more` }).waitFor();
  for (const [width, height] of [[1280, 800], [640, 400]] as const) {
    await page.setViewportSize({ width, height });
    await page.waitForTimeout(300);
    const box = await legend.boundingBox();
    const letters = await page.locator('[data-view="3d"] svg.over [text-anchor="middle"] > text').all();
    for (const letter of letters) {
      const at = await letter.boundingBox();
      if (box === null || at === null || at.width === 0) continue;
      const isApart = at.x > box.x + box.width || at.x + at.width < box.x || at.y > box.y + box.height || at.y + at.height < box.y;
      expect(isApart, `${width} x ${height}: ${await letter.innerHTML()}`).toBe(true);
    }
  }
});

test("a click hides a label in space and on slices, and another one shows it again", async () => {
  await change(page, { op: "replace", path: "/view/layout", value: { name: "two-by-two", main: "3d" } },
    { op: "replace", path: "/view/slices/crosshair", value: [20, 20, 20] });
  await atRest(page);
  await atRest(page, "z");
  const before = [await pixels(page), await pixels(page, "z")];
  const row = page.getByRole("list", { name: "Legend" }).getByRole("button", { name: "1", exact: true });
  await row.click();
  await expect.poll(async () => (await state(page)).labels?.labels["1"]?.opacity).toBe(0);
  await atRest(page);
  await atRest(page, "z");
  expect((await pixels(page)).data.equals(before[0]?.data as Buffer)).toBe(false);
  expect((await pixels(page, "z")).data.equals(before[1]?.data as Buffer)).toBe(false);
  expect(await row.getAttribute("aria-pressed")).toBe("false");
  await row.click();
  await atRest(page);
  await atRest(page, "z");
  expect((await pixels(page)).data.equals(before[0]?.data as Buffer)).toBe(true);
  expect((await pixels(page, "z")).data.equals(before[1]?.data as Buffer)).toBe(true);
});

test("a label is renamed in its row of 28 px, and a hidden one keeps its opacity there", async () => {
  await openPanel(page, "labels");
  const row = page.getByRole("list", { name: "Labels" }).getByRole("listitem").nth(1);
  expect((await row.boundingBox())?.height).toBe(28);
  await row.getByRole("textbox", { name: /^Name/ }).fill("spleen");
  await page.keyboard.press("Enter");
  await expect.poll(async () => (await state(page)).labels?.labels["2"]?.name).toBe("spleen");
  await row.getByRole("slider").fill("0.6");
  await expect.poll(async () => (await state(page)).labels?.labels["2"]?.opacity).toBe(0.6);
  await row.getByRole("checkbox").uncheck();
  await expect.poll(async () => (await state(page)).labels?.labels["2"]?.opacity).toBe(0);
  expect(await row.getByRole("slider").inputValue()).toBe("0.6");
  await page.getByRole("button", { name: "Undo" }).click();
  await page.getByRole("list", { name: "Legend" }).getByText("spleen").waitFor();
});

test("the count of the others opens all of them", async () => {
  await page.getByRole("list", { name: "Legend" }).getByRole("button", { name: /more$/ }).click();
  const sheet = page.locator('[data-panel="labels"]');
  await sheet.waitFor();
  expect(await sheet.getByRole("list", { name: "Labels" }).getByRole("listitem").count()).toBe(N_LABELS);
  expect(page.complaints).toEqual([]);
});
