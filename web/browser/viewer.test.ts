// The viewer's features, in a real browser on the bundled scan.

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, beforeEach, describe, expect, test } from "vitest";

import type { TransferFunction, ViewerState } from "../src/state/state.ts";
import {
  NIGHT, atRest, change, command, drag, folder, middle, nightly, openBrowser, openPanel, openViewer, pixels, pngPixels, python, records, startServer, state, type Browser, type Server,
} from "./harness.ts";

let server: Server;
let browser: Browser;
let page: Page & { complaints: string[] };
let first: ViewerState;

beforeAll(async () => {
  server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
  browser = await openBrowser();
  await browser.context.grantPermissions(["clipboard-read", "clipboard-write"], { origin: `http://127.0.0.1:${server.port}` });
  page = await openViewer(browser, server.link);
  first = await state(page);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

beforeEach(async () => {
  // Browsers draw pages that are behind others only once a second.
  await page.bringToFront();
  await change(page, { op: "replace", path: "", value: first });
  await atRest(page);
});

const differs = (a: Buffer, b: Buffer): boolean => a.length !== b.length || !a.equals(b);

describe("the picture at rest", () => {
  test("is, to the byte, what the copied Python, the copied command and the saved state draw", async () => {
    await change(page, { op: "replace", path: "/camera", value: { ...first.camera, view_up: [0.1, 0, 1] } },
      { op: "replace", path: "/layers/0/look/shading/ambient_occlusion", value: 0.5 }, { op: "replace", path: "/view/interface/panels", value: [] });
    await atRest(page);
    // Shared is what was seen before the sheet, which makes the view narrower.
    const seen = await pixels(page);
    await openPanel(page, "share");
    await atRest(page);
    await page.getByLabel("With measures, bars and legend").uncheck();
    const where = folder();
    await page.getByRole("button", { name: "Copy as Python" }).click();
    await page.getByLabel("What was copied").filter({ visible: true }).waitFor();
    await expect.poll(() => page.evaluate(() => navigator.clipboard.readText())).toContain("import wavesplat");
    python(await page.evaluate(() => navigator.clipboard.readText()), where);
    expect(differs(pngPixels(join(where, "CT.png")), seen.data)).toBe(false);
    await page.getByRole("button", { name: "Copy as command" }).click();
    await expect.poll(() => page.evaluate(() => navigator.clipboard.readText())).toContain("wavesplat render");
    writeFileSync(join(where, "CT.png"), "");
    command(await page.evaluate(() => navigator.clipboard.readText()), where);
    expect(differs(pngPixels(join(where, "CT.png")), seen.data)).toBe(false);
    const [saved] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save state" }).click()]);
    await saved.saveAs(join(where, "view.json"));
    command("wavesplat render --from view.json -o again.png", where);
    expect(differs(pngPixels(join(where, "again.png")), seen.data)).toBe(false);
  });

  nightly("has as many pixels as the view, and no complaint was made", async () => {
    const { width, height } = await middle(page);
    const seen = await pixels(page);
    expect([seen.width, seen.height]).toEqual([Math.round(width), Math.round(height)]);
    expect(page.complaints).toEqual([]);
  });
});

describe("the mouse", () => {
  test("turns the patient with the pointer", async () => {
    const before = await state(page);
    await drag(page, 120, 0);
    await atRest(page);
    const { camera } = await state(page);
    const turned = python(
      `import json, sys, wavesplat as ws
camera = ws.Camera.from_json(json.loads(sys.argv[1]))
height = float(sys.argv[2])
print(json.dumps(camera.turned(azimuth=-120 / height * 180).position))`,
      // The page knows its height in whole pixels: what it observes is the box of device pixels.
      folder(), JSON.stringify(before.camera), String(Math.round((await middle(page)).height)),
    );
    const expected = JSON.parse(turned) as number[];
    camera.position.forEach((value, n) => expect(value).toBeCloseTo(expected[n] ?? NaN, 3));
  });

  nightly("moves, magnifies and rolls", async () => {
    const { camera } = first;
    await page.keyboard.down("Shift");
    await drag(page, 50, 0);
    await page.keyboard.up("Shift");
    const panned = (await state(page)).camera;
    expect(panned.focal_point).not.toEqual(camera.focal_point);
    await drag(page, 0, -60, { button: "right" });
    const zoomed = (await state(page)).camera;
    expect(zoomed.parallel_scale ?? 0).toBeLessThan(panned.parallel_scale ?? 0);
    const { x, y } = await middle(page);
    await page.mouse.move(x, y);
    await page.mouse.wheel(0, -200);
    await expect.poll(async () => (await state(page)).camera.parallel_scale ?? 0).toBeLessThan(zoomed.parallel_scale ?? 0);
    await page.keyboard.down("Control");
    await drag(page, 60, 0);
    await page.keyboard.up("Control");
    expect((await state(page)).camera.view_up).not.toEqual(zoomed.view_up);
    await page.keyboard.down("Alt");
    await drag(page, 40, 20);
    await page.keyboard.up("Alt");
    expect((await state(page)).layers[0]?.look.transfer_function).not.toEqual(first.layers[0]?.look.transfer_function);
  });

  test("what moves is JPEG with its camera, and comes to rest", async () => {
    await drag(page, 90, 30);
    await atRest(page);
    const moving = (await records(page)).filter((record) => !record.frame.at_rest);
    expect(moving.length).toBeGreaterThan(0);
    expect(new Set(moving.map((record) => record.frame.format))).toEqual(new Set(["jpeg"]));
    const last = (await records(page)).at(-1);
    expect(last?.frame.format).toBe("png");
    expect(last?.frame.camera).toEqual((await state(page)).camera);
  });
});

nightly("a marker follows the pointer", async () => {
  const where = folder();
  python(
    `import numpy as np, wavesplat as ws
samples = np.zeros((40, 40, 40), np.uint8)
samples[:3, :3, :3] = samples[-3:, -3:, -3:] = 30  # so that all is in view
samples[18:22, 34:38, 18:22] = 255  # in front, at +y
header = "NRRD0004\\ntype: uint8\\ndimension: 3\\nspace: right-anterior-superior\\nsizes: 40 40 40\\nspace directions: (1,0,0) (0,1,0) (0,0,1)\\nspace origin: (0,0,0)\\nkinds: domain domain domain\\nencoding: raw\\n\\n"
open("marker.nrrd", "wb").write(header.encode() + samples.tobytes())`,
    where,
  );
  const other = await startServer(join(where, "marker.nrrd"), "--view", "front", "--composite", "maximum");
  try {
    const marked = await openViewer(browser, other.link);
    const center = async (): Promise<[number, number]> => {
      const { width, data } = await pixels(marked);
      let [sum, x, y] = [0, 0, 0];
      for (let n = 0; n < data.length; n += 4) {
        const value = data[n] ?? 0;
        if (value < 60) continue;
        sum += value;
        x += value * ((n / 4) % width);
        y += value * Math.floor(n / 4 / width);
      }
      return [x / sum, y / sum];
    };
    const before = await center();
    await drag(marked, 80, 0);
    await atRest(marked);
    const right = await center();
    expect(right[0]).toBeGreaterThan(before[0] + 20);
    await drag(marked, 0, 60);
    await atRest(marked);
    expect((await center())[1]).toBeGreaterThan(right[1] + 15);
    await marked.close();
  } finally {
    await other.stop();
  }
});

const nPoints = (s: ViewerState): number | undefined => (s.layers[0]?.look.transfer_function as TransferFunction | undefined)?.opacity.length;

type Read = (found: ViewerState) => unknown;

/** Controls: panel, name, action, the part of the state that it changes, and whether the picture changes too. */
const CONTROLS: readonly (readonly [string, string, (page: Page) => Promise<unknown>, Read, boolean])[] = [
  ["a preset", "presets", (p) => p.getByRole("option", { name: /^Muscle/ }).click(), (s) => s.layers[0]?.look.name, true],
  ["a point by keys", "function", async (p) => {
    await p.getByText("Edit curve").click();
    await p.getByRole("slider", { name: "Point 3 of 5" }).focus();
    await p.keyboard.press("PageUp");
  }, (s) => s.layers[0]?.look.transfer_function, true],
  ["a point added", "function", async (p) => {
    await p.getByText("Edit curve").click();
    await p.getByRole("button", { name: "Add opacity point" }).click();
  }, (s) => nPoints(s), false],
  ["a point deleted", "function", async (p) => {
    await p.getByText("Edit curve").click();
    await p.getByRole("slider", { name: "Point 4 of 5" }).focus();
    await p.keyboard.press("Delete");
  }, (s) => nPoints(s), true],
  ["a knob", "function", async (p) => {
    await p.getByRole("slider", { name: "Reveal", exact: true }).focus();
    for (let n = 0; n < 8; n += 1) await p.keyboard.press("ArrowRight");
    await p.keyboard.press("Tab");
  }, (s) => s.layers[0]?.look.transfer_function, true],
  ["a layer's opacity", "layers", (p) => p.locator('[data-panel="layers"]').getByRole("slider", { name: "Opacity" }).fill("0.4"), (s) => s.layers[0]?.opacity, true],
  ["a layer hidden", "layers", (p) => p.getByRole("checkbox", { name: /^Show CT/ }).uncheck(), (s) => s.layers[0]?.visible, true],
  ["the operator", "light", (p) => p.getByRole("combobox", { name: "Projection" }).selectOption("maximum"), (s) => s.render.composite, true],
  ["an isosurface", "light", (p) => p.getByRole("combobox", { name: "Projection" }).selectOption("first-hit"), (s) => s.render.composite, true],
  ["shading off", "light", (p) => p.getByRole("checkbox", { name: "Shading" }).uncheck(), (s) => [s.shading, s.layers[0]?.look.shading], true],
  ["a mood", "light", (p) => p.getByRole("button", { name: "Dramatic" }).click(), (s) => s.layers[0]?.look.shading?.shadow, true],
  ["ambient light", "light", async (p) => {
    await p.getByText("All settings of light").click();
    await p.getByRole("slider", { name: "Ambient" }).fill("0.6");
  }, (s) => s.layers[0]?.look.shading?.ambient, true],
  ["occlusion", "light", async (p) => {
    await p.getByText("All settings of light").click();
    await p.getByRole("slider", { name: "Occlusion" }).fill("0.9");
  }, (s) => s.layers[0]?.look.shading?.ambient_occlusion, true],
  ["a shadow", "light", async (p) => {
    await p.getByText("All settings of light").click();
    await p.getByRole("slider", { name: "Shadow" }).fill("0.8");
  }, (s) => s.layers[0]?.look.shading?.shadow, true],
  ["the kernel", "light", (p) => p.getByRole("combobox", { name: "Kernel" }).selectOption("bspline3"), (s) => s.render.kernel, true],
  ["cropping", "cut", async (p) => {
    await p.getByRole("button", { name: "Crop", exact: true }).click();
    await p.locator('[data-panel="cut"]').getByRole("slider", { name: "x from" }).fill("0");
  }, (s) => s.clip, true],
  ["a corner cut out", "cut", (p) => p.getByRole("button", { name: "Cut a corner out" }).click(), (s) => s.clip, true],
  ["a clip plane", "cut", (p) => p.getByRole("button", { name: "Add a plane that faces you" }).click(), (s) => s.clip, true],
  ["the quality at rest", "settings", (p) => p.getByRole("combobox", { name: "Quality at rest" }).selectOption("high"), (s) => s.render.quality, true],
  ["the quality while moving", "settings", (p) => p.getByRole("combobox", { name: "Quality while moving" }).selectOption("exact"), (s) => s.view.quality.moving, false],
  ["perspective", "settings", (p) => p.getByRole("checkbox", { name: "Perspective" }).check(), (s) => s.camera.view_angle, true],
  ["the theme", "settings", (p) => p.getByRole("combobox", { name: "Theme" }).selectOption("light"), (s) => s.view.interface.theme, false],
  ["an overlay", "settings", (p) => p.getByRole("checkbox", { name: "Orientation cube" }).uncheck(), (s) => s.view.overlays.cube, false],
  ["a slab", "slices", (p) => p.getByRole("slider", { name: "Thickness" }).fill("30"), (s) => s.view.slices.thickness, false],
  ["a named window", "slices", (p) => p.getByRole("combobox", { name: "Window" }).selectOption("bone"), (s) => s.view.slices.window, false],
  ["a standard view", "presets", (p) => p.getByRole("button", { name: "From the left" }).first().click(), (s) => s.camera, true],
  ["fit", "presets", async (p) => {
    await p.keyboard.press("Escape");
    await p.getByRole("button", { name: "Fit all into view" }).click();
  }, (s) => s.camera.parallel_scale, true],
];

/** By day one control of each panel is tried. */
const onePerPanel = (all: typeof CONTROLS): typeof CONTROLS => all.filter(([, panel], n) => all.findIndex((other) => other[1] === panel) === n);

describe("each control does what it says", () => {
  test.each(NIGHT ? CONTROLS : onePerPanel(CONTROLS))("%s", async (name, panel, act, read, changesPicture) => {
    if (name === "fit") await change(page, { op: "replace", path: "/camera/parallel_scale", value: 40 });
    await openPanel(page, panel);
    await atRest(page);
    const [before, seen] = [await state(page), await pixels(page)];
    await act(page);
    await expect.poll(async () => JSON.stringify(read(await state(page)))).not.toBe(JSON.stringify(read(before)));
    // On a busy machine the new picture may come long after the change; a page that waits for none is at rest.
    if (changesPicture) await expect.poll(async () => differs((await pixels(page)).data, seen.data)).toBe(true);
    await atRest(page);
    expect(differs((await pixels(page)).data, seen.data)).toBe(changesPicture);
    expect(page.complaints).toEqual([]);
  });

  test("undo and redo", async () => {
    await drag(page, 70, 0);
    await change(page, { op: "replace", path: "/render/kernel", value: "bspline2" });
    const done = await state(page);
    await page.getByRole("button", { name: "Undo" }).click();
    expect((await state(page)).render.kernel).toBe("linear");
    expect((await state(page)).camera).toEqual(done.camera);
    await page.getByRole("button", { name: "Undo" }).click();
    // The whole drag was one step.
    expect((await state(page)).camera).toEqual(first.camera);
    await page.locator('[data-view="3d"]').focus();
    await page.keyboard.press("Control+Shift+Z");
    await page.keyboard.press("Control+y");
    expect(await state(page)).toEqual({ ...done, view: (await state(page)).view });
  });

  test("slices, crosshair, window and measures", async () => {
    await change(page, { op: "replace", path: "/view/layout", value: { name: "one-and-three", main: "3d" } });
    await page.locator('[data-view="z"] canvas[data-at-rest="true"]').waitFor();
    await atRest(page, "z");
    const { x, y, width } = await middle(page, "z");
    const before = await state(page);
    await page.mouse.click(x + width / 5, y - 40);
    const after = await state(page);
    // The patient's right is on the left of the picture.
    expect(after.view.slices.crosshair[0]).toBeLessThan(before.view.slices.crosshair[0]);
    expect(after.view.slices.crosshair[1]).toBeGreaterThan(before.view.slices.crosshair[1]);
    expect(after.view.slices.crosshair[2]).toBeCloseTo(before.view.slices.crosshair[2], 6);
    await page.mouse.wheel(0, 100);
    await expect.poll(async () => (await state(page)).view.slices.crosshair[2]).not.toBe(after.view.slices.crosshair[2]);
    await page.keyboard.down("Alt");
    await drag(page, 40, 0, { view: "z" });
    await page.keyboard.up("Alt");
    await expect.poll(async () => (await state(page)).view.slices.window).toBeDefined();
    await page.getByRole("slider", { name: "Tilt the coronal plane" }).first().focus();
    await page.keyboard.press("PageUp");
    await expect.poll(async () => (await state(page)).view.slices.normals?.y).toBeDefined();
    await page.getByRole("radio", { name: "Measure a distance" }).click();
    await page.mouse.click(x - 40, y + 30);
    await page.mouse.click(x + 40, y + 30);
    await expect.poll(async () => (await state(page)).view.measures.length).toBe(1);
    await page.getByRole("radio", { name: "Turn", exact: true }).click();
    await page.mouse.move(x, y);
    await expect.poll(() => page.locator(".status").innerText()).toMatch(/HU at [RL] \d/);
  });

  nightly("a click with Ctrl puts the crosshair on what is seen", async () => {
    const { x, y } = await middle(page);
    await page.keyboard.down("Control");
    await page.mouse.click(x, y - 40);
    await page.keyboard.up("Control");
    await expect.poll(async () => (await state(page)).view.slices.crosshair).not.toEqual(first.view.slices.crosshair);
    // Seen from the front, the point lies as far up as the click.
    const pixel = (2 * (first.camera.parallel_scale ?? 0)) / (await middle(page)).height;
    const [px, , pz] = (await state(page)).view.slices.crosshair;
    expect(Math.abs(pz - first.camera.focal_point[2] - 40 * pixel)).toBeLessThan(2 * pixel);
    expect(Math.abs(px - first.camera.focal_point[0])).toBeLessThan(2 * pixel);
  });

  nightly("a face of the crop box is dragged", async () => {
    await openPanel(page, "cut");
    // From a little farther away, so that the upper face of the box lies below the tools.
    await change(page, { op: "replace", path: "/camera/parallel_scale", value: 1.3 * (first.camera.parallel_scale ?? 0) });
    await page.getByRole("button", { name: "Crop", exact: true }).click();
    await atRest(page);
    const handle = page.getByRole("slider", { name: "Crop, z to", exact: true }).first();
    const box = await handle.boundingBox();
    if (box === null) throw new Error("there is no handle");
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2 + 60, { steps: 5 });
    await page.mouse.up();
    const clip = (await state(page)).clip[0] as unknown as { keep: { upper: number[] } };
    const whole = python("import wavesplat as ws; print(ws.examples.ct_pelvis().bounds[1][2])", folder());
    expect(clip.keep.upper[2]).toBeLessThan(Number(whole) - 10);
  });

  test("pictures, pages and states are saved", async () => {
    await openPanel(page, "share");
    const where = folder();
    for (const [button, name] of [["Save picture", "CT.png"], ["Save page (HTML)", "CT.html"], ["Save state", "CT.json"]] as const) {
      const [saved] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: button }).click()]);
      expect(saved.suggestedFilename()).toBe(name);
      await saved.saveAs(join(where, name));
    }
    expect(readFileSync(join(where, "CT.html"), "utf8")).toContain("data:image/png;base64,");
    await drag(page, 60, 20);
    const turned = await state(page);
    await page.locator('input[type="file"]').last().setInputFiles(join(where, "CT.json"));
    await expect.poll(async () => (await state(page)).camera).toEqual(first.camera);
    expect(turned.camera).not.toEqual(first.camera);
  });
});

nightly("a link opens the same state in another window, and a page that is loaded again keeps it", async () => {
  // First, since the strip of looks gives its room to the picture, whose camera keeps in view what was in view.
  await openPanel(page, "share");
  await atRest(page);
  await drag(page, 60, 20);
  await atRest(page);
  const shown = await state(page);
  await page.getByRole("button", { name: "Copy link" }).click();
  await expect.poll(() => page.evaluate(() => navigator.clipboard.readText())).toContain("&state=");
  const link = await page.evaluate(() => navigator.clipboard.readText());
  await page.reload();
  await atRest(page);
  expect((await state(page)).camera).toEqual(shown.camera);
  await change(page, { op: "replace", path: "", value: first });
  const other = await openViewer(browser, link);
  await expect.poll(async () => (await state(other)).camera).toEqual(shown.camera);
  expect(other.url()).not.toContain("state=");
  await other.close();
});

test("the keyboard alone does the main job", async () => {
  await page.locator('[data-view="3d"]').focus();
  for (const key of ["ArrowLeft", "ArrowLeft", "+", ".", "Shift+ArrowUp"]) await page.keyboard.press(key);
  const turned = await state(page);
  expect(turned.camera.position).not.toEqual(first.camera.position);
  expect(turned.camera.view_up).not.toEqual(first.camera.view_up);
  await page.keyboard.press("3");
  await page.keyboard.press("?");
  await expect.poll(() => page.getByRole("dialog").isVisible()).toBe(true);
  await page.keyboard.press("Escape");
  await expect.poll(() => page.getByRole("dialog").count()).toBe(0);
  // Tab goes from the view through the page: to a preset, a point, a crop, the picture. The sheet follows the rail.
  const reach = async (name: RegExp): Promise<void> => {
    for (let n = 0; n < 220; n += 1) {
      await page.keyboard.press("Tab");
      const label = await page.evaluate(() => {
        const element = document.getElementById("viewer")?.shadowRoot?.activeElement;
        return `${element?.getAttribute("aria-label") ?? ""} ${element?.textContent ?? ""}`;
      });
      if (name.test(label)) return;
    }
    throw new Error(`${name} is not reached by Tab`);
  };
  await openPanel(page, "presets");
  await reach(/^Bone:/);
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  await expect.poll(async () => (await state(page)).layers[0]?.look.name).not.toBe("ct-bone");
  await openPanel(page, "function");
  await reach(/Edit curve/);
  await page.keyboard.press("Enter");
  await reach(/Point 2 of/);
  const before = JSON.stringify((await state(page)).layers[0]?.look.transfer_function);
  await page.keyboard.press("ArrowRight");
  await expect.poll(async () => JSON.stringify((await state(page)).layers[0]?.look.transfer_function)).not.toBe(before);
  await openPanel(page, "cut");
  await reach(/^ ?Crop$/);
  await page.keyboard.press("Enter");
  await expect.poll(async () => (await state(page)).clip.length).toBe(1);
  await openPanel(page, "share");
  await reach(/Save picture/);
  const [saved] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("Enter")]);
  expect(saved.suggestedFilename()).toBe("CT.png");
});

test("touch turns, moves and magnifies", async () => {
  const { x, y } = await middle(page);
  const client = await page.context().newCDPSession(page);
  const touch = (type: "touchStart" | "touchMove" | "touchEnd", ...points: [number, number][]): Promise<unknown> =>
    client.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([px, py], id) => ({ x: px, y: py, id })) });
  await touch("touchStart", [x, y]);
  for (let n = 1; n <= 5; n += 1) await touch("touchMove", [x + 12 * n, y]);
  await touch("touchEnd");
  const turned = (await state(page)).camera;
  expect(turned.position).not.toEqual(first.camera.position);
  await touch("touchStart", [x - 40, y], [x + 40, y]);
  for (let n = 1; n <= 5; n += 1) await touch("touchMove", [x - 40 - 8 * n, y], [x + 40 + 8 * n, y]);
  await touch("touchEnd");
  expect((await state(page)).camera.parallel_scale ?? 0).toBeLessThan(turned.parallel_scale ?? 0);
  await client.detach();
});
