// The face of the page: the rail, one sheet at a time, words, fields.

import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, beforeEach, describe, expect, test } from "vitest";

import type { ViewerState } from "../src/state/state.ts";
import {
  atRest, change, folder, nightly, openBrowser, openViewer, pixels, python, startServer, state, type Browser, type Server,
} from "./harness.ts";

let server: Server;
let browser: Browser;
let page: Page & { complaints: string[] };
let first: ViewerState;

beforeAll(async () => {
  server = await startServer("--example", "ct_pelvis", "--preset", "ct-bone");
  browser = await openBrowser({ viewport: { width: 1280, height: 800 } });
  page = await openViewer(browser, server.link);
  first = await state(page);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

beforeEach(async () => {
  await page.setViewportSize({ width: 1280, height: 800 });
  await change(page, { op: "replace", path: "", value: first }, { op: "replace", path: "/view/interface/panels", value: [] });
  await atRest(page);
});

/** Words that nobody understands at once; each has a plain one in its place. */
const UNCLEAR = [
  "Space", "Rays show", "Across it", "Box that is cut out", "Seen", "Usual values", "Points", "Log counts", "Normal width",
  "Reach of occlusion", "Clear below", "own sampling", "End it", "sheets a slice", "texels a pixel",
];

describe("the rail", () => {
  test("opens every panel by one click in a window of 1280 x 800, none below the fold", async () => {
    const icons = page.getByRole("navigation", { name: "Panels" }).locator("[data-opens]");
    const names = await icons.evaluateAll((all) => all.map((one) => (one as HTMLElement).dataset["opens"] ?? ""));
    expect(names.length).toBe(9);
    for (const name of names) {
      await page.locator(`[data-opens="${name}"]`).click();
      const sheet = page.locator(`[data-panel="${name}"]`);
      await sheet.waitFor();
      // The strip of looks stays at the foot; sheets take each other's place.
      await expect.poll(() => page.locator(".sheet").count()).toBe(name === "presets" ? 0 : 1);
      for (const box of [await sheet.boundingBox(), await page.locator(`[data-opens="${name}"]`).boundingBox()]) {
        expect(box?.y ?? -1).toBeGreaterThanOrEqual(0);
        expect((box?.y ?? 0) + (box?.height ?? 900)).toBeLessThanOrEqual(800);
      }
    }
    await page.locator(`[data-opens="${names.at(-1)}"]`).click();
    await page.locator('[data-opens="presets"]').click();
    await expect.poll(() => page.locator("[data-panel]").count()).toBe(0);
  });

  nightly("Escape closes the sheet, and its icon has the focus", async () => {
    await page.locator('[data-opens="cut"]').click();
    await page.getByRole("checkbox", { name: "Handles in the views" }).focus();
    await page.keyboard.press("Escape");
    await expect.poll(() => page.locator("[data-panel]").count()).toBe(0);
    await expect.poll(() => page.evaluate(() => (document.getElementById("viewer")?.shadowRoot?.activeElement as HTMLElement | null | undefined)?.dataset["opens"])).toBe("cut");
  });

  nightly("the picture has all but the rail and the tools, and no panel has an unclear word", async () => {
    const picture = await page.locator('[data-view="3d"]').boundingBox();
    expect([picture?.width, picture?.height]).toEqual([1280 - 88, 800 - 62]);
    for (const name of ["function", "layers", "light", "cut", "slices", "measure", "share", "settings"]) {
      await page.locator(`[data-opens="${name}"]`).click();
      const text = await page.locator(`[data-panel="${name}"]`).innerText();
      const lines = text.split("\n").map((line) => line.trim());
      for (const word of UNCLEAR) expect(lines, name).not.toContain(word);
    }
    await page.keyboard.press("?");
    expect(await page.getByRole("dialog").innerText()).not.toContain("End it");
    await page.keyboard.press("Escape");
    expect(page.complaints).toEqual([]);
  });
});

/** The number fields whose text is wider than they are. */
const cutFields = (): Promise<string[]> =>
  page.evaluate(() =>
    [...(document.getElementById("viewer")?.shadowRoot?.querySelectorAll<HTMLInputElement>('input[type="number"]') ?? [])]
      .filter((field) => field.scrollWidth > field.clientWidth)
      .map((field) => `${field.getAttribute("aria-label")}: ${field.value}`),
  );

describe("numbers", () => {
  nightly("no number field cuts its text, at 100 and at 200 %", async () => {
    const lower = [-177.95619, 50.00123, 150.4999];
    await change(page, { op: "add", path: "/clip/-", value: { keep: { lower, upper: [100.123, 250.77, 400.1], space: "world" } } });
    for (const [width, height] of [[1280, 800], [640, 400]] as const) {
      await page.setViewportSize({ width, height });
      for (const name of ["function", "layers", "light", "cut", "slices", "share", "settings"]) {
        await page.locator(`[data-opens="${name}"]`).click();
        await page.locator(`[data-panel="${name}"]`).waitFor();
        expect(await cutFields(), name).toEqual([]);
      }
    }
    await page.locator('[data-opens="cut"]').click();
    expect(await page.getByRole("spinbutton", { name: "x from, number, mm" }).inputValue()).toBe("-178");
  });

  nightly("the card about the data says what is known and what was guessed", async () => {
    await page.getByRole("button", { name: /about the data$/ }).click();
    const card = page.locator('[data-panel="about"]');
    const { volumes } = await page.evaluate(() => (document.getElementById("viewer") as unknown as { wavesplat: { welcome: { volumes: { shape: number[] }[] } } }).wavesplat.welcome);
    const text = await card.innerText();
    expect(text).toContain((volumes[0]?.shape ?? []).join(" × "));
    expect(text).toMatch(/\d HU/);
    expect(text).toContain("CT in Hounsfield units");
  });
});

/** Starts a viewer of made samples of a spacing in a unit. */
async function made(name: string, expression: string, spacing: number, unit: string): Promise<Server> {
  const where = folder();
  python(
    `import numpy as np
rng = np.random.default_rng(0)
z, y, x = np.indices((40, 40, 40))
samples = (${expression}).astype(np.float32)
header = "NRRD0004\\ntype: float\\ndimension: 3\\nspace: left-posterior-superior\\nsizes: 40 40 40\\nspace directions: (${spacing},0,0) (0,${spacing},0) (0,0,${spacing})\\nspace units: ${[unit, unit, unit].map((one) => `\\"${one}\\"`).join(" ")}\\nspace origin: (0,0,0)\\nkinds: domain domain domain\\nencoding: raw\\nendian: little\\n\\n"
open("${name}.nrrd", "wb").write(header.encode() + samples.tobytes())`,
    where,
  );
  return startServer(join(where, `${name}.nrrd`));
}

nightly("what data were taken for is in the page, and micrometres are written µm", async () => {
  const blobs = "rng.gamma(2, 1, z.shape) + 400 * np.exp(-((z - 20) ** 2 + (y - 12) ** 2 + (x - 20) ** 2) / 8) + 300 * np.exp(-((z - 30) ** 2 + (y - 25) ** 2 + (x - 10) ** 2) / 4)";
  for (const [unit, spacing, kind] of [["mm", 4, "Taken for PET"], ["um", 0.5, "µm"]] as const) {
    const other = await made(unit, blobs, spacing, unit);
    try {
      const shown = await openViewer(browser, other.link);
      await change(shown, { op: "replace", path: "/view/layout", value: { name: "two-by-two", main: "3d" } },
        { op: "replace", path: "/view/interface/panels", value: ["about"] });
      await atRest(shown, "z");
      const text = await shown.locator(".wavesplat").evaluate((all) => all.textContent ?? "");
      expect(text).toContain(kind);
      expect(text).not.toMatch(/\d um/);
      await shown.close();
    } finally {
      await other.stop();
    }
  }
});

/** Share of the pixels that are bone-coloured: bright, and with more blue than skin has. */
async function boneShare(): Promise<number> {
  const { data } = await pixels(page);
  let n = 0;
  for (let k = 0; k < data.length; k += 4) {
    const [red = 0, , blue = 0] = data.subarray(k, k + 3);
    if (red > 100 && blue > 0.7 * red) n += 1;
  }
  return n / (data.length / 4);
}

nightly("one drag of See-through shows the bones behind the skin, and is one step of undo", async () => {
  await page.locator('[data-opens="presets"]').click();
  await page.getByRole("option", { name: /^Skin:/ }).click();
  await expect.poll(async () => (await state(page)).layers[0]?.look.name).toBe("ct-skin");
  await page.locator('[data-opens="function"]').click();
  await atRest(page);
  const before = await state(page);
  expect(await boneShare()).toBeLessThan(0.02);
  const slider = page.getByRole("slider", { name: "See-through", exact: true });
  const box = await slider.boundingBox();
  if (box === null) throw new Error("there is no knob");
  await page.mouse.move(box.x + 8, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width - 8, box.y + box.height / 2, { steps: 12 });
  await page.mouse.up();
  await atRest(page);
  expect(await boneShare()).toBeGreaterThan(0.05);
  await page.locator('[data-view="3d"]').focus();
  await page.keyboard.press("Control+z");
  await expect.poll(async () => (await state(page)).layers[0]?.look).toEqual(before.layers[0]?.look);
  await expect.poll(() => slider.inputValue()).toBe("0");
});

/** Groups that float over the picture: pairs that overlap, and those that leave the window. */
const collisions = (): Promise<string[]> =>
  page.evaluate(() => {
    const root = document.getElementById("viewer")?.shadowRoot;
    const all = [...(root?.querySelectorAll<HTMLElement>(".float, .status > *") ?? [])].filter((one) => one.offsetParent !== null);
    const boxes = all.map((one) => ({ name: one.className, ...one.getBoundingClientRect().toJSON() }) as DOMRect & { name: string });
    const isOver = (a: DOMRect, b: DOMRect): boolean =>
      a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    return boxes.flatMap((a, n) => [
      ...boxes.slice(n + 1).filter((b) => isOver(a, b)).map((b) => `${a.name} over ${b.name}`),
      ...(a.top < -1 || a.left < -1 || a.bottom > innerHeight + 1 ? [`${a.name} beyond the window`] : []),
    ]);
  });

describe("small windows", () => {
  nightly("on a phone there is one row of tools, and a sheet from below leaves the picture 60 % of the height", async () => {
    await page.setViewportSize({ width: 390, height: 844 });
    for (const panels of [[], ["presets"], ["function"], ["light"], ["presets", "settings"]]) {
      await change(page, { op: "replace", path: "/view/interface/panels", value: panels });
      await page.waitForTimeout(300);
      const [tools, picture] = [await page.locator(".toolbar").boundingBox(), await page.locator('[data-view="3d"]').boundingBox()];
      expect(tools?.height ?? 844).toBeLessThan(60);
      expect((picture?.height ?? 0) / 844, panels.join()).toBeGreaterThanOrEqual(0.6);
      expect(await collisions(), panels.join()).toEqual([]);
    }
  });

  nightly("at 200 % nothing that floats lies over another", async () => {
    await page.setViewportSize({ width: 640, height: 400 });
    for (const panels of [["presets"], ["function"], ["slices"], ["about"]]) {
      await change(page, { op: "replace", path: "/view/interface/panels", value: panels });
      await page.waitForTimeout(300);
      expect(await collisions(), panels.join()).toEqual([]);
    }
  });
});

describe("the palette", () => {
  nightly("Ctrl K finds looks, layouts, windows and keys, without the mouse", async () => {
    const run = async (text: string): Promise<void> => {
      await page.keyboard.press("Control+k");
      await page.getByRole("combobox", { name: /^Find a command/ }).waitFor();
      await page.keyboard.type(text);
      await page.keyboard.press("Enter");
      await expect.poll(() => page.getByRole("dialog").count()).toBe(0);
    };
    await run("muscle look");
    await expect.poll(async () => (await state(page)).layers[0]?.look.name).toBe("ct-muscle");
    await run("two by");
    await expect.poll(async () => (await state(page)).view.layout.name).toBe("two-by-two");
    await run("bone window");
    await expect.poll(async () => (await state(page)).view.slices.window).toEqual([400, 1800]);
    const before = await state(page);
    await run("from the left");
    await expect.poll(async () => (await state(page)).camera.position).not.toEqual(before.camera.position);
    await run("crop");
    await expect.poll(async () => (await state(page)).clip.length).toBe(1);
    await run("slice 56");
    await expect.poll(() => page.locator('[data-view="z"] .pill').first().innerText()).toContain("56/112");
    const [download] = await Promise.all([page.waitForEvent("download"), run("screenshot")]);
    expect(download.suggestedFilename()).toMatch(/png$/);
    await page.keyboard.press("Control+k");
    await page.keyboard.type("no command has this");
    await page.getByText("Nothing is found for these words.").waitFor();
    await page.keyboard.press("Escape");
    await expect.poll(() => page.getByRole("dialog").count()).toBe(0);
    expect(page.complaints).toEqual([]);
  });
});
