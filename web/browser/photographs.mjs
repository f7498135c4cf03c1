// Photographs of the viewer, to look at and for the README: `node photographs.mjs FOLDER`; `make viewer-pictures` runs this.
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const [, , folder = "."] = process.argv;
const ROOT = fileURLToPath(new URL("../..", import.meta.url));
const VENV = join(ROOT, ".venv/bin/python");
const PYTHON = existsSync(VENV) ? VENV : "python3";

const server = spawn(PYTHON, ["-m", "wavesplat", "view", "--example", "ct_pelvis", "--preset", "ct-bone", "--azimuth", "25", "--elevation", "10", "--no-browser"], { cwd: ROOT });
const link = await new Promise((resolve) => server.stdout.once("data", (data) => resolve(String(data).trim())));
const profile = mkdtempSync(join(tmpdir(), "wavesplat-photographs-"));
const context = await chromium.launchPersistentContext(profile, {
  executablePath: "/usr/bin/chromium",
  headless: true,
  colorScheme: "dark",
  viewport: { width: 1280, height: 760 },
  args: ["--no-sandbox", "--disable-quic", "--no-first-run"],
});
const page = context.pages()[0] ?? (await context.newPage());
await page.goto(link);

/** Photographs the viewer after some operations on its state, in a window of a size, under a name. */
async function photograph(name, operations, { width = 1280, height = 760 } = {}) {
  await page.setViewportSize({ width, height });
  await page.evaluate((all) => document.getElementById("viewer").wavesplat.store.change(all), operations);
  await page.mouse.move(2, 2);
  // What is seen fills the view, whatever its shape.
  await page.waitForTimeout(2000);
  await page.keyboard.press("f");
  // Longer than notes stay.
  await page.waitForTimeout(12_000);
  await page.screenshot({ path: join(folder, `${name}.png`) });
}

await page.waitForFunction(() => document.getElementById("viewer")?.wavesplat !== undefined);
const set = (path, value) => ({ op: "add", path, value });
const layout = (name) => set("/view/layout", { name, main: "3d" });
const panels = (...names) => set("/view/interface/panels", names);
const theme = (name) => set("/view/interface/theme", name);
await photograph("viewer", [layout("one-and-three"), panels("function"), set("/view/slices/window", [50, 400])]);
await photograph("viewer_light", [theme("light"), layout("3d"), panels("presets")]);
await photograph("viewer_narrow", [theme("dark"), panels("presets")], { width: 390, height: 780 });
await photograph("viewer_magnified", [panels("function")], { width: 640, height: 380 });
await context.close();
server.kill("SIGINT");
rmSync(profile, { recursive: true, force: true });
