// Drags the camera of a viewer in Chromium for some seconds, and prints the frames as JSON. `benches/viewer.py` calls it:
//   node bench.mjs LINK SECONDS
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const [, , link, seconds = "5"] = process.argv;
/** Size of the window, which the 3-D picture fills. */
const WINDOW = { width: 1024, height: 768 };
const EVENTS_PER_S = 60;
const KEPT = 8;

const folder = mkdtempSync(join(tmpdir(), "wavesplat-bench-"));
const begun = performance.now();
const context = await chromium.launchPersistentContext(folder, {
  executablePath: "/usr/bin/chromium",
  headless: true,
  viewport: WINDOW,
  args: ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking"],
});
const page = context.pages()[0] ?? (await context.newPage());
const opened = performance.now();
await page.goto(link);
const viewer = () => page.evaluate(() => document.getElementById("viewer")?.shadowRoot?.querySelector('[data-view="3d"] canvas')?.dataset.atRest);
while ((await viewer()) !== "true") await page.waitForTimeout(10);
const first = performance.now();
// No panels: their small pictures are drawn by the same processors.
await page.evaluate(() => document.getElementById("viewer").wavesplat.store.change([{ op: "replace", path: "/view/interface/panels", value: [] }]));
await page.waitForTimeout(4000);

const box = await page.locator('[data-view="3d"]').boundingBox();
const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
const client = await page.context().newCDPSession(page);
await client.send("Performance.enable");
const taskSeconds = async () => (await client.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration").value;
const heap = async () => {
  await client.send("HeapProfiler.collectGarbage");
  return (await client.send("Runtime.getHeapUsage")).usedSize;
};

/** Drags for a while, at a fixed rate of events, whether they are answered or not. */
async function drag() {
  await page.evaluate(() => (document.getElementById("viewer").wavesplat.statistics.records.length = 0));
  const send = (type, px, py) => client.send("Input.dispatchMouseEvent", { type, x: px, y: py, button: "left", buttons: type === "mouseReleased" ? 0 : 1, clickCount: 1 });
  await send("mousePressed", x, y);
  const start = performance.now();
  let n = 0;
  while (performance.now() - start < seconds * 1000) {
    n += 1;
    void send("mouseMoved", x + 260 * Math.sin(n / 70), y + 90 * Math.sin(n / 95));
    await new Promise((resolve) => setTimeout(resolve, Math.max(0, (n * 1000) / EVENTS_PER_S - (performance.now() - start))));
  }
  await send("mouseReleased", x, y);
  while ((await viewer()) !== "true") await page.waitForTimeout(10);
  return page.evaluate(() =>
    document.getElementById("viewer").wavesplat.statistics.records
      .filter(({ frame }) => !frame.at_rest)
      .map(({ at, latency, bytes, frame }) => ({ at, latency, bytes, ms: frame.ms, settings: frame.settings, expected: frame.expected_psnr_db })),
  );
}

const before = await taskSeconds();
const frames = await drag();
const task = (await taskSeconds()) - before;

// Drags again, to keep some of the pictures that were seen, with the cameras that they show.
await page.evaluate((most) => {
  const { statistics } = document.getElementById("viewer").wavesplat;
  const canvas = document.getElementById("viewer").shadowRoot.querySelector('[data-view="3d"] canvas');
  const kept = [];
  window.kept = kept;
  const drawn = statistics.drawn.bind(statistics);
  let n = 0;
  statistics.drawn = (frame, at) => {
    drawn(frame, at);
    n += 1;
    if (!frame.at_rest && n % 12 === 0 && kept.length < most) kept.push({ camera: frame.camera, png: canvas.toDataURL("image/png") });
  };
}, KEPT);
await drag();
const kept = await page.evaluate(() => window.kept);
const size = await page.evaluate(() => {
  const canvas = document.getElementById("viewer").shadowRoot.querySelector('[data-view="3d"] canvas');
  return [canvas.width, canvas.height];
});
const state = await page.evaluate(() => document.getElementById("viewer").wavesplat.store.state);
console.log(JSON.stringify({ size, browser_ms: opened - begun, first_picture_ms: first - opened, task_s: task, heap: await heap(), frames, kept, state }));
await context.close();
rmSync(folder, { recursive: true, force: true });
