// Slices by numbers: crosshair, thickness, window and level, zoom, tilt.

import { add, scaled, withComponent } from "../input/camera.ts";
import { set } from "../state/patch.ts";
import { PANES, SLICE_COLORS } from "../state/state.ts";
import { Choice, NumberField } from "./fields.tsx";
import { WORDS } from "../words.ts";
import { decimalsOf } from "./descriptions.ts";
import type { PartProps } from "./part.ts";
import { pick } from "./scene_view.tsx";
import { crosshairAt, fitted, zoomedAbout, ZOOMS } from "./slices/moves.ts";
import { chooseWindow, namedWindows } from "./slices/window_menu.tsx";

const TEXT = WORDS.slices;
const AXES = ["x", "y", "z"] as const;

export function SlicesPanel(props: PartProps) {
  const { store, welcome, ui } = props;
  const { slices } = store.state.view;
  const [lower, upper] = welcome.bounds;
  const info = welcome.volumes[0];
  const unit = info?.unit ?? TEXT.units;
  const settle = (): void => store.settle();
  const automatic = PANES.map((pane) => ui.frames[pane]?.slice?.window).find(Boolean);
  const robust = info?.robust_range ?? [0, 1];
  const [level, width] = slices.window ?? automatic ?? [(robust[0] + robust[1]) / 2, robust[1] - robust[0]];
  const span = (info?.range[1] ?? 1) - (info?.range[0] ?? 0) || 1;
  const setWindow = (next: readonly [number, number], gesture?: string): void =>
    store.change([set(next, "view", "slices", "window")], gesture);
  const names = namedWindows(props);
  const colors = PANES.map((pane) => ui.frames[pane]?.slice?.colors).find(Boolean);
  const named = names.find(([, [l, w]]) => slices.window?.[0] === l && slices.window[1] === w)?.[0];
  return (
    <>
      <fieldset>
        <legend>{TEXT.crosshairs}</legend>
        {AXES.map((name, axis) => (
          <NumberField
            key={name}
            decimals={decimalsOf(info?.spacing[axis] ?? 1)}
            label={TEXT.crosshair(name)}
            shown={name}
            unit={unit}
            value={slices.crosshair[axis] ?? 0}
            min={lower[axis] ?? 0}
            max={upper[axis] ?? 1}
            onInput={(value) => {
              const next = withComponent(slices.crosshair, axis, value);
              store.change([set(next, "view", "slices", "crosshair")], `crosshair ${name}`);
            }}
            onSettle={settle}
          />
        ))}
        <div class="row">
          <button
            class="button"
            onClick={() => {
              const middle = scaled(add(lower, upper), 0.5);
              store.change(crosshairAt(store.state, middle));
            }}
          >
            {TEXT.toMiddle}
          </button>
          <button class="button" onClick={() => void pick(props, 0.5, 0.5, ui.frames["3d"] ?? { width: 512, height: 512 })}>{TEXT.toSurface}</button>
        </div>
      </fieldset>
      <NumberField
        label={TEXT.thickness}
        unit={unit}
        value={slices.thickness}
        min={0}
        max={Math.max(...AXES.map((_, a) => (upper[a] ?? 0) - (lower[a] ?? 0))) / 4}
        onInput={(value) => store.change([set(Math.max(0, value), "view", "slices", "thickness")], "thickness")}
        onSettle={settle}
      />
      <Choice
        label={TEXT.slabOf}
        value={slices.slab}
        options={Object.entries(TEXT.slabs)}
        onChoose={(value) => store.change([set(value, "view", "slices", "slab")])}
      />
      {names.length > 0 && (
        <Choice
          label={TEXT.window}
          value={named ?? (slices.window === undefined ? "automatic" : "own")}
          options={[
            ["automatic", TEXT.automatic],
            ...names.map(([name, [l, w]]) => [name, `${name} (${l}, ${w})`] as const),
            ...(named === undefined && slices.window !== undefined ? [["own", TEXT.own] as const] : []),
          ]}
          onChoose={(value) => chooseWindow(props, value)}
        />
      )}
      <Choice
        label={TEXT.colors}
        value={slices.colors ?? colors ?? "gray"}
        options={SLICE_COLORS.map((name) => [name, TEXT.colorNames[name]] as const)}
        onChoose={(value) => chooseWindow(props, value)}
      />
      <NumberField
        label={TEXT.level}
        unit={info?.value_unit ?? ""}
        value={level}
        min={info?.range[0] ?? 0}
        max={info?.range[1] ?? 1}
        onInput={(value) => setWindow([value, width], "level")}
        onSettle={settle}
      />
      <NumberField
        label={TEXT.width}
        unit={info?.value_unit ?? ""}
        value={width}
        min={span * 1e-4}
        max={span}
        onInput={(value) => setWindow([level, Math.max(value, span * 1e-6)], "width")}
        onSettle={settle}
      />
      <NumberField
        label={TEXT.zoom}
        value={slices.zoom}
        min={ZOOMS[0]}
        max={ZOOMS[1]}
        onInput={(value) => store.change(zoomedAbout(store.state, welcome, slices.crosshair, value / slices.zoom), "zoom")}
        onSettle={settle}
      />
      <div class="row">
        <button class="button" disabled={slices.center === undefined && slices.zoom === 1} onClick={() => store.change(fitted(store.state))}>
          {TEXT.whole}
        </button>
        <button
          class="button"
          disabled={slices.window === undefined && slices.colors === undefined}
          onClick={() => chooseWindow(props, "automatic")}
        >
          {TEXT.automaticWindow}
        </button>
        <button
          class="button"
          disabled={slices.normals === undefined}
          onClick={() => store.change([{ op: "remove", path: "/view/slices/normals" }])}
        >
          {TEXT.resetTilt}
        </button>
      </div>
    </>
  );
}
