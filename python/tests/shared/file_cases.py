"""Small NIfTI and NRRD files, and what Python finds in them, for the tests of the crates `files` and `wavesplat`.

    python python/tests/shared/file_cases.py > crates/files/tests/cases.jsonl

prints a line for each file: its bytes, and its size, type, affine and facts, a checksum of its samples, the kind of
data, the camera of its picture by a preset, and its automatic look; or a word that the crate's error must hold, where
it refuses the file.
"""

from __future__ import annotations

import gzip
import json
import tempfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

SHAPE = (4, 3, 2)  # x, y, z
FACTS = ("unit", "is_anatomical", "modality", "value_unit", "quantity", "conventions", "guesses")
OBLIQUE = np.array([[-0.8, 0.3, 0.1, 5.5], [0.2, 0.9, -0.4, -7.25], [0.1, 0.2, 2.5, 30.125], [0, 0, 0, 1]])


def ramp(dtype: str) -> np.ndarray:
    """Numbers that differ in all places, [x, y, z]."""
    return (np.arange(np.prod(SHAPE)).reshape(SHAPE, order="F") * 7 - (0 if dtype[-2] == "u" else 20)).astype(dtype)


def nifti(dtype: str = "<i2", *, second: bool = False, affine: Any = OBLIQUE, form: str = "s", **fields: Any) -> bytes:
    """The bytes of a NIfTI file. `form`: which of sform and qform has a code; `fields`: fields of the header."""
    import nibabel as nib

    kind = nib.Nifti2Image if second else nib.Nifti1Image
    samples = fields.pop("samples", ramp(dtype))
    image = kind(samples, None, dtype=samples.dtype)
    header = kind.header_class(endianness=">" if dtype[0] == ">" else "<")
    header.set_data_dtype(samples.dtype)
    header.set_data_shape(samples.shape)
    header.set_sform(affine, code="scanner" if "s" in form else "unknown")
    header.set_qform(affine, code="scanner" if "q" in form else "unknown")
    header["vox_offset"] = header.single_vox_offset
    header["magic"] = header.single_magic
    offset = int(header["vox_offset"])
    for name, value in fields.items():
        header[name] = value
    del image
    return header.binaryblock.ljust(offset, b"\0") + samples.tobytes(order="F")


def nrrd(*lines: str, samples: bytes = b"", dtype: str = "<i2", between: bytes = b"") -> bytes:
    """The bytes of an NRRD file with the lines of its header."""
    samples = samples or ramp(dtype).tobytes(order="F")
    text = "\n".join(["NRRD0005", "dimension: 3", "sizes: 4 3 2", *lines])
    return text.encode("latin-1") + b"\n\n" + between + samples


PLACED = ("space directions: (0.5,0,0.1) (0,0.75,0) (-0.1,0,2)", "space origin: (10,-20,30.5)")


def files() -> Iterator[tuple[str, bytes, str]]:
    """The files: name, bytes, and a word of the reason why the crate refuses it, or nothing."""
    yield from nifti_files()
    yield from nrrd_files()
    yield from phantoms()
    yield "empty.nrrd", b"", "empty"
    yield "other.png", b"\x89PNG\r\n\x1a\n", "more formats"


def nifti_files() -> Iterator[tuple[str, bytes, str]]:
    """Files of each type, version, byte order, place and slope, and damaged ones."""
    yield "sform.nii", nifti(), ""
    yield "packed.nii.gz", gzip.compress(nifti(xyzt_units=2), mtime=0), ""
    yield "qform.nii", nifti(form="q"), ""
    yield "mirrored_qform.nii", nifti(form="q", affine=np.diag([-1.5, 2, 3, 1])), ""
    yield "both_forms.nii", nifti(form="sq"), ""
    yield "no_form.nii", nifti(form="", pixdim=[1, 0.5, 0, 2, 1, 1, 1, 1]), ""
    yield "big_endian.nii", nifti(">f4"), ""
    yield "whole_slope.nii", nifti(scl_slope=2, scl_inter=-1000), ""
    yield "wide_whole_slope.nii", nifti(scl_slope=2000, scl_inter=-100000), ""
    yield "slope.nii", nifti("<u2", scl_slope=0.1, scl_inter=-3.3), ""
    yield "slope_nan.nii", nifti(scl_slope=np.nan, scl_inter=np.nan), ""
    yield "huge_slope.nii", nifti("<f4", scl_slope=3e37), ""
    yield "double_slope.nii", nifti("<f8", scl_slope=0.3, scl_inter=1), ""
    yield "narrowed.nii", nifti("<i8"), ""
    yield "narrowed_unsigned.nii", nifti("<u8"), ""
    yield "uint32.nii", nifti("<u4"), ""
    yield "int8.nii", nifti("|i1"), ""
    yield "second.nii", nifti("<f8", second=True, xyzt_units=3, form="q"), ""
    yield "second_sform.nii", nifti(">u1", second=True), ""
    yield "metres.nii", nifti(xyzt_units=1, affine=np.diag([0.001, 0.002, 0.003, 1])), ""
    yield "unknown_unit.nii", nifti(xyzt_units=5), ""
    yield "z_score.nii", nifti("<f4", intent_code=5), ""
    yield "no_anatomy.nii", nifti(descrip=b"axes without anatomy", xyzt_units=2), ""
    yield "no_offset.nii", nifti(vox_offset=0), ""
    yield "nan.nii", nifti(samples=np.where(ramp("<f4") > 60, np.float32(np.nan), ramp("<f4"))), ""
    yield "times.nii", nifti(samples=np.stack([ramp("<i2")] * 2, axis=-1)), "2 volumes"
    yield "colors.nii", nifti(datatype=128, bitpix=24), "colours"
    yield "truncated.nii", nifti()[:-1], "truncated"
    yield "truncated.nii.gz", gzip.compress(nifti(), mtime=0)[:-20], "damaged"
    yield "offset_in_header.nii", nifti(vox_offset=348), "vox_offset"


def nrrd_files() -> Iterator[tuple[str, bytes, str]]:
    """Files of each space, unit, encoding and place of the samples, and damaged ones."""
    raw, short = "encoding: raw", "type: short"
    little = "endian: little"
    lps, ras = "space: left-posterior-superior", "space: RAS"
    packed = gzip.compress(ramp("<i2").tobytes(order="F"), mtime=0)
    yield "lps.nrrd", nrrd(short, little, raw, lps, *PLACED), ""
    yield "ras_packed.nrrd", nrrd(short, little, "encoding: gzip", ras, *PLACED, samples=packed), ""
    yield "las.nrrd", nrrd("type: float", little, raw, "space: LAS", *PLACED, dtype="<f4"), ""
    yield "no_space.nrrd", nrrd(short, little, raw, "space dimension: 3", *PLACED), ""
    yield "spacings.nrrd", nrrd("type: uchar", raw, "spacings: 0.5 1 2", 'units: "um" "um" "mm"', dtype="|u1"), ""
    yield "no_spacings.nrrd", nrrd("type: uchar", raw, dtype="|u1"), ""
    yield (
        "microns.nrrd",
        nrrd(short, little, raw, "space dimension: 3", *PLACED, 'space units: "\xb5m" "\xb5m" "nm"'),
        "",
    )
    yield "strange_unit.nrrd", nrrd(short, little, raw, "spacings: 1 1 1", 'units: "kpc" "mm" "mm"'), ""
    yield "keys.nrrd", nrrd(short, little, raw, lps, *PLACED, "modality:=CT", "unit:=cm", "value_unit:=HU"), ""
    yield "dicom_key.nrrd", nrrd(short, little, raw, lps, *PLACED, "0008|0060:=XA"), ""
    yield "sample_units.nrrd", nrrd(short, little, raw, lps, *PLACED, 'sample units: "Gy"'), ""
    axes = "space directions: (1,0,0) (0,1,0) (0,0,1)"
    yield "no_place.nrrd", nrrd(short, little, raw, lps, axes, "space origin: (0,0,0)"), ""
    yield "big_endian.nrrd", nrrd("type: int", "endian: big", raw, ras, *PLACED, dtype=">i4"), ""
    yield "wide.nrrd", nrrd("type: longlong", little, raw, ras, *PLACED, dtype="<i8"), ""
    yield "skipped.nrrd", nrrd(short, little, raw, ras, *PLACED, "byte skip: -1", between=b"other bytes"), ""
    yield "lines.nrrd", nrrd(short, little, raw, ras, *PLACED, "line skip: 2", between=b"one\ntwo\n"), ""
    yield "detached.nhdr", nrrd(short, little, raw, ras, *PLACED, "data file: detached.raw")[: -2 * 24], ""
    yield "comment.nrrd", nrrd("# a comment: of words", short, little, raw, ras, *PLACED), ""
    yield "truncated.nrrd", nrrd(short, little, raw, ras, *PLACED)[:-1], "truncated"
    yield "bzip2.nrrd", nrrd(short, little, "encoding: bzip2", ras, *PLACED), "bzip2"
    yield (
        "other_folder.nhdr",
        nrrd(short, little, raw, ras, *PLACED, "data file: ../a.raw")[: -2 * 24],
        "another folder",
    )
    yield "missing.nhdr", nrrd(short, little, raw, ras, *PLACED, "data file: none.raw")[: -2 * 24], "none.raw"


def phantoms() -> Iterator[tuple[str, bytes, str]]:
    """Files of several kinds of data, of which a preset shows a part."""
    x, y, z = np.meshgrid(*(np.arange(n, dtype=np.float32) for n in (26, 22, 18)), indexing="ij")
    away = np.sqrt((x - 16) ** 2 + (y - 9) ** 2 + (2 * (z - 8)) ** 2)
    body = np.select([away < 4, away < 9], [700, 40], -1000) + np.where((x + y + z) % 3 == 0, 7, 0)
    wave = np.sin(0.3 * x) * np.cos(0.25 * y) * np.cos(0.2 * z)
    oblique = "space directions: (0.7,0.1,0) (-0.1,0.8,0) (0,0,1.5)"
    places = {
        "patient": ("space: LPS", oblique),
        "plain": ("spacings: 1 1 2",),
        "um": ("spacings: 1 1 1", 'units: "um" "um" "um"'),
    }
    samples = {
        "ct": ("short", body.astype("<i2")),
        "mask": ("uchar", (away < 7).astype("|u1")),
        "labels": ("uchar", np.digitize(away, [3, 6, 9, 12]).astype("|u1")),
        "wave": ("float", np.round(8 * wave).astype("<f4") / 8),
        "holes": ("float", np.where(away < 5, np.round(900 - 30 * away), np.nan).astype("<f4")),
    }
    for name, (kind, numbers) in samples.items():
        content = gzip.compress(numbers.tobytes(order="F"), mtime=0)
        for place, lines in places.items():
            header = (
                "NRRD0005",
                "dimension: 3",
                "sizes: 26 22 18",
                f"type: {kind}",
                "endian: little",
                "encoding: gzip",
            )
            yield f"{name}_{place}.nrrd", "\n".join([*header, *lines]).encode() + b"\n\n" + content, ""
    yield from phantoms_by_modality(body[::2, ::2, ::2] + 1000)


def phantoms_by_modality(body: np.ndarray) -> Iterator[tuple[str, bytes, str]]:
    """Small files whose headers say what they hold, of looks that no other file has."""
    x, y, z = np.meshgrid(*map(np.arange, body.shape), indexing="ij")
    full = 90 + (7 * x + 3 * y + 5 * z) % 23
    for name, modality, samples in (
        ("uptake", "PT", body),
        ("echoes", "US", body),
        ("dose", "RTDOSE", body),
        ("block", "MR", full),
    ):
        header = ["NRRD0005", "type: short", "dimension: 3", "sizes: " + " ".join(map(str, samples.shape))]
        header += ["endian: little", "encoding: gzip", "space: LPS", "space directions: (2,0,0) (0,2,0) (0,0,3)"]
        content = gzip.compress(samples.astype("<i2").tobytes(order="F"), mtime=0)
        yield f"{name}.nrrd", "\n".join([*header, f"modality:={modality}"]).encode() + b"\n\n" + content, ""
    shares = np.clip(np.abs(body - 900) / 1000, 0, 1).astype("<f4")
    yield "p_values.nii", nifti(samples=shares, intent_code=22), ""
    yield "prob.nii", nifti(samples=shares), ""
    noise = (7 * x * x + 13 * y * y + 29 * z * z + x * y * z) % 17
    glow = 3 + noise + 60 * (body > 1000) + 900 * ((body > 1600) & ((x + y + z) % 7 == 0))
    content = glow.astype("<u2").tobytes(order="F")
    header = ["NRRD0005", "type: ushort", "dimension: 3", "sizes: " + " ".join(map(str, glow.shape)), "endian: little"]
    header += ["encoding: raw", "spacings: 1 1 1", 'units: "um" "um" "um"']
    yield "light.nrrd", "\n".join(header).encode() + b"\n\n" + content, ""


def found(path: Path) -> dict[str, Any]:
    """Size, type, affine and facts of a file, a checksum of its samples, their kind, and the camera of a preset."""
    import wavesplat as ws
    from wavesplat._looks.kinds.kinds import found_in
    from wavesplat._render.framing import framed, natural_view

    volume = ws.open(path)
    camera = framed([(volume, ws.Look.preset("ct-bone"))], *natural_view(volume))
    samples = volume.samples
    return {
        "size": list(samples.shape[::-1]),
        "type": samples.dtype.name,
        "crc32": zlib.crc32(samples.astype(samples.dtype.newbyteorder("<")).tobytes()),
        "affine": volume.world_from_index[:3].tolist(),
        "facts": {name: value for name, value in volume.facts.as_json().items() if name in FACTS},
        "kind": [found_in(volume).kind, found_in(volume).reason],
        "camera": [*camera.position, *camera.focal_point, *camera.view_up, camera.parallel_scale],
        "look": look_of(volume),
    }


def look_of(volume: Any) -> dict[str, Any] | str | None:
    """The automatic look of a volume, its nodes summed up, and the camera of its picture; None where it has none."""
    import wavesplat as ws
    from wavesplat._render.arguments import chosen_camera
    from wavesplat._render.framing import EVERYTHING
    from wavesplat._render.opened import cut_open_from

    try:
        look = ws.Look.auto(volume)
    except ws.ArgumentError:
        return None
    if look.labels is not None:
        return "labels"
    function = look.transfer_function
    drawn = volume if look.part is None else cut_open_from(volume, look.view)
    camera = chosen_camera(None, [(drawn, look)], EVERYTHING, 1.0)
    light = look.shading and [look.shading.specular, look.shading.ambient_occlusion]
    return {
        "words": [look.composite, look.background, look.view, look.part, look.reason],
        "light": light,
        "unit": function.opacity_unit,
        "opacity": _summed(function.opacity),
        "color": _summed(function.color),
        "camera": [float(f"{number:.9e}") for number in (*camera.position, camera.parallel_scale)],
    }


def _summed(nodes: Any) -> list[float]:
    """The number of nodes, and of each column the sum of its numbers times their places, 1 for the first node."""
    places = np.arange(1.0, len(nodes) + 1)
    return [len(nodes), *(float(f"{places @ column:.9e}") for column in np.array(nodes).T)]


def lines() -> Iterator[str]:
    """A line of JSON for each file."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        (folder / "detached.raw").write_bytes(ramp("<i2").tobytes(order="F"))
        for name, content, reason in files():
            (folder / name).write_bytes(content)
            line = {"file": name, "bytes": content.hex(), **({"refused": reason} if reason else found(folder / name))}
            yield json.dumps(line)


if __name__ == "__main__":
    print("\n".join(lines()))
