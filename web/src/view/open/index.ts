// Opening files in the page.

export { DataFollower } from "./data_follower.ts";
export { PageOpener } from "./page_opener.ts";
export { withoutLabels, withoutLayer, withoutShape } from "./remove.ts";
export { StartPage } from "./start_page.tsx";
export { Openings } from "./steps.tsx";
export { default as css } from "./open.css";
