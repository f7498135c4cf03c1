// Runs a program for wasm32-wasip1 in Node, with its arguments: the runner of that system's tests. It has no files and no
// environment. Node 20's own `node:wasi` breaks Node after programs whose memory has grown by 64 MB.
import { readFileSync, writeSync } from "node:fs";

const args = process.argv.slice(2).map((word) => Buffer.from(`${word}\0`));
let instance;
const memory = () => new DataView(instance.exports.memory.buffer);
const BAD_FILE = 8;

const known = {
  args_sizes_get(count, size) {
    memory().setUint32(count, args.length, true);
    memory().setUint32(size, Buffer.concat(args).length, true);
    return 0;
  },
  args_get(places, bytes) {
    for (const [i, arg] of args.entries()) {
      memory().setUint32(places + 4 * i, bytes, true);
      new Uint8Array(instance.exports.memory.buffer, bytes).set(arg);
      bytes += arg.length;
    }
    return 0;
  },
  environ_sizes_get(count, size) {
    memory().setUint32(count, 0, true);
    memory().setUint32(size, 0, true);
    return 0;
  },
  environ_get: () => 0,
  clock_time_get(_clock, _precision, time) {
    memory().setBigUint64(time, process.hrtime.bigint(), true);
    return 0;
  },
  random_get(place, count) {
    crypto.getRandomValues(new Uint8Array(instance.exports.memory.buffer, place, count));
    return 0;
  },
  fd_write(file, parts, count, written) {
    let total = 0;
    for (let part = parts; part < parts + 8 * count; part += 8) {
      const [start, length] = [memory().getUint32(part, true), memory().getUint32(part + 4, true)];
      writeSync(file, new Uint8Array(instance.exports.memory.buffer, start, length));
      total += length;
    }
    memory().setUint32(written, total, true);
    return 0;
  },
  proc_exit: (status) => process.exit(status),
};

const module = await WebAssembly.compile(readFileSync(process.argv[2]));
const imports = {};
for (const { module: from, name } of WebAssembly.Module.imports(module)) {
  imports[from] ??= {};
  imports[from][name] = known[name] ?? (() => BAD_FILE);
}
instance = await WebAssembly.instantiate(module, imports);
instance.exports._start();
