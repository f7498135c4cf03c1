// What leaves the page: pictures of what is seen and code that draws the same, links for other browsers, refusals.

import { request } from "node:http";
import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, expect, test } from "vitest";

import {
  atRest, change, command, drag, folder, middle, openBrowser, openPanel, openViewer, pngPixels, startServer, state, type Browser,
  type Server,
} from "./harness.ts";

let browser: Browser;
let server: Server;
let page: Page;

beforeAll(async () => {
  server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
  browser = await openBrowser();
  await browser.context.grantPermissions(["clipboard-read", "clipboard-write"], { origin: `http://127.0.0.1:${server.port}` });
  page = await openViewer(browser, server.link);
  await openPanel(page, "share");
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

/** The text that a button copies. */
async function copied(name: string, part: string): Promise<string> {
  await page.evaluate(() => navigator.clipboard.writeText(""));
  await page.getByRole("button", { name }).click();
  await expect.poll(() => page.evaluate(() => navigator.clipboard.readText())).toContain(part);
  return page.evaluate(() => navigator.clipboard.readText());
}

/** Saves the picture, and returns the name of its file and its path. */
async function saved(where: string): Promise<{ name: string; path: string }> {
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save picture" }).click()]);
  const name = download.suggestedFilename();
  const path = join(where, `saved_${name}`);
  await download.saveAs(path);
  return { name, path };
}

test.each([
  ["one slice", { name: "single", main: "z" }, "z", "CT_axial.png"],
  ["two by two", { name: "two-by-two", main: "3d" }, "z", "CT_all.png"],
])("%s: what is saved has the measure, and the copied command draws the same pixels", async (_, layout, view, file) => {
  const [x, y, z] = (await state(page)).view.slices.crosshair;
  await change(page, { op: "replace", path: "/view/layout", value: layout }, { op: "replace", path: "/view/measures", value: [] });
  await atRest(page, view);
  const where = folder();
  const plain = pngPixels((await saved(where)).path);
  await change(page, { op: "add", path: "/view/measures/-", value: { kind: "distance", points: [[x, y, z], [x + 40, y, z]] } });
  const picture = await saved(where);
  expect(picture.name).toBe(file);
  const pixels = pngPixels(picture.path);
  expect(pixels.equals(plain)).toBe(false);
  // The size is written below its choice.
  const written = await page.getByText(/pixels, as seen without this sheet/).innerText();
  const [, wide = "", high = ""] = /^(\d+) × (\d+) pixels/.exec(written) ?? [];
  expect(pixels.length).toBe(4 * Number(wide) * Number(high));
  // As wide as without the sheet: all of the window but the rail.
  const { height } = await middle(page, view);
  if (layout.name === "single") expect(pixels.length).toBe(4 * (1100 - 88) * Math.round(height));
  command(await copied("Copy as command", "wavesplat view"), where);
  expect(pngPixels(join(where, file)).equals(pixels)).toBe(true);
});

test("a copied link opens the same state in another browser, once", async () => {
  await change(page, { op: "replace", path: "/view/layout", value: { name: "3d", main: "3d" } });
  await drag(page, 70, 20);
  await atRest(page);
  const shown = await state(page);
  const link = await copied("Copy link", "#token=");
  const other = await openBrowser();
  const there = await openViewer(other, link);
  await expect.poll(async () => (await state(there)).camera).toEqual(shown.camera);
  expect(there.url()).not.toContain("token");
  await other.close();
  const third = await openBrowser();
  const late = await third.context.newPage();
  await late.goto(link);
  await expect.poll(() => late.locator(".opening").innerText()).toContain("the link was used");
  expect(await late.locator(".opening").innerText()).toContain("Copy link in an open page");
  await third.close();
});

test("another port of a tunnel gets a page that names ssh -L and the rule", async () => {
  const told = await new Promise<{ status: number; text: string }>((resolve, reject) => {
    request({ port: server.port, headers: { Host: "localhost:9000" } }, (answer) => {
      let text = "";
      answer.on("data", (data) => (text += String(data)));
      answer.on("end", () => resolve({ status: answer.statusCode ?? 0, text }));
    }).on("error", reject).end();
  });
  expect(told.status).toBe(403);
  expect(told.text).toContain(`ssh -N -L ${server.port}:127.0.0.1:${server.port}`);
  expect(told.text).toContain("both ends must have the same port");
  expect(told.text).not.toContain("token");
});

test("the link of the state is short", async () => {
  const link = await copied("Copy link", "#token=");
  expect(link.length).toBeLessThan(4000);
});
