// Nothing that the page always shows lies over a view: toolbar, rail, strip, sheets. Handles can be grasped, figures stay.

import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";

import { atRest, change, drag, folder, nightly, openBrowser, openPanel, openViewer, pixels, pngPixels, startServer, state, type Browser, type Server } from "./harness.ts";

let browser: Browser;
let server: Server;
let page: Page;

beforeAll(async () => {
  server = await startServer("--example", "ct_pelvis");
  browser = await openBrowser({ viewport: { width: 1280, height: 800 } });
  page = await openViewer(browser, server.link);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

/** Parts of the page that lie over a view, and the handles that another element covers. */
const covered = (): Promise<string[]> =>
  page.evaluate(() => {
    const root = document.getElementById("viewer")?.shadowRoot;
    const all = (selector: string): Element[] => [...(root?.querySelectorAll(selector) ?? [])];
    const area = all(".views")[0]?.getBoundingClientRect() ?? new DOMRect();
    const over = all(".toolbar > *, .rail, .sheet, .looks, .times")
      .map((element) => ({ name: element.className, box: element.getBoundingClientRect() }))
      .filter(({ box }) => box.width > 0 && box.left < area.right && area.left < box.right && box.top < area.bottom && area.top < box.bottom)
      .map(({ name }) => `${name} over the views`);
    const hidden = all(".over [role=slider]").flatMap((handle) => {
      const { left, right, top, bottom } = handle.getBoundingClientRect();
      const seen = root?.elementFromPoint((left + right) / 2, (top + bottom) / 2);
      return seen && handle.contains(seen) ? [] : [`${handle.getAttribute("aria-label")} under ${seen?.tagName}`];
    });
    return [...over, ...hidden];
  });

/** Number of pixels along the edge of the 3-D picture that are bright: what is seen goes on beyond it. */
async function outside(): Promise<number> {
  const { width, height, data } = await pixels(page);
  const isLit = (x: number, y: number): boolean => (data[4 * (y * width + x)] ?? 0) > 64;
  const rows = [...Array(width).keys()].filter((x) => isLit(x, 0) || isLit(x, height - 1)).length;
  return rows + [...Array(height).keys()].filter((y) => isLit(0, y) || isLit(width - 1, y)).length;
}

const WINDOWS = [[1280, 800], [640, 400], [390, 844], [1000, 700]] as const;

for (const [n, [width, height]] of WINDOWS.entries()) {
  (n < 2 ? test : nightly)(`${width} x ${height}: the box and its handles lie in the free rectangle, with and without a sheet`, async () => {
    await page.setViewportSize({ width, height });
    await change(page, { op: "replace", path: "/view/layout", value: { name: "3d", main: "3d" } },
      { op: "add", path: "/view/overlays/crop_box", value: true },
      { op: "replace", path: "/clip", value: [{ keep: await wholeBox() }, { plane: { point: (await state(page)).view.slices.crosshair, normal: [0, -1, 0] } }] });
    for (const panels of [["presets"], ["presets", "cut"]]) {
      await change(page, { op: "replace", path: "/view/interface/panels", value: panels });
      await atRest(page);
      await page.keyboard.press("f");
      await page.waitForTimeout(400);
      await atRest(page);
      expect(await covered(), panels.join()).toEqual([]);
      expect(await outside(), panels.join()).toBe(0);
    }
    await change(page, { op: "replace", path: "/view/layout", value: { name: "two-by-two", main: "3d" } });
    await atRest(page, "z");
    expect(await covered()).toEqual([]);
  });
}

const wholeBox = () =>
  page.evaluate(() => {
    const { bounds } = (document.getElementById("viewer") as unknown as { wavesplat: { welcome: { bounds: [number[], number[]] } } }).wavesplat.welcome;
    return { lower: bounds[0], upper: bounds[1], space: "world" };
  });

test("the upper face of the crop box is dragged", async () => {
  await page.setViewportSize({ width: 1280, height: 800 });
  await change(page, { op: "replace", path: "/view/layout", value: { name: "3d", main: "3d" } }, { op: "replace", path: "/clip", value: [{ keep: await wholeBox() }] });
  await atRest(page);
  const upper = async (): Promise<number> => ((await state(page)).clip[0] as { keep: { upper: readonly number[] } }).keep.upper[2] ?? 0;
  const before = await upper();
  const box = await page.getByRole("slider", { name: "Crop, z to" }).boundingBox();
  const [x, y] = [(box?.x ?? 0) + (box?.width ?? 0) / 2, (box?.y ?? 0) + (box?.height ?? 0) / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, y + 60, { steps: 6 });
  await page.mouse.up();
  expect(await upper()).toBeLessThan(before - 20);
});

nightly("the sheet that saves a picture changes nothing of it", async () => {
  // So narrow that the turned volume, beside the sheet, takes a smaller scale.
  await page.setViewportSize({ width: 820, height: 700 });
  await change(page, { op: "replace", path: "/clip", value: [] }, { op: "replace", path: "/view/interface/panels", value: [] });
  await atRest(page);
  await drag(page, 60, 20);
  await atRest(page);
  const before = await pixels(page);
  await openPanel(page, "share");
  await atRest(page);
  await page.getByRole("checkbox", { name: /measures/i }).uncheck();
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save picture" }).click()]);
  const path = join(folder(), "picture.png");
  await download.saveAs(path);
  expect(pngPixels(path).equals(before.data)).toBe(true);
});
