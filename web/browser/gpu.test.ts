// The shaders of the GPU path in a browser's WebGPU: the texels of captured dispatches are those of the CPU. `make
// browser-test` writes the captures; without them these tests are skipped.

import { existsSync, readdirSync, readFileSync } from "node:fs";
import { createServer, type Server } from "node:http";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

import type { Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, test } from "vitest";

import { FLAGS, openBrowser, type Browser } from "./harness.ts";

const FOLDER = process.env["WAVESPLAT_CAPTURES"] ?? fileURLToPath(new URL("../../.cache/gpu-captures", import.meta.url));
const FILES = existsSync(FOLDER) ? readdirSync(FOLDER).filter((name) => name.endsWith(".json")) : [];
/** WebGPU on the processor (SwiftShader), which headless browsers do not offer by themselves. */
const WEBGPU = ["--enable-unsafe-webgpu", "--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-angle=swiftshader"];

interface Told {
  readonly reason: string | null;
  readonly adapter: string;
  readonly largest: number;
  readonly beyond: number;
  readonly seen: number;
}

describe.skipIf(FILES.length === 0)("WebGPU", () => {
  let server: Server;
  let browser: Browser;
  let page: Page;

  beforeAll(async () => {
    const host = readFileSync(new URL("gpu_host.mjs", import.meta.url));
    server = createServer((request, response) => {
      const name = request.url?.slice(1) ?? "";
      if (name === "host.mjs") {
        response.setHeader("Content-Type", "text/javascript");
        response.end(host);
      } else if (FILES.includes(name)) {
        response.end(readFileSync(join(FOLDER, name)));
      } else {
        response.setHeader("Content-Type", "text/html");
        response.end("<!doctype html><title>WebGPU</title>");
      }
    });
    await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
    const address = server.address();
    const port = typeof address === "object" && address !== null ? address.port : 0;
    browser = await openBrowser({ args: [...FLAGS, ...WEBGPU] });
    page = await browser.context.newPage();
    await page.goto(`http://127.0.0.1:${port}/`);
  });

  afterAll(async () => {
    await browser?.close();
    server?.close();
  });

  test.each(FILES)("draws the texels of the CPU: %s", async (name) => {
    const told = (await page.evaluate(
      `import("/host.mjs").then(async ({ run }) => run(await (await fetch("/${name}")).json()))`,
    )) as Told;
    expect(told.reason).toBeNull();
    expect(told.seen).toBeGreaterThan(300);
    expect(told.beyond).toBe(0);
    expect(told.largest).toBeLessThan(0.1);
  });
});
