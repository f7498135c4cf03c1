// Planes pushed from their side, fields that fit, windows set finely, pictures that no sheet makes narrower, undo after a reload.

import { readFileSync } from "node:fs";
import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";

import type { Vec3 } from "../src/state/state.ts";

import { atRest, change, drag, folder, openBrowser, openPanel, openViewer, startServer, state, type Browser, type Server } from "./harness.ts";

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

test("a plane that is seen from its side is pushed by the handle in its middle, and not tilted", async () => {
  await openPanel(page, "cut");
  await page.getByRole("button", { name: "Add a plane that faces you" }).click();
  await page.keyboard.press("3");
  await atRest(page);
  const plane = async () => ((await state(page)).clip[0] as { plane: { point: Vec3; normal: Vec3 } }).plane;
  const before = await plane();
  const box = await page.getByRole("slider", { name: "Clip plane 1", exact: true }).boundingBox();
  const [x, y] = [(box?.x ?? 0) + (box?.width ?? 0) / 2, (box?.y ?? 0) + (box?.height ?? 0) / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 60, y, { steps: 6 });
  await page.mouse.up();
  await atRest(page);
  const after = await plane();
  after.normal.forEach((part, axis) => expect(part).toBeCloseTo(before.normal[axis] ?? 0, 9));
  expect(after.point).not.toEqual(before.point);
});

test("the fields of a plane lie within the sheet", async () => {
  const sheet = await page.locator(".sheet").boundingBox();
  const right = (sheet?.x ?? 0) + (sheet?.width ?? 0);
  const fields = await page.locator(".sheet .plane input").all();
  expect(fields.length).toBeGreaterThanOrEqual(4);
  for (const field of fields) {
    const box = await field.boundingBox();
    expect((box?.x ?? 0) + (box?.width ?? 0)).toBeLessThanOrEqual(right);
  }
});

test("a slice is saved as wide as it is without the sheet that saves it", async () => {
  await change(page, { op: "replace", path: "/clip", value: [] }, { op: "replace", path: "/view/layout", value: { name: "two-by-two", main: "3d" } },
    { op: "replace", path: "/view/interface/panels", value: [] });
  await atRest(page, "z");
  const pane = await page.locator('[data-view="z"] canvas').boundingBox();
  await openPanel(page, "share");
  await atRest(page, "z");
  await page.getByLabel("Picture of").selectOption("z");
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save picture" }).click()]);
  const path = join(folder(), "slice.png");
  await download.saveAs(path);
  // The width stands at byte 16 of a PNG.
  expect(Math.abs(readFileSync(path).readUInt32BE(16) - (pane?.width ?? 0))).toBeLessThanOrEqual(2);
});

test("a narrow window is set as finely as a wide one", async () => {
  await change(page, { op: "replace", path: "/view/interface/panels", value: [] }, { op: "add", path: "/view/slices/window", value: [40, 80] });
  await atRest(page, "z");
  await page.keyboard.down("Alt");
  await drag(page, 10, 10, { view: "z" });
  await page.keyboard.up("Alt");
  const [level, width] = (await state(page)).view.slices.window ?? [0, 0];
  expect(Math.abs(width - 80)).toBeGreaterThan(1);
  expect(Math.abs(width - 80)).toBeLessThanOrEqual(8);
  expect(Math.abs(level - 40)).toBeLessThanOrEqual(8);
});

test("steps can be undone after the page was loaded again", async () => {
  await change(page, { op: "replace", path: "/render/kernel", value: "gaussian" });
  await atRest(page);
  await page.reload();
  await atRest(page);
  expect((await state(page)).render.kernel).toBe("gaussian");
  await page.getByRole("button", { name: /^Undo/ }).click();
  expect((await state(page)).render.kernel).not.toBe("gaussian");
});
