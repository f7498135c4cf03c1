// Controls of the panels for the 3-D view and slices, made of the look's controls.

import { CheckField, SelectField, SliderField } from "./look/fields.tsx";

/** A number with a slider. */
export function NumberField(props: {
  readonly label: string;
  readonly value: number;
  readonly min: number;
  readonly max: number;
  readonly unit?: string;
  readonly decimals?: number;
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
