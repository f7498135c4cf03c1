// Robustness of the viewer: accessibility by axe, lost servers, slow lines, links that were used, memory.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

import { afterAll, beforeAll, describe, expect, test } from "vitest";

import {
  NIGHT, atRest, change, drag, middle, nightly, openBrowser, openPanel, openViewer, pixels, records, startServer, state, type Browser, type Server,
} from "./harness.ts";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const PANELS = ["presets", "looks", "about", "function", "layers", "light", "cut", "slices", "measure", "share", "settings"];

let browser: Browser;

beforeAll(async () => {
  browser = await openBrowser();
});

afterAll(async () => {
  await browser?.close();
});

describe("accessibility", () => {
  let server: Server;
  beforeAll(async () => {
    server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
  });
  afterAll(async () => {
    await server?.stop();
  });

  test.each(NIGHT ? ["dark", "light"] : ["dark"])("axe finds nothing in %s", async (theme) => {
    const page = await openViewer(browser, theme === "dark" ? server.link : `http://127.0.0.1:${server.port}/`);
    await change(page, { op: "replace", path: "/view/interface/theme", value: theme },
      { op: "replace", path: "/view/layout", value: { name: "one-and-three", main: "3d" } },
      { op: "replace", path: "/view/overlays", value: Object.fromEntries(["scale_bar", "letters", "cube", "color_bar", "crosshair", "crop_box", "legend"].map((name) => [name, true])) },
      { op: "add", path: "/clip/-", value: { keep: { lower: [-100, 50, 150], upper: [100, 250, 400], space: "world" } } },
      { op: "add", path: "/view/measures/-", value: { kind: "distance", points: [[0, 150, 260], [50, 150, 260]] } });
    await atRest(page);
    await page.evaluate(AXE);
    const find = async (): Promise<string[]> =>
      page.evaluate(async () => {
        const { axe } = window as unknown as { axe: { run(options: object): Promise<{ violations: { id: string; nodes: { target: unknown; failureSummary?: string }[] }[] }> } };
        const { violations } = await axe.run({ resultTypes: ["violations"] });
        return violations.flatMap(({ id, nodes }) => nodes.map(({ target, failureSummary }) => `${id}: ${JSON.stringify(target)} ${failureSummary ?? ""}`));
      });
    expect(await find()).toEqual([]);
    for (const name of PANELS) {
      await openPanel(page, name);
      expect(await find(), name).toEqual([]);
    }
    await page.locator('[data-view="3d"]').focus();
    await page.keyboard.press("?");
    await page.getByRole("dialog").waitFor();
    expect(await find()).toEqual([]);
    await page.keyboard.press("Escape");
    await page.keyboard.press("Control+k");
    await page.getByRole("combobox", { name: /^Find a command/ }).waitFor();
    expect(await find()).toEqual([]);
    await page.close();
  });

  nightly("nothing overflows where it is narrow or magnified", async () => {
    const page = await openViewer(browser, `http://127.0.0.1:${server.port}/`);
    for (const [width, height] of [[360, 640], [640, 400], [320, 512]] as const) {
      await page.setViewportSize({ width, height });
      await page.waitForTimeout(300);
      const found = await page.evaluate(() => {
        const root = document.getElementById("viewer")?.shadowRoot;
        const box = root?.querySelector(".wavesplat")?.getBoundingClientRect();
        const picture = root?.querySelector('[data-view="3d"]')?.getBoundingClientRect();
        return { scroll: document.documentElement.scrollWidth, right: box?.right ?? 0, picture: [picture?.width ?? 0, picture?.height ?? 0] };
      });
      expect(found.scroll).toBeLessThanOrEqual(width);
      expect(found.right).toBeLessThanOrEqual(width + 1);
      expect(Math.min(...found.picture)).toBeGreaterThan(100);
    }
    await page.close();
  });
});

test("a page connects again after the server was started again, with what was changed", async () => {
  const first = await startServer("--example", "ripples");
  const page = await openViewer(browser, first.link);
  await drag(page, 50, 20);
  await atRest(page);
  const shown = await state(page);
  await first.stop();
  await expect.poll(() => page.locator(".banner").innerText()).toContain("The connection to the program that draws is lost");
  // Changes made meanwhile are kept.
  await change(page, { op: "replace", path: "/render/kernel", value: "bspline2" });
  const again = await startServer("--example", "ripples", "--port", String(first.port));
  // The new link, as the command opens it in the browser.
  const other = await openViewer(browser, again.link);
  await page.bringToFront();
  await expect.poll(() => page.locator(".banner").count(), { timeout: 20_000 }).toBe(0);
  await atRest(page);
  expect((await state(page)).camera).toEqual(shown.camera);
  await expect.poll(async () => (await state(other)).render.kernel).toBe("bspline2");
  await page.close();
  await other.close();
  await again.stop();
});

nightly("a link that was used says so", async () => {
  const server = await startServer("--example", "ripples");
  const one = await openBrowser();
  const page = await openViewer(one, server.link);
  await page.close();
  await one.close();
  const other = await browser.context.newPage();
  await other.goto(server.link);
  await expect.poll(() => other.locator(".opening").innerText()).toContain("the link was used");
  await other.close();
  await server.stop();
});

const cpuMs = (pid: number): number => {
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ")[1]?.split(" ") ?? [];
  return (Number(fields[11]) + Number(fields[12])) * 10;
};

nightly("over a slow line a page is never further behind than one frame; one that does not answer costs nothing", async () => {
  const server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
  const page = await browser.context.newPage();
  // A line of 100 ms there and back, 10 Mbit/s.
  await page.routeWebSocket(/\/socket$/, (route) => {
    const far = route.connectToServer();
    const queue = (forward: (message: string | Buffer) => void, rate: number): ((message: string | Buffer) => void) => {
      let free = 0;
      return (message) => {
        const now = performance.now();
        free = Math.max(free, now) + message.length / rate;
        setTimeout(() => forward(message), free - now + 50);
      };
    };
    route.onMessage(queue((message) => far.send(message), Infinity));
    far.onMessage(queue((message) => route.send(message), 1250));
  });
  await page.goto(server.link);
  await atRest(page);
  const { x, y } = await middle(page);
  await page.mouse.move(x, y);
  await page.mouse.down();
  const before = (await records(page)).length;
  for (let n = 1; n <= 60; n += 1) {
    await page.mouse.move(x + 2 * n, y);
    await page.waitForTimeout(16);
  }
  const newest = await page.evaluate(() => (document.getElementById("viewer") as unknown as { wavesplat: { store: { seq: number } } }).wavesplat.store.seq);
  await page.mouse.up();
  const released = performance.now();
  await expect.poll(async () => (await records(page)).some((record) => record.frame.seq >= newest - 1), { interval: 20 }).toBe(true);
  const waited = performance.now() - released;
  const moving = (await records(page)).slice(before).filter((record) => !record.frame.at_rest);
  expect(moving.length).toBeGreaterThan(4);
  // The wait is at most that for two frames, 100 ms and the transfer of the bytes each.
  expect(waited).toBeLessThan(3000);
  const latencies = moving.flatMap((record) => (record.latency === null ? [] : [record.latency])).sort((a, b) => a - b);
  expect(latencies[Math.floor(latencies.length / 2)] ?? Infinity).toBeLessThan(700);
  await atRest(page);
  await page.close();

  // Nothing is drawn for a page that stops reading.
  const silent = await browser.context.newPage();
  let isSilent = false;
  await silent.routeWebSocket(/\/socket$/, (route) => {
    const far = route.connectToServer();
    route.onMessage((message) => {
      if (!isSilent) far.send(message);
    });
    far.onMessage((message) => route.send(message));
  });
  await silent.goto(`http://127.0.0.1:${server.port}/`);
  await atRest(silent);
  await drag(silent, 40, 0);
  isSilent = true;
  await silent.waitForTimeout(1500);
  const begun = cpuMs(server.process.pid ?? 0);
  await drag(silent, 60, 0);
  await silent.waitForTimeout(3000);
  expect(cpuMs(server.process.pid ?? 0) - begun).toBeLessThan(300);
  await silent.close();
  await server.stop();
});

nightly("a thousand frames need no more memory", async () => {
  const server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
  const page = await openViewer(browser, server.link);
  await page.setViewportSize({ width: 640, height: 420 });
  const turn = (n: number): Promise<number> =>
    page.evaluate(async (frames) => {
      const viewer = (document.getElementById("viewer") as unknown as { wavesplat: { store: { seq: number; state: { camera: { position: number[]; focal_point: number[] } }; change(o: unknown[], g: string): void; settle(): void }; statistics: { records: { frame: { seq: number } }[] } } }).wavesplat;
      const { store, statistics } = viewer;
      const { position, focal_point } = store.state.camera;
      let drawn = 0;
      for (let k = 0; drawn < frames; k += 1) {
        const angle = k / 40;
        const [x, y] = [(position[0] ?? 0) - (focal_point[0] ?? 0), (position[1] ?? 0) - (focal_point[1] ?? 0)];
        const next = [(focal_point[0] ?? 0) + x * Math.cos(angle) - y * Math.sin(angle), (focal_point[1] ?? 0) + x * Math.sin(angle) + y * Math.cos(angle), position[2] ?? 0];
        store.change([{ op: "replace", path: "/camera/position", value: next }], "turn");
        const { seq } = store;
        while ((statistics.records.at(-1)?.frame.seq ?? 0) < seq) await new Promise((resolve) => setTimeout(resolve, 2));
        drawn += 1;
      }
      store.settle();
      return drawn;
    }, n);
  const client = await page.context().newCDPSession(page);
  const heap = async (): Promise<number> => {
    await client.send("HeapProfiler.collectGarbage");
    const { usedSize } = await client.send("Runtime.getHeapUsage");
    return usedSize;
  };
  const resident = (): number => Number(readFileSync(`/proc/${server.process.pid}/statm`, "utf8").split(" ")[1]) * 4096;
  // Three rests to warm up, so that blocks that are allocated once are there before the count begins.
  for (let round = 0; round < 3; round += 1) {
    await turn(100);
    await atRest(page);
  }
  const heapBefore = await heap();
  const sizes = [resident()];
  for (let quarter = 0; quarter < 4; quarter += 1) {
    expect(await turn(250)).toBe(250);
    await atRest(page);
    sizes.push(resident());
  }
  const heapAfter = await heap();
  const growth = sizes.slice(1).map((size, k) => size - (sizes[k] ?? 0));
  expect((sizes.at(-1) ?? 0) - (sizes[0] ?? 0), `bytes after each quarter: ${growth.join(", ")}`).toBeLessThan(10e6);
  // A leak grows in every quarter.
  expect(Math.min(...growth) * growth.length).toBeLessThan(2e6);
  // The statistics of a thousand frames are kept: 0.6 kB each.
  expect(heapAfter - heapBefore).toBeLessThan(5e6);
  expect((await pixels(page)).width).toBeGreaterThan(100);
  await page.close();
  await server.stop();
}, 240_000);
