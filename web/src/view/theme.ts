// The theme, dark or light: chosen in the state, else by the notebook or the system.

import type { ViewerState } from "../state/state.ts";

export type Theme = "dark" | "light";

/** The theme to be shown. */
export function themeOf(state: ViewerState): Theme {
  const { theme } = state.view.interface;
  return theme === "system" ? surrounding() : theme;
}

/** The theme of the notebook or the system. */
export function surrounding(): Theme {
  const lab = document.body?.dataset["jpThemeLight"];
  if (lab !== undefined) return lab === "true" ? "light" : "dark";
  const classes = document.body?.classList;
  if (classes?.contains("vscode-light") || classes?.contains("vscode-high-contrast-light")) return "light";
  if (classes?.contains("vscode-dark") || classes?.contains("vscode-high-contrast")) return "dark";
  return window.matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
}

/** Calls back when the surroundings change. */
export function onThemeChange(listener: () => void): () => void {
  const query = window.matchMedia("(prefers-color-scheme: light)");
  query.addEventListener("change", listener);
  const observer = new MutationObserver(listener);
  if (document.body !== null) observer.observe(document.body, { attributes: true, attributeFilter: ["class", "data-jp-theme-light"] });
  return () => {
    query.removeEventListener("change", listener);
    observer.disconnect();
  };
}
