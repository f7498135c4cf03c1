import { defineConfig } from "vitest/config";

/** Files that `npm run browser:all` alone runs, at night; the others have one test of each kind by day. */
const NIGHTLY = ["cut_and_window", "jobs", "legend", "looks", "notebook", "shapes", "share", "two_fields"].map((name) => `browser/${name}.test.ts`);

export default defineConfig({
  oxc: { jsx: { runtime: "automatic", importSource: "preact" } },
  test: {
    projects: [
      { extends: true, test: { name: "unit", include: ["tests/**/*.test.ts", "tests/**/*.test.tsx"], environment: "node" } },
      // The module in Node, by `make wasm-test`, which builds it.
      { extends: true, test: { name: "wasm", include: ["wasm/**/*.test.ts"], environment: "node", testTimeout: 60_000 } },
      {
        extends: true,
        test: {
          name: "browser",
          include: ["browser/**/*.test.ts"],
          exclude: process.env["WAVESPLAT_NIGHT"] === "1" ? [] : NIGHTLY,
          environment: "node",
          // Machines may be busy.
          testTimeout: 120_000,
          hookTimeout: 120_000,
          fileParallelism: false,
          expect: { poll: { timeout: 20_000 } },
        },
      },
    ],
  },
});
