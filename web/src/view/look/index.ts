// The parts of the look that the first view has; its other panels are loaded later.

export { TimeBar } from "./time_bar.tsx";
export { windowDrag } from "./window_drag.ts";
export { default as css } from "./look.css";
