// Input in space and the state of the page: turning, framing, wheel, keys, help, cube, how often the page draws itself.

import { afterAll, beforeAll, beforeEach, describe, expect, test } from "vitest";

import * as cameras from "../src/input/camera.ts";
import { median } from "../src/view/frame_statistics.ts";
import type { Camera, Vec3, ViewerState } from "../src/state/state.ts";
import {
  atRest, change, drag, middle, nightly, openBrowser, openPanel, openViewer, startServer, state, type Browser, type Server,
} from "./harness.ts";
import type { Page } from "playwright-core";

let server: Server;
let browser: Browser;
let page: Page & { complaints: string[] };
let first: ViewerState;

beforeAll(async () => {
  server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
  browser = await openBrowser();
  page = await openViewer(browser, server.link);
  first = await state(page);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

beforeEach(async () => {
  await page.bringToFront();
  await page.evaluate(() => (document.getElementById("viewer")?.shadowRoot?.activeElement as HTMLElement | null)?.blur());
  await change(page, { op: "replace", path: "", value: first });
  await atRest(page);
});

const camera = async (): Promise<Camera> => (await state(page)).camera;
const numbers = (one: Camera): number[] => [...one.position, ...one.focal_point, ...one.view_up, one.parallel_scale ?? 0, one.view_angle ?? 0];
function same(one: Camera, other: Camera): void {
  numbers(one).forEach((value, n) => expect(value).toBeCloseTo(numbers(other)[n] ?? NaN, 6));
}
/** Waits until a move that a key began has ended: the session may take a while to say where it goes. */
async function moved(from: Camera): Promise<void> {
  await expect.poll(async () => JSON.stringify(await camera())).not.toBe(JSON.stringify(from));
  await settled();
}
/** Waits until the camera moves no more. */
async function settled(): Promise<Camera> {
  let last = "";
  await expect
    .poll(async () => {
      const now = JSON.stringify(await camera());
      const isSame = now === last;
      last = now;
      return isSame;
    }, { interval: 250 })
    .toBe(true);
  return camera();
}

test("keys work on a page that was not clicked, and help opens at its top", async () => {
  expect(await page.evaluate(() => document.activeElement === document.body)).toBe(true);
  await page.keyboard.press("ArrowLeft");
  await expect.poll(async () => (await camera()).position).not.toEqual(first.camera.position);
  await page.keyboard.press("?");
  const title = page.getByRole("heading", { name: "Keys and gestures" });
  await title.waitFor();
  const [seen, box] = await Promise.all([title.boundingBox(), page.getByRole("dialog").boundingBox()]);
  expect(seen !== null && box !== null && seen.y >= box.y && seen.y < box.y + 60).toBe(true);
  expect(await page.getByRole("dialog").evaluate((dialog) => dialog.scrollTop)).toBe(0);
  expect(await page.evaluate(() => document.getElementById("viewer")?.shadowRoot?.activeElement?.textContent)).toBe("Close");
  await page.keyboard.press("Escape");
  await expect.poll(() => page.getByRole("dialog").count()).toBe(0);
  // A key for the page is none in a field.
  await openPanel(page, "looks");
  await atRest(page); // in the view beside the panel
  const before = await settled();
  await page.getByRole("searchbox").first().pressSequentially("1f");
  expect(await camera()).toEqual(before);
});

describe("what is upright stays upright", () => {
  nightly("three circles of 60 px", async () => {
    await page.keyboard.press("1");
    await settled();
    const { x, y } = await middle(page);
    await page.mouse.move(x + 60, y);
    await page.mouse.down();
    const begun = (await camera()).position;
    let turned = 0;
    for (let step = 1; step <= 72; step += 1) {
      await page.mouse.move(x + 60 * Math.cos((step * Math.PI) / 12), y + 60 * Math.sin((step * Math.PI) / 12));
      if (step === 36) turned = Math.hypot(...(await camera()).position.map((value, axis) => value - (begun[axis] ?? 0)));
    }
    await page.mouse.up();
    expect(turned, "half a circle turns the picture").toBeGreaterThan(20);
    const { up } = cameras.axesOf(await camera());
    expect((Math.acos(Math.min(1, up[2])) * 180) / Math.PI).toBeLessThan(1);
  });

  nightly("a square of arrow keys ends where it began, and the trackball does not", async () => {
    const square = async (): Promise<Camera> => {
      for (const key of ["ArrowLeft", "ArrowUp", "ArrowRight", "ArrowDown"]) for (let n = 0; n < 3; n += 1) await page.keyboard.press(key);
      return camera();
    };
    same(await square(), first.camera);
    await change(page, { op: "replace", path: "/view/interface/turning", value: "trackball" });
    const rolled = await square();
    expect(cameras.axesOf(rolled).right[2]).not.toBeCloseTo(0, 2);
    await page.keyboard.press("l");
    expect(cameras.axesOf(await settled()).right[2]).toBeCloseTo(0, 6);
  });
});

describe("one frame", () => {
  test("the first picture, key 1 and key 0 are the same", async () => {
    for (const key of ["1", "0"]) {
      await drag(page, 70, 30);
      await page.mouse.wheel(0, -300);
      await page.keyboard.press(key);
      same(await settled(), first.camera);
    }
    await page.keyboard.press("3");
    const left = await settled();
    expect(cameras.axesOf(left).back[0]).toBeCloseTo(-1, 6);
    await page.keyboard.press("f");
    same(await settled(), left);
  });

  nightly("keys ease for 200 ms, and come at once for those who want less motion", async () => {
    const path = async (key: string): Promise<number> => {
      const before = await page.evaluate(() => (document.getElementById("viewer") as unknown as { wavesplat: { store: { seq: number } } }).wavesplat.store.seq);
      const from = await camera();
      await page.keyboard.press(key);
      await moved(from);
      return (await page.evaluate(() => (document.getElementById("viewer") as unknown as { wavesplat: { store: { seq: number } } }).wavesplat.store.seq)) - before;
    };
    expect(await path("3")).toBeGreaterThan(3);
    await page.emulateMedia({ reducedMotion: "reduce" });
    expect(await path("1")).toBe(1);
    await page.emulateMedia({ reducedMotion: "no-preference" });
    // The whole way is one step of undo.
    await page.keyboard.press("3");
    await moved(first.camera);
    await page.keyboard.press("Control+z");
    same(await camera(), first.camera);
  });

  nightly("layouts keep in view what was in view", async () => {
    const seenWidth = async (): Promise<number> => {
      const { width, height } = await middle(page);
      return (2 * ((await camera()).parallel_scale ?? 0) * width) / height;
    };
    // A first picture is framed again; one that was magnified shows its whole width.
    await change(page, { op: "replace", path: "/camera/parallel_scale", value: 60 });
    await atRest(page);
    const [before, whole] = [await camera(), await seenWidth()];
    await change(page, { op: "replace", path: "/view/layout", value: { name: "one-and-three", main: "3d" } });
    await expect.poll(async () => (await seenWidth()) / whole).toBeCloseTo(1, 2);
    await change(page, { op: "replace", path: "/view/layout", value: { name: "3d", main: "3d" } });
    await expect.poll(async () => (await camera()).parallel_scale).toBeCloseTo(60, 6);
    same(await camera(), before);
    // In a narrow window the width of the body decides.
    await page.setViewportSize({ width: 900, height: 800 });
    await atRest(page);
    const wide = await settled();
    await page.keyboard.press("1");
    await moved(wide);
    const framed = await camera();
    await change(page, { op: "replace", path: "/view/layout", value: { name: "one-and-three", main: "3d" } });
    await expect.poll(async () => (await camera()).parallel_scale).not.toBe(framed.parallel_scale);
    await atRest(page);
    const narrow = await settled();
    await page.keyboard.press("0");
    same(await settled(), narrow);
  });
});

nightly("the wheel and a pinch magnify about the pointer", async () => {
  const { x, y, width, height } = await middle(page);
  const size = { width, height };
  const at = { x: 0.75 * width, y: 0.3 * height };
  const { origin, direction } = cameras.ray(first.camera, size, at.x, at.y);
  const point = cameras.add(origin, cameras.scaled(direction, 200)) as Vec3;
  const stays = async (): Promise<void> => {
    const now = await settled();
    expect(now.parallel_scale ?? 0).toBeLessThan(0.9 * (first.camera.parallel_scale ?? 0));
    const place = cameras.project(now, size, point);
    expect(Math.hypot((place?.x ?? 0) - at.x, (place?.y ?? 0) - at.y)).toBeLessThan(1);
  };
  const [px, py] = [x - width / 2 + at.x, y - height / 2 + at.y];
  await page.mouse.move(px, py);
  for (let n = 0; n < 3; n += 1) await page.mouse.wheel(0, -100);
  await stays();
  await change(page, { op: "replace", path: "/camera", value: first.camera });
  const client = await page.context().newCDPSession(page);
  const touch = (type: "touchStart" | "touchMove" | "touchEnd", ...points: [number, number][]): Promise<unknown> =>
    client.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([tx, ty], id) => ({ x: tx, y: ty, id })) });
  await touch("touchStart", [px - 30, py], [px + 30, py]);
  for (let n = 1; n <= 6; n += 1) await touch("touchMove", [px - 30 - 6 * n, py], [px + 30 + 6 * n, py]);
  await touch("touchEnd");
  await client.detach();
  await stays();
});

describe("the cube", () => {
  nightly("looks from faces, edges and corners, which have names", async () => {
    const cube = page.getByRole("group", { name: "Orientation cube" });
    const places = cube.getByRole("button", { includeHidden: true });
    // Seen from the front: a face, four edges, four corners.
    expect(await places.count()).toBe(9);
    expect(await places.first().evaluate((place) => (place as SVGElement).tagName)).toBe("g");
    await cube.getByRole("button", { name: "LAS, from the left, front, top" }).click();
    const corner = await settled();
    expect(cameras.axesOf(corner).back.map((one) => one * Math.sqrt(3))).toEqual([-1, 1, 1].map((one) => expect.closeTo(one, 6)));
    expect(cameras.axesOf(corner).right[2]).toBeCloseTo(0, 6);
    await cube.getByRole("button", { name: "S, from the top" }).click();
    expect(cameras.axesOf(await settled()).back[2]).toBeCloseTo(1, 6);
    await page.keyboard.press("0");
    same(await settled(), first.camera);
  });

  test("a drag on it turns the picture", async () => {
    const box = await page.getByRole("button", { name: "A, from the front" }).last().boundingBox();
    if (box === null) throw new Error("there is no face");
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x - 50, y, { steps: 5 });
    await page.mouse.up();
    expect((await camera()).position[0]).not.toBeCloseTo(first.camera.position[0], 1);
  });
});

nightly("a drag with the ruler is one measure between what is seen at its ends", async () => {
  await page.getByRole("radio", { name: "Measure a distance" }).click();
  const { x, y, width, height } = await middle(page);
  await page.mouse.move(x, y + 40);
  await page.mouse.down();
  for (let step = 1; step <= 10; step += 1) await page.mouse.move(x + 10 * step, y + 40);
  const line = `M${width / 2} ${height / 2 + 40}L${width / 2 + 100} ${height / 2 + 40}`;
  await expect.poll(() => page.locator("[data-view='3d'] svg.over path").last().getAttribute("d")).toBe(line);
  await page.mouse.up();
  await expect.poll(async () => (await state(page)).view.measures.length).toBe(1);
  const now = await state(page);
  expect(now.camera).toEqual(first.camera);
  const places = (now.view.measures[0]?.points ?? []).map((point) => cameras.project(now.camera, { width, height }, point));
  expect(Math.abs(Math.hypot((places[1]?.x ?? 0) - (places[0]?.x ?? 0), (places[1]?.y ?? 0) - (places[0]?.y ?? 0)) - 100)).toBeLessThan(2);
  await page.keyboard.press("Escape");
});

nightly("a corner is cut out on the side from which one looks", async () => {
  const middles: number[] = [];
  for (const key of ["1", "2"]) {
    await page.keyboard.press(key);
    await settled();
    await openPanel(page, "cut");
    await page.getByRole("button", { name: "Cut a corner out" }).click();
    const clip = (await state(page)).clip[0] as unknown as { cut_out: { lower: Vec3; upper: Vec3 } };
    middles.push((clip.cut_out.lower[1] + clip.cut_out.upper[1]) / 2);
    await page.keyboard.press("Control+z");
  }
  expect((middles[0] ?? 0) - (middles[1] ?? 0)).toBeGreaterThan(20);
});

nightly.each(["function", "slices"])("a drag draws the panel %s not anew, and takes the page less than 2 ms a frame", async (panel) => {
  await openPanel(page, panel);
  await atRest(page);
  await page.evaluate(() => {
    const viewer = document.getElementById("viewer") as unknown as { shadowRoot: ShadowRoot; wavesplat: { statistics: { draws: number[] } } };
    viewer.wavesplat.statistics.draws.length = 0;
    const changes: string[] = [];
    (window as unknown as { changes: string[] }).changes = changes;
    const observer = new MutationObserver((all) => changes.push(...all.map(({ target }) => (target as HTMLElement).outerHTML ?? "text")));
    observer.observe(viewer.shadowRoot.querySelector(".sheet") as Element, { subtree: true, childList: true, attributes: true, characterData: true });
  });
  const { x, y } = await middle(page);
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let step = 1; step <= 40; step += 1) {
    await page.mouse.move(x + 2 * step, y + step / 2);
    await page.waitForTimeout(16);
  }
  const [draws, changes] = await page.evaluate(() => [
    (document.getElementById("viewer") as unknown as { wavesplat: { statistics: { draws: number[] } } }).wavesplat.statistics.draws,
    (window as unknown as { changes: string[] }).changes,
  ] as const);
  await page.mouse.up();
  expect(draws.length).toBeGreaterThan(15);
  expect(changes).toEqual([]);
  expect(median(draws)).toBeLessThan(2);
});

nightly("undo to the end keeps the focus", async () => {
  await drag(page, 40, 0);
  const undo = page.getByRole("button", { name: "Undo" });
  await undo.click();
  const isMore = (): Promise<boolean> =>
    page.evaluate(() => (document.getElementById("viewer") as unknown as { wavesplat: { store: { canUndo: boolean } } }).wavesplat.store.canUndo);
  while (await isMore()) await page.keyboard.press("Enter");
  await expect.poll(() => undo.getAttribute("aria-disabled")).toBe("true");
  expect(await page.evaluate(() => document.getElementById("viewer")?.shadowRoot?.activeElement?.getAttribute("aria-label"))).toBe("Undo");
  expect(page.complaints).toEqual([]);
});
