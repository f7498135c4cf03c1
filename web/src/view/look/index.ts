import type { PartProps } from "../part.ts";
export const css = "";
const none = (_: PartProps) => null;
export const PresetsPanel = none, FunctionPanel = none, LightPanel = none, LayersPanel = none, LabelsPanel = none, TimeBar = none;
