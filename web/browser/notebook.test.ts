// The widget in a real JupyterLab: a cell shows the picture, a drag turns it, Python reads and sets the camera.

import { spawn, spawnSync, type ChildProcess } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

import { folder, openBrowser, PYTHON, type Browser } from "./harness.ts";

const HAS_LAB = spawnSync(PYTHON, ["-c", "import jupyterlab, anywidget"]).status === 0;
const TOKEN = "test";
const CELLS = [
  'import wavesplat as ws\nviewer = ws.view(ws.examples.ct_pelvis(), "ct-bone")\nviewer',
  'print("camera", *viewer.camera.position)',
  "viewer.camera = ws.Camera.view(viewer.scene, 'left')\nprint('set')",
];

async function freePort(): Promise<number> {
  return new Promise((resolve) => {
    const server = createServer().listen(0, "127.0.0.1", () => {
      const address = server.address();
      server.close(() => resolve(typeof address === "object" && address !== null ? address.port : 0));
    });
  });
}

describe.skipIf(!HAS_LAB)("JupyterLab", () => {
  let lab: ChildProcess;
  let browser: Browser;
  let page: Page;
  const where = folder();
  const path = join(where, "view.ipynb");

  beforeAll(async () => {
    const cells = CELLS.map((source, n) => ({ cell_type: "code", id: `cell${n}`, metadata: {}, source, outputs: [], execution_count: null }));
    const kernelspec = { display_name: "Python 3", language: "python", name: "python3" };
    writeFileSync(path, JSON.stringify({ cells, metadata: { kernelspec }, nbformat: 4, nbformat_minor: 5 }));
    const port = await freePort();
    const root = fileURLToPath(new URL("../../python", import.meta.url));
    lab = spawn(
      PYTHON,
      ["-m", "jupyterlab", "--no-browser", `--port=${port}`, `--IdentityProvider.token=${TOKEN}`, "--allow-root", `--ServerApp.root_dir=${where}`, "--LabApp.news_url=None", "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate"],
      { cwd: where, env: { ...process.env, PYTHONPATH: root, PATH: `${dirname(PYTHON)}:${process.env["PATH"]}`, JUPYTER_CONFIG_DIR: where, JUPYTER_DATA_DIR: join(where, "data"), IPYTHONDIR: join(where, "ipython") } },
    );
    let said = "";
    await new Promise<void>((resolve, reject) => {
      lab.stderr?.on("data", (data) => {
        said += String(data);
        if (said.includes("is running at")) resolve();
      });
      lab.once("exit", () => reject(new Error(`JupyterLab ended: ${said}`)));
    });
    browser = await openBrowser({ viewport: { width: 1300, height: 900 } });
    page = await browser.context.newPage();
    await page.goto(`http://127.0.0.1:${port}/lab/tree/view.ipynb?token=${TOKEN}`);
    await page.locator(".jp-Notebook .jp-Cell").first().waitFor({ timeout: 60_000 });
    // A cell that is run before there is a kernel is lost.
    await page.getByText("| Idle").first().waitFor({ timeout: 60_000 });
    await page.locator(".jp-Notebook .jp-Cell .cm-content").first().click();
    await page.keyboard.press("Shift+Enter");
  }, 150_000);

  afterAll(async () => {
    await browser?.close();
    lab?.kill("SIGTERM");
  });

  const canvas = () => page.locator('.jp-OutputArea [data-view="3d"] canvas');
  const printed = async (cell: number): Promise<string> => {
    const input = page.locator(".jp-Notebook .jp-Cell").nth(cell);
    await input.locator(".cm-content").click();
    await page.keyboard.press("Shift+Enter");
    const output = input.locator(".jp-OutputArea-output pre");
    await output.first().waitFor({ timeout: 30_000 });
    return output.first().innerText();
  };
  const bright = (): Promise<number> =>
    canvas().evaluate((element) => {
      const shown = element as HTMLCanvasElement;
      const { data } = shown.getContext("2d")?.getImageData(0, 0, shown.width, shown.height) ?? { data: [] };
      return [...data].filter((value, n) => n % 4 === 0 && value > 128).length;
    });

  test("shows the picture, turns it, and Python reads and sets the camera", async () => {
    await canvas().waitFor({ timeout: 60_000 });
    await expect.poll(() => canvas().getAttribute("data-at-rest"), { timeout: 30_000 }).toBe("true");
    expect(await bright()).toBeGreaterThan(1000);
    const before = await printed(1);
    await canvas().scrollIntoViewIfNeeded();
    const box = await canvas().boundingBox();
    if (box === null) throw new Error("there is no canvas");
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 90, y, { steps: 8 });
    await page.mouse.up();
    await page.waitForTimeout(500);
    const after = await printed(1);
    expect(after).toMatch(/^camera/);
    expect(after).not.toBe(before);
    await printed(2);
    await expect
      .poll(() => canvas().evaluate((element) => {
        const host = (element.getRootNode() as ShadowRoot).host as HTMLElement & { wavesplat: { store: { state: { camera: { position: number[] } } } } };
        return host.wavesplat.store.state.camera.position[0];
      }))
      .toBeLessThan(-200);
  });

  test("keys of the viewer are not those of the notebook", async () => {
    await page.locator('.jp-OutputArea [data-view="3d"]').focus();
    const n = await page.locator(".jp-Notebook .jp-Cell").count();
    // In command mode of a notebook these delete and insert cells.
    for (const key of ["d", "d", "a", "b", "ArrowDown"]) await page.keyboard.press(key);
    expect(await page.locator(".jp-Notebook .jp-Cell").count()).toBe(n);
  });

  test("the saved notebook shows a still picture", async () => {
    await page.locator(".jp-Notebook .jp-Cell .cm-content").nth(1).click();
    await page.keyboard.press("Control+s");
    await expect.poll(() => readFileSync(path, "utf8").includes("image/png"), { timeout: 20_000 }).toBe(true);
    const { cells } = JSON.parse(readFileSync(path, "utf8")) as { cells: { outputs: { data?: Record<string, string> }[] }[] };
    const data = cells[0]?.outputs[0]?.data ?? {};
    expect(Object.keys(data).sort()).toEqual(["application/vnd.jupyter.widget-view+json", "image/png", "text/plain"]);
    expect(Buffer.from(data["image/png"] ?? "", "base64").subarray(1, 4).toString()).toBe("PNG");
  });

  test("after a restart of the kernel the picture is dimmed, and the page says to run the cell again", async () => {
    await canvas().scrollIntoViewIfNeeded();
    const status = await page.evaluate(async (token) => {
      const kernels = (await (await fetch(`/api/kernels?token=${token}`)).json()) as { id: string }[];
      // As the server itself does it, not by the page's menu.
      const xsrf = /_xsrf=([^;]+)/.exec(document.cookie)?.[1] ?? "";
      const done = await fetch(`/api/kernels/${kernels[0]?.id}/restart?token=${token}`, { method: "POST", headers: { "X-XSRFToken": xsrf } });
      return done.status;
    }, TOKEN);
    expect(status).toBe(200);
    const box = await canvas().boundingBox();
    if (box === null) throw new Error("there is no canvas");
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y, { steps: 4 });
    await page.mouse.up();
    const banner = page.locator(".jp-OutputArea .banner");
    await banner.waitFor({ timeout: 3000 });
    expect(await banner.innerText()).toContain("kernel");
    expect(await banner.innerText()).toContain("un the cell again");
    expect(await page.locator(".jp-OutputArea .views").getAttribute("data-stale")).toBe("true");
  });
});
