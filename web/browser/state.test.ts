// Page and session in step: confirmed changes, a server that is silent or gone, and progress of a picture at rest.

import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { afterAll, beforeAll, expect, test } from "vitest";

import {
  atRest, change, drag, nightly, openBrowser, openViewer, python, startServer, state, type Browser, type Server,
} from "./harness.ts";

const PANELS = ["presets", "function", "layers", "light", "cut", "slices", "measure", "share", "settings"];

let browser: Browser;
let server: Server;

beforeAll(async () => {
  browser = await openBrowser();
  server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

test("changes that draw nothing are confirmed: no word of a missing answer", async () => {
  const page = await openViewer(browser, server.link);
  const before = await page.locator(".status").innerText();
  for (const panel of PANELS) await change(page, { op: "replace", path: "/view/interface/panels", value: [panel] });
  for (const theme of ["light", "dark"]) await change(page, { op: "replace", path: "/view/interface/theme", value: theme });
  await page.waitForTimeout(2600);
  expect(await page.locator(".banner").count()).toBe(0);
  expect(await page.locator(".status").innerText()).toBe(before);
  expect(page.complaints).toEqual([]);
  await page.close();
});

test("a session that does not answer dims the picture within three seconds, and says what to do", async () => {
  const page = await browser.context.newPage();
  let isSilent = false;
  await page.routeWebSocket(/\/socket$/, (route) => {
    const far = route.connectToServer();
    route.onMessage((message) => void (isSilent || far.send(message)));
    far.onMessage((message) => route.send(message));
  });
  await page.goto(`http://127.0.0.1:${server.port}/`);
  await atRest(page);
  isSilent = true;
  await drag(page, 40, 0);
  await page.locator(".banner").waitFor({ timeout: 3000 });
  expect(await page.locator(".banner").innerText()).toContain("does not answer");
  expect(await page.locator(".views").getAttribute("data-stale")).toBe("true");
  await page.close();
});

test("a second window has its own layout and panels, and follows the camera", async () => {
  const one = await openViewer(browser, `http://127.0.0.1:${server.port}/`);
  const other = await openViewer(browser, `http://127.0.0.1:${server.port}/`);
  const before = (await state(one)).view;
  await other.getByRole("radio", { name: "Two by two" }).click();
  await other.locator('[data-opens="light"]').click();
  await change(other, { op: "replace", path: "/background", value: "#102030" });
  await expect.poll(async () => (await state(one)).background).toBe("#102030");
  expect((await state(one)).view).toEqual(before);
  expect(await one.locator(".viewport").count()).toBe(1);
  expect(await other.locator(".viewport").count()).toBe(4);
  await one.close();
  await other.close();
});

test("a page follows another one while it is changed itself, and both end alike", async () => {
  const one = await openViewer(browser, `http://127.0.0.1:${server.port}/`);
  const other = await openViewer(browser, `http://127.0.0.1:${server.port}/`);
  await Promise.all(
    [one, other].map(async (page, which) => {
      for (let n = 0; n < 20; n += 1) {
        await change(page, { op: "replace", path: "/layers/0/opacity", value: (n + 1 + which / 2) / 30 },
          // Refused now and then: a refusal takes back no change of the other page.
          ...(n % 7 === 3 ? [{ op: "replace", path: "/render/kernel", value: "none" }] : []));
      }
    }),
  );
  await expect.poll(async () => JSON.stringify(await state(one)) === JSON.stringify(await state(other))).toBe(true);
  expect((await state(one)).render.kernel).toBe("linear");
  await one.close();
  await other.close();
});

nightly("the share of a picture of a lazy volume is shown while it is drawn, and gone at rest", async () => {
  const folder = mkdtempSync(join(tmpdir(), "wavesplat-lazy-"));
  const path = join(folder, "noise.ome.zarr");
  // Noise, in which no block is empty; each level is half the one before.
  python(
    "import sys, numpy as np, zarr\n" +
    "group = zarr.open_group(sys.argv[1], mode='w', zarr_format=2)\n" +
    "whole = np.random.default_rng(1).integers(0, 60, (192,) * 3, dtype='u1')\n" +
    "levels = [whole[::step, ::step, ::step] for step in (1, 2, 4)]\n" +
    "for n, level in enumerate(levels): group.create_array(str(n), data=level, chunks=(32,) * 3)\n" +
    "scales = [{'path': str(n), 'coordinateTransformations': [{'type': 'scale', 'scale': [2.0 ** n] * 3}]} for n in range(3)]\n" +
    "axes = [{'name': name, 'type': 'space', 'unit': 'micrometer'} for name in 'zyx']\n" +
    "group.attrs['multiscales'] = [{'version': '0.4', 'name': 'noise', 'axes': axes, 'datasets': scales}]\n",
    folder, path,
  );
  const lazy = await startServer(path, "--memory", "64MB", "--quality", "high");
  const page = await browser.context.newPage();
  const seen: number[] = [];
  await page.exposeFunction("seen", (percent: number) => seen.push(percent));
  await page.addInitScript(() => {
    setInterval(() => {
      const ring = document.getElementById("viewer")?.shadowRoot?.querySelector(".refining");
      if (ring) (window as unknown as { seen(percent: number): void }).seen(Number(ring.getAttribute("aria-valuenow")));
    }, 20);
  });
  await page.goto(lazy.link);
  await atRest(page);
  expect(new Set(seen).size).toBeGreaterThan(2);
  expect(seen).toEqual([...seen].sort((a, b) => a - b));
  await expect.poll(() => page.locator(".refining").count()).toBe(0);
  await page.close();
  await lazy.stop();
  rmSync(folder, { recursive: true });
});

test("a server that has ended dims the picture, and the page says how to go on", async () => {
  const page = await openViewer(browser, `http://127.0.0.1:${server.port}/`);
  await server.stop();
  await page.locator(".banner").waitFor();
  expect(await page.locator(".banner").innerText()).toContain("start it again with the same --port");
  expect(await page.locator(".views").getAttribute("data-stale")).toBe("true");
  await expect.poll(() => page.getByRole("button", { name: "Try again now" }).count()).toBe(1);
  await page.close();
});
