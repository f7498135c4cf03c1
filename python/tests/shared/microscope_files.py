"""Small files in the layouts of Imaris and BigDataViewer, for tests."""

from __future__ import annotations

import json

import h5py
import numpy as np


def image(n_times=1, n_channels=2, shape=(6, 10, 12), dtype=np.uint16):
    """Random samples [time, channel, z, y, x]."""
    return np.random.default_rng(6).integers(1, 60000, (n_times, n_channels, *shape)).astype(dtype)


def halved(samples):
    """Means of blocks of 2 x 2 x 2 samples; ends that are no whole block are left out."""
    z, y, x = (n // 2 * 2 for n in samples.shape)
    blocks = samples[:z, :y, :x].reshape(z // 2, 2, y // 2, 2, x // 2, 2).astype(np.float64)
    return blocks.mean(axis=(1, 3, 5)).astype(samples.dtype)


def at_level(samples, level):
    """The samples of a level: 0 is the finest."""
    return samples if level == 0 else at_level(halved(samples), level - 1)


def letters(text):
    """A text as Imaris stores attributes: an array of single letters."""
    return np.array([letter.encode() for letter in text], "S1")


def save_imaris(path, samples, *, image_info=(), channels=(), times=(), n_levels=2, chunk=8, **more):
    """Write an Imaris file; datasets are filled up to whole chunks with 7, which are no samples of the image."""
    with h5py.File(path, "w") as file:
        for level in range(n_levels):
            for t, of_time in enumerate(samples):
                for c, finest in enumerate(of_time):
                    one = at_level(finest, level)
                    group = file.create_group(f"DataSet/ResolutionLevel {level}/TimePoint {t}/Channel {c}")
                    padded = np.full([-(-n // chunk) * chunk for n in one.shape], 7, one.dtype)
                    padded[tuple(slice(n) for n in one.shape)] = one
                    group.create_dataset("Data", data=padded, chunks=(chunk,) * 3, compression="gzip", **more)
                    for axis, n in zip("ZYX", one.shape, strict=True):
                        group.attrs[f"ImageSize{axis}"] = letters(str(n))
        z, y, x = samples.shape[2:]
        info = {"X": x, "Y": y, "Z": z, "Unit": "um", "ExtMin0": 10, "ExtMin1": 20, "ExtMin2": -3}
        info |= {"ExtMax0": 10 + 0.2 * x, "ExtMax1": 20 + 0.2 * y, "ExtMax2": -3 + 1.0 * z, **dict(image_info)}
        groups = {"Image": info, "TimeInfo": {f"TimePoint{n + 1}": text for n, text in enumerate(times)}}
        groups |= {f"Channel {n}": one for n, one in enumerate(channels)}
        for name, values in groups.items():
            group = file.create_group(f"DataSetInfo/{name}")
            for key, value in values.items():
                if value is not None:
                    group.attrs[key] = letters(str(value))
    return path


def save_bdv_samples(path, samples, *, n_levels=2, stored=np.int16):
    """Write an HDF5 file of BigDataViewer, whose samples of uint16 are stored as int16."""
    with h5py.File(path, "w") as file:
        for s in range(samples.shape[1]):
            file[f"s{s:02d}/resolutions"] = np.array([[2.0**level] * 3 for level in range(n_levels)])
            file[f"s{s:02d}/subdivisions"] = np.array([[8, 8, 8]] * n_levels, np.int32)
            for t in range(samples.shape[0]):
                for level in range(n_levels):
                    one = at_level(samples[t, s], level)
                    cells = one.view(stored) if one.dtype == np.uint16 else one
                    file.create_dataset(
                        f"t{t:05d}/s{s:02d}/{level}/cells", data=cells, chunks=tuple(min(2, n) for n in one.shape)
                    )
    return path


#: The affine of a registration with voxels of 0.2 x 0.2 x 1 and a shift, row by row.
REGISTERED = "0.2 0 0 5  0 0.2 0 6  0 0 1 7"


def bdv_xml(
    *,
    name="bdv.h5",
    n_setups=2,
    voxel="0.2 0.2 1.0",
    unit="µm",
    transforms=(REGISTERED,),
    times="<first>0</first><last>0</last>",
    attributes=lambda setup: {"channel": setup},
    of_channels="",
    format="bdv.hdf5",
    n_times=1,
    extra="",
    tag="hdf5",
):
    """The text of an XML of BigDataViewer."""
    setups = ""
    for s in range(n_setups):
        own = "".join(f"<{kind}>{value}</{kind}>" for kind, value in attributes(s).items())
        size = f"<voxelSize><unit>{unit}</unit><size>{voxel}</size></voxelSize>" if voxel else ""
        setups += f"<ViewSetup><id>{s}</id>{size}<attributes>{own}</attributes></ViewSetup>"
    views = ""
    for t in range(n_times):
        for s in range(n_setups):
            given = transforms(s) if callable(transforms) else transforms
            parts = "".join(f'<ViewTransform type="affine"><affine>{one}</affine></ViewTransform>' for one in given)
            views += f'<ViewRegistration timepoint="{t}" setup="{s}">{parts}</ViewRegistration>' if parts else ""
    kind = "pattern" if "integerpattern" in times else "range"
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<SpimData version="0.2"><BasePath type="relative">.</BasePath>'
        f'<SequenceDescription><ImageLoader format="{format}"><{tag} type="relative">{name}</{tag}></ImageLoader>'
        f'<ViewSetups>{setups}{of_channels}</ViewSetups><Timepoints type="{kind}">{times}</Timepoints>{extra}'
        f"</SequenceDescription><ViewRegistrations>{views}</ViewRegistrations></SpimData>"
    )


def save_bdv(folder, samples, **options):
    """Write both files; the path of the XML."""
    save_bdv_samples(folder / "bdv.h5", samples)
    xml = folder / "bdv.xml"
    xml.write_text(bdv_xml(n_setups=samples.shape[1], n_times=samples.shape[0], **options), encoding="utf-8")
    return xml


def save_bdv_n5(folder, samples, *, name="bdv.n5", n_levels=2, compression="gzip", **options):
    """Write a folder of N5 with uint16 as it is, and its XML; the path of the XML."""
    import tensorstore

    root = folder / name
    root.mkdir()
    (root / "attributes.json").write_text('{"n5": "2.5.1"}')
    for s in range(samples.shape[1]):
        (root / f"setup{s}").mkdir()
        told = {"dataType": str(samples.dtype), "downsamplingFactors": [[2**level] * 3 for level in range(n_levels)]}
        (root / f"setup{s}" / "attributes.json").write_text(json.dumps(told))
        for t in range(samples.shape[0]):
            for level in range(n_levels):
                one = at_level(samples[t, s], level)
                place = {"driver": "file", "path": str(root / f"setup{s}/timepoint{t}/s{level}")}
                metadata = {
                    "dimensions": one.shape[::-1],
                    "blockSize": [4, 3, 2],
                    "dataType": str(one.dtype),
                    "compression": {"type": compression},
                }
                spec = {"driver": "n5", "kvstore": place, "metadata": metadata}
                tensorstore.open(spec, create=True).result()[...] = one.T
    xml = folder / "bdv.xml"
    own = {"n_setups": samples.shape[1], "n_times": samples.shape[0], "format": "bdv.n5", "tag": "n5", "name": name}
    xml.write_text(bdv_xml(**own, **options), encoding="utf-8")
    return xml
