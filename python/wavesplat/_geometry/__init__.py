"""Shapes that stand in space with the volumes of a scene: surfaces, lines, points, slices and frames."""
