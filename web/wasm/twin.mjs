// The module by the calls of its native twin (`crates/wasm/examples/twin.rs`): a line of JSON for a line of JSON.
// `node twin.mjs MODULE`. `ms` is processor time of the whole process, with what V8 compiles beside the calls.
import { readFileSync, writeFileSync } from "node:fs";
import { createInterface } from "node:readline";
import { crc32 } from "node:zlib";

import { build } from "esbuild";

const entry = new URL("../src/engine/module.ts", import.meta.url).pathname;
const { outputFiles } = await build({ entryPoints: [entry], bundle: true, format: "esm", write: false });
const { VolumeModule } = await import(`data:text/javascript,${encodeURIComponent(outputFiles[0].text)}`);
const compiled = await WebAssembly.compile(readFileSync(process.argv[2]));

let module = await VolumeModule.of(compiled);
const answers = {
  kind: () => module.kind(),
  look: (asked) => module.look(asked),
  scene: ({ document }) => module.scene(document),
  camera: (asked) => module.camera(asked),
  draw: ({ size, quality }) => module.draw(size, quality),
  floats: () => module.floats(),
  slice: (asked) => module.slice(asked),
  samples: () => module.samples(),
  check: ({ kind, text }) => module.check(kind, text),
  patch: ({ document, operations }) => module.patch(document, operations),
};

for await (const line of createInterface({ input: process.stdin })) {
  const call = JSON.parse(line);
  if (!call.ask) module = await VolumeModule.of(compiled);
  const bytes = call.path ? readFileSync(call.path) : Buffer.from(call.hex ?? "", "hex");
  const before = process.cpuUsage();
  let told;
  try {
    const answer = call.ask ? answers[call.ask](call.asked ?? {})
      : call.open ? module.open(call.open, bytes)
      : call.samples ? module.openSamples(call.samples, bytes) : null;
    const { user, system } = process.cpuUsage(before);
    told = { ms: (user + system) / 1000, memory: module.memoryBytes };
    if (ArrayBuffer.isView(answer)) {
      const numbers = new Uint8Array(answer.buffer, answer.byteOffset, answer.byteLength);
      told.crc32 = crc32(numbers);
      if (call.save) writeFileSync(call.save, numbers);
    } else told.text = JSON.stringify(answer);
  } catch (error) {
    told = { error: error.message };
  }
  console.log(JSON.stringify(told));
}
