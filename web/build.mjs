// Bundles the viewer into the Python package, minified, the same bytes wherever it is built:
//   client/widget.js   one file, which notebooks load
//   client/page/       the page's script and the chunks that it loads later, named by the hashes of their contents
//   client/index.html  the page, which names its script
//   client/LICENSES-OF-OTHERS.txt  the terms of the packages that these hold
// `node build.mjs --size` prints what travels, compressed, and fails where it is more than the limits; `--check` fails if
// what is committed is not what is built.
import { build, transform } from "esbuild";
import { gzipSync } from "node:zlib";
import { mkdir, readdir, readFile, rm, writeFile } from "node:fs/promises";

const CLIENT = new URL("../python/wavesplat/_viewer/client/", import.meta.url);
/** Largest compressed bytes: of the scripts that the first view waits for, of all scripts of the page, and of the widget. */
const LIMITS = { first: 60_000, page: 100_000, widget: 100_000 };
const HEAD = "// Built from web/ by `make web`; change that, not this.";

// To the bundler, style sheets are texts, which it would not minify.
const smallStyles = {
  name: "small styles",
  setup: ({ onLoad }) =>
    onLoad({ filter: /\.css$/ }, async ({ path }) => {
      const { code } = await transform(await readFile(path, "utf8"), { loader: "css", minify: true });
      return { contents: code, loader: "text" };
    }),
};

const options = {
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  charset: "utf8",
  tsconfigRaw: { compilerOptions: { jsx: "react", jsxFactory: "h", jsxFragmentFactory: "Fragment", target: "ES2022" } },
  inject: [new URL("src/jsx.ts", import.meta.url).pathname],
  legalComments: "inline",
  banner: { js: HEAD },
  plugins: [smallStyles],
  write: false,
  metafile: true,
  absWorkingDir: new URL(".", import.meta.url).pathname,
  // The bundler orders modules by their paths: packages behind a link would get other names than those beside.
  preserveSymlinks: true,
};

const widget = await build({ ...options, entryPoints: ["src/widget.ts"], outfile: "widget.js" });
const page = await build({
  ...options, entryPoints: ["src/page.ts"], splitting: true, outdir: "page", entryNames: "[name]-[hash]", chunkNames: "[name]-[hash]",
});

const outputs = Object.entries(page.metafile.outputs);
const entry = outputs.find(([, { entryPoint }]) => entryPoint === "src/page.ts")[0];
/** The scripts that the page loads before it shows anything: the entry and what it imports, not what it imports later. */
function first() {
  const found = new Set();
  const add = (name) => {
    if (found.has(name)) return;
    found.add(name);
    page.metafile.outputs[name].imports.filter(({ kind }) => kind === "import-statement").forEach(({ path }) => add(path));
  };
  add(entry);
  return [...found];
}

const index = `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="dark light">
<title>Wavesplat</title>
<link rel="icon" href="/favicon.svg">
${first().slice(1).map((name) => `<link rel="modulepreload" href="/${name.replace("page/", "")}">\n`).join("")}<script type="module" src="/${entry.replace("page/", "")}"></script>
</head>
<body>
<noscript>The viewer needs JavaScript.</noscript>
<div id="viewer"></div>
</body>
</html>
`;
/** The terms of the packages that the scripts hold, which they ask to be given on. */
async function licences() {
  const inputs = [widget, page].flatMap(({ metafile }) => Object.keys(metafile.inputs));
  const names = new Set(inputs.flatMap((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(path)?.[1] ?? []));
  const texts = [...names].sort().map(async (name) => {
    const folder = new URL(`node_modules/${name}/`, import.meta.url);
    const { version, license } = JSON.parse(await readFile(new URL("package.json", folder), "utf8"));
    return `${name} ${version} (${license})\n\n${await readFile(new URL("LICENSE", folder), "utf8")}`;
  });
  return (await Promise.all(texts)).join("\n");
}

/** Contents by their names in the client's folder. */
const built = new Map([
  ["index.html", index],
  ["LICENSES-OF-OTHERS.txt", await licences()],
  ["widget.js", widget.outputFiles[0].text],
  ...page.outputFiles.map(({ path, text }) => [path.slice(path.lastIndexOf("page/")), text]),
]);

const compressed = (names) => names.reduce((total, name) => total + gzipSync(built.get(name), { level: 9 }).length, 0);

if (process.argv.includes("--size")) {
  const sizes = { first: compressed(first()), page: compressed(outputs.map(([name]) => name)), widget: compressed(["widget.js"]) };
  const names = { first: "first view of the page", page: "page in all", widget: "widget" };
  for (const [name, size] of Object.entries(sizes)) console.log(`${names[name]}: ${size} bytes compressed, at most ${LIMITS[name]}`);
  if (Object.keys(sizes).some((name) => sizes[name] > LIMITS[name])) {
    console.error("too large: load a part later (src/view/later.tsx), or take one out");
    process.exit(1);
  }
} else if (process.argv.includes("--check")) {
  const found = await readdir(new URL("page/", CLIENT)).catch(() => []);
  const old = found.filter((name) => !built.has(`page/${name}`));
  const other = [];
  for (const [name, text] of built) if ((await readFile(new URL(name, CLIENT), "utf8").catch(() => "")) !== text) other.push(name);
  if (old.length + other.length > 0) {
    console.error(`python/wavesplat/_viewer/client is not what web/ builds (${[...old, ...other].join(", ")}); run make web, and commit it`);
    process.exit(1);
  }
} else {
  await rm(new URL("page/", CLIENT), { recursive: true, force: true });
  await mkdir(new URL("page/", CLIENT), { recursive: true });
  for (const [name, text] of built) await writeFile(new URL(name, CLIENT), text);
}
