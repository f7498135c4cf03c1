"""The report of a picture: how it was made, and what it shows. Every field stands in `FIELDS`, and nowhere else."""

from __future__ import annotations

import json
import math
from typing import Any, NamedTuple

from wavesplat._model.volume.private_names import whole
from wavesplat._public import public

WHOLE, TEXT, FLAG, OBJECT = ({"type": name} for name in ("integer", "string", "boolean", "object"))
#: A number that is not finite is null in JSON.
NUMBER = {"type": ["number", "null"]}
TEXTS = {"type": "array", "items": TEXT}
THREE = {"type": "array", "items": NUMBER, "minItems": 3, "maxItems": 3}
TWO = {"type": "array", "items": NUMBER, "minItems": 2, "maxItems": 2}
PIXELS = {"type": "array", "items": WHOLE, "minItems": 2, "maxItems": 2}
OBJECTS = {"type": "array", "items": OBJECT}


def _or_none(schema: dict[str, Any]) -> dict[str, Any]:
    return {"anyOf": [schema, {"type": "null"}]}


class Field(NamedTuple):
    """A field of a report: its JSON schema, and what it says."""

    schema: dict[str, Any]
    text: str


#: Fields by name. A report has those that its picture has something to say about.
FIELDS: dict[str, Field] = {
    # What is shown.
    "size": Field(PIXELS, "Width and height, pixels."),
    "pixel": Field(NUMBER, "Distance of neighbouring pixels, world units; in perspective in the focal plane."),
    "unit": Field(_or_none(TEXT), "Unit of the world's lengths; none if unknown."),
    "anatomical": Field(FLAG, "Whether the world's axes are a patient's: x to the right, y to the front, z up."),
    "camera": Field(OBJECT, "The camera, as `Camera.from_json` takes it; slices have none."),
    "stereo": Field(
        OBJECT,
        "Two eyes: layout, distance of the eyes, distance of the plane without parallax, world units; null is "
        "infinity.",
    ),
    "panorama": Field(FLAG, "Whether the picture is a panorama, of longitudes and latitudes."),
    "background": Field(
        _or_none({"anyOf": [{"type": "array", "items": NUMBER}, TEXT]}),
        "Colour of the background; none is transparent.",
    ),
    "look": Field(OBJECT, "Name of the first layer's look, and the reason why it was chosen."),
    "layers": Field(OBJECTS, "Several layers: a report of each; on slices name, opacity, time and processing of each."),
    "shown": Field(OBJECTS, "The visible layers: name, unit of values, operator, and the colours of values."),
    "geometry": Field(
        OBJECTS,
        "Surfaces, lines, points, slices and frames: kind, name, number of parts; `visible` is false for hidden ones.",
    ),
    "geometry_colors": Field(
        OBJECTS,
        "Geometry with values: kind, name, quantity, unit, and colours of values.",
    ),
    "labels": Field(OBJECTS, "Names and colours of the visible labels; on slices, of the labels in the slice."),
    "time": Field(OBJECT, "Number of the time point, and its time with the unit as text."),
    "panels": Field(OBJECTS, "Lightbox: plane, position and place on the sheet, in pixels, of each slice."),
    "lines": Field(OBJECTS, "Names and colours of the visible contours and isolines."),
    "processing": Field(TEXTS, "Earlier processing of the samples, a sentence each (`Facts.processing`)."),
    "resampled": Field(TEXTS, "Names of layers that were resampled onto the axes of the first."),
    "notes": Field(TEXTS, "Notes for the user, a sentence each: why nothing is visible, or why the CPU drew."),
    "scene": Field(
        OBJECT,
        "The scene as a document that draws the same picture (`Scene.from_json`), without folders.",
    ),
    "version": Field(TEXT, "Version of Wavesplat that drew the picture."),
    # How it was drawn.
    "quality": Field(
        {"type": ["string", "object"]}, "Quality that was asked for; with `psnr` the sampling that was chosen."
    ),
    "kernel": Field(TEXT, "Reconstruction between samples."),
    "composite": Field(TEXT, "Operator along the rays."),
    "local_threshold": Field(NUMBER, "Local maxima: the least value that counts as a maximum."),
    "depth_shading": Field(
        TWO, "Depth-shaded maxima: fraction of light that is lost at the back; value that is black."
    ),
    "depth_colors": Field(
        OBJECT,
        "Maxima in depth colours: colour map; axis, none for the view; range in world units: coordinates along "
        "the axis, or depths along the view.",
    ),
    "attenuated": Field(
        THREE, "Attenuated maxima: value that dims nothing; value that dims most; its optical depth per world unit."
    ),
    "attenuation": Field(TWO, "X-rays: value that is transparent; optical depth per unit of value and of the world."),
    "sheets_per_slice": Field(NUMBER, "Sheets for each distance of slices."),
    "oversampling": Field(NUMBER, "Texels for each pixel, along each side."),
    "expected_psnr_db": Field(
        NUMBER,
        "With `psnr`: estimated PSNR against the converged picture, dB; 1.2 dB too high in the median, and up to 5 dB "
        "for hard functions and views along an axis ([limits](limits.md)).",
    ),
    "expected_psnr_spread_db": Field(
        NUMBER,
        "With `psnr`: standard deviation of that estimate over the measured tiles, dB, without the error of "
        "the finer picture that they were compared with.",
    ),
    "measured": Field(_or_none(OBJECT), "With `psnr`: errors that were measured, for the next pictures."),
    "device": Field(
        OBJECT, "Device that drew: `name`, and `reason` why it was the CPU; for a GPU also its resources and times."
    ),
    # What it took.
    "seconds": Field(
        OBJECT,
        "Times of the stages: `prepare` (bounds of bricks, spline coefficients; almost 0 after the first "
        "picture), `plan`, `draw` and `warp`.",
    ),
    "n_texels": Field(WHOLE, "Texels of sheets that were computed."),
    "n_skipped_slabs": Field(
        WHOLE, "Slabs of tiles, or of parts of tiles on 16 threads or more, without visible samples."
    ),
    "n_base_planes": Field(WHOLE, "Base planes: one, or up to three in perspective."),
    "n_base_texels": Field(WHOLE, "Texels of the base planes."),
    "n_sheets": Field({"type": "array", "items": WHOLE}, "Sheets of each base plane."),
    "n_planes": Field(WHOLE, "Slice: number of combined planes; 1 unless it is a slab."),
    "n_splats": Field(WHOLE, "Standard splatting: samples that were splatted."),
    "n_fragments": Field(WHOLE, "Surfaces, lines and points: intersections with rays."),
    "n_joined_rays": Field(WHOLE, "Rays with more surfaces than are kept separately, so that deeper ones are joined."),
    "n_nonfinite_samples": Field(WHOLE, "Samples that are NaN or infinite."),
    "n_threads": Field(WHOLE, "Threads that drew."),
    "simd": Field(TEXT, "Vector instructions of the processor that were used."),
    "lazy": Field(OBJECT, "Lazy volumes: levels, origin of bounds, bytes read, blocks, seconds and waiting."),
    "holes": Field(TEXTS, "Samples that could not be read, a sentence each."),
    "is_final": Field(FLAG, "`wavesplat.progressive`: whether it is the last picture."),
    # Slices.
    "position": Field(NUMBER, "Slice: where the plane crosses its axis, world units."),
    "normal": Field(THREE, "Slice: unit vector at right angles to the plane."),
    "origin": Field(THREE, "Slice: world position of the centre of the first pixel."),
    "right": Field(THREE, "Slice: unit vector of the world along the rows of pixels."),
    "down": Field(THREE, "Slice: unit vector of the world down the columns of pixels."),
    "letters": Field(_or_none(OBJECT), "Slice: the patient's sides at the edges; none without anatomy."),
    "window": Field(TWO, "Slice: level and width of the values that are shown."),
    "clim": Field(TWO, "Slice: the values shown as black and as white."),
    "compared": Field(OBJECT, "Slice of two scans: name of the second one, in squares or subtracted."),
    # Figures, and pictures over each other.
    "scale_bar": Field(OBJECT, "Figure: length, pixels and text of its scale bar."),
    "over": Field(OBJECT, "Picture over another: the report of the upper one."),
    # Studies.
    "method": Field(TEXT, "Studies: the method that drew."),
    "buffer": Field(TEXT, "Standard splatting: how its sheets lie."),
    "view_angle_correction": Field(FLAG, "Studies: whether opacities are corrected for the angle of the view."),
}


@public
class Report(dict[str, Any]):
    """How a picture was made, and what it shows: a dictionary whose fields are attributes too.

    `docs/report.md` lists the fields. One that a picture has nothing to say about is not among the keys, and None as an
    attribute.

    Examples
    --------
    >>> import wavesplat as ws
    >>> report = ws.render(ws.examples.ripples(8), size=(24, 16), device="cpu").report
    >>> report["size"], report.kernel, report.device["name"], report.scale_bar
    ([24, 16], 'linear', 'cpu', None)
    >>> report.to_json()[:21]
    '{"sheets_per_slice": '
    """

    def __getattr__(self, name: str) -> Any:
        if name in FIELDS:
            return self.get(name)
        raise AttributeError(f"a report has no field {name!r}; Report.fields() has those that there are")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *FIELDS]

    def to_json(self, indent: int | None = None, *, embed_paths: bool = False) -> str:
        """The report as JSON text, of the schema `schema()`.

        Parameters
        ----------
        indent : int, optional
            Columns by which inner lines are moved in; None writes one line.
        embed_paths : bool, default False
            Write whole paths of files into the scene; else it holds no folders, and no names of patients' scans.
        """
        return json.dumps(finite(whole(self) if embed_paths else self), indent=indent, allow_nan=False, default=float)

    @classmethod
    def fields(cls) -> dict[str, str]:
        """Names of all fields, and what each says."""
        return {name: field.text for name, field in FIELDS.items()}

    @classmethod
    def schema(cls) -> dict[str, Any]:
        """The JSON schema (draft 2020-12) of reports."""
        return {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": "Report of a picture of Wavesplat",
            "type": "object",
            "properties": {name: {**field.schema, "description": field.text} for name, field in FIELDS.items()},
            "additionalProperties": False,
        }


def finite(value: Any) -> Any:
    """A value whose numbers that JSON cannot hold are None."""
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
