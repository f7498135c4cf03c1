// Distances and angles, on slices and in space. Their points are world positions, which handles move.

import { inPicture } from "../overlay3d/box.ts";
import { add, length, project, scaled, sub } from "../../input/camera.ts";
import { set } from "../../state/patch.ts";
import type { Camera, Measure, Vec3 } from "../../state/state.ts";
import { WORDS } from "../../words.ts";
import { shortNumber } from "../descriptions.ts";
import { Handle, take } from "../handle.tsx";
import type { CssSize, PartProps } from "../part.ts";
import type { Drawing } from "./drawing.ts";
import { RegionText } from "./region_text.tsx";
import { angleDeg, areaOf, distance, placeOf, worldAt, type SliceFrame } from "./geometry.ts";

const COLOR = "#7df0ff";
/** Room for a text beside its point, and its distance from it, CSS pixels. */
const TEXT_PX = 170;
const TEXT_GAP = 10;
const FILL = "#7df0ff22";

/** Text of a measure: "12.3 mm", "45.0°", "123 mm²". */
export function measured(measure: Measure, unit: string): string {
  if (measure.kind === "area") return `${shortNumber(areaOf(measure.points), 4)} ${unit}²`;
  return measure.kind === "distance" ? `${shortNumber(distance(measure.points), 4)} ${unit}` : `${angleDeg(measure.points).toFixed(1)}°`;
}

interface Place {
  readonly x: number;
  readonly y: number;
}

function Drawn(
  props: PartProps & {
    readonly placed: (point: Vec3) => Place | null;
    readonly moved: (point: Vec3, dx: number, dy: number) => Vec3;
    readonly isNear: (points: readonly Vec3[]) => boolean;
    /** Width of the view, CSS pixels. */
    readonly width: number;
    readonly drawing?: Drawing;
  },
) {
  const { store, welcome, placed, moved, isNear } = props;
  const unit = welcome.volumes[0]?.unit ?? WORDS.slices.units;
  return (
    <g>
      {store.state.view.measures.map((measure, n) => {
        const places = measure.points.map(placed);
        if (!isNear(measure.points) || places.some((place) => place === null)) return null;
        const points = places as Place[];
        const middle = points[measure.kind === "angle" ? 1 : 0] as Place;
        const text = measured(measure, unit);
        const isRegion = measure.kind === "area";
        // Texts near the right edge stand on the left of their point.
        const isAtEdge = middle.x > props.width - TEXT_PX;
        const textX = middle.x + (isAtEdge ? -TEXT_GAP : TEXT_GAP);
        return (
          <g key={n}>
            <path d={pathOf(points, isRegion)} fill={isRegion ? FILL : "none"} stroke={COLOR} stroke-width="1.5" />
            <g text-anchor={isAtEdge ? "end" : "start"}>
              <text x={textX} y={middle.y - 8}>{text}</text>
              {isRegion && <RegionText {...props} measure={measure} x={textX} y={middle.y + 8} />}
            </g>
            {/* A region is moved as a whole, by its first point. */}
            {points.slice(0, isRegion ? 1 : undefined).map(({ x, y }, k) => {
              const pointsNow = (): readonly Vec3[] => store.state.view.measures[n]?.points ?? measure.points;
              const now = (): Vec3 => pointsNow()[k] as Vec3;
              const change = (to: Vec3, gesture: string): void => {
                const way = sub(to, now());
                const next = pointsNow().map((point, p) => (isRegion || p === k ? add(point, way) : point));
                store.change([set(next, "view", "measures", n, "points")], gesture);
              };
              return (
                <Handle
                  key={k}
                  round
                  label={WORDS.measures.point(n + 1, k + 1)}
                  text={text}
                  value={k}
                  range={[0, points.length]}
                  x={x}
                  y={y}
                  color={COLOR}
                  onDrag={(_x, _y, dx, dy) => change(moved(now(), dx, dy), "measure")}
                  onKey={(event) => {
                    const way = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
                    if (event.key === "Delete") {
                      event.preventDefault();
                      store.change([{ op: "remove", path: `/view/measures/${n}` }]);
                    }
                    if (way === undefined) return;
                    take(event);
                    change(moved(now(), way[0] ?? 0, way[1] ?? 0), "key measure");
                  }}
                  onEnd={() => store.settle()}
                />
              );
            })}
          </g>
        );
      })}
      <Pending {...props} />
    </g>
  );
}

const pathOf = (places: readonly Place[], isClosed: boolean): string =>
  `M${places.map(({ x, y }) => `${x} ${y}`).join("L")}${isClosed ? "Z" : ""}`;

/** The measure under way: the points so far, a line from the last one to the pointer with its length, or a line around a region. */
function Pending(props: PartProps & { readonly placed: (point: Vec3) => Place | null; readonly drawing?: Drawing }) {
  const { ui, welcome, placed, drawing } = props;
  const points = [...ui.points, ...(drawing?.to ? [drawing.to] : [])];
  const places = (drawing !== undefined && drawing.outline.length > 0 ? drawing.outline : points).map(placed);
  if (places.length === 0 || places.some((place) => place === null)) return null;
  const known = places as Place[];
  const last = known.at(-1) as Place;
  const kind = ui.tool === "angle" && points.length > 2 ? "angle" : "distance";
  const text = ui.tool !== "area" && points.length > 1 ? measured({ kind, points }, welcome.volumes[0]?.unit ?? WORDS.slices.units) : "";
  return (
    <g class="pending">
      <path d={pathOf(known, false)} fill="none" stroke={COLOR} stroke-width="1.5" stroke-dasharray="5 3" />
      {known.slice(0, ui.points.length).map(({ x, y }, k) => <circle key={k} cx={x} cy={y} r="4" fill={COLOR} stroke="#000" />)}
      {text !== "" && <text x={last.x + 12} y={last.y - 10}>{text}</text>}
    </g>
  );
}

export function MeasuresOnSlice(props: PartProps & { readonly on: SliceFrame; readonly drawing: Drawing }) {
  const { on, store } = props;
  const thickness = Math.max(store.state.view.slices.thickness / 2, on.geometry.pixel * 1.5);
  return (
    <Drawn
      {...props}
      width={on.size.width}
      placed={(point) => placeOf(on, point)}
      moved={(point, dx, dy) => {
        const { x, y } = placeOf(on, point);
        // The point keeps its distance from the slice.
        return add(point, sub(worldAt(on, x + dx, y + dy), worldAt(on, x, y)));
      }}
      isNear={(points) => points.every((point) => placeOf(on, point).away <= thickness)}
    />
  );
}

export function Measures3d(props: PartProps & { readonly camera: Camera; readonly size: CssSize }) {
  const { camera, size } = props;
  return (
    <Drawn
      {...props}
      width={size.width}
      placed={(point) => project(camera, size, point)}
      moved={(point, dx, dy) => add(point, inPicture(camera, size, point, dx, dy))}
      isNear={() => true}
    />
  );
}

/** Whether points make a measure: no two successive ones are the same. */
export const isMeasure = (points: readonly Vec3[]): boolean =>
  points.every((point, n) => n === 0 || length(sub(point, scaled(points[n - 1] as Vec3, 1))) > 0);
