// Opening files in the page: the start page, drops, what a second volume does, undo over it, and pages from elsewhere.

import { mkdirSync, mkdtempSync, readdirSync, readFileSync } from "node:fs";
import { createServer, type Server as HttpServer } from "node:http";
import { createRequire } from "node:module";
import type { AddressInfo } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

import {
  atRest, change, nightly, openBrowser, openPanel, openViewer, pixels, python, startServer, state, type Browser, type Server,
} from "./harness.ts";

const DATA = mkdtempSync(join(tmpdir(), "wavesplat-test-"));
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
/** Temporary files of the server. */
const TEMPORARY = join(DATA, "tmp");
mkdirSync(TEMPORARY);

/** Writes the files that are opened: the bundled CT, a hot spot in it, its bones, a surface, and slices. */
const WRITE = `
import os, numpy as np, tifffile, wavesplat as ws
whole = ws.examples.ct_pelvis()
place = {"world_from_index": whole.world_from_index @ np.diag([2, 2, 2, 1]), "facts": whole.facts}
ct = ws.Volume(whole.samples[::2, ::2, ::2], **place)
ct.save("ct.nii.gz")
z, y, x = np.indices(ct.shape)
spot = np.exp(-((z - 30) ** 2 + (y - 25) ** 2 + (x - 30) ** 2) / 50).astype(np.float32) * 9
ws.Volume(spot, **place).save("pet.nii.gz")
ws.Volume((ct.samples > 250).astype(np.uint8), **place).save("bones.nii.gz")
low, high = ct.bounds
middle = (low + high) / 2
corners = [[low[0], middle[1], low[2]], [high[0], middle[1], low[2]], [low[0], middle[1], high[2]]]
text = "".join("vertex %f %f %f " % tuple(corner) for corner in corners)
open("cut.stl", "w").write(f"solid s\\nfacet normal 0 1 0\\nouter loop\\n{text}\\nendloop\\nendfacet\\nendsolid s\\n")
open("letter.nii.gz", "wb").write(b"Dear all")
os.mkdir("series")
for n, plane in enumerate(ct.samples[:20]):
    tifffile.imwrite(f"series/{n:03}.tif", plane)
`;

let server: Server;
let browser: Browser;
let page: Page;
const complaints: string[] = [];

beforeAll(async () => {
  python(WRITE, DATA);
  process.env["TMPDIR"] = TEMPORARY;
  server = await startServer();
  delete process.env["TMPDIR"];
  browser = await openBrowser({ viewport: { width: 800, height: 560 } });
  page = await browser.context.newPage();
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  await page.goto(server.link);
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

/** Drops files on the page, as the system's file manager does. */
async function drop(...names: string[]): Promise<void> {
  const files = names.map((name) => ({ name, base64: readFileSync(join(DATA, name)).toString("base64") }));
  const transfer = await page.evaluateHandle((given) => {
    const made = new DataTransfer();
    for (const { name, base64 } of given) {
      made.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
    }
    return made;
  }, files);
  const target = page.locator(".wavesplat");
  await target.dispatchEvent("dragover", { dataTransfer: transfer });
  await target.dispatchEvent("drop", { dataTransfer: transfer });
}

const layers = async (): Promise<string[]> => (await state(page)).layers.map(({ volume }) => volume.name);

describe("without a file", () => {
  test("there are a place to drop it, three examples with their pictures, and no list yet", async () => {
    await page.getByText("Drop a file or a folder here").waitFor();
    await expect.poll(() => page.locator("img.open-picture").count()).toBe(3);
    expect(await page.getByRole("listitem").count()).toBe(3);
    expect(await page.getByText("Up to 4 GB").count()).toBe(1);
    expect(await page.getByRole("button", { name: "Clear list" }).count()).toBe(0);
  });

  nightly.each(["dark", "light"] as const)("axe finds nothing in %s", async (colorScheme) => {
    await page.emulateMedia({ colorScheme });
    await page.evaluate(AXE);
    const found = await page.evaluate(async () => {
      const { axe } = window as unknown as { axe: { run(): Promise<{ violations: { id: string }[] }> } };
      return (await axe.run()).violations.map(({ id }) => id);
    });
    expect(found).toEqual([]);
  });

  nightly("a file that is none is said to be so, and nothing of it stays", async () => {
    await drop("letter.nii.gz");
    await page.getByRole("alert").getByText("letter.nii.gz").waitFor();
    await expect.poll(() => uploads()).toEqual([]);
  });

  test("a file that is dropped is shown", async () => {
    await drop("ct.nii.gz");
    await page.locator('[data-view="3d"] canvas').waitFor();
    await atRest(page);
    expect(await layers()).toEqual(["CT"]);
    await expect.poll(() => page.title()).toBe("CT – Wavesplat");
    const { data } = await pixels(page);
    expect(new Set(data).size).toBeGreaterThan(100);
    // It is in memory.
    expect(uploads()).toEqual([]);
  });
});

/** Files that pages have sent. */
function uploads(): string[] {
  return readdirSync(TEMPORARY, { recursive: true }).map(String).filter((name) => /wavesplat-open-\w+\/\d/.test(name));
}

describe("a second volume", () => {
  test("is laid over the first, undone, done again, and removed", async () => {
    const before = await pixels(page);
    await drop("pet.nii.gz");
    await page.getByRole("button", { name: "Overlay" }).click();
    await expect.poll(layers).toEqual(["CT", "PET"]);
    await expect.poll(() => page.title()).toBe("CT, PET – Wavesplat");
    // The panels are about the layer that came last.
    const layer = page.locator(".looks").getByRole("combobox");
    expect(await layer.evaluate((list) => (list as HTMLSelectElement).selectedOptions[0]?.textContent)).toContain("PET");
    await atRest(page);
    expect((await pixels(page)).data.equals(before.data)).toBe(false);
    await page.getByRole("button", { name: "Undo" }).click();
    expect(await layers()).toEqual(["CT"]);
    await atRest(page);
    expect((await pixels(page)).data.equals(before.data)).toBe(true);
    await page.getByRole("button", { name: "Redo" }).click();
    expect(await layers()).toEqual(["CT", "PET"]);
    await openPanel(page, "layers");
    await page.getByRole("button", { name: "Remove PET" }).click();
    expect(await layers()).toEqual(["CT"]);
    // The panel took the place of the strip of looks, so that the view was larger.
    await change(page, { op: "replace", path: "/view/interface/panels", value: ["presets"] });
    await page.locator(".looks").waitFor();
    await atRest(page);
    expect((await pixels(page)).data.equals(before.data)).toBe(true);
  });

  nightly("replaces the first, which undo brings back", async () => {
    await drop("pet.nii.gz");
    await page.getByRole("button", { name: "Replace" }).click();
    await expect.poll(layers).toEqual(["PET"]);
    await atRest(page);
    await page.getByRole("button", { name: "Undo" }).click();
    expect(await layers()).toEqual(["CT"]);
    await atRest(page);
  });

  nightly("is nothing if the question is cancelled", async () => {
    await drop("pet.nii.gz");
    await page.getByRole("dialog").getByRole("button", { name: "Cancel" }).click();
    await page.getByRole("dialog").waitFor({ state: "detached" });
    expect(await layers()).toEqual(["CT"]);
    await expect.poll(uploads).toEqual([]);
  });
});

nightly("a segmentation is known as one, and a surface is added without a question", async () => {
  await drop("bones.nii.gz");
  await page.getByRole("button", { name: "Segmentation" }).click();
  await expect.poll(async () => Object.keys((await state(page)).labels?.labels ?? {})).toEqual(["1"]);
  await drop("cut.stl");
  await expect.poll(async () => (await state(page)).geometry.map(({ name }) => name)).toEqual(["cut.stl"]);
  await atRest(page);
  await openPanel(page, "layers");
  await page.getByRole("button", { name: "Remove cut.stl" }).click();
  await openPanel(page, "labels");
  await page.getByRole("button", { name: "Remove the segmentation" }).click();
  expect(await state(page)).toMatchObject({ labels: null, geometry: [] });
  await atRest(page);
});

nightly("a saved state still opens, and a folder comes by its button", async () => {
  await change(page, { op: "replace", path: "/background", value: "#102030" });
  await openPanel(page, "share");
  const [saved] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save state" }).click()]);
  await saved.saveAs(join(DATA, "view.json"));
  // What was sent has no path on the server: the state names the file as the user does.
  expect(JSON.parse(readFileSync(join(DATA, "view.json"), "utf8")).layers[0].volume.path).toBe("ct.nii.gz");
  await page.getByRole("button", { name: "Undo" }).click();
  expect((await state(page)).background).not.toBe("#102030");
  await drop("view.json");
  await expect.poll(async () => (await state(page)).background).toBe("#102030");
  await page.getByRole("button", { name: "Open", exact: true }).click();
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.getByText("Choose a folder").click()]);
  await chooser.setFiles(join(DATA, "series"));
  await page.getByRole("button", { name: "Replace" }).click();
  await expect.poll(layers).toEqual(["CT"]);
  await atRest(page);
  expect(complaints).toEqual([]);
});

describe("pages from elsewhere", () => {
  let elsewhere: HttpServer;

  beforeAll(async () => {
    elsewhere = createServer((_, answer) => answer.setHeader("Content-Type", "text/html").end("<title>elsewhere</title>"));
    await new Promise<void>((resolve) => elsewhere.listen(0, "127.0.0.1", resolve));
  });

  afterAll(() => void elsewhere?.close());

  test("get nothing, and can send nothing", async () => {
    const stranger = await browser.context.newPage();
    const before = uploads();
    await stranger.goto(`http://127.0.0.1:${(elsewhere.address() as AddressInfo).port}/`);
    const got = await stranger.evaluate(async (port) => {
      const tries: string[] = [];
      await new Promise<void>((resolve) => {
        const socket = new WebSocket(`ws://127.0.0.1:${port}/socket`);
        socket.onopen = () => tries.push("socket");
        socket.onmessage = () => tries.push("message");
        socket.onclose = () => resolve();
      });
      for (const [method, path] of [["GET", "/"], ["GET", "/viewer.js"], ["POST", "/upload"], ["POST", "/socket"]] as const) {
        await fetch(`http://127.0.0.1:${port}${path}`, { method, ...(method === "POST" ? { body: "abc" } : {}) }).then(
          () => tries.push(path),
          () => undefined,
        );
      }
      return tries;
    }, server.port);
    await stranger.close();
    expect(got).toEqual([]);
    expect(uploads()).toEqual(before);
    await page.bringToFront();
  });
});

nightly("files of the command are listed, opened again and forgotten, and what was sent is removed at the end", async () => {
  await page.close();
  await server.stop();
  expect(readdirSync(TEMPORARY)).toEqual([]);
  const first = await startServer(join(DATA, "pet.nii.gz"));
  await openViewer(browser, first.link);
  await first.stop();
  server = await startServer();
  page = await browser.context.newPage();
  await page.goto(server.link);
  const recent = page.locator(".open-recent").getByRole("button", { name: /^pet\.nii\.gz/ });
  await recent.waitFor();
  await recent.click();
  await page.locator('[data-view="3d"] canvas').waitFor();
  expect(await layers()).toEqual(["PET"]);
  await page.getByRole("button", { name: "Open", exact: true }).click();
  await page.getByRole("button", { name: "Clear list" }).click();
  await recent.waitFor({ state: "detached" });
});
