// Slices whose values the page gives colours: the pixels are those of `wavesplat.slice`, and follow a window at once.

import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

import { atRest, change, folder, middle, openBrowser, openViewer, pixels, pngPixels, python, startServer, state, type Browser, type Server } from "./harness.ts";

const where = folder();
let server: Server;
let browser: Browser;
let page: Page & { complaints: string[] };

/** The scan, a layer over it and a segmentation, as the command and as Python open them. */
const SCENE = `
import sys, numpy as np, wavesplat as ws
scan = ws.examples.ct_pelvis()
def like(samples):
    return ws.Volume(samples, world_from_index=scan.world_from_index, facts=ws.Facts(unit="mm", is_anatomical=True))
near = np.exp(-sum(((one - n / 2) / (n / 5)) ** 2 for one, n in zip(np.indices(scan.shape), scan.shape)))
spot, marks = like((10 * near).astype(np.float32)), like((scan.samples > 250).astype(np.uint8) * 3)
`;

beforeAll(async () => {
  python(`${SCENE}\nspot.save("spot.nii.gz")\nmarks.save("marks.nii.gz")\nscan.save("scan.nii.gz")`, where);
  server = await startServer(join(where, "scan.nii.gz"), "--layer", `${join(where, "spot.nii.gz")}:hot:2,8`, "--labels", join(where, "marks.nii.gz"));
  browser = await openBrowser();
  page = await openViewer(browser, server.link);
  await change(page, { op: "replace", path: "/view/layout", value: { name: "single", main: "z" } },
    { op: "replace", path: "/view/interface/panels", value: [] });
  await settled();
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

const settled = async (): Promise<void> => {
  await page.locator('[data-view="z"] canvas[data-at-rest="true"]').waitFor();
  await atRest(page, "z");
};

/** The greatest difference of the view's pixels from those of `wavesplat.slice`, with arguments as Python has them. */
async function difference(layers: string, options: string): Promise<number> {
  const seen = await pixels(page, "z");
  const { crosshair } = (await state(page)).view.slices;
  python(
    `${SCENE}
spot, marks, scan = (ws.open(name + ".nii.gz") for name in ("spot", "marks", "scan"))
ws.slice(${layers}, "axial", ${crosshair[2]}, size=(${seen.width}, ${seen.height}), ${options}).save("slice.png")`,
    where,
  );
  const wanted = pngPixels(join(where, "slice.png"));
  expect(wanted.length).toBe(seen.data.length);
  return wanted.reduce((most, value, n) => Math.max(most, Math.abs(value - (seen.data[n] ?? 0))), 0);
}

const ALL = (opacity: number): string =>
  `ws.Scene([ws.Layer(scan, "ct-bone"), ws.Layer(spot, ws.Layer.overlay(spot, "hot", (2, 8)).look, opacity=${opacity})], labels=ws.Labels.open("marks.nii.gz"))`;

describe("at rest the pixels are those of wavesplat.slice within a level", () => {
  test("with a layer and labels over a scan", async () => {
    expect(await difference(ALL(1), "window=(40, 400)")).toBeLessThanOrEqual(1);
  });

  test("with another window and another opacity, for which nothing was asked", async () => {
    const before = await drawn();
    await change(page, { op: "add", path: "/view/slices/window", value: [300, 900] }, { op: "replace", path: "/layers/1/opacity", value: 0.4 });
    await expect.poll(painted).toBeGreaterThan(0);
    await page.waitForTimeout(300);
    expect(await difference(ALL(0.4), "window=(300, 900)")).toBeLessThanOrEqual(1);
    expect(await drawn()).toBe(before);
  });

  test("in other colours", async () => {
    await change(page, { op: "add", path: "/view/slices/colors", value: "viridis" }, { op: "replace", path: "/layers/1/visible", value: false });
    await settled();
    const scene = ALL(1).replace("opacity=1", "visible=False");
    expect(await difference(scene, 'transfer_function=ws.TransferFunction.from_colormap("viridis", clim=(-150, 750), opacity=1)')).toBeLessThanOrEqual(1);
  });
});

/** Number of the newest frame of the slice, which the session drew. */
const drawn = (): Promise<number> =>
  page.evaluate(() => (document.getElementById("viewer") as unknown as { wavesplat: { frames: Record<string, { number: number }> } }).wavesplat.frames["z"]?.number ?? 0);
const painted = (): Promise<number> =>
  page.evaluate(() => Number(document.getElementById("viewer")?.shadowRoot?.querySelector<HTMLElement>('[data-view="z"] canvas')?.dataset["painted"] ?? 0));

test("a drag of the window changes the canvas with the display, and sends nothing", async () => {
  await change(page, { op: "remove", path: "/view/slices/colors" });
  await settled();
  const session = await browser.context.newCDPSession(page);
  await session.send("Network.enable");
  const sent: string[] = [];
  session.on("Network.webSocketFrameSent", ({ timestamp, response }) => void sent.push(`${timestamp} ${response.payloadData.length}`));
  const before = await painted();
  const { x, y } = await middle(page, "z");
  await page.keyboard.down("Alt");
  await page.mouse.move(x, y);
  await page.mouse.down();
  // Two seconds on a machine that has nothing else to do.
  let changes = 0;
  for (let step = 1; changes < 60 && step < 2000; step += 1) {
    await page.mouse.move(x + (step % 150), y + (step % 40));
    changes = (await painted()) - before;
  }
  const sentBefore = [...sent];
  await page.mouse.up();
  await page.keyboard.up("Alt");
  expect(sentBefore).toEqual([]);
  expect(changes).toBeGreaterThanOrEqual(60);
  // The session is told of the window when the drag ends, and draws nothing for it.
  await expect.poll(() => sent.length).toBeGreaterThan(0);
});

test("the values and the label under the pointer are told without a question", async () => {
  await change(page, { op: "replace", path: "/layers/1/visible", value: true });
  await settled();
  const { x, y } = await middle(page, "z");
  await page.mouse.move(x + 3, y);
  await expect.poll(() => page.locator(".status").innerText()).toMatch(/\S+ -?\d+ HU, \S+ -?\d.*, label \d+ at /);
});

test("nothing was complained of", () => expect(page.complaints).toEqual([]));
