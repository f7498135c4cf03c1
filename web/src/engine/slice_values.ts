// The values of a slice as the session sends them; `python/wavesplat/_viewer/slices/slice_values.py` is the twin, and says how.

/** A node of a colour curve: value, red, green, blue; colours 0..1. */
export type ColorNode = readonly [number, number, number, number];
/** A node of an opacity curve: value, opacity 0..1. */
export type OpacityNode = readonly [number, number];

/** A layer's values, `low + code * step`, and how they become colours. */
export interface ValueLayer {
  /** Its place among the layers of the state, which has its opacity and whether it is visible. */
  readonly layer: number;
  /** By the window; as light that is added; or over the layers before. */
  readonly kind: "window" | "light" | "over";
  readonly low: number;
  readonly step: number;
  /** Of a window: at 0 is its lower end, at 1 its upper end; else sample values. */
  readonly color: readonly ColorNode[];
  readonly opacity?: readonly OpacityNode[];
  /** Least value that shows; null: all do. */
  readonly lowest?: number | null;
}

export interface SliceValuesHeader {
  readonly layers: readonly ValueLayer[];
  /** Opacity of the outline, red, green and blue, and name, by code; names are null where nothing is marked. */
  readonly labels: { readonly colors: readonly ColorNode[]; readonly names: readonly (string | null)[] } | null;
  readonly background: readonly [number, number, number];
}

/** Code of pixels without a value. */
export const NOTHING = 0xffff;

export interface SliceValues {
  readonly header: SliceValuesHeader;
  readonly width: number;
  readonly height: number;
  /** Codes of each layer of the header, row by row. */
  readonly layers: readonly Uint16Array[];
  readonly labels: Uint16Array | null;
}

/** Decodes the payload of a frame of values. */
export async function decodedValues(
  header: SliceValuesHeader,
  width: number,
  height: number,
  payload: Uint8Array<ArrayBuffer>,
): Promise<SliceValues> {
  const stream = new Blob([payload]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const n = width * height;
  const nPlanes = header.layers.length + (header.labels === null ? 0 : 1);
  if (bytes.length !== 2 * n * nPlanes) {
    throw new Error(`a slice of ${width} x ${height} pixels and ${nPlanes} planes has ${bytes.length} bytes`);
  }
  const planes = Array.from({ length: nPlanes }, (_, plane) => summed(bytes.subarray(2 * n * plane, 2 * n * (plane + 1)), width));
  return {
    header,
    width,
    height,
    layers: planes.slice(0, header.layers.length),
    labels: header.labels === null ? null : (planes.at(-1) ?? null),
  };
}

/** Codes from their differences along rows, low bytes before high bytes. */
function summed(bytes: Uint8Array, width: number): Uint16Array {
  const n = bytes.length / 2;
  const codes = new Uint16Array(n);
  for (let start = 0; start < n; start += width) {
    let code = 0;
    for (let k = start; k < start + width; k += 1) {
      code = (code + (bytes[k] as number) + ((bytes[n + k] as number) << 8)) & 0xffff;
      codes[k] = code;
    }
  }
  return codes;
}
