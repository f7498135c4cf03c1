// Colours of a slice's values: the picture of `wavesplat.slice` within a grey level. No DOM.
// Values are codes of 16 bits, so each layer's colours are a table with a colour for every code.

import { NOTHING, type ColorNode, type SliceValues, type ValueLayer } from "../../engine/slice_values.ts";

/** The fields of the state on which the colours of a slice depend. */
export interface Coloring {
  /** [level, width] of layers of the kind "window". */
  readonly window: readonly [number, number];
  /** Opacity of each layer of the values, 0 where it is hidden. */
  readonly opacities: readonly number[];
}

/** Opacity of a label's inside, as a share of its outline's. Twin of `FILL` in `_scene/slices/layers_on_slices.py`. */
const FILL = 0.4;

/** Colours by code: red, green, blue, 0..255, and opacity, 0..1, in rows of four. */
type Table = Float32Array;

/** The picture, RGBA with 8 bits, into `out`. */
export function colored(values: SliceValues, { window, opacities }: Coloring, out: Uint8ClampedArray): void {
  const tables = values.header.layers.map((layer, n) => tableOf(layer, codesOf(values.layers[n] as Uint16Array), window));
  if (values.layers.length === 1 && values.labels === null && values.header.layers[0]?.kind === "window" && opacities[0] === 1) {
    coloredAlone(values, tables[0] as Table, out);
    return;
  }
  const [red, green, blue] = values.header.background.map((share) => 255 * share) as [number, number, number];
  const n = values.width * values.height;
  const mixed = new Float32Array(3 * n);
  for (let k = 0; k < n; k += 1) {
    mixed[3 * k] = red;
    mixed[3 * k + 1] = green;
    mixed[3 * k + 2] = blue;
  }
  addLights(values, tables, opacities, mixed);
  values.header.layers.forEach((layer, place) => {
    if (layer.kind !== "light") layOver(values.layers[place] as Uint16Array, tables[place] as Table, opacities[place] ?? 0, mixed);
  });
  if (values.labels !== null) layLabels(values, mixed);
  for (let k = 0; k < n; k += 1) {
    out[4 * k] = mixed[3 * k] as number;
    out[4 * k + 1] = mixed[3 * k + 1] as number;
    out[4 * k + 2] = mixed[3 * k + 2] as number;
    out[4 * k + 3] = 255;
  }
}

/** One more than the largest code of a value. */
function codesOf(codes: Uint16Array): number {
  let most = 0;
  for (const code of codes) if (code > most && code !== NOTHING) most = code;
  return most + 1;
}

/** The colours of a layer by code, in ascending order; codes from `n` on have no colour. */
function tableOf(layer: ValueLayer, n: number, [level, width]: readonly [number, number]): Table {
  const table = new Float32Array(4 * n);
  const [origin, scale] = layer.kind === "window" ? [level - width / 2, 1 / width] : [0, 1];
  const colors = curve(layer.color);
  const opacity = layer.opacity === undefined ? null : curve(layer.opacity);
  const most = Math.max(...(layer.opacity ?? [[0, 1]]).map((node) => node[1] as number));
  const lowest = layer.lowest ?? -Infinity;
  for (let code = 0; code < n; code += 1) {
    const value = layer.low + code * layer.step;
    const at = (value - origin) * scale;
    for (let channel = 0; channel < 3; channel += 1) table[4 * code + channel] = 255 * colors(at, channel + 1);
    table[4 * code + 3] = opacity === null ? 1 : value < lowest || most === 0 ? 0 : opacity(value, 1) / most;
  }
  return table;
}

/** A piecewise linear curve; for values that ascend from call to call, whose node is found by going on from the last one. */
function curve(nodes: readonly (ColorNode | readonly number[])[]): (value: number, column: number) => number {
  let place = 0;
  return (value, column) => {
    while (place + 1 < nodes.length && (nodes[place + 1]?.[0] ?? Infinity) <= value) place += 1;
    const [from, to] = [nodes[place] as readonly number[], nodes[place + 1] as readonly number[] | undefined];
    const [x0, y0] = [from[0] as number, from[column] as number];
    if (to === undefined || value <= x0) return y0;
    return y0 + ((value - x0) / ((to[0] as number) - x0)) * ((to[column] as number) - y0);
  };
}

/** The usual picture, a volume alone: whole pixels from a table. */
function coloredAlone({ layers, header }: SliceValues, table: Table, out: Uint8ClampedArray): void {
  const codes = layers[0] as Uint16Array;
  const rounded = new Uint8ClampedArray(table);
  const pixels = new Uint32Array(0x10000);
  const pixel = (red: number, green: number, blue: number): number => (0xff000000 | (blue << 16) | (green << 8) | red) >>> 0;
  for (let code = 0; 4 * code < rounded.length; code += 1) {
    pixels[code] = pixel(rounded[4 * code] as number, rounded[4 * code + 1] as number, rounded[4 * code + 2] as number);
  }
  const [red, green, blue] = header.background.map((share) => Math.round(255 * share)) as [number, number, number];
  pixels[NOTHING] = pixel(red, green, blue);
  const words = new Uint32Array(out.buffer, out.byteOffset, codes.length);
  for (let k = 0; k < codes.length; k += 1) words[k] = pixels[codes[k] as number] as number;
}

/** Adds the light of channels over black, where one of them has values. */
function addLights({ header, layers }: SliceValues, tables: readonly Table[], opacities: readonly number[], mixed: Float32Array): void {
  const lights = header.layers.map((layer, place) => ({ layer, place })).filter(({ layer, place }) => layer.kind === "light" && (opacities[place] ?? 0) > 0);
  if (lights.length === 0) return;
  for (let k = 0; k < mixed.length / 3; k += 1) {
    let [red, green, blue, isKnown] = [0, 0, 0, false];
    for (const { place } of lights) {
      const code = (layers[place] as Uint16Array)[k] as number;
      if (code === NOTHING) continue;
      const [table, opacity] = [tables[place] as Table, opacities[place] as number];
      red += opacity * (table[4 * code] as number);
      green += opacity * (table[4 * code + 1] as number);
      blue += opacity * (table[4 * code + 2] as number);
      isKnown = true;
    }
    if (!isKnown) continue;
    mixed[3 * k] = Math.min(red, 255);
    mixed[3 * k + 1] = Math.min(green, 255);
    mixed[3 * k + 2] = Math.min(blue, 255);
  }
}

function layOver(codes: Uint16Array, table: Table, opacity: number, mixed: Float32Array): void {
  if (opacity === 0) return;
  for (let k = 0; k < codes.length; k += 1) {
    const code = codes[k] as number;
    if (code === NOTHING) continue;
    const alpha = opacity * (table[4 * code + 3] as number);
    if (alpha === 0) continue;
    mix(mixed, 3 * k, table, 4 * code, alpha);
  }
}

/** Lays labels over: their colours, faint inside and full along their outlines. */
function layLabels({ header, labels, width, height }: SliceValues, mixed: Float32Array): void {
  const codes = labels as Uint16Array;
  const colors = new Float32Array((header.labels?.colors ?? []).flatMap(([share, ...rgb]) => [share, ...rgb.map((one) => 255 * one)]));
  for (let row = 0; row < height; row += 1) {
    for (let column = 0; column < width; column += 1) {
      const k = row * width + column;
      const code = codes[k] as number;
      const share = colors[4 * code] as number;
      if (share === 0) continue;
      const isEdge =
        (column > 0 && codes[k - 1] !== code) || (column + 1 < width && codes[k + 1] !== code) ||
        (row > 0 && codes[k - width] !== code) || (row + 1 < height && codes[k + width] !== code);
      mix(mixed, 3 * k, colors, 4 * code + 1, isEdge ? share : FILL * share);
    }
  }
}

/** Mixes a colour of a table into a pixel. */
function mix(mixed: Float32Array, pixel: number, table: Float32Array, place: number, alpha: number): void {
  for (let channel = 0; channel < 3; channel += 1) {
    const below = mixed[pixel + channel] as number;
    mixed[pixel + channel] = below + alpha * ((table[place + channel] as number) - below);
  }
}
