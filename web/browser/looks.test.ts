// The strip of looks: a preview while the pointer rests on a tile, and tiles that follow the camera.

import type { Page } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";

import { atRest, drag, openBrowser, openViewer, pixels, startServer, state, type Browser, type Server } from "./harness.ts";

let server: Server;
let browser: Browser;
let page: Page & { complaints: string[] };

beforeAll(async () => {
  server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
  browser = await openBrowser({ viewport: { width: 1280, height: 800 } });
  page = await openViewer(browser, server.link);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

const canUndo = (): Promise<boolean> => page.getByRole("button", { name: "Undo" }).isEnabled();
const tile = (name: string) => page.locator(".looks").getByRole("option", { name: new RegExp(`^${name}:`) });
const addressOf = (name: string): Promise<string | null> => tile(name).locator("img").getAttribute("src");

test("the pointer on a tile shows a look, leaving restores it, a click keeps it in one step", async () => {
  const [before, seen] = [await state(page), await pixels(page)];
  await tile("Muscle").hover();
  await expect.poll(async () => (await state(page)).layers[0]?.look.name).toBe("ct-muscle");
  await atRest(page);
  expect((await pixels(page)).data.equals(seen.data)).toBe(false);
  expect(await tile("Bone").getAttribute("aria-selected")).toBe("true");
  expect(await canUndo()).toBe(false);
  await page.mouse.move(640, 300);
  await expect.poll(async () => state(page)).toEqual(before);
  await atRest(page);
  expect((await pixels(page)).data.equals(seen.data)).toBe(true);

  await tile("Muscle").click();
  await page.mouse.move(640, 300);
  await expect.poll(async () => (await state(page)).layers[0]?.look.name).toBe("ct-muscle");
  expect(await tile("Muscle").getAttribute("aria-selected")).toBe("true");
  await page.getByRole("button", { name: "Undo" }).click();
  expect((await state(page)).layers).toEqual(before.layers);
  // The button follows in the next frame.
  await expect.poll(canUndo).toBe(false);
});

test("after a turn and three seconds the tiles show the new side", async () => {
  await tile("Skin").locator("img").waitFor();
  const old = await addressOf("Skin");
  const { height } = (await page.locator('[data-view="3d"]').boundingBox()) ?? { height: 0 };
  await drag(page, height / 2, 0);
  await expect.poll(() => addressOf("Skin"), { timeout: 40_000 }).not.toBe(old);
  const picture = await tile("Skin").locator("img").evaluate((image) => (image as HTMLImageElement).naturalWidth);
  expect(picture).toBe(192);
  expect(page.complaints).toEqual([]);
});

test("all looks are one click away, with a search", async () => {
  await page.getByRole("button", { name: "All looks" }).click();
  const sheet = page.locator('[data-panel="looks"]');
  await sheet.getByRole("searchbox").fill("coronary");
  await expect.poll(() => sheet.getByRole("option").count()).toBe(3);
});
