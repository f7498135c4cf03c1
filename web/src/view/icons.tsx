// Icons as lines on a grid of 20; each stands beside a name, or has one for screen readers.

const PATHS = {
  open: "M2 16V4h6l2 3h8v9zM2 16l3-6h15l-3 6",
  undo: "M8 5 4 9l4 4M4 9h8a4 4 0 0 1 0 8H9",
  redo: "M12 5l4 4-4 4M16 9H8a4 4 0 0 0 0 8h3",
  fit: "M4 8V4h4M16 8V4h-4M4 12v4h4M16 12v4h-4M8 8h4v4H8z",
  turn: "M15 6a7 3 0 1 0 1 4M16 3v4h-4M10 10v7",
  window: "M10 3a7 7 0 1 0 0 14zM10 3a7 7 0 0 1 0 14",
  distance: "M3 17 17 3M3 13v4h4M17 7V3h-4",
  angle: "M16 16H4L14 4M9 16a6 6 0 0 0-1.5-4",
  help: "M7.5 7.5a2.5 2.5 0 1 1 3.5 2.3c-.8.4-1 .9-1 1.7M10 14.6v.1M10 18a8 8 0 1 0 0-16 8 8 0 0 0 0 16z",
  dark: "M16 12A7 7 0 0 1 8 4a7 7 0 1 0 8 8z",
  close: "M5 5l10 10M15 5 5 15",
  search: "M8.5 14a5.5 5.5 0 1 0 0-11 5.5 5.5 0 0 0 0 11zM12.5 12.5 17 17",
  info: "M10 18a8 8 0 1 0 0-16 8 8 0 0 0 0 16zM10 9v5M10 6.2v.1",
  "3d": "M10 2.5l6.5 3.7v7.6L10 17.5l-6.5-3.7V6.2zM3.5 6.2 10 10l6.5-3.8M10 10v7.5",
  "one-and-three": "M3 3.5h14v13H3zM11.5 3.5v13M11.5 7.8H17M11.5 12.2H17",
  "two-by-two": "M3 3.5h14v13H3zM10 3.5v13M3 10h14",
  single: "M3 3.5h14v13H3zM10 7v6M7 10h6",
  presets: "M10 2.5l1.7 4.6 4.8.2-3.8 3 1.3 4.7-4-2.7-4 2.7 1.3-4.7-3.8-3 4.8-.2z",
  function: "M3 3v14h14M5 14c3 0 3-8 5.5-8S13 11 17 11",
  layers: "M10 3l7.5 4L10 11 2.5 7zM2.5 10.5 10 14.5l7.5-4M2.5 14 10 18l7.5-4",
  labels: "M3 3.5h6.5L17 11l-6 6-8-7.5zM6.5 6.8v.1",
  light: "M10 2v2M10 16v2M2 10h2M16 10h2M4.5 4.5l1.4 1.4M14.1 14.1l1.4 1.4M15.5 4.5l-1.4 1.4M5.9 14.1l-1.4 1.4M10 6.5a3.5 3.5 0 1 0 0 7 3.5 3.5 0 0 0 0-7z",
  cut: "M5.5 8a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5zM5.5 17a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5zM7.6 6.9 17 15M7.6 13.1 17 5",
  slices: "M6 3.5h11v8M4.5 6H14v8.5M3 8.5h8.5v8H3z",
  measure: "M13.5 2.5l4 4-11 11-4-4zM6 10l2 2M8.5 7.5 10 9M11 5l2 2",
  share: "M10 12V3M6 7l4-4 4 4M4 11v6h12v-6",
  settings: "M3 6h8M15 6h2M3 14h2M9 14h8M13 8a2 2 0 1 0 0-4 2 2 0 0 0 0 4zM7 16a2 2 0 1 0 0-4 2 2 0 0 0 0 4z",
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name }: { readonly name: IconName }) {
  return (
    <svg viewBox="0 0 20 20" aria-hidden="true">
      <path d={PATHS[name]} />
    </svg>
  );
}
