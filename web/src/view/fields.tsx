// Controls of the panels for the 3-D view and slices, made of the look's controls; and a panel.

import type { ComponentChildren } from "preact";

import { CheckField, SelectField, SliderField } from "./look/fields.tsx";

/** A number with a slider. */
export function NumberField(props: {
  readonly label: string;
  readonly value: number;
  readonly min: number;
  readonly max: number;
  readonly unit?: string;
  readonly onInput: (value: number) => void;
  readonly onSettle: () => void;
}) {
  const { onInput, onSettle, ...others } = props;
  // A number that is typed may lie beyond the slider.
  return <SliderField {...others} least={-Infinity} most={Infinity} onValue={onInput} onDone={onSettle} />;
}

/** A choice of one of several options. */
export function Choice(props: {
  readonly label: string;
  readonly value: string;
  readonly options: readonly (readonly [value: string, text: string])[];
  readonly onChoose: (value: string) => void;
}) {
  const { label, value, options, onChoose } = props;
  return <SelectField {...{ label, value }} options={options.map(([name, text]) => ({ value: name, text }))} onChoice={onChoose} />;
}

export function Switch(props: { readonly label: string; readonly on: boolean; readonly onToggle: (on: boolean) => void }) {
  return <CheckField label={props.label} checked={props.on} onCheck={props.onToggle} />;
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
