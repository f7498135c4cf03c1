// The panels, slices, looks and the help: one chunk, which the page loads after the first view.

export { AboutPanel } from "./about_panel.tsx";
export { CutPanel } from "./cut_panel.tsx";
export { Help } from "./help.tsx";
export { FunctionPanel } from "./look/function_panel.tsx";
export { LabelsPanel } from "./look/labels_panel.tsx";
export { LayersPanel } from "./look/layers_panel.tsx";
export { LightPanel } from "./look/light_panel.tsx";
export { LooksStrip } from "./look/looks_strip.tsx";
export { PresetsPanel } from "./look/presets_panel.tsx";
export { MeasurePanel } from "./measure_panel.tsx";
export { Palette } from "./palette.tsx";
export { SettingsPanel } from "./settings_panel.tsx";
export { SharePanel } from "./share.tsx";
export { SlicePane } from "./slices/slice_pane.tsx";
export { SlicesPanel } from "./slices_panel.tsx";
