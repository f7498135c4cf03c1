// A real browser before a real server: the command of the checkout, and the distribution's Chromium.

import { spawn, spawnSync, type ChildProcess } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

import { chromium, type BrowserContext, type Page } from "playwright-core";
import { test } from "vitest";

import type { ViewerState } from "../src/state/state.ts";
import type { FrameRecord } from "../src/view/frame_statistics.ts";

/** Whether all tests run (`npm run browser:all`), not one of each kind. */
export const NIGHT = process.env["WAVESPLAT_NIGHT"] === "1";
/** A test of a kind that another one, of the day, has. */
export const nightly: typeof test = NIGHT ? test : (test.skip as typeof test);

const ROOT = fileURLToPath(new URL("../..", import.meta.url));
const VENV = join(ROOT, ".venv/bin/python");
export const PYTHON = process.env["WAVESPLAT_PYTHON"] ?? (existsSync(VENV) ? VENV : "python3");
const CHROMIUM = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find((path) => existsSync(path));
/** Flags of Chromium: no background traffic, and no sandbox, which containers do not allow. */
export const FLAGS = [
  "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
  "--disable-sync",
];
const STATE = mkdtempSync(join(tmpdir(), "wavesplat-state-"));
const REST_MS = 60_000;
const POLL_MS = 50;
const CALM = 24;

export interface Server {
  readonly link: string;
  readonly port: number;
  readonly process: ChildProcess;
  /** The server's output on stderr so far. */
  errors(): string;
  stop(): Promise<number | null>;
}

/** Starts `wavesplat view` and reads its link. */
export async function startServer(...options: string[]): Promise<Server> {
  // The list of recent files is not the user's own, and memory is compared: threads that meet in malloc on a busy machine get
  // no further arenas.
  const env = { ...process.env, XDG_STATE_HOME: STATE, MALLOC_ARENA_MAX: "2" };
  const child = spawn(PYTHON, ["-m", "wavesplat", "view", ...options, "--no-browser"], { cwd: ROOT, env });
  let errors = "";
  child.stderr.on("data", (data) => (errors += String(data)));
  const ended = new Promise<number | null>((resolve) => child.once("exit", resolve));
  const link = await new Promise<string>((resolve, reject) => {
    child.stdout.once("data", (data) => resolve(String(data).trim()));
    child.once("exit", () => reject(new Error(`the server ended: ${errors}`)));
  });
  process.once("exit", () => child.kill("SIGKILL"));
  return {
    link,
    port: Number(new URL(link).port),
    process: child,
    errors: () => errors,
    async stop() {
      child.kill("SIGINT");
      return ended;
    },
  };
}

export interface Browser {
  readonly context: BrowserContext;
  close(): Promise<void>;
}

export async function openBrowser(options: Parameters<typeof chromium.launchPersistentContext>[1] = {}): Promise<Browser> {
  if (CHROMIUM === undefined) throw new Error("there is no Chromium; install it: apt-get install chromium");
  const folder = mkdtempSync(join(tmpdir(), "wavesplat-browser-"));
  const context = await chromium.launchPersistentContext(folder, {
    executablePath: CHROMIUM,
    headless: true,
    viewport: { width: 1100, height: 720 },
    colorScheme: "dark",
    args: FLAGS,
    acceptDownloads: true,
    ...options,
  });
  return {
    context,
    async close() {
      await context.close();
      rmSync(folder, { recursive: true, force: true });
    },
  };
}

/** Opens a page of the viewer, and waits until it is at rest. `complaints` collects the page's errors, for tests. */
export async function openViewer(browser: Browser, link: string): Promise<Page & { complaints: string[] }> {
  const page = (await browser.context.newPage()) as Page & { complaints: string[] };
  page.complaints = [];
  page.on("pageerror", (error) => page.complaints.push(String(error)));
  page.on("console", (message) => message.type() === "error" && page.complaints.push(message.text()));
  await page.goto(link);
  await atRest(page);
  return page;
}

/**
 * Waits until the newest change is drawn at rest in the size that the view has by now, or, as some changes need no picture,
 * until nothing follows for a while.
 */
export async function atRest(page: Page, view = "3d"): Promise<void> {
  const until = Date.now() + REST_MS;
  let calm = 0;
  let last = "";
  while (calm < CALM) {
    if (Date.now() > until) throw new Error(`the picture does not come to rest: ${last}`);
    await page.waitForTimeout(POLL_MS);
    const [isAtRest, seq, newest] = await page.evaluate((name) => {
      const viewer = document.getElementById("viewer") as (HTMLElement & { wavesplat?: Exposed }) | null;
      const canvas = viewer?.shadowRoot?.querySelector<HTMLCanvasElement>(`[data-view="${name}"] canvas`);
      const box = canvas?.parentElement?.getBoundingClientRect();
      const [width, height] = [(box?.width ?? 0) * devicePixelRatio, (box?.height ?? 0) * devicePixelRatio];
      const fits = canvas != null && Math.abs(canvas.width - width) <= 1 && Math.abs(canvas.height - height) <= 1;
      return [canvas?.dataset["atRest"] === "true" && fits, Number(canvas?.dataset["seq"] ?? -1), viewer?.wavesplat?.store.seq ?? 0] as const;
    }, view);
    if (isAtRest && seq >= newest) return;
    const now = `${isAtRest} ${seq}`;
    calm = isAtRest && now === last ? calm + 1 : 0;
    last = now;
  }
}

interface Exposed {
  readonly store: { readonly state: ViewerState; readonly seq: number; change(operations: unknown[], gesture?: string): void; settle(): void };
  readonly statistics: { readonly records: FrameRecord[] };
}

export const state = (page: Page): Promise<ViewerState> =>
  page.evaluate(() => (document.getElementById("viewer") as unknown as { wavesplat: Exposed }).wavesplat.store.state);

export const records = (page: Page): Promise<FrameRecord[]> =>
  page.evaluate(() => (document.getElementById("viewer") as unknown as { wavesplat: Exposed }).wavesplat.statistics.records);

export const change = (page: Page, ...operations: unknown[]): Promise<void> =>
  page.evaluate((all) => {
    const { store } = (document.getElementById("viewer") as unknown as { wavesplat: Exposed }).wavesplat;
    store.change(all);
    store.settle();
  }, operations);

/** The pixels of a canvas, RGBA. */
export async function pixels(page: Page, view = "3d"): Promise<{ width: number; height: number; data: Buffer }> {
  const { width, height, base64 } = await page.evaluate(async (name) => {
    const canvas = document.getElementById("viewer")?.shadowRoot?.querySelector<HTMLCanvasElement>(`[data-view="${name}"] canvas`);
    const context = canvas?.getContext("2d");
    if (!canvas || !context) throw new Error("there is no canvas");
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    const url = await new Promise<string>((resolve) => {
      const reader = new FileReader();
      reader.onload = () => resolve(String(reader.result));
      reader.readAsDataURL(new Blob([data]));
    });
    return { width: canvas.width, height: canvas.height, base64: url.slice(url.indexOf(",") + 1) };
  }, view);
  return { width, height, data: Buffer.from(base64, "base64") };
}

/** The middle of a view, and its size, in CSS pixels. */
export async function middle(page: Page, view = "3d"): Promise<{ x: number; y: number; width: number; height: number }> {
  const box = await page.locator(`[data-view="${view}"]`).boundingBox();
  if (box === null) throw new Error(`there is no view ${view}`);
  return { x: box.x + box.width / 2, y: box.y + box.height / 2, width: box.width, height: box.height };
}

export async function drag(page: Page, dx: number, dy: number, options: { button?: "left" | "middle" | "right"; view?: string } = {}): Promise<void> {
  const { x, y } = await middle(page, options.view);
  const how = { button: options.button ?? "left" } as const;
  await page.mouse.move(x, y);
  await page.mouse.down(how);
  for (let step = 1; step <= 8; step += 1) await page.mouse.move(x + (dx * step) / 8, y + (dy * step) / 8);
  await page.mouse.up(how);
}

/** Opens the sheet of a panel, in place of the one that is open. */
export async function openPanel(page: Page, name: string): Promise<void> {
  await change(page, { op: "replace", path: "/view/interface/panels", value: [name] });
  await page.locator(`[data-panel="${name}"] .body`).waitFor();
}

/** Runs Python in a folder, and returns what it prints. */
export function python(code: string, folder: string, ...options: string[]): string {
  const done = spawnSync(PYTHON, ["-c", code, ...options], { cwd: folder, encoding: "utf8", env: { ...process.env, PYTHONPATH: join(ROOT, "python") } });
  if (done.status !== 0) throw new Error(done.stderr);
  return done.stdout;
}

export function command(text: string, folder: string): void {
  const script = text.replace(/^wavesplat /m, `"${PYTHON}" -m wavesplat `);
  const done = spawnSync("sh", ["-c", script], { cwd: folder, encoding: "utf8", env: { ...process.env, PYTHONPATH: join(ROOT, "python") } });
  if (done.status !== 0) throw new Error(done.stderr);
}

/** The pixels of a PNG file, RGBA. */
export function pngPixels(path: string): Buffer {
  const out = `${path}.rgba`;
  python(
    "import sys; from PIL import Image; open(sys.argv[2], 'wb').write(Image.open(sys.argv[1]).convert('RGBA').tobytes())",
    tmpdir(), path, out,
  );
  return readFileSync(out);
}

export const folder = (): string => mkdtempSync(join(tmpdir(), "wavesplat-test-"));
