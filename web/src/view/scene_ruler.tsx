// Measures drawn over the 3-D picture: a line follows the pointer, and its ends are points of what is seen there.

import { useRef, useState } from "preact/hooks";

import type { Gesture } from "../input/gestures.ts";
import type { CssSize, PartProps } from "./part.ts";
import { pick } from "./scene_view.tsx";

/** The line under the pointer, in CSS pixels of the view. */
interface Line {
  readonly x0: number;
  readonly y0: number;
  readonly x1: number;
  readonly y1: number;
}

interface Ruler {
  readonly line: Line | null;
  onDrag(gesture: Gesture & { kind: "drag" }, size: CssSize): void;
}

export function useRuler(props: PartProps): Ruler {
  const { ui } = props;
  const [line, setLine] = useState<Line | null>(null);
  const now = useRef<Line | null>(null);
  const show = (next: Line | null): void => {
    now.current = next;
    setLine(next);
  };
  const measure = async ({ x0, y0, x1, y1 }: Line, size: CssSize): Promise<void> => {
    // A drag is two points, or the next one where some were clicked before.
    const isBegun = ui.points.length > 0 || (await pick(props, x0 / size.width, y0 / size.height, size));
    if (isBegun) await pick(props, x1 / size.width, y1 / size.height, size);
  };
  return {
    line,
    onDrag({ phase, x, y }, size) {
      if (phase === "start") show({ x0: x, y0: y, x1: x, y1: y });
      else if (now.current !== null && phase === "move") show({ ...now.current, x1: x, y1: y });
      else if (now.current !== null) {
        const drawn = now.current;
        show(null);
        void measure(drawn, size);
      }
    },
  };
}

export function RulerLine({ line: { x0, y0, x1, y1 } }: { readonly line: Line }) {
  return (
    <svg class="over" aria-hidden="true">
      <path d={`M${x0} ${y0}L${x1} ${y1}`} stroke="#000" stroke-width="3.5" opacity="0.6" />
      <path d={`M${x0} ${y0}L${x1} ${y1}`} stroke="#7df0ff" stroke-width="1.5" />
    </svg>
  );
}
