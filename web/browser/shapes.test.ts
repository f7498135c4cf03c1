// Geometry in the viewer: listed, hidden and shown, and told under the pointer.

import { writeFileSync } from "node:fs";
import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";

import {
  atRest, folder, middle, openBrowser, openPanel, openViewer, pixels, python, startServer, state, type Browser, type Server,
} from "./harness.ts";

/** In front of the patient, where no matter hides it. */
const CELLS = "x_mm,y_mm,z_mm,speed\n0,330,260,1.5\n";

let server: Server;
let browser: Browser;
let page: Page & { complaints: string[] };

beforeAll(async () => {
  const cells = join(folder(), "cells.csv");
  writeFileSync(cells, CELLS);
  server = await startServer(
    "--example", "ct_pelvis", "--preset", "ct-bone", "--points", `${cells}:values=speed:15mm`, "--frame",
  );
  browser = await openBrowser();
  page = await openViewer(browser, server.link);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

/** The place of a world point in the picture, CSS pixels of the page. */
async function placeOf(point: readonly number[]): Promise<readonly [number, number]> {
  const { x, y, width, height } = await middle(page);
  const told = python(
    `import json, sys, wavesplat as ws
camera, point, size = (json.loads(one) for one in sys.argv[1:])
pixels, _ = ws.Camera.from_json(camera).project([point], size=size)
print(json.dumps(pixels[0].tolist()))`,
    folder(), JSON.stringify((await state(page)).camera), JSON.stringify(point),
    JSON.stringify([Math.round(width), Math.round(height)]),
  );
  const [column = NaN, row = NaN] = JSON.parse(told) as number[];
  return [x - width / 2 + column, y - height / 2 + row];
}

test("geometry is listed, hidden, shown and undone", async () => {
  await openPanel(page, "layers");
  const list = page.getByRole("list", { name: "Geometry" });
  await expect.poll(() => list.getByRole("listitem").count()).toBe(2);
  await atRest(page); // in the larger view: the panel takes the place of the strip of looks
  const shown = await pixels(page);
  const box = list.getByRole("checkbox").first();
  await box.uncheck();
  await atRest(page);
  expect((await state(page)).geometry.map(({ visible }) => visible)).toEqual([false, true]);
  expect((await pixels(page)).data.equals(shown.data)).toBe(false);
  await page.locator('[data-view="3d"]').focus();
  await page.keyboard.press("Control+z");
  await expect.poll(() => box.isChecked()).toBe(true);
  await atRest(page);
  expect((await pixels(page)).data.equals(shown.data)).toBe(true);
});

test("the shape under the pointer is told, and no longer when it leaves", async () => {
  await page.mouse.move(...(await placeOf([0, 330, 260])));
  const told = page.locator(".status").getByText(/^points 1, point 0, 1.5 at [RL] \d/);
  await told.waitFor();
  await page.mouse.move(...(await placeOf([0, 330, 700])));
  await told.waitFor({ state: "detached" });
  expect(page.complaints).toEqual([]);
});
