// Controls that the panels share: a number with a slider, a choice, a switch. Each is a native element with its label.

import type { ComponentChildren } from "preact";

export interface NumberFieldProps {
  readonly label: string;
  readonly value: number;
  readonly min: number;
  readonly max: number;
  readonly step?: number | "any";
  readonly unit?: string;
  /** Whether a slider goes with it. */
  readonly slider?: boolean;
  readonly onInput: (value: number) => void;
  readonly onSettle: () => void;
}

/** Steps of a slider. */
const N_STEPS = 500;

export function NumberField(props: NumberFieldProps) {
  const { label, value, min, max, unit, slider = true, onInput, onSettle } = props;
  const step = props.step ?? "any";
  const shown = Number(value.toPrecision(6));
  const given = (event: Event): void => {
    const typed = (event.currentTarget as HTMLInputElement).valueAsNumber;
    if (Number.isFinite(typed)) onInput(typed);
  };
  return (
    <label class="field">
      <span>{label}</span>
      {slider && (
        <input
          type="range"
          aria-label={label}
          min={min}
          max={max}
          step={step === "any" ? (max - min) / N_STEPS || "any" : step}
          value={value}
          onInput={given}
          onChange={onSettle}
        />
      )}
      <input
        type="number"
        aria-label={unit ? `${label}, ${unit}` : label}
        step={step}
        value={shown}
        onChange={(event) => {
          given(event);
          onSettle();
        }}
      />
      {unit && <span class="dim">{unit}</span>}
    </label>
  );
}

export function Choice(props: {
  readonly label: string;
  readonly value: string;
  readonly options: readonly (readonly [value: string, text: string])[];
  readonly onChoose: (value: string) => void;
}) {
  const { label, value, options, onChoose } = props;
  return (
    <label class="field">
      <span>{label}</span>
      <select value={value} onChange={(event) => onChoose(event.currentTarget.value)}>
        {options.map(([name, text]) => (
          <option key={name} value={name} selected={name === value}>
            {text}
          </option>
        ))}
      </select>
    </label>
  );
}

export function Switch(props: { readonly label: string; readonly on: boolean; readonly onToggle: (on: boolean) => void }) {
  return (
    <label class="row">
      <input type="checkbox" checked={props.on} onChange={(event) => props.onToggle(event.currentTarget.checked)} />
      {props.label}
    </label>
  );
}

export function Panel(props: {
  readonly name: string;
  readonly title: string;
  readonly open: boolean;
  readonly onToggle: (name: string, open: boolean) => void;
  readonly children: ComponentChildren;
}) {
  const { name, title, open, onToggle, children } = props;
  return (
    <details
      class="panel"
      open={open}
      data-panel={name}
      onToggle={(event) => {
        const now = event.currentTarget.open;
        if (now !== open) onToggle(name, now);
      }}
    >
      <summary>{title}</summary>
      {open && <div class="body">{children}</div>}
    </details>
  );
}
