"""Small OME-Zarr files for tests: images with labels, series of bioformats2raw, plates, zip archives."""

from __future__ import annotations

import zipfile

import numpy as np

LOOK = {
    "colors": [{"label-value": 1, "rgba": [255, 0, 0, 255]}, {"label-value": 2, "rgba": [0, 0, 255, 255]}],
    "properties": [{"label-value": 1, "class": "nucleus"}],
}


def cells(shape=(20, 24, 24)):
    """An image of two bright balls, and their numbers."""
    z, y, x = np.ogrid[tuple(map(slice, shape))]
    near, far = ((z - 10) ** 2 + (y - 12) ** 2 + (x - middle) ** 2 <= 25 for middle in (6, 17))
    numbers = (near + 2 * far).astype(np.uint16)
    return (50 + 400 * (numbers > 0)).astype(np.uint16), numbers


def _described(group, attributes, version):
    group.attrs.update(attributes if version == "0.4" else {"ome": {"version": version, **attributes}})


def write_image(group, samples, *, labels=None, version="0.5", more=None):
    """Write an image of two levels; `labels`: numbers and metadata of segmentations, by name."""
    datasets = []
    for level in range(2):
        step = 2**level
        group.create_array(str(level), data=samples[::step, ::step, ::step], chunks=(8, 8, 8))
        scale = [{"type": "scale", "scale": [1.0 * step, 0.5 * step, 0.5 * step]}]
        datasets.append({"path": str(level), "coordinateTransformations": scale})
    axes = [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    _described(group, {"multiscales": [{"axes": axes, "datasets": datasets}], **(more or {})}, version)
    if labels:
        inner = group.create_group("labels")
        _described(inner, {"labels": list(labels)}, version)
        for name, (numbers, look) in labels.items():
            own = inner.create_group(name)
            write_image(own, numbers, version=version, more={"image-label": look})


def opened(path, version="0.5"):
    """A new group."""
    import zarr

    return zarr.open_group(path, mode="w", zarr_format=2 if version == "0.4" else 3)


def labelled(path, version="0.5"):
    """An image with the labels `nuclei`, in colours, and `plain`."""
    samples, numbers = cells()
    write_image(
        opened(path, version), samples, labels={"nuclei": (numbers, LOOK), "plain": (numbers, {})}, version=version
    )
    return path


def series(path, version="0.5", *, is_listed=True):
    """Two images as bioformats2raw writes them, the second brighter."""
    group = opened(path, version)
    _described(group, {"bioformats2raw.layout": 3}, version)
    samples, numbers = cells()
    for number in range(2):
        labels = {"nuclei": (numbers, LOOK)} if number == 0 else None
        write_image(group.create_group(str(number)), samples + 1000 * number, labels=labels, version=version)
    if is_listed:
        _described(group.create_group("OME"), {"series": ["0", "1"]}, version)
        (path / "OME" / "METADATA.ome.xml").write_text(
            '<?xml version="1.0"?><OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06">'
            '<Image ID="Image:0" Name="left"/><Image ID="Image:1" Name="right"/></OME>'
        )
    return path


def plate(path, version="0.5", *, n_fields=1):
    """A plate of wells A1, A2, B1 and B2, each brighter than the one before."""
    group = opened(path, version)
    wells = []
    for number, (row, column) in enumerate(("A1", "A2", "B1", "B2")):
        well = group.create_group(f"{row}/{column}")
        _described(well, {"well": {"images": [{"path": str(field)} for field in range(n_fields)]}}, version)
        for field in range(n_fields):
            write_image(well.create_group(str(field)), cells()[0] + 100 * number + field, version=version)
        wells.append({"path": f"{row}/{column}", "rowIndex": number // 2, "columnIndex": number % 2})
    rows, columns = ([{"name": name} for name in names] for names in ("AB", "12"))
    _described(group, {"plate": {"rows": rows, "columns": columns, "wells": wells}}, version)
    return path


def zipped(folder, archive, *, top="", packing=zipfile.ZIP_STORED):
    """The files of a folder in an archive, below `top`."""
    with zipfile.ZipFile(archive, "w", packing) as out:
        for file in sorted(folder.rglob("*")):
            if file.is_file():
                out.write(file, f"{top}{file.relative_to(folder).as_posix()}")
    return archive
