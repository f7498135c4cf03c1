"""Reports of pictures: all fields stand in one table, with the schema that JSON texts of them keep to."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import wavesplat as ws
from wavesplat._picture.report import FIELDS

PAGE = Path(__file__).parents[3] / "docs/report.md"
RIPPLES = ws.examples.ripples(12)
SMALL = {"size": (24, 16), "device": "cpu"}


def lazy(tmp_path):
    np.save(tmp_path / "a.npy", RIPPLES.samples)
    return ws.open(tmp_path / "a.npy", memory="64 MB")


PICTURES = {
    "over": lambda _: ws.render(RIPPLES, **SMALL),
    "psnr": lambda _: ws.render(RIPPLES, psnr=30, **SMALL),
    "isosurface": lambda _: ws.render(RIPPLES, composite=ws.FirstHit(100), depth=True, **SMALL),
    **{
        name: lambda _, name=name: ws.render(RIPPLES, composite=name, **SMALL)
        for name in ("maximum", "x-ray", "local-maximum", "depth-shaded-maximum")
    },
    "layers": lambda _: ws.render([RIPPLES, RIPPLES], **SMALL),
    "added": lambda _: ws.render([RIPPLES, RIPPLES], composite="maximum", **SMALL),
    "nothing": lambda _: ws.Scene(ws.Layer(RIPPLES, visible=False)).render(**SMALL),
    "lazy": lambda tmp_path: ws.render(lazy(tmp_path), **SMALL),
    "final": lambda _: list(ws.progressive(RIPPLES, **SMALL))[-1],
    "slice": lambda _: ws.slice(RIPPLES),
    "slab": lambda _: ws.slice([RIPPLES, RIPPLES], thickness=3.0, slab="mean"),
    "patient": lambda _: ws.slice(ws.examples.ct_pelvis(), window="bone"),
    "figure": lambda _: ws.slice(RIPPLES, size=(96, 96)).annotated(scale_bar=True),
    "over another": lambda _: ws.render(RIPPLES, **SMALL).over(ws.render(RIPPLES, **SMALL)),
    "study": lambda _: ws.study.render(RIPPLES, pre_integration=False, **SMALL),
    "standard": lambda _: ws.study.standard(RIPPLES, size=(8, 8)),
    "ablation": lambda _: ws.study.splat(RIPPLES, size=(8, 8)),
    "reference": lambda _: ws.reference.raycast(RIPPLES, size=(8, 8)),
}


@pytest.mark.parametrize("kind", PICTURES)
def test_reports_keep_to_their_schema(kind, tmp_path):
    report = PICTURES[kind](tmp_path).report
    assert isinstance(report, ws.Report)
    assert set(report) <= set(FIELDS)
    jsonschema.validate(json.loads(report.to_json()), ws.Report.schema())
    for name in FIELDS:
        assert getattr(report, name) is report.get(name)


def test_the_schema_is_valid_and_refuses_what_is_none_of_its_fields():
    jsonschema.Draft202012Validator.check_schema(ws.Report.schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"n_texel": 3}, ws.Report.schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"n_texels": "many"}, ws.Report.schema())


def test_a_field_that_does_not_exist_is_told():
    report = ws.Report(pixel=0.5)
    assert report.pixel == 0.5
    assert report.unit is None
    with pytest.raises(AttributeError, match="no field 'pixels'"):
        _ = report.pixels
    assert {"pixel", "unit", "to_json"} <= set(dir(report))


def test_numbers_that_json_lacks_become_null():
    assert json.loads(ws.Report(pixel=float("nan"), window=(1.0, float("inf"))).to_json()) == {
        "pixel": None,
        "window": [1.0, None],
    }


def test_a_picture_takes_a_plain_dictionary():
    picture = ws.Picture(np.zeros((2, 3, 4), np.float32), report={"pixel": 2.0})
    assert picture.report.pixel == picture.pixel == 2.0


def test_the_page_lists_every_field():
    rows = [f"| `{name}` | {text} |" for name, text in ws.Report.fields().items()]
    listed = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    assert listed == rows
