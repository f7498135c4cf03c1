// JSON Patch (RFC 6902), the part that is needed: `add`, `replace` and `remove`. Merge patches (RFC 7386) cannot set null,
// and replace lists as a whole. `python/wavesplat/_viewer/patches.py` is the twin.

export type Json = null | boolean | number | string | readonly Json[] | { readonly [name: string]: Json };

export type Operation =
  | { readonly op: "add" | "replace"; readonly path: string; readonly value: unknown }
  | { readonly op: "remove"; readonly path: string };
