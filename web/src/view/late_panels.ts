// The panels and the help: one chunk, which the page loads after the first view.

export { AboutPanel } from "./about_panel.tsx";
export { CutPanel } from "./cut_panel.tsx";
export { Help } from "./help.tsx";
export { FunctionPanel } from "./look/function_panel.tsx";
export { LabelsPanel } from "./look/labels_panel.tsx";
export { LayersPanel } from "./look/layers_panel.tsx";
export { LightPanel } from "./look/light_panel.tsx";
export { PresetsPanel } from "./look/presets_panel.tsx";
export { MeasurePanel } from "./measure_panel.tsx";
export { SettingsPanel } from "./settings_panel.tsx";
export { SlicesPanel } from "./slices_panel.tsx";
