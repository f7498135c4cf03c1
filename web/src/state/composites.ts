// Operators along a ray, with their names for people.

export const COMPOSITE_NAMES: Readonly<Record<string, string>> = {
  over: "Volume rendering (over)",
  maximum: "Maximum intensity (MIP)",
  "depth-shaded-maximum": "Maximum, dimmed by depth",
  "depth-colored-maximum": "Maximum, colour by depth",
  "attenuated-maximum": "Maximum, attenuated",
  "local-maximum": "First local maximum (LMIP)",
  minimum: "Minimum intensity (MinIP)",
  mean: "Mean",
  sum: "Sum",
  "x-ray": "X-ray",
  "first-hit": "Isosurface (first hit)",
};
