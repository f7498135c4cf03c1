"""First pictures of many volumes, drawn as `wavesplat render FILE` draws them: a contact sheet and a table.

    make looks                          all bundled volumes, and those of BENCH_DATA
    make looks LOOKS="--only ct,pet"    those whose names hold one of the words

Luminance: Rec. 709 weights on the encoded values, 0 to 255, over pixels that differ from the background by more than 6.
Clipped: pixels of these with a channel at 255, of pictures that are not projections (which are windowed on purpose).
"""

from __future__ import annotations

import argparse
import os
import time
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

import wavesplat as ws

DATA = Path(os.environ.get("BENCH_DATA", "../shared/data"))
SIDE = 512
THUMB = 256
COLUMNS = 7


@dataclass(frozen=True)
class Case:
    """A volume by its file and the options of `wavesplat.open`."""

    path: str
    options: dict[str, Any] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """File and what is chosen in it, such as a channel or a time."""
        chosen = " ".join(str(value).rpartition("/")[2] for value in self.options.values())
        stem = self.path.rstrip("/").rpartition("/")[2].partition(".")[0]
        return f"{stem} {chosen}".strip()


def _fields(path: str, *names: str) -> list[Case]:
    return [Case(path, {"dataset": name}) for name in names]


CASES = [
    *(Case(path) for path in ("ct_abdomen_pelvis_3mm.nii.gz", "dicom_ct_pelvis", "ct_torso_u8.mha")),
    *(Case(path) for path in ("mri_head_t1.nii.gz", "nrrd_rotated_gzip_flair.nrrd", "nrrd_flipped_y_gzip_mr.nrrd")),
    *(Case(f"nifti_cases/{name}.nii.gz") for name in ("orient_RAS", "rotated_sform_ct_phantom")),
    *(Case(f"nifti_cases/{name}.nii.gz") for name in ("sheared_sform_ct_phantom", "big_endian_f32")),
    Case("nifti_cases/timeseries_4d_int8_scaled.nii.gz", {"time": 0}),
    *(Case(path) for path in ("pet_body_f32.nii.gz", "us_spine_phantom.mha", "aneurism.vti", "carotid_pcmra.vtk")),
    *(Case(path) for path in ("engine.nrrd", "embryo.nrrd", "neghip.nrrd")),
    *(Case(path) for path in ("sim_heptane_jet_u8.nii.gz", "sim_fuel_u8.nii.gz", "sim_turbulence_f32.nhdr")),
    *_fields(
        "sim_cosmology_nyx_f32.h5",
        *(f"native_fields/{name}" for name in ("baryon_density", "dark_matter_density", "temperature")),
        *(f"native_fields/velocity_{axis}" for axis in "xyz"),
    ),
    *(Case(path) for path in ("micro_mouse_brain_u16.nrrd", "micro_chromosomes_zstack.tif", "tiff_stack_em")),
    *_fields("micro_nuclei_noisy.h5", "raw", "label"),
    Case("omezarr_v2_mouse_brain.ome.zarr"),
    *(Case("omezarr_v2_spim_czyx.ome.zarr", {"channel": channel}) for channel in range(3)),
    Case("omezarr_v3_mri_rotation.ome.zarr"),
    Case("dicom_multiframe/emri_small.dcm"),
]


def main() -> None:
    """Draw, measure, write the sheet and the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("out/looks"))
    parser.add_argument("--only", default="", help="words, with commas between")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    words = arguments.only.split(",")
    thumbs, rows = [], []
    for name, volume in _volumes():
        if not any(word in name for word in words):
            continue
        started = time.perf_counter()
        ws.Look.auto(volume)
        chosen = time.perf_counter() - started
        picture = ws.render(volume, size=(SIDE, SIDE))
        shown = _on_black(picture)
        Image.fromarray(shown).save(arguments.out / f"{name.replace(' ', '_')}.png")
        row = {**_measured(shown), "seconds": chosen, "reason": picture.report["look"]["reason"]}
        rows.append((name, row))
        thumbs.append((name, shown))
        print(_line(name, row), flush=True)
    if rows:
        _contact_sheet(thumbs).save(arguments.out / "looks.png")
        print(_summary([row for _, row in rows]))


def _volumes() -> Any:
    for name in ("ct_pelvis", "mri_head", "ripples"):
        yield f"bundled {name}", getattr(ws.examples, name)()
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 96)] * 3, indexing="ij"))
    x, y, z = grid[2], grid[1], grid[0]
    yield "made vorticity", ws.Volume((np.sin(5 * x) * np.cos(4 * y) * np.exp(-2 * z * z)).astype(np.float32))
    yield "made mask", ws.Volume(((x * x + 2 * y * y + z * z) < 0.4).astype(np.uint8))
    rng = np.random.default_rng(3)
    spots = np.zeros((96, 96, 96), np.float32)
    for at in rng.uniform(-0.8, 0.8, (30, 3)):
        spots += np.exp(-((x - at[0]) ** 2 + (y - at[1]) ** 2 + (z - at[2]) ** 2) / 0.004).astype(np.float32)
    yield "made spots", ws.Volume(1000 * spots + rng.normal(100, 8, spots.shape).astype(np.float32))
    for case in CASES:
        path = DATA / case.path
        if not path.exists():
            print(f"{case.name}: not there: {path}")
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield case.name, ws.open(path, **case.options)


def _on_black(picture: ws.Picture) -> NDArray[np.uint8]:
    """Picture as a file shows it: over black where nothing is."""
    rgb = picture.rgba[..., :3]
    return np.asarray(np.clip(np.round(rgb * 255), 0, 255), dtype=np.uint8)


def _measured(rgb: NDArray[np.uint8]) -> dict[str, float]:
    background = rgb[0, 0].astype(int)
    seen = (np.abs(rgb.astype(int) - background) > 6).any(axis=2)
    luminance = rgb.astype(float) @ np.array([0.2126, 0.7152, 0.0722])
    if not seen.any():
        return {"foreground": 0.0, "mean": 0.0, "p99": 0.0, "clipped": 0.0}
    clipped = (rgb == 255).any(axis=2) if background.max() < 128 else (rgb == 0).any(axis=2)
    return {
        "foreground": 100 * float(seen.mean()),
        "mean": float(luminance[seen].mean()),
        "p99": float(np.percentile(luminance[seen], 99)),
        "clipped": 100 * float(clipped[seen].mean()),
    }


def _line(name: str, row: dict[str, Any]) -> str:
    numbers = (
        f"{row['foreground']:5.1f} {row['mean']:6.1f} {row['p99']:6.1f} {row['clipped']:6.2f} {row['seconds']:6.3f}"
    )
    return f"{name[:36]:36s} {numbers}  {row['reason']}"


def _summary(rows: list[dict[str, Any]]) -> str:
    means, tops = ([row[key] for row in rows] for key in ("mean", "p99"))
    return (
        f"{len(rows)} pictures: median of means {np.median(means):.0f}, p99 of at least 215 in "
        f"{sum(top >= 215 for top in tops)}, clipped at most {max(row['clipped'] for row in rows):.2f} %, "
        f"foreground of at least 35 % in {sum(row['foreground'] >= 35 for row in rows)}, "
        f"look chosen in at most {max(row['seconds'] for row in rows):.3f} s"
    )


def _contact_sheet(thumbs: list[tuple[str, NDArray[np.uint8]]]) -> Image.Image:
    n_rows = -(-len(thumbs) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * THUMB, n_rows * (THUMB + 18)), (30, 30, 30))
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(12)
    for number, (name, rgb) in enumerate(thumbs):
        left, top = number % COLUMNS * THUMB, number // COLUMNS * (THUMB + 18)
        sheet.paste(Image.fromarray(rgb).resize((THUMB, THUMB), Image.Resampling.LANCZOS), (left, top))
        pen.text((left + 4, top + THUMB + 2), name[:38], font=font, fill=(235, 235, 235))
    return sheet


if __name__ == "__main__":
    main()
