// The control of the first light's direction: a ball seen from the front, on which the bright spot is moved.

import { useId, useRef } from "preact/hooks";
import { vector } from "../../input/camera.ts";
import type { Vec3 } from "../../state/state.ts";
import { NumberBox } from "../fields.tsx";
import { anglesOf, directionOf } from "./looks.ts";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.lightPad;
const SIZE_PX = 132;
const RADIUS_PX = 60;

interface LightPadProps {
  readonly direction: Vec3;
  /** Returns the direction as it is now: keys can come more often than the page is drawn. */
  latest(): Vec3;
  onDirection(direction: Vec3): void;
  onSettle(): void;
}

export function LightPad({ direction, latest, onDirection, onSettle }: LightPadProps) {
  const isDragging = useRef(false);
  const shade = useId();
  const [azimuth, elevation] = anglesOf(direction);
  const length = Math.hypot(...direction) || 1;
  const spot = { x: (direction[0] / length) * RADIUS_PX, y: (-direction[1] / length) * RADIUS_PX };
  const set = (direction: Vec3): void =>
    onDirection(vector((axis) => Number(direction[axis].toFixed(4))));
  const turn = (by: number, up: number): void => {
    const [a, e] = anglesOf(latest());
    set(directionOf([wrapped(a + by), Math.max(-90, Math.min(90, e + up))]));
  };
  const point = (event: PointerEvent & { readonly currentTarget: SVGSVGElement }): void => {
    const box = event.currentTarget.getBoundingClientRect();
    const x = (event.clientX - box.left - SIZE_PX / 2) / RADIUS_PX;
    const y = -(event.clientY - box.top - SIZE_PX / 2) / RADIUS_PX;
    const share = Math.max(1, Math.hypot(x, y));
    const [a, b] = [x / share, y / share];
    const front = Math.sqrt(Math.max(0, 1 - a * a - b * b));
    set([a, b, front]);
  };
  const stop = (): void => {
    if (isDragging.current) onSettle();
    isDragging.current = false;
  };
  return (
    <div class="row look-nowrap">
      <svg
        class="look-pad"
        width={SIZE_PX}
        height={SIZE_PX}
        viewBox={`${-SIZE_PX / 2} ${-SIZE_PX / 2} ${SIZE_PX} ${SIZE_PX}`}
        role="slider"
        tabindex={0}
        aria-label={TEXT.pad}
        aria-valuemin={-180}
        aria-valuemax={180}
        aria-valuenow={Math.round(azimuth)}
        aria-valuetext={TEXT.text(azimuth, elevation)}
        aria-description={TEXT.keys}
        onPointerDown={(event) => {
          event.currentTarget.setPointerCapture(event.pointerId);
          isDragging.current = true;
          point(event);
        }}
        onPointerMove={(event) => {
          if (isDragging.current) point(event);
        }}
        onLostPointerCapture={stop}
        onKeyUp={onSettle}
        onKeyDown={(event) => {
          const steps: Partial<Record<string, readonly [number, number]>> = {
            ArrowLeft: [-2, 0],
            ArrowRight: [2, 0],
            ArrowUp: [0, 2],
            ArrowDown: [0, -2],
            PageUp: [0, 15],
            PageDown: [0, -15],
            Home: [-15, 0],
            End: [15, 0],
          };
          const step = steps[event.key];
          if (step === undefined) return;
          event.preventDefault();
          event.stopPropagation();
          turn(...step);
        }}
      >
        <defs>
          <radialGradient id={shade} cx={spot.x} cy={spot.y} r={1.5 * RADIUS_PX} gradientUnits="userSpaceOnUse">
            <stop offset="0" class={direction[2] < 0 ? "look-shade-behind" : "look-shade-lit"} />
            <stop offset="0.55" class="look-shade-half" />
            <stop offset="1" class="look-shade-dark" />
          </radialGradient>
        </defs>
        <circle class="look-ball" r={RADIUS_PX} fill={`url(#${shade})`} />
        {/* Hollow: behind the ball. */}
        <circle class="look-spot" cx={spot.x} cy={spot.y} r={6} data-behind={direction[2] < 0} />
      </svg>
      <div class="look-grow look-angles">
        <Angle
          label={TEXT.azimuth}
          value={azimuth}
          most={180}
          onInput={(angle) => set(directionOf([angle, elevation]))}
          onSettle={onSettle}
        />
        <Angle
          label={TEXT.elevation}
          value={elevation}
          most={90}
          onInput={(angle) => set(directionOf([azimuth, angle]))}
          onSettle={onSettle}
        />
      </div>
    </div>
  );
}

function Angle(props: { label: string; value: number; most: number; onInput(angle: number): void; onSettle(): void }) {
  const { label, value, most, onInput, onSettle } = props;
  return (
    <div class="row">
      <span aria-hidden="true">{label}</span>
      <NumberBox
        label={label}
        unit={TEXT.unit}
        min={-most}
        max={most}
        step={1}
        value={Math.round(10 * value) / 10}
        onInput={onInput}
        onSettle={onSettle}
      />
      <span aria-hidden="true">{TEXT.degrees}</span>
    </div>
  );
}

/** The angle in the range from -180 to 180 degrees. */
function wrapped(degrees: number): number {
  return ((((degrees + 180) % 360) + 360) % 360) - 180;
}
