// Bundles the viewer into the Python package: readable, not minified, the same bytes wherever it is built.
// `node build.mjs --size` prints its sizes, and fails if it is larger than the limit when compressed, which is how it travels;
// `--check` fails if what is committed is not what is built.
import { build, transform } from "esbuild";
import { gzipSync } from "node:zlib";
import { readFile, writeFile } from "node:fs/promises";

const OUT = new URL("../python/wavesplat/_viewer/client/viewer.js", import.meta.url);
const MAX_COMPRESSED = 80_000;

const options = {
  entryPoints: [new URL("src/viewer.ts", import.meta.url).pathname],
  bundle: true,
  format: "esm",
  target: "es2022",
  charset: "utf8",
  loader: { ".css": "text" },
  tsconfigRaw: { compilerOptions: { jsx: "react", jsxFactory: "h", jsxFragmentFactory: "Fragment", target: "ES2022" } },
  inject: [new URL("src/jsx.ts", import.meta.url).pathname],
  legalComments: "inline",
  write: false,
};
const HEAD = "// Built from web/ by `make web`; change that, not this.\n";

const readable = await build({ ...options, minify: false });
const text = HEAD + readable.outputFiles[0].text;
// To the bundler, style sheets are texts, which it would not minify.
const smallStyles = {
  name: "small styles",
  setup: ({ onLoad }) =>
    onLoad({ filter: /\.css$/ }, async ({ path }) => {
      const { code } = await transform(await readFile(path, "utf8"), { loader: "css", minify: true });
      return { contents: code, loader: "text" };
    }),
};
const small = (await build({ ...options, minify: true, plugins: [smallStyles] })).outputFiles[0].contents;
const compressed = gzipSync(small, { level: 9 }).length;

if (process.argv.includes("--size")) {
  console.log(`viewer.js: ${text.length} bytes, ${small.length} minified, ${compressed} compressed`);
  if (compressed > MAX_COMPRESSED) {
    console.error(`too large: at most ${MAX_COMPRESSED} compressed`);
    process.exit(1);
  }
} else if (process.argv.includes("--check")) {
  if ((await readFile(OUT, "utf8")) !== text) {
    console.error("python/wavesplat/_viewer/client/viewer.js is not what web/ builds; run make web, and commit it");
    process.exit(1);
  }
} else {
  await writeFile(OUT, text);
}
