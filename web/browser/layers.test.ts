// The row of a layer: a window that is typed and dragged, a threshold, gamma; channels in the colours of their dyes.

import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";

import type { TransferFunction } from "../src/state/state.ts";

import { atRest, command, folder, nightly, openBrowser, openPanel, openViewer, pixels, pngPixels, python, startServer, state, type Browser, type Server } from "./harness.ts";

const SCANS = `
import numpy as np, wavesplat as ws
places = np.indices((24, 28, 32)) - np.array([12, 14, 16]).reshape(3, 1, 1, 1)
away = (places ** 2).sum(axis=0)
scan = np.where(away < 120, 40, -1000).astype("int16")
ws.Volume(scan, spacing=(5, 5, 5), anatomical=True, facts=ws.Facts(modality="CT")).save("ct.nrrd")
ws.Volume((0.5 + 9 * np.exp(-away / 20)).astype("float32"), spacing=(5, 5, 5), anatomical=True).save("pet.nrrd")
`;

let browser: Browser;
let server: Server;
let page: Page & { complaints: string[] };
const where = folder();

beforeAll(async () => {
  python(SCANS, where);
  server = await startServer(join(where, "ct.nrrd"), "--layer", join(where, "pet.nrrd"));
  browser = await openBrowser({ viewport: { width: 1280, height: 800 } });
  page = await openViewer(browser, server.link);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

const curves = async (): Promise<TransferFunction> => (await state(page)).layers[1]?.look.transfer_function as TransferFunction;
const ends = async (): Promise<readonly (number | undefined)[]> => [(await curves()).color[0]?.[0], (await curves()).color.at(-1)?.[0]];

async function type(field: string, text: string): Promise<void> {
  await page.locator(".look-layer").nth(1).getByRole("textbox", { name: field }).fill(text);
  await page.keyboard.press("Enter");
}

test("from 2 to 8, hidden below 2: typed into the row of a layer, they draw what the command draws", async () => {
  await openPanel(page, "layers");
  await page.locator(".look-window").nth(1).waitFor();
  // As fast as one types: each field sets what it is for.
  await type("From", "2");
  await type("To", "8");
  await expect.poll(ends).toEqual([2, 8]);
  await type("Hide below", "2");
  await expect.poll(async () => (await curves()).opacity).toEqual([[2, 0], [2, 1]]);
  await atRest(page);
  const { data, width, height } = await pixels(page);
  const camera = JSON.stringify((await state(page)).camera);
  command(`wavesplat render ct.nrrd --layer pet.nrrd:hot:2,8:threshold=2 --camera '${camera}' --size ${width}x${height} -o picture.png`, where);
  expect(pngPixels(join(where, "picture.png")).equals(data)).toBe(true);
  for (let step = 0; step < 3; step += 1) await page.getByRole("button", { name: /^Undo/ }).click();
  await expect.poll(async () => (await curves()).opacity.length).toBe(5);
  expect(page.complaints).toEqual([]);
});

test("Ctrl Z undoes where a slider or a name that was taken has the focus; Escape takes back one thing after the other", async () => {
  await openPanel(page, "layers");
  const row = page.locator(".look-layer").nth(1);
  const layer = async () => (await state(page)).layers[1];
  const sheets = (): Promise<number> => page.locator(".sheet").count();
  await row.getByRole("slider", { name: /^Opacity/ }).fill("0.5");
  await expect.poll(async () => (await layer())?.opacity).toBe(0.5);
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await layer())?.opacity).toBe(1);
  const name = row.getByRole("textbox", { name: /^Name/ });
  const named = await name.inputValue();
  await name.fill("Sugar");
  await page.keyboard.press("Enter");
  await expect.poll(async () => (await layer())?.name).toBe("Sugar");
  await page.keyboard.press("Control+z");
  await expect.poll(async () => [(await layer())?.name, await name.inputValue()]).toEqual([named, named]);

  // The message lies over no control, and goes before the sheet does.
  await type("From", "200%");
  const message = page.getByRole("alert");
  const box = await message.boundingBox();
  for (const control of [".toolbar", ".sheet", ".legend", ".rail", ".bottom"]) {
    const other = await page.locator(control).boundingBox();
    const isApart = box !== null && other !== null && (box.x >= other.x + other.width || other.x >= box.x + box.width || box.y >= other.y + other.height || other.y >= box.y + box.height);
    expect(isApart, control).toBe(true);
  }
  const from = row.getByRole("textbox", { name: "From" });
  const before = [await from.inputValue(), await ends()];
  await from.focus();
  await page.keyboard.press("Escape");
  await expect.poll(() => message.count()).toBe(0);
  await from.fill("3");
  await page.keyboard.press("Escape");
  await expect.poll(() => from.inputValue()).toBe(before[0]);
  expect(await sheets()).toBe(1);
  await page.keyboard.press("Escape");
  await expect.poll(sheets).toBe(0);
  expect([before[0], await ends()]).toEqual(before);

  // The focus is on the icon that opened the sheet; the help goes before the sheet.
  await page.locator('[data-opens="layers"]').click();
  await page.keyboard.press("?");
  await page.getByRole("dialog").waitFor();
  await page.keyboard.press("Escape");
  await expect.poll(() => page.getByRole("dialog").count()).toBe(0);
  expect(await sheets()).toBe(1);
  await page.keyboard.press("Escape");
  await expect.poll(sheets).toBe(0);
  expect(page.complaints).toEqual([]);
});

nightly("an end of the window is dragged, gamma is set, and Auto takes both back", async () => {
  const before = await curves();
  const slider = page.locator(".look-window").nth(1).getByRole("slider").last();
  const box = await slider.boundingBox();
  await page.mouse.move((box?.x ?? 0) + (box?.width ?? 0) - 8, (box?.y ?? 0) + (box?.height ?? 0) / 2);
  await page.mouse.down();
  await page.mouse.move((box?.x ?? 0) + (box?.width ?? 0) / 2, (box?.y ?? 0) + 5, { steps: 8 });
  await page.mouse.up();
  await expect.poll(async () => ((await ends())[1] ?? 0) < 0.7 * (before.color.at(-1)?.[0] ?? 0)).toBe(true);
  const [low, high] = await ends();
  await page.locator(".look-layer").nth(1).getByRole("slider", { name: /^Gamma/ }).fill("0.5");
  await expect.poll(async () => (await curves()).color[64]?.[0]).toBeCloseTo((low ?? 0) + ((high ?? 0) - (low ?? 0)) * (64 / 255) ** 2, 6);
  await page.locator(".look-layer").nth(1).getByRole("button", { name: /^Auto/ }).click();
  await expect.poll(curves).toEqual(before);
  expect(page.complaints).toEqual([]);
});
