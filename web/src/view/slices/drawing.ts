// Measures drawn on a slice: rulers and angles by a drag or by clicks, regions by a line drawn around them.

import { useRef, useState } from "preact/hooks";

import type { Gesture } from "../../input/gestures.ts";
import { set } from "../../state/patch.ts";
import { MAX_REGION_POINTS, type Vec3 } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import type { PartProps } from "../part.ts";
import { worldAt, type SliceFrame } from "./geometry.ts";

/** Least distance of the points of a drawn line, pixels. */
const POINT_PX = 3;

/** A measure under way: the place of the pointer, to which a line runs from the last point, and a line around a region. */
export interface Drawing {
  readonly to: Vec3 | null;
  readonly outline: readonly Vec3[];
}

interface DrawingTool {
  readonly drawing: Drawing;
  readonly isOn: boolean;
  onTap(on: SliceFrame, x: number, y: number, isDouble: boolean): void;
  /** Takes a drag; `on`: the frame when it began. */
  onDrag(on: SliceFrame, gesture: Gesture & { kind: "drag" }): void;
  onHover(on: SliceFrame | null, place: { readonly x: number; readonly y: number } | null): void;
}

export function useDrawing(props: PartProps): DrawingTool {
  const { ui, store } = props;
  const [to, setTo] = useState<Vec3 | null>(null);
  const [outline, setOutline] = useState<readonly Vec3[]>([]);
  const line = useRef<{ points: Vec3[]; x: number; y: number }>({ points: [], x: 0, y: 0 });

  const drawRegion = (on: SliceFrame, { phase, x, y }: Gesture & { kind: "drag" }): void => {
    const now = line.current;
    if (phase === "start") now.points = [];
    if (phase === "start" || Math.hypot(x - now.x, y - now.y) >= POINT_PX) {
      now.points.push(worldAt(on, x, y));
      [now.x, now.y] = [x, y];
      setOutline([...now.points]);
    }
    if (phase !== "end") return;
    addRegion(props, now.points);
    now.points = [];
    setOutline([]);
  };

  return {
    drawing: { to: ui.points.length > 0 ? to : null, outline },
    // Read when it is asked for: the tool may have been chosen since this was drawn.
    get isOn() {
      return ui.tool === "distance" || ui.tool === "angle" || ui.tool === "area";
    },
    onTap(on, x, y, isDouble) {
      if (ui.tool === "area" && isDouble) {
        closeRegion(props);
        return;
      }
      ui.addPoint(worldAt(on, x, y));
      setTo(null);
    },
    onDrag(on, gesture) {
      if (ui.tool === "area") {
        drawRegion(on, gesture);
        return;
      }
      const point = worldAt(on, gesture.x, gesture.y);
      // A drag is two points, or the next one where some were clicked before.
      if (gesture.phase === "start" ? ui.points.length === 0 : gesture.phase === "end") ui.addPoint(point);
      setTo(gesture.phase === "end" ? null : point);
      if (gesture.phase === "end") store.settle();
    },
    onHover(on, place) {
      if (ui.points.length > 0 || to !== null) setTo(on === null || place === null ? null : worldAt(on, place.x, place.y));
    },
  };
}

/** Ends the region whose corners were clicked. */
export function closeRegion(props: PartProps): void {
  const { ui } = props;
  addRegion(props, ui.points);
  ui.setTool(ui.tool);
}

function addRegion({ store, ui }: PartProps, points: readonly Vec3[]): void {
  const kept = thinned(points, MAX_REGION_POINTS);
  if (kept.length < 3) {
    ui.announce(WORDS.measures.fewPoints);
    return;
  }
  store.change([set({ kind: "area", points: kept }, "view", "measures", "-")]);
}

/** At most `most` of the points, spread evenly. */
function thinned<T>(points: readonly T[], most: number): readonly T[] {
  if (points.length <= most) return points;
  return Array.from({ length: most }, (_, n) => points[Math.floor((n * points.length) / most)] as T);
}
