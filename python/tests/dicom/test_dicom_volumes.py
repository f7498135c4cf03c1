"""Frames at the same place belong to the volumes that their attributes name, whatever their instance numbers are."""

from __future__ import annotations

import itertools
import warnings

import numpy as np
import pytest
from dicom_files import base, enhanced, random, save, sequence, slice_at

import wavesplat as ws
from wavesplat.errors import FileError, FileWarning

N_VOLUMES, N_SLICES = 3, 4

#: Attributes of the files, by volume and slice, for each kind of series.
KINDS = {
    "temporal position": lambda t, _: {"TemporalPositionIdentifier": t + 1},
    "trigger time": lambda t, _: {"TriggerTime": 33.5 * t},
    "trigger time of a heart that is not even": lambda t, z: {"TriggerTime": 33.5 * t + 0.7 * z},
    "acquisition time": lambda t, _: {"AcquisitionTime": f"1200{10 + 7 * t}.5"},
    "acquisition time, slice by slice": lambda t, z: {"AcquisitionTime": f"12{10 + t}{10 + 7 * z}.25"},
    "acquisition past midnight": lambda t, _: {
        "AcquisitionTime": ("235950", "235958.5", "000003")[t],
        "AcquisitionDate": ("20200131", "20200131", "20200201")[t],
    },
    "acquisition date and time": lambda t, z: {"AcquisitionDateTime": f"2020010112{10 + t}{10 + z}.0+0100"},
    "content time": lambda t, _: {"ContentTime": f"12{10 + t}10"},
    "acquisition number": lambda t, _: {"AcquisitionNumber": t + 1},
    "acquisition number, place by place": lambda t, z: {"AcquisitionNumber": z * N_VOLUMES + t + 1},
    "reference time": lambda t, _: {"FrameReferenceTime": 1500.0 * t},
    "echo time": lambda t, _: {"EchoTime": 2.3 * (t + 1)},
    "echo time, rounded otherwise in a slice": lambda t, z: {"EchoTime": 2.3 * (t + 1) + (1e-4 if z == 1 else 0)},
    "echo number": lambda t, _: {"EchoNumbers": t + 9},
    "image type": lambda t, _: {"ImageType": ["ORIGINAL", "PRIMARY", "MPI"[t], "NORM"]},
    "b-value": lambda t, _: {"DiffusionBValue": 500.0 * t},
    "b-value of Siemens": lambda t, _: {"private": (0x0019, "SIEMENS MR HEADER", 0x0C, "IS", str(500 * t))},
    "b-value of GE": lambda t, _: {"private": (0x0043, "GEMS_PARM_01", 0x39, "IS", [f"{10**9 + 500 * t}", "8", "0"])},
    "direction": lambda t, _: {"DiffusionBValue": 1000.0, "DiffusionGradientOrientation": np.eye(3)[2 - t].tolist()},
    "heart phase": lambda t, _: {"NominalPercentageOfCardiacPhase": 10.0 * t + 40},
    "flip angle": lambda t, _: {"FlipAngle": 5.0 * t + 2},
    "inversion time": lambda t, _: {"InversionTime": 100.0 * (t + 1)},
    "contrast": lambda t, _: {} if t == 0 else {"ContrastBolusAgent": ("", "early", "late")[t]},
    "kernel": lambda t, _: {"ConvolutionKernel": ("B30f", "B50f", "B70f")[t]},
}
#: Instance numbers by volume and slice.
ORDER = np.random.default_rng(8).permutation(N_VOLUMES * N_SLICES)
NUMBERS = {
    "by volume": lambda t, z: t * N_SLICES + z,
    "by slice": lambda t, z: z * N_VOLUMES + t,
    "up and down": lambda t, z: z * N_VOLUMES + (t if z % 2 else N_VOLUMES - 1 - t),
    "random": lambda t, z: int(ORDER[t * N_SLICES + z]),
    "equal": lambda *_: 1,
}


def written(folder, kind, numbers=NUMBERS["random"], n_volumes=N_VOLUMES, leave_out=()):
    """Write files whose samples are 100 times the volume's number plus the slice's; their names depend on neither."""
    files = []
    names = np.random.default_rng(3).permutation(n_volumes * N_SLICES)
    for t, z in itertools.product(range(n_volumes), range(N_SLICES)):
        attributes = kind(t, z)
        private = attributes.pop("private", None)
        pixels = np.full((6, 7), 100 * t + z, np.uint16)
        dataset = slice_at(pixels, numbers(t, z), z=3.0 * z, **attributes)
        if private is not None:
            group, creator, element, code, value = private
            dataset.private_block(group, creator, create=True).add_new(element, code, value)
        uid = f"1.2.3.{names[t * N_SLICES + z] + 1}"
        dataset.SOPInstanceUID = dataset.file_meta.MediaStorageSOPInstanceUID = uid
        files.append((names[t * N_SLICES + z], (t, z), dataset))
    chosen = [dataset for _, place, dataset in sorted(files, key=lambda file: file[0]) if place not in leave_out]
    return save(folder, chosen)


def check_volumes(folder, n_volumes=N_VOLUMES, wanted=None):
    """Check that each volume has its own slices alone, in order."""
    series = ws.open_series(folder)
    assert len(series) == n_volumes
    for t, volume in enumerate(series):
        own = 100 * (t if wanted is None else wanted[t]) + np.arange(N_SLICES)
        np.testing.assert_array_equal(volume.samples, np.broadcast_to(own[:, None, None], (N_SLICES, 6, 7)))
        assert volume.facts.n_times == n_volumes
    return series


@pytest.mark.parametrize(
    ("kind", "numbers"),
    [
        *((kind, "up and down") for kind in KINDS),
        *((kind, numbers) for kind in ("temporal position", "echo time", "image type") for numbers in NUMBERS),
    ],
)
def test_attributes_tell_frames_of_a_place_apart(tmp_path, kind, numbers):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        series = check_volumes(written(tmp_path / "mr", KINDS[kind], NUMBERS[numbers]))
    assert series[0].guesses == ()


def test_two_slices_at_two_times(tmp_path):
    datasets = [
        slice_at(np.full((6, 7), 100 * time + place, np.uint16), number, z=place, TemporalPositionIdentifier=time)
        for time, place, number in ((1, 0.0, 1), (1, 3.0, 4), (2, 0.0, 2), (2, 3.0, 3))
    ]
    series = ws.open_series(save(tmp_path / "mr", datasets))
    assert [np.unique(volume.samples).tolist() for volume in series] == [[100, 103], [200, 203]]


@pytest.mark.parametrize("numbers", NUMBERS)
def test_several_attributes_together(tmp_path, numbers):
    """Two echoes at three times, each slice with its own clock: the order is by echo first, then by time."""

    def kind(t, z):
        echo, time = divmod(t, 3)
        clock = 120000 + 10 * time + z + 0.5 * echo
        return {"EchoTime": (9.2, 4.6)[echo], "AcquisitionTime": f"{clock:.2f}", "ContentTime": f"{120059 - t - z}"}

    def number(t, z):
        # Instance numbers for six volumes instead of three.
        return NUMBERS[numbers](t % 3, z) + (12 if numbers != "equal" and t >= 3 else 0)

    folder = written(tmp_path / "mr", kind, number, n_volumes=6)
    check_volumes(folder, 6, wanted=[3, 4, 5, 0, 1, 2])


def test_b_values_and_directions_together(tmp_path):
    directions = [None, *np.eye(3).tolist(), *np.eye(3).tolist()]

    def kind(t, z):
        b_value = {"DiffusionBValue": (0.0, 1000.0, 1000.0, 1000.0, 2000.0, 2000.0, 2000.0)[t]}
        return b_value if t == 0 else {**b_value, "DiffusionGradientOrientation": directions[t]}

    series = check_volumes(written(tmp_path / "mr", kind, lambda *_: 1, n_volumes=7), 7, [0, 3, 2, 1, 6, 5, 4])
    assert series.times == tuple(range(7))


@pytest.mark.parametrize("numbers", ["by volume", "by slice"])
def test_directions_are_in_the_order_of_acquisition(tmp_path, numbers):
    """As in a .bvec file: pictures without diffusion in between keep their places."""
    directions = [None, [1, 0, 0], [0, 0.6, 0.8], None, [0, 1, 0], None]

    def kind(t, z):
        clock = {"AcquisitionTime": f"12{10 + t}{10 + z}"}
        if directions[t] is None:
            return {**clock, "DiffusionBValue": 0.0}
        return {**clock, "DiffusionBValue": 1000.0, "DiffusionGradientOrientation": directions[t]}

    number = {"by volume": lambda t, z: t * N_SLICES + z, "by slice": lambda t, z: z * 6 + t}[numbers]
    check_volumes(written(tmp_path / "mr", kind, number, n_volumes=6), 6)


def test_identifiers_of_time_order_volumes_of_any_kind(tmp_path):
    """The order is that of acquisition: weighted and unweighted volumes in turns."""
    kind = lambda t, _: {"TemporalPositionIdentifier": t + 1, "DiffusionBValue": 1000.0 * (t % 2)}  # noqa: E731
    check_volumes(written(tmp_path / "mr", kind, NUMBERS["equal"], n_volumes=4), 4)


@pytest.mark.parametrize("numbers", ["by volume", "by slice", "equal"])
def test_texts_are_in_the_order_of_times_or_numbers(tmp_path, numbers):
    phases = ("plain", "arterial", "venous")
    kind = lambda t, z: {"ContrastBolusAgent": phases[t], "ContentTime": f"1200{10 * t + z:02}"}  # noqa: E731
    check_volumes(written(tmp_path / "a", kind, NUMBERS[numbers]))
    if numbers != "equal":
        check_volumes(written(tmp_path / "b", lambda t, _: {"SeriesDescription": phases[t]}, NUMBERS[numbers]))


def test_an_attribute_that_is_not_the_same_at_every_place_does_not_count(tmp_path):
    """Here flip angles are written at random; trigger times separate the volumes."""
    kind = lambda t, z: {"FlipAngle": float((7 * t + 5 * z * z) % 4), "TriggerTime": 30.0 * t}  # noqa: E731
    check_volumes(written(tmp_path / "mr", kind))


def test_places_are_the_same_to_a_hundredth_of_a_pixel(tmp_path):
    """Positions that fall into different cells of a grid of rounded numbers belong together all the same."""
    datasets = [
        slice_at(np.full((6, 7), 100 * t + z, np.uint16), 1, z=3.0 * z + 0.005 + (-1e-4, 1e-4)[t], TriggerTime=30 * t)
        for t, z in itertools.product(range(2), range(N_SLICES))
    ]
    for number, dataset in enumerate(datasets):
        dataset.SOPInstanceUID = dataset.file_meta.MediaStorageSOPInstanceUID = f"1.2.3.{number + 1}"
    check_volumes(save(tmp_path / "mr", datasets), 2)


def test_times_are_those_of_the_clock(tmp_path):
    assert ws.open_series(written(tmp_path / "a", KINDS["acquisition past midnight"])).times == (0, 8.5, 13)
    assert ws.open_series(written(tmp_path / "b", KINDS["trigger time"])).times == pytest.approx((0, 0.0335, 0.067))
    echoes = lambda t, _: {"EchoTime": float(t + 1), "ContentTime": f"12000{t}"}  # noqa: E731
    assert ws.open_series(written(tmp_path / "c", echoes)).time_unit is None  # echoes are not times


# Messages


@pytest.mark.parametrize(
    ("kind", "labels"),
    [
        ("temporal position", ["temporal position 1", "temporal position 2", "temporal position 3"]),
        ("echo time", ["echo time 2.3 ms", "echo time 4.6 ms", "echo time 6.9 ms"]),
        ("image type", ["M", "P", "I"]),
        ("acquisition time", ["acquisition time +0 s", "acquisition time +7 s", "acquisition time +14 s"]),
        ("contrast", ["no contrast agent", "contrast agent early", "contrast agent late"]),
        ("direction", ["direction (0, 0, 1)", "direction (0, 1, 0)", "direction (1, 0, 0)"]),
        ("heart phase", ["cardiac phase 40 %", "cardiac phase 50 %", "cardiac phase 60 %"]),
    ],
)
def test_info_lists_what_tells_volumes_apart(wavesplat, tmp_path, kind, labels):
    done = wavesplat("info", written(tmp_path / "mr", KINDS[kind], NUMBERS["equal"]))
    assert done.returncode == 0, done.stderr
    assert f"choose with --time: {', '.join(f'{n} {label}' for n, label in enumerate(labels))}" in done.stdout


def test_the_error_that_asks_lists_it_too(tmp_path):
    with pytest.raises(FileError, match=r"3 time points \(0 echo time 2.3 ms, 1 echo time 4.6 ms, 2 echo"):
        ws.open(written(tmp_path / "mr", KINDS["echo time"]))


def test_numbers_alone_are_a_guess(tmp_path):
    series = check_volumes(written(tmp_path / "mr", lambda *_: {}, NUMBERS["by slice"]))
    assert "instance numbers: nothing else in the headers says" in series[0].guesses[0]


def test_names_alone_are_a_warning(tmp_path):
    folder = written(tmp_path / "mr", lambda *_: {}, NUMBERS["equal"])
    with pytest.warns(FileWarning, match="nothing in the headers says which of the 3 slices .* order of file names"):
        ws.open(folder, time=0)


# Missing and doubled


def test_missing_slices_are_those_of_their_volume(tmp_path):
    folder = written(tmp_path / "mr", KINDS["echo time"], leave_out=[(1, 2), (2, 3)])
    np.testing.assert_array_equal(ws.open(folder, time=0).samples[:, 0, 0], np.arange(4))
    with pytest.warns(FileWarning, match="1 slice is missing .*: filled in from their neighbours"):
        volume = ws.open(folder, time=1)
    np.testing.assert_array_equal(volume.samples[:, 0, 0], 100 + np.arange(4))
    with pytest.warns(FileWarning, match="1 slice is missing at its end, .*: it has 3 of 4"):
        volume = ws.open(folder, time=2)
    np.testing.assert_array_equal(volume.samples[:, 0, 0], 200 + np.arange(3))
    for time in (1, 2):
        with pytest.raises(FileError, match="missing"):
            ws.open(folder, time=time, gaps="refuse")


def test_missing_slices_of_clocks_that_differ_are_refused(tmp_path):
    folder = written(tmp_path / "mr", KINDS["acquisition time, slice by slice"], leave_out=[(1, 2)])
    with pytest.raises(FileError, match="3 slices at position .*, 2 at others: a slice is missing or doubled"):
        ws.open(folder, time=0)


def test_doubled_slices_are_named(tmp_path):
    folder = written(tmp_path / "mr", KINDS["echo time"])
    from pydicom import dcmread

    other = dcmread(folder / "003.dcm")
    other.SOPInstanceUID = other.file_meta.MediaStorageSOPInstanceUID = "1.2.3.99"
    other.save_as(folder / "copy.dcm")
    with pytest.raises(FileError, match=r"nothing in the headers distinguishes (003|copy).dcm from (003|copy).dcm"):
        ws.open(folder, time=0)
    (folder / "copy.dcm").write_bytes((folder / "003.dcm").read_bytes())
    check_volumes(folder)  # a file of the same UID is a copy


def test_files_of_one_uid_that_lie_elsewhere_are_no_copies(tmp_path):
    datasets = [slice_at(pixels, number) for number, pixels in enumerate(random(4))]
    for dataset in datasets:
        dataset.SOPInstanceUID = dataset.file_meta.MediaStorageSOPInstanceUID = "1.2.3"
    assert ws.open(save(tmp_path / "ct", datasets)).shape == (4, 6, 7)


def test_the_file_that_is_named_is_read_not_its_damaged_copy(tmp_path):
    pixels = random(3)
    folder = save(tmp_path / "ct", [slice_at(one, number) for number, one in enumerate(pixels)])
    (folder / "zz.dcm").write_bytes((folder / "001.dcm").read_bytes()[:-40])
    np.testing.assert_array_equal(ws.open(folder / "001.dcm").samples, pixels)


# Enhanced files

#: Functional groups with the same attributes as `KINDS`.
GROUPS = {
    "temporal position": lambda t: {"FrameContentSequence": {"TemporalPositionIndex": t + 1}},
    "echo": lambda t: {"MREchoSequence": {"EffectiveEchoTime": 2.5 * (t + 1)}},
    "b-value": lambda t: {"MRDiffusionSequence": {"DiffusionBValue": 500.0 * t}},
    "direction": lambda t: {
        "MRDiffusionSequence": {
            "DiffusionBValue": 500.0,
            "DiffusionGradientDirectionSequence": {"DiffusionGradientOrientation": np.eye(3)[2 - t].tolist()},
        }
    },
    "heart": lambda t: {"CardiacSynchronizationSequence": {"NominalPercentageOfCardiacPhase": 20.0 * t}},
    "trigger delay": lambda t: {"CardiacSynchronizationSequence": {"NominalCardiacTriggerDelayTime": 20.5 * t}},
    "flip angle": lambda t: {"MRTimingAndRelatedParametersSequence": {"FlipAngle": 10.0 * (t + 1)}},
    "type": lambda t: {"MRImageFrameTypeSequence": {"FrameType": ["ORIGINAL", "PRIMARY", "MPI"[t], "NONE"]}},
    "component": lambda t: {
        "MRImageFrameTypeSequence": {"ComplexImageComponent": ("MAGNITUDE", "PHASE", "IMAGINARY")[t]}
    },
    "contrast": lambda t: {"ContrastBolusUsageSequence": {"ContrastBolusAgentPhase": ("ARTERIAL", "PRE", "VENOUS")[t]}},
    "clock": lambda t: {"FrameContentSequence": {"FrameAcquisitionDateTime": f"20200101120{t}00.5"}},
    "spin labelling": lambda t: {"MRArterialSpinLabelingSequence": {"ASLContext": ("CONTROL", "LABEL", "M0")[t]}},
}


def frames_of(kind, order):
    """An enhanced file with its frames in the order `order`."""
    places = [divmod(int(n), N_SLICES) for n in order]
    pixels = np.array([np.full((6, 7), 100 * t + z, np.uint16) for t, z in places])
    dataset = enhanced(pixels, [(1.5 * z,) for _, z in places])
    for (t, _), group in zip(places, dataset.PerFrameFunctionalGroupsSequence, strict=True):
        del group.FrameContentSequence[0].TemporalPositionIndex, group.FrameContentSequence[0].DimensionIndexValues
        del group.MRImageFrameTypeSequence
        for name, values in GROUPS[kind](t).items():
            if name == "FrameContentSequence":
                for one, value in values.items():
                    setattr(group.FrameContentSequence[0], one, value)
            else:
                setattr(group, name, sequence(values))
    return dataset


@pytest.mark.parametrize("kind", GROUPS)
def test_functional_groups_tell_frames_apart(tmp_path, kind):
    folder = save(tmp_path / "mr", [frames_of(kind, ORDER)])
    series = check_volumes(folder)
    assert series[0].guesses == ()


@pytest.mark.parametrize("is_explained", [True, False])
def test_indices_of_an_enhanced_file_order_its_volumes(tmp_path, is_explained):
    """Philips numbers b-values and directions; some exports leave out which index is which.

    The indices, stack, place, b-value and direction, are those of a public file, philips_enhanced/dti/001 of
    icometrix/dicom2nifti, whose frames without diffusion have the last direction. Temporal positions are against them.
    """
    directions = [None, [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-0.026, -0.649, 0.76]]
    places = [divmod(int(n), N_SLICES) for n in np.random.default_rng(5).permutation(4 * N_SLICES)]
    pixels = np.array([np.full((6, 7), 100 * t + z, np.uint16) for t, z in places])
    dataset = enhanced(pixels, [(1.5 * z,) for _, z in places])
    for (t, z), group in zip(places, dataset.PerFrameFunctionalGroupsSequence, strict=True):
        content = group.FrameContentSequence[0]
        content.DimensionIndexValues = [1, z + 1, 1 if t == 0 else 2, 65 if t == 0 else t]
        content.TemporalPositionIndex = 4 - t
        direction = (
            {} if t == 0 else {"DiffusionGradientDirectionSequence": {"DiffusionGradientOrientation": directions[t]}}
        )
        group.MRDiffusionSequence = sequence({"DiffusionBValue": 1300.0 if t else 0.0, **direction})
    pointers = (0x00209056, 0x00209057, 0x00189087, 0x00189089)
    dataset.DimensionIndexSequence = sequence(*({"DimensionIndexPointer": tag} for tag in pointers))
    if not is_explained:
        del dataset.DimensionIndexSequence
    check_volumes(save(tmp_path / "mr", [dataset]), 4)


def test_frames_of_a_file_in_its_order_are_a_guess(tmp_path):
    frames = [(1.5 * (n % 4),) for n in range(8)]
    dataset = enhanced(np.array([np.full((6, 7), 100 * (n // 4) + n % 4, np.uint16) for n in range(8)]), frames)
    series = check_volumes(save(tmp_path / "mr", [dataset]), 2)
    assert "in the order of the file" in series[0].guesses[0]


def test_time_slots_of_a_tomogram(tmp_path):
    """Nuclear medicine has a list of numbers for all frames of a file."""
    places = [divmod(int(n), N_SLICES) for n in ORDER]
    pixels = np.array([np.full((6, 7), 100 * t + z, np.uint16) for t, z in places])
    dataset = base(pixels, modality="NM", NumberOfFrames=len(pixels), PixelSpacing=[0.8, 0.7], SliceThickness=1.5)
    dataset.DetectorInformationSequence = sequence(
        {"ImagePositionPatient": [0, 0, 0], "ImageOrientationPatient": [1, 0, 0, 0, 1, 0]}
    )
    dataset.TimeSlotVector, dataset.SliceVector = [t + 1 for t, _ in places], [z + 1 for _, z in places]
    check_volumes(save(tmp_path / "nm", [dataset]))
