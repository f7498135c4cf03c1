// The panel of light and projection: one ball and three moods, all fields behind them; the operator; the kernel.

import { useRef } from "preact/hooks";
import type { Problem } from "../../engine/engine.ts";
import { set } from "../../state/patch.ts";
import type { Light, Shading, Vec3 } from "../../state/state.ts";
import type { PartProps } from "../part.ts";
import {
  DIMMING,
  compositeNamed,
  numberOf,
  SHADED,
  withNumber,
} from "./composites.ts";
import { compositeName } from "../descriptions.ts";
import { rounded } from "./axis.ts";
import { surfaceValue } from "./curves.ts";
import { Button, Switch, ColorField, Choice, NumberField } from "../fields.tsx";
import { LayerChoice } from "./layer_choice.tsx";
import { LightPad } from "./light_pad.tsx";
import { inMood, moodOf, MOODS, type MoodName } from "./moods.ts";
import { DEFAULT_LIGHTS, DEFAULT_SHADING, hexColor, lookAsChosen, namedColor, shadingOf } from "./looks.ts";
import { PANEL_WORDS } from "../../panel_words.ts";

const TEXT = PANEL_WORDS.lightPanel;
/** Least and largest standard deviation of gradient smoothing, voxels, as `wavesplat.Shading` takes them. */
const SMOOTHING: readonly [number, number] = [0.5, 1.25];
const SMOOTH = 0.8;
/** Attenuation of water at 60 keV per Hounsfield unit and millimetre, the default of `wavesplat.XRay`. */
const WATER = 2.059e-5;

export function LightPanel(props: PartProps) {
  return (
    <div class="look-panel">
      <LayerChoice {...props} />
      <LightFields {...props} />
      <Operator {...props} />
      <Rest {...props} />
    </div>
  );
}

function Operator({ store, ui, welcome }: PartProps) {
  const { render, layers, labels } = store.state;
  const volume = welcome.volumes[ui.layer];
  const name = compositeName(render.composite);
  const isOverOnly = layers.filter((layer) => layer.visible).length > 1 || labels !== null;
  const look = layers[ui.layer]?.look;
  const [low, high] = volume?.range ?? [0, 1];
  const surface = (): number => {
    const usual = volume?.robust_range ?? [0, 1];
    return look === undefined ? (low + high) / 2 : rounded(surfaceValue(look.transfer_function, usual), high - low);
  };
  const number = (field: string, value: number | null, gesture?: string): void =>
    store.change([set(withNumber(render.composite, field, value), "render", "composite")], gesture);
  const slider = (
    label: string,
    field: string,
    value: number,
    min: number,
    max: number,
    unit = "",
    beyond: object = {},
  ) => (
    <NumberField
      isBounded
      label={label}
      unit={unit}
      min={min}
      max={max}
      value={value}
      {...beyond}
      onInput={(next) => number(field, next, `${name} ${field}`)}
      onSettle={() => store.settle()}
    />
  );
  /** A field for a parameter that the program chooses until it is set. */
  const optional = (label: string, field: string, first: number, min: number, max: number, unit = "") => {
    const value = numberOf(render.composite, field);
    return (
      <>
        <Switch
          label={TEXT.automatic(label)}
          on={value === null}
          onToggle={(on) => number(field, on ? null : first)}
        />
        {value !== null && slider(label, field, value, min, max, unit, { least: -Infinity, most: Infinity })}
      </>
    );
  };
  const unit = volume?.value_unit ?? "";
  // Little light passes: exp(-3) of it, 5 %, along the longest side through the largest value.
  const attenuation = unit === "HU" ? WATER : 3 / ((high - low || 1) * longestSide(volume?.bounds));
  return (
    <>
      <Choice
        label={TEXT.composite}
        value={name}
        options={welcome.composites.map(
          (value) => [value, PANEL_WORDS.composites[value] ?? value, isOverOnly && value !== "over" && value !== name] as const,
        )}
        onChoose={(value) => store.change([set(compositeNamed(value, surface()), "render", "composite")])}
      />
      {isOverOnly && <p class="dim look-small">{TEXT.overOnly}</p>}
      {name === "first-hit" &&
        slider(TEXT.iso, "iso_value", numberOf(render.composite, "iso_value") ?? surface(), low, high, unit)}
      {name === "local-maximum" && optional(TEXT.threshold, "threshold", surface(), low, high, unit)}
      {name === "depth-shaded-maximum" &&
        slider(TEXT.strength, "strength", numberOf(render.composite, "strength") ?? DIMMING, 0, 1)}
      {name === "x-ray" && optional(TEXT.clear, "clear", low, low, high, unit)}
      {name === "x-ray" && optional(TEXT.attenuation, "attenuation", attenuation, attenuation / 100, 5 * attenuation)}
    </>
  );
}

function LightFields({ store, engine, ui, welcome }: PartProps) {
  const { state } = store;
  const { shading, path } = shadingOf(state, ui.layer);
  const look = state.layers[ui.layer]?.look;
  const kept = useRef<Shading | null>(null);
  if (shading !== null) kept.current = shading;
  const name = compositeName(state.render.composite);
  const isShaded = SHADED.includes(name);

  const reset = async (): Promise<void> => {
    try {
      const first = look === undefined ? null : await lookAsChosen(engine, welcome, ui.layer, look.name);
      const operations = state.shading === "look" ? [] : [set("look", "shading")];
      if (first !== null) store.change([...operations, set(first.shading, "layers", ui.layer, "look", "shading")]);
    } catch (problem) {
      ui.problem(problem as Problem);
    }
  };
  const toggle = (on: boolean): void => store.change([set(on ? (kept.current ?? DEFAULT_SHADING) : null, ...path)]);
  const resetButton = <Button onClick={() => void reset()}>{TEXT.reset}</Button>;
  const mood = moodOf(shading);
  const head = (
    <>
      <div class="row look-moods" role="group" aria-label={PANEL_WORDS.moods.title}>
        {(Object.keys(MOODS) as MoodName[]).map((one) => (
          <Button key={one} pressed={one === mood} onClick={() => store.change([set(inMood(shading, one), ...path)])}>
            {PANEL_WORDS.moods[one]}
          </Button>
        ))}
      </div>
      <Switch label={TEXT.shading} on={shading !== null} onToggle={toggle} />
      {!isShaded && <p class="dim look-small">{TEXT.unshaded}</p>}
      {state.shading !== "look" && state.layers.length > 1 && <p class="dim look-small">{TEXT.all}</p>}
    </>
  );
  if (shading === null) {
    return (
      <>
        {head}
        {resetButton}
      </>
    );
  }

  const change = (field: keyof Shading, value: unknown): void =>
    store.change([set(value, ...path, field)], `light ${field}`);
  const done = (): void => store.settle();
  const slider = (label: string, field: keyof Shading, min: number, max: number, more: object = {}) => (
    <NumberField
      isBounded
      key={field}
      label={label}
      min={min}
      max={max}
      value={(shading[field] as number | null) ?? min}
      {...more}
      onInput={(value) => change(field, value)}
      onSettle={done}
    />
  );
  const lights = lightsOf(shading);
  const first = lights[0] as Light;
  const latest = (): Vec3 => (lightsOf(shadingOf(store.state, ui.layer).shading ?? shading)[0] ?? first).direction;
  const setDirection = (direction: Vec3): void => change("lights", [{ ...first, direction }, ...lights.slice(1)]);
  const isSmooth = shading.gradient_smoothing > 0;
  const side = longestSide(welcome.volumes[ui.layer]?.bounds);
  return (
    <>
      <LightPad direction={first.direction} latest={latest} onDirection={setDirection} onSettle={done} />
      {first["frame"] === "world" && <p class="dim look-small">{TEXT.world}</p>}
      {head}
      <details class="look-details">
        <summary>{PANEL_WORDS.moods.all}</summary>
        {slider(TEXT.exposure, "exposure", 0, 3, { most: 100, step: 0.01 })}
        {slider(TEXT.ambient, "ambient", 0, 1, { most: 10, step: 0.01 })}
        {slider(TEXT.diffuse, "diffuse", 0, 2, { most: 10, step: 0.01 })}
        {slider(TEXT.specular, "specular", 0, 1, { most: 10, step: 0.01 })}
        {slider(TEXT.power, "specular_power", 1, 100, { most: 1000, step: 1 })}
        {slider(TEXT.shoulder, "shoulder", 0, 1, { step: 0.01 })}
        {slider(TEXT.occlusion, "ambient_occlusion", 0, 1, { step: 0.01 })}
        {shading.ambient_occlusion > 0 && (
          <>
            <Switch
              label={TEXT.automatic(TEXT.reach)}
              on={shading.occlusion_radius === null}
              onToggle={(on) => store.change([set(on ? null : side / 10, ...path, "occlusion_radius")])}
            />
            {shading.occlusion_radius !== null &&
              slider(TEXT.radius, "occlusion_radius", side / 500, side / 2, {
                unit: welcome.volumes[ui.layer]?.unit ?? "",
              })}
          </>
        )}
        {slider(TEXT.shadow, "shadow", 0, 1, { step: 0.01 })}
        <Switch
          label={TEXT.smoothingOn}
          on={isSmooth}
          onToggle={(on) => store.change([set(on ? SMOOTH : 0, ...path, "gradient_smoothing")])}
        />
        {isSmooth
          ? slider(TEXT.smoothing, "gradient_smoothing", ...SMOOTHING, { unit: "voxels", step: 0.01 })
          : slider(TEXT.offset, "gradient_offset", 0.01, 4, { unit: "voxels", step: 0.01 })}
        {resetButton}
      </details>
    </>
  );
}

function Rest({ store, welcome }: PartProps) {
  const { render, background } = store.state;
  return (
    <>
      <Choice
        label={TEXT.kernel}
        value={render.kernel}
        options={welcome.kernels.map((value) => [value, PANEL_WORDS.kernels[value] ?? value] as const)}
        onChoose={(value) => store.change([set(value, "render", "kernel")])}
      />
      <div class="field">
        <span aria-hidden="true">{TEXT.background}</span>
        <ColorField
          label={TEXT.background}
          value={hexColor(background, namedColor)}
          onColor={(hex) => store.change([set(hex, "background")], "background")}
          onSettle={() => store.settle()}
        />
      </div>
    </>
  );
}

function lightsOf({ lights }: Shading): readonly Light[] {
  return lights.length > 0 ? lights : DEFAULT_LIGHTS;
}

function longestSide(bounds: readonly [Vec3, Vec3] | undefined): number {
  if (bounds === undefined) return 1;
  const [lower, upper] = bounds;
  return Math.max(...upper.map((end, axis) => end - (lower[axis] ?? 0)));
}
