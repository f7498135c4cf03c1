// A layer that another field colours: shown and turned, its colour bar, both values at a place, and a saved view opened again.

import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";

import { atRest, change, drag, folder, middle, openBrowser, openPanel, openViewer, pixels, python, startServer, state, type Browser, type Server } from "./harness.ts";

let where: string;
let server: Server;
let browser: Browser;
let page: Page & { complaints: string[] };

const options = ["--dataset", "density", "--color-by", "temperature:inferno:300,331", "--background", "black"];

beforeAll(async () => {
  where = folder();
  // A ball whose temperature is that of x, 300 and more.
  python(
    `import h5py
import numpy as np
z, y, x = np.indices((32, 32, 32), dtype=np.float32)
radius = np.sqrt((x - 15.5) ** 2 + (y - 15.5) ** 2 + (z - 15.5) ** 2)
with h5py.File("gas.h5", "w") as file:
    file["density"] = np.clip(14 - radius, 0, None).astype(np.float32)
    file["temperature"] = (300 + x).astype(np.float32)
    file["temperature"].attrs["units"] = "K"`,
    where,
  );
  server = await startServer(join(where, "gas.h5"), ...options);
  browser = await openBrowser({ viewport: { width: 1100, height: 720 } });
  page = await openViewer(browser, server.link);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

/** Mean colour of what is seen in the left and the right half of the picture. */
async function halves(of: Page): Promise<[number[], number[]]> {
  const { width, data } = await pixels(of);
  const sums = [[0, 0, 0, 0], [0, 0, 0, 0]];
  for (let at = 0; at < data.length; at += 4) {
    const sum = sums[(at / 4) % width < width / 2 ? 0 : 1] as number[];
    const rgb = [data[at], data[at + 1], data[at + 2]] as number[];
    if (Math.max(...rgb) < 24) continue;
    rgb.forEach((value, c) => (sum[c] = (sum[c] ?? 0) + value));
    sum[3] = (sum[3] ?? 0) + 1;
  }
  return sums.map(([r = 0, g = 0, b = 0, n = 0]) => [r / n, g / n, b / n]) as [number[], number[]];
}

test("the colours are those of the second field, and turn with it", async () => {
  // Seen along y with z up, x grows to the right.
  const seen = { position: [15.5, -60, 15.5], focal_point: [15.5, 15.5, 15.5], view_up: [0, 0, 1], parallel_scale: 18 };
  const camera = { ...(await state(page)).camera, ...seen };
  await change(page, { op: "replace", path: "/camera", value: camera });
  await atRest(page);
  const [left, right] = await halves(page);
  // inferno is violet where it is cold, and orange where it is hot.
  const violet = ([r = 0, , b = 0]: number[]): number => b / r;
  expect(violet(left)).toBeGreaterThan(3 * violet(right));
  const before = await pixels(page);
  await drag(page, 160, 40);
  await atRest(page);
  expect((await pixels(page)).data.equals(before.data)).toBe(false);
});

test("the colour bar is that of the field that colours", async () => {
  await change(page, { op: "replace", path: "/view/overlays/color_bar", value: true });
  const bar = page.getByRole("img", { name: "Colours of temperature from 300 to 331 K" });
  await bar.waitFor();
  expect(await bar.innerText()).toMatch(/temperature\s+331 K\s+300/);
});

test("what is under the pointer, and a picked place, tell both values", async () => {
  const { x, y } = await middle(page);
  const told = page.locator(".status span").filter({ hasText: "density" });
  const numbers = async (): Promise<number[]> =>
    (/density (\S+), temperature (\S+) K at x (\S+) /.exec((await told.allInnerTexts())[0] ?? "") ?? []).slice(1).map(Number);
  await page.keyboard.down("Control");
  await page.mouse.click(x, y);
  await page.keyboard.up("Control");
  const crosshair = async (): Promise<number> => (await state(page)).view.slices.crosshair[0];
  await expect.poll(async () => Math.abs(((await numbers())[2] ?? NaN) - (await crosshair()))).toBeLessThan(0.1);
  // The pointer alone tells the same.
  await page.mouse.move(x + 20, y);
  await expect.poll(async () => Math.abs(((await numbers())[2] ?? NaN) - (await crosshair()))).toBeGreaterThan(0.2);
  const [density = 0, temperature = 0, place = 0] = await numbers();
  expect(density).toBeGreaterThan(0);
  // The nearest sample along x, whose temperature is 300 + x.
  expect(Math.abs(temperature - 300 - place)).toBeLessThanOrEqual(0.56);
  // A place where nothing is seen has no values.
  await page.mouse.move(x - 300, y - 250);
  await told.waitFor({ state: "detached" });
});

test("a saved view opens again with both fields", async () => {
  await openPanel(page, "share");
  await atRest(page);
  const drawn = await pixels(page);
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save state" }).click()]);
  const path = join(where, "saved.json");
  await download.saveAs(path);
  const again = await startServer("--state", path);
  try {
    const other = await openViewer(browser, again.link);
    expect((await pixels(other)).data.equals(drawn.data)).toBe(true);
    expect(other.complaints).toEqual([]);
    await other.close();
  } finally {
    await again.stop();
  }
  expect(page.complaints).toEqual([]);
});
