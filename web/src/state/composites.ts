// Names of the operators along a ray, in the order in which they are offered.

export const COMPOSITES: readonly string[] = [
  "over", "maximum", "depth-shaded-maximum", "depth-colored-maximum", "attenuated-maximum", "local-maximum", "minimum", "mean",
  "sum", "x-ray", "first-hit",
];
