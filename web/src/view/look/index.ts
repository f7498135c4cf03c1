// The panels of the look.

export { FunctionPanel } from "./function_panel.tsx";
export { LabelsPanel } from "./labels_panel.tsx";
export { LayersPanel } from "./layers_panel.tsx";
export { LightPanel } from "./light_panel.tsx";
export { LooksStrip } from "./looks_strip.tsx";
export { PresetsPanel } from "./presets_panel.tsx";
export { TimeBar } from "./time_bar.tsx";
export { windowDrag } from "./window_drag.ts";
export { default as css } from "./look.css";
