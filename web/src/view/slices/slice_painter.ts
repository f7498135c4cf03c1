// Draws the values of a slice into its canvas, again whenever the state gives them other colours.

import { decodedValues, NOTHING, type SliceValues } from "../../engine/slice_values.ts";
import type { Frame } from "../../engine/engine.ts";
import type { ViewerState } from "../../state/state.ts";
import { colored, type Coloring } from "./slice_colors.ts";

export class SlicePainter {
  /** The frame whose values these are, and the canvas they are in. */
  frame: Frame | null = null;
  private values: SliceValues | null = null;
  private canvas: HTMLCanvasElement | null = null;
  private image: ImageData | null = null;
  private coloring = "";

  /** Takes a frame of values and draws it. */
  async take(frame: Frame, canvas: HTMLCanvasElement, state: ViewerState): Promise<void> {
    if (frame.values === undefined) return;
    this.values = await decodedValues(frame.values, frame.width, frame.height, frame.bytes);
    this.frame = frame;
    this.canvas = canvas;
    this.coloring = "";
    if (canvas.width !== frame.width) canvas.width = frame.width;
    if (canvas.height !== frame.height) canvas.height = frame.height;
    this.image = new ImageData(frame.width, frame.height);
    this.draw(state);
  }

  /** Draws the values again, if the state gives them other colours than are in the canvas. */
  draw(state: ViewerState): void {
    const { values, canvas, image, frame } = this;
    if (values === null || canvas === null || image === null || frame === null) return;
    const coloring = coloringOf(values, frame, state);
    const key = JSON.stringify(coloring);
    if (key === this.coloring) return;
    this.coloring = key;
    colored(values, coloring, image.data);
    canvas.getContext("2d")?.putImageData(image, 0, 0);
    // Counted for tests.
    canvas.dataset["painted"] = String(Number(canvas.dataset["painted"] ?? 0) + 1);
  }

  /** Values of each layer, by its number in the state, and name of the label, at a pixel; null outside of them. */
  at(column: number, row: number): { values: Map<number, number | null>; label: string | null } | null {
    const { values } = this;
    if (values === null || column < 0 || row < 0 || column >= values.width || row >= values.height) return null;
    const k = row * values.width + column;
    const found = values.header.layers.map(({ layer, low, step }, n): [number, number | null] => {
      const code = values.layers[n]?.[k] ?? NOTHING;
      return [layer, code === NOTHING ? null : low + code * step];
    });
    return { values: new Map(found), label: values.header.labels?.names[values.labels?.[k] ?? NOTHING] ?? null };
  }
}

function coloringOf({ header }: SliceValues, frame: Frame, state: ViewerState): Coloring {
  return {
    window: state.view.slices.window ?? frame.slice?.window ?? [0, 1],
    opacities: header.layers.map(({ layer }) => {
      const { visible, opacity } = state.layers[layer] ?? { visible: false, opacity: 0 };
      return visible ? opacity : 0;
    }),
  };
}
