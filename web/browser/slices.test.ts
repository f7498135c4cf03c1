// Slices in a real browser: centre, pan, magnification, scrolling, tools, crosshair, texts that give way.

import type { Page } from "playwright-core";
import { afterAll, beforeAll, beforeEach, describe, expect, test } from "vitest";

import type { Vec3, ViewerState } from "../src/state/state.ts";
import { atRest, change, middle, nightly, openBrowser, openViewer, startServer, state, type Browser, type Server } from "./harness.ts";

/** A place of the page where no slice is. */
const ON_RAIL = [30, 500] as const;

let server: Server;
let browser: Browser;
let page: Page & { complaints: string[] };
let first: ViewerState;

beforeAll(async () => {
  server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
  browser = await openBrowser();
  page = await openViewer(browser, server.link);
  await change(page, { op: "replace", path: "/view/layout", value: { name: "single", main: "z" } },
    { op: "replace", path: "/view/interface/panels", value: [] });
  first = await state(page);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

beforeEach(async () => {
  await change(page, { op: "replace", path: "", value: first });
  await page.mouse.move(...ON_RAIL);
  await settled();
});

/** Waits until the slice is drawn at rest for the newest state. */
const settled = async (): Promise<void> => {
  await page.locator('[data-view="z"] canvas[data-at-rest="true"]').waitFor();
  await atRest(page, "z");
};

/** Where a world point lies in the axial slice, CSS pixels from its top left, by the frame on the screen. */
const placeOf = (point: Vec3): Promise<{ x: number; y: number }> =>
  page.evaluate((p) => {
    const viewer = document.getElementById("viewer") as unknown as HTMLElement & { wavesplat: { frames: Record<string, Shown> } };
    const frame = viewer.wavesplat.frames["z"] as Shown;
    const { origin, right, down, pixel } = frame.slice;
    const box = viewer.shadowRoot?.querySelector('[data-view="z"]')?.getBoundingClientRect() as DOMRect;
    const along = (way: Vec3): number => [0, 1, 2].reduce((sum, a) => sum + ((p[a] ?? 0) - (origin[a] ?? 0)) * (way[a] ?? 0), 0) / pixel;
    return { x: ((along(right) + 0.5) / frame.width) * box.width, y: ((along(down) + 0.5) / frame.height) * box.height };
  }, point);

interface Shown {
  readonly width: number;
  readonly height: number;
  readonly slice: { readonly origin: Vec3; readonly right: Vec3; readonly down: Vec3; readonly pixel: number };
}

async function magnified(zoom = 4): Promise<void> {
  await change(page, { op: "replace", path: "/view/slices/zoom", value: zoom });
  await settled();
}

describe("at zoom 4", () => {
  test("the crosshair follows a drag, also one that stops on its way, within a pixel", async () => {
    await magnified();
    const { x, y, width, height } = await middle(page, "z");
    await page.mouse.move(x + 40, y + 60);
    await page.mouse.down();
    for (let step = 1; step <= 8; step += 1) {
      await page.mouse.move(x + 40 + 5 * step, y + 60);
      await page.waitForTimeout(step % 4 === 0 ? 250 : 20);
    }
    await page.mouse.up();
    await settled();
    const at = await placeOf((await state(page)).view.slices.crosshair);
    expect(Math.hypot(at.x - (width / 2 + 80), at.y - (height / 2 + 60))).toBeLessThan(1);
  });

  nightly.each([["Shift", "left"], [null, "middle"]] as const)("a drag with %s %s moves the picture, and not the crosshair", async (key, button) => {
    await magnified();
    const before = await state(page);
    const mark: Vec3 = before.view.slices.crosshair;
    const from = await placeOf(mark);
    const { x, y } = await middle(page, "z");
    if (key !== null) await page.keyboard.down(key);
    await page.mouse.move(x + 30, y);
    await page.mouse.down({ button });
    for (let step = 1; step <= 4; step += 1) {
      await page.mouse.move(x + 30 + 10 * step, y + 5 * step);
      await page.waitForTimeout(60);
    }
    await page.mouse.up({ button });
    if (key !== null) await page.keyboard.up(key);
    await settled();
    expect((await state(page)).view.slices.crosshair).toEqual(mark);
    const to = await placeOf(mark);
    expect(Math.hypot(to.x - from.x - 40, to.y - from.y - 20)).toBeLessThan(1);
  });
});

test("the value under the pointer is of its place, over a handle of the crosshair too", async () => {
  const { x, y } = await middle(page, "z");
  await page.mouse.move(x + 60, y + 60);
  const told = page.locator(".status > span", { hasText: " at " });
  await told.waitFor();
  const before = await told.innerText();
  const handle = await page.locator('[data-view="z"] svg.over [data-handle]').first().boundingBox();
  await page.mouse.move((handle?.x ?? 0) + (handle?.width ?? 0) / 2, (handle?.y ?? 0) + (handle?.height ?? 0) / 2);
  await expect.poll(() => told.innerText()).not.toBe(before);
});

test("the wheel scrolls by a slice, and with Ctrl magnifies about the pointer", async () => {
  const { x, y, width, height } = await middle(page, "z");
  const before = (await state(page)).view.slices;
  // Events of the wheel have whole pixels.
  const [px, py] = [Math.round(x + width / 4), Math.round(y + 30)];
  const [at, down] = [px - x + width / 2, py - y + height / 2];
  await page.mouse.move(px, py);
  await page.mouse.wheel(0, 100);
  await expect.poll(async () => (await state(page)).view.slices.crosshair[2]).not.toBe(before.crosshair[2]);
  await settled();
  const under = await worldAt(at, down);
  await page.keyboard.down("Control");
  await page.mouse.wheel(0, -300);
  await page.mouse.wheel(0, -300);
  await page.keyboard.up("Control");
  await expect.poll(async () => (await state(page)).view.slices.zoom).toBeGreaterThan(2);
  await settled();
  const after = await placeOf(under);
  expect(Math.hypot(after.x - at, after.y - down)).toBeLessThan(1);
});

/** The world point at a place of the axial slice, CSS pixels from its top left. */
const worldAt = async (x: number, y: number): Promise<Vec3> => {
  const [origin, right, down] = await Promise.all([placeOf([0, 0, 0]), placeOf([1, 0, 0]), placeOf([0, 1, 0])]);
  const { crosshair } = (await state(page)).view.slices;
  // The axial slice shows x to the left and y upwards.
  return [(x - origin.x) / (right.x - origin.x), (y - origin.y) / (down.y - origin.y), crosshair[2]];
};

describe("two fingers", () => {
  const touch = async (moves: readonly (readonly [number, number, number, number])[]): Promise<void> => {
    const session = await browser.context.newCDPSession(page);
    const points = ([ax, ay, bx, by]: readonly [number, number, number, number]) => [{ x: ax, y: ay, id: 1 }, { x: bx, y: by, id: 2 }];
    const [begin, ...others] = moves;
    if (begin === undefined) return;
    await session.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: points(begin) });
    for (const move of others) await session.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: points(move) });
    await session.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    await session.detach();
  };

  nightly("up and down scroll through slices, sideways they move the picture", async () => {
    await magnified(2);
    const { x, y } = await middle(page, "z");
    const before = (await state(page)).view.slices;
    await touch(Array.from({ length: 11 }, (_, n) => [x - 50, y - 40 + 8 * n, x + 50, y - 40 + 8 * n] as const));
    const scrolled = (await state(page)).view.slices;
    expect(scrolled.crosshair[2]).not.toBe(before.crosshair[2]);
    expect(scrolled.center).toEqual(before.center);
    const mark = scrolled.crosshair;
    await settled();
    const from = await placeOf(mark);
    await touch(Array.from({ length: 11 }, (_, n) => [x - 50 + 8 * n, y, x + 50 + 8 * n, y] as const));
    await settled();
    const to = await placeOf(mark);
    expect((await state(page)).view.slices.crosshair).toEqual(mark);
    expect(to.x - from.x).toBeGreaterThan(70);
    expect(Math.abs(to.y - from.y)).toBeLessThan(3);
  });

  nightly("apart they magnify about the point between them", async () => {
    const { x, y, width, height } = await middle(page, "z");
    const under = await worldAt(width / 2 + 60, height / 2);
    await touch(Array.from({ length: 11 }, (_, n) => [x + 60 - 40 - 8 * n, y, x + 60 + 40 + 8 * n, y] as const));
    await settled();
    expect((await state(page)).view.slices.zoom).toBeGreaterThan(2.5);
    const after = await placeOf(under);
    expect(Math.hypot(after.x - width / 2 - 60, after.y - height / 2)).toBeLessThan(3);
  });
});

describe("tools", () => {
  const choose = (name: string): Promise<void> => page.getByRole("radio", { name, exact: true }).click();
  const pixelMm = async (): Promise<number> => {
    const [a, b] = [await placeOf([0, 0, 0]), await placeOf([1, 0, 0])];
    return 1 / Math.abs(b.x - a.x);
  };
  const lengths = async (): Promise<number[]> =>
    (await state(page)).view.measures.map(({ points: [a, b] }) => Math.hypot(...[0, 1, 2].map((k) => (a?.[k] ?? 0) - (b?.[k] ?? 0))));

  test("a drag of 100 px with the ruler is one measure of 100 px, and the crosshair stays", async () => {
    await choose("Measure a distance");
    const { x, y } = await middle(page, "z");
    await page.mouse.move(x - 70, y + 50);
    await page.mouse.down();
    for (let step = 1; step <= 5; step += 1) await page.mouse.move(x - 70 + 20 * step, y + 50);
    // The line and its length follow the pointer.
    await expect.poll(() => page.locator('[data-view="z"] .pending text').textContent()).toMatch(/mm$/);
    await page.mouse.up();
    const [length, ...others] = await lengths();
    expect(others).toEqual([]);
    expect(Math.abs((length ?? 0) / (await pixelMm()) - 100)).toBeLessThan(1);
    expect((await state(page)).view.slices.crosshair).toEqual(first.view.slices.crosshair);
  });

  nightly("two clicks are a measure with a line between them, also on a handle of the crosshair", async () => {
    const handle = page.getByRole("slider", { name: "Coronal plane", exact: true });
    const box = await handle.boundingBox();
    if (box === null) throw new Error("there is no handle");
    await choose("Measure a distance");
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.move(box.x + 80, box.y + 90);
    await expect.poll(() => page.locator('[data-view="z"] .pending text').textContent()).toMatch(/mm$/);
    await page.mouse.click(box.x + 80, box.y + 90);
    expect((await lengths()).length).toBe(1);
    await choose("Turn");
  });

  nightly("every tool has a cursor of its own", async () => {
    const cursors: string[] = [];
    for (const [tool, name] of [["Turn", "turn"], ["Window and level", "window"], ["Measure a distance", "distance"], ["Measure an angle", "angle"]] as const) {
      await choose(tool);
      await page.locator(`[data-view="z"][data-tool="${name}"]`).waitFor();
      cursors.push(await page.locator('[data-view="z"]').evaluate((view) => getComputedStyle(view).cursor));
    }
    expect(new Set(cursors).size).toBe(4);
    await choose("Turn");
  });

  nightly("a line around a region gives its area and the mean in it", async () => {
    await choose("Measure a region");
    const { x, y } = await middle(page, "z");
    const corner = (angle: number): [number, number] => [x + 50 * Math.cos(angle), y + 90 + 50 * Math.sin(angle)];
    await page.mouse.move(...corner(0));
    await page.mouse.down();
    for (let step = 1; step < 48; step += 1) await page.mouse.move(...corner((step / 48) * 2 * Math.PI));
    await page.mouse.up();
    await choose("Turn");
    const mm2 = Math.PI * (50 * (await pixelMm())) ** 2;
    const shown = page.locator('[data-view="z"] svg text');
    await expect.poll(() => shown.allTextContents()).toContainEqual(expect.stringMatching(/^mean .* HU$/));
    const [area] = (await shown.allTextContents()).filter((text) => text.endsWith("mm²"));
    expect(Math.abs(Number(area?.split(" ")[0]) / mm2 - 1)).toBeLessThan(0.02);
  });
});

nightly("a double click lets a slice fill the page, and goes back", async () => {
  await change(page, { op: "replace", path: "/view/layout", value: { name: "two-by-two", main: "3d" } });
  await page.locator('[data-view="y"] canvas[data-at-rest="true"]').waitFor();
  const { x, y } = await middle(page, "y");
  await page.mouse.dblclick(x + 20, y + 20);
  await expect.poll(async () => (await state(page)).view.layout).toEqual({ name: "single", main: "y" });
  await page.locator('[data-view="y"] canvas[data-at-rest="true"]').waitFor();
  const now = await middle(page, "y");
  await page.mouse.dblclick(now.x + 20, now.y + 20);
  await expect.poll(async () => (await state(page)).view.layout.name).toBe("two-by-two");
});

test("a slice is drawn however fast the layout changes", async () => {
  const show = (name: string, main: string): Promise<void> => change(page, { op: "replace", path: "/view/layout", value: { name, main } });
  for (let k = 0; k < 12; k += 1) {
    await show("two-by-two", "3d");
    await page.waitForTimeout(12 * k);
    await show("single", "y");
    await show("two-by-two", "3d");
    await page.waitForTimeout(5 * k);
    await show("single", "z");
    await page.locator('[data-view="z"] canvas[data-at-rest="true"]').waitFor();
  }
});

nightly("the text of the window is a menu", async () => {
  await page.locator('[data-view="z"]').getByRole("combobox", { name: "Window" }).selectOption("bone");
  expect((await state(page)).view.slices.window).toEqual([400, 1800]);
  await page.locator('[data-view="z"]').getByRole("combobox", { name: "Window" }).selectOption("automatic");
  expect((await state(page)).view.slices.window).toBeUndefined();
});

nightly("handles of the crosshair show where the pointer or the focus is, and its middle is free", async () => {
  const opacity = (): Promise<string> => page.getByRole("slider", { name: "Coronal plane", exact: true }).evaluate((one) => getComputedStyle(one).opacity);
  await page.mouse.move(...ON_RAIL);
  expect(await opacity()).toBe("0");
  const { x, y } = await middle(page, "z");
  await page.mouse.move(x + 90, y + 90);
  expect(await opacity()).toBe("1");
  const at = await placeOf((await state(page)).view.slices.crosshair);
  const reaches = await page.locator('[data-view="z"] .quiet > path').evaluateAll((paths, { x: cx, y: cy }) =>
    paths.map((path) => {
      const line = path as SVGPathElement;
      const all = Array.from({ length: 4000 }, (_, n) => line.getPointAtLength((line.getTotalLength() * n) / 4000));
      return Math.min(...all.map((point) => Math.hypot(point.x - cx, point.y - cy)));
    }), at);
  expect(reaches.length).toBe(2);
  reaches.forEach((reach) => expect(Math.abs(reach - 12)).toBeLessThan(1.5));
});

nightly.each([[640, 400], [390, 844], [1280, 800]])("no two texts of slices lie over each other in a page of %i x %i", async (width, height) => {
  await page.setViewportSize({ width, height });
  try {
    for (const name of ["one-and-three", "two-by-two"]) {
      await change(page, { op: "replace", path: "/view/layout", value: { name, main: "3d" } });
      await page.locator('[data-view="x"] canvas[data-at-rest="true"]').waitFor();
      await page.waitForTimeout(200);
      const over = await page.evaluate(() => {
        const found: string[] = [];
        for (const pane of document.getElementById("viewer")?.shadowRoot?.querySelectorAll('[data-view="x"], [data-view="y"], [data-view="z"]') ?? []) {
          const texts = [...pane.querySelectorAll(".pill")].map((one) => [one.textContent ?? "", one.getBoundingClientRect()] as const);
          const box = pane.getBoundingClientRect();
          for (const [text, { left, right, top, bottom }] of texts) {
            if (left < box.left || right > box.right + 1 || top < box.top || bottom > box.bottom + 1) found.push(`${text} is cut`);
          }
          texts.forEach(([one, a], n) => texts.slice(n + 1).forEach(([other, b]) => {
            if (a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom) found.push(`${one} over ${other}`);
          }));
          if (texts.length === 0) found.push("no text is left");
        }
        return found;
      });
      expect(over).toEqual([]);
    }
  } finally {
    await page.setViewportSize({ width: 1100, height: 720 });
  }
});

test("nothing was complained of", () => expect(page.complaints).toEqual([]));
