// What travels: compressed scripts, once for all loads; panels after the first view.

import { get } from "node:http";

import { afterAll, beforeAll, expect, test } from "vitest";

import { openBrowser, openPanel, openViewer, startServer, type Browser, type Server } from "./harness.ts";

let browser: Browser;
let server: Server;

beforeAll(async () => {
  browser = await openBrowser();
  server = await startServer("--example", "ripples");
});

afterAll(async () => {
  await browser?.close();
  await server?.stop();
});

interface Sent {
  readonly name: string;
  readonly bytes: number;
}

/** Bytes of the body of a file as it is sent to a browser, which takes gzip. */
const compressedBytes = (port: number, path: string): Promise<number> =>
  new Promise((resolve, reject) => {
    get({ host: "127.0.0.1", port, path, headers: { "Accept-Encoding": "gzip" } }, (response) => {
      let bytes = 0;
      if (response.headers["content-encoding"] !== "gzip") reject(new Error(`${path} is not compressed`));
      response.on("data", (data: Buffer) => (bytes += data.length));
      response.on("end", () => resolve(bytes));
    }).on("error", reject);
  });

test("scripts travel compressed, below the limit of the first view, and the second load sends none", async () => {
  const sent = (page: Awaited<ReturnType<typeof openViewer>>): Promise<Sent[]> =>
    page.evaluate(() =>
      performance.getEntriesByType("resource").map((one) => {
        const { name, transferSize } = one as PerformanceResourceTiming;
        return { name: new URL(name).pathname, bytes: transferSize };
      }).filter(({ name }) => name.endsWith(".js")));
  const first = await openViewer(browser, server.link);
  await openPanel(first, "presets");
  const scripts = await sent(first);
  expect(scripts.length).toBeGreaterThan(2);
  expect(scripts.every(({ bytes }) => bytes > 0)).toBe(true);
  expect(scripts.reduce((total, { bytes }) => total + bytes, 0)).toBeLessThan(102_000);
  const shown = scripts.filter(({ name }) => !name.startsWith("/late_panels"));
  expect(shown.length).toBe(scripts.length - 1);
  const sizes = await Promise.all(shown.map(({ name }) => compressedBytes(server.port, name)));
  expect(sizes.reduce((total, bytes) => total + bytes, 0)).toBeLessThan(60_000);
  const second = await openViewer(browser, `http://127.0.0.1:${server.port}/`);
  await openPanel(second, "presets");
  expect((await sent(second)).map(({ bytes }) => bytes)).toEqual(scripts.map(() => 0));
  expect([...first.complaints, ...second.complaints]).toEqual([]);
});
