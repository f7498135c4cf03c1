"""Surfaces, lines, points, standing slices and frames: what stands in space with the volumes of a scene."""
