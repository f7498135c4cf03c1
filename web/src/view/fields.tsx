// The fields of all panels: a label, a slider, a number, a choice, a switch, a colour. All events of one gesture have one name and one step of undo.

import type { ComponentChildren } from "preact";
import { useEffect, useState } from "preact/hooks";
import { clamped } from "./look/curves.ts";
import { decimalsOfStep, fieldText, numberText, roundStep } from "./look/axis.ts";
import { WORDS } from "../words.ts";

interface NumberBoxProps {
  readonly label: string;
  readonly value: number;
  readonly min?: number;
  readonly max?: number;
  readonly step?: number | "any";
  /** Decimals of the text; without them as many as fit. */
  readonly decimals?: number;
  readonly unit?: string;
  readonly disabled?: boolean;
  readonly id?: string;
  /** Called with each number while it is typed or stepped. */
  onInput(value: number): void;
  /** Called at the end of the gesture. */
  onSettle(): void;
}

/** A number alone, named for screen readers. The text stays as typed until the field is left. */
export function NumberBox(props: NumberBoxProps) {
  const { label, value, min, max, step = "any", unit = "", disabled = false, id, decimals } = props;
  const [typed, setTyped] = useState<string | null>(null);
  const done = (): void => {
    setTyped(null);
    props.onSettle();
  };
  return (
    <input
      type="number"
      id={id}
      aria-label={unit === "" ? label : `${label}, ${unit}`}
      value={typed ?? fieldText(value, decimals)}
      min={min}
      max={max}
      step={step}
      disabled={disabled}
      onInput={(event) => {
        const field = event.currentTarget;
        setTyped(field.value);
        const number = field.valueAsNumber;
        if (Number.isFinite(number)) props.onInput(clamped(number, min ?? -Infinity, max ?? Infinity));
      }}
      onChange={done}
      onBlur={done}
      onKeyDown={(event) => {
        if (event.key === "Enter") done();
      }}
    />
  );
}

/** A number with its label and unit before and after it. */
export function NamedNumber(props: NumberBoxProps & { readonly shown?: string }) {
  const { label, shown = label, unit = "" } = props;
  return (
    <span class="look-named">
      <span class="dim" aria-hidden="true">
        {shown}
      </span>
      <NumberBox {...props} />
      {unit !== "" && (
        <span class="dim" aria-hidden="true">
          {unit}
        </span>
      )}
    </span>
  );
}

interface NumberFieldProps extends NumberBoxProps {
  /** Text before the slider, where the label would be too long; "" for no text. */
  readonly shown?: string;
  readonly min: number;
  readonly max: number;
  /** Whether numbers that are typed stay within the slider's ends, too. */
  readonly isBounded?: boolean;
  /** Smallest and largest number that may be typed, where these are not the ends of the slider. */
  readonly least?: number;
  readonly most?: number;
}

/** A slider and its number. */
export function NumberField(props: NumberFieldProps) {
  const {
    label,
    value,
    min,
    max,
    step = roundStep((max - min) / 500),
    unit = "",
    disabled = false,
    isBounded = false,
    least = isBounded ? min : -Infinity,
    most = isBounded ? max : Infinity,
  } = props;
  const { shown = label, decimals = step === "any" ? undefined : decimalsOfStep(step) } = props;
  return (
    <div class="field look-slider">
      {shown !== "" && (
        <span aria-hidden="true">
          {shown}
          {unit !== "" && <small>{unit}</small>}
        </span>
      )}
      <input
        type="range"
        aria-label={label}
        aria-valuetext={`${numberText(value)}${unit && ` ${unit}`}`}
        value={value}
        min={min}
        max={max}
        step={step}
        disabled={disabled}
        onInput={(event) => props.onInput(event.currentTarget.valueAsNumber)}
        onChange={() => props.onSettle()}
      />
      <NumberBox
        {...props}
        {...(decimals === undefined ? {} : { decimals })}
        min={least}
        max={most}
        step={step}
        label={WORDS.fields.number(label, "")}
      />
    </div>
  );
}

interface RelativeSliderProps {
  readonly label: string;
  /** Amount of change at a position of the slider, whose ends are at -1 and 1; `position` is the inverse. */
  amount(position: number): number;
  position(amount: number): number;
  /** Amount of no change: 0 of a shift, 1 of a factor. */
  readonly neutral: number;
  readonly unit?: string;
  readonly disabled?: boolean;
  /** Called with the amount of change from the state at the begin of the gesture. */
  onAmount(amount: number): void;
  onSettle(): void;
}

/** A slider that goes back to its middle after each gesture, so that there is no end to run out of. */
export function RelativeSlider(props: RelativeSliderProps) {
  const { label, neutral, unit = "", disabled = false } = props;
  const [amount, setAmount] = useState<number | null>(null);
  const [typed, setTyped] = useState("");
  const done = (): void => {
    setAmount(null);
    props.onSettle();
  };
  const apply = (): void => {
    const number = Number(typed);
    setTyped("");
    if (typed.trim() === "" || !Number.isFinite(number)) return;
    props.onAmount(number);
    done();
  };
  const shown = numberText(amount ?? neutral);
  return (
    <div class="field look-slider">
      <span aria-hidden="true">
        {label}
        {unit !== "" && <small>{unit}</small>}
      </span>
      <input
        type="range"
        aria-label={label}
        aria-valuetext={`${shown}${unit && ` ${unit}`}`}
        min={-1}
        max={1}
        step={0.01}
        value={amount === null ? 0 : props.position(amount)}
        disabled={disabled}
        onInput={(event) => {
          const next = props.amount(event.currentTarget.valueAsNumber);
          setAmount(next);
          props.onAmount(next);
        }}
        onChange={done}
      />
      <input
        type="number"
        step="any"
        aria-label={WORDS.fields.number(label, unit)}
        value={amount === null ? typed : fieldText(Number(amount.toPrecision(3)))}
        placeholder={numberText(neutral)}
        disabled={disabled}
        onInput={(event) => setTyped(event.currentTarget.value)}
        onBlur={apply}
        onKeyDown={(event) => {
          if (event.key === "Enter") apply();
        }}
      />
    </div>
  );
}

interface ChoiceProps {
  readonly label: string;
  readonly value: string;
  readonly options: readonly (readonly [value: string, text: string, disabled?: boolean])[];
  onChoose(value: string): void;
}

/** A choice of one of several options. */
export function Choice({ label, value, options, onChoose }: ChoiceProps) {
  return (
    <label class="field">
      <span>{label}</span>
      <select class="look-grow" value={value} onChange={(event) => onChoose(event.currentTarget.value)}>
        {options.map(([name, text, disabled = false]) => (
          <option key={name} value={name} disabled={disabled}>
            {text}
          </option>
        ))}
      </select>
    </label>
  );
}

interface SwitchProps {
  readonly label: string;
  readonly note?: string;
  readonly on: boolean;
  onToggle(on: boolean): void;
}

export function Switch({ label, note, on, onToggle }: SwitchProps) {
  return (
    <label class="row look-check">
      <input type="checkbox" checked={on} onChange={(event) => onToggle(event.currentTarget.checked)} />
      <span>{label}</span>
      {note && <span class="dim">{note}</span>}
    </label>
  );
}

interface ColorFieldProps {
  readonly label: string;
  /** The colour, #rrggbb. */
  readonly value: string;
  onColor(hex: string): void;
  onSettle(): void;
}

/** The browser's colour picker. Preact sets the value anew on each render, which some pickers take as a choice. */
export function ColorField({ label, value, onColor, onSettle }: ColorFieldProps) {
  const [picked, setPicked] = useState<string | null>(null);
  useEffect(() => setPicked(null), [value]);
  return (
    <input
      type="color"
      aria-label={label}
      value={picked ?? value}
      onInput={(event) => {
        setPicked(event.currentTarget.value);
        onColor(event.currentTarget.value);
      }}
      onChange={onSettle}
      onBlur={onSettle}
    />
  );
}

/** A button with a text. */
export function Button(props: {
  readonly children: ComponentChildren;
  readonly label?: string;
  readonly pressed?: boolean;
  readonly disabled?: boolean;
  onClick(): void;
}) {
  return (
    <button
      type="button"
      class="button"
      aria-label={props.label}
      title={props.label}
      aria-pressed={props.pressed}
      disabled={props.disabled ?? false}
      onClick={() => props.onClick()}
    >
      {props.children}
    </button>
  );
}
