"""Units of DICOM values, and standardised uptake values (SUV) of PET."""

from __future__ import annotations

import json
import math
import re
from datetime import datetime, timedelta

import numpy as np
import pytest
from dicom_files import base, random, save, sequence, slice_at

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

F18_S = 6586.2
SCAN = datetime(2020, 3, 1, 10, 30)
INJECTED = SCAN - timedelta(minutes=65)
DOSE, WEIGHT = 350e6, 72.5


def drug(**changes):
    said = {
        "RadionuclideTotalDose": DOSE,
        "RadionuclideHalfLife": F18_S,
        "RadiopharmaceuticalStartDateTime": INJECTED.strftime("%Y%m%d%H%M%S"),
        **changes,
    }
    return {name: value for name, value in said.items() if value is not None}


def at(time, kind):
    return {f"{kind}Date": time.strftime("%Y%m%d"), f"{kind}Time": time.strftime("%H%M%S.%f")}


def pet(folder, pixels=None, *, of_drug=None, each=None, without=(), **changes):
    """A PET series. `each`: attributes of a slice by its number."""
    pixels = random(4) if pixels is None else pixels
    said = {
        "modality": "PT",
        "Units": "BQML",
        "CorrectedImage": ["NORM", "ATTN", "DECY", "SCAT"],
        "DecayCorrection": "START",
        "PatientWeight": WEIGHT,
        "RescaleSlope": 2.5,
        "RescaleIntercept": 0,
        "RadiopharmaceuticalInformationSequence": sequence(drug() if of_drug is None else of_drug),
        **at(SCAN, "Series"),
        **changes,
    }
    datasets = []
    for n, one in enumerate(pixels):
        acquired = at(SCAN + timedelta(minutes=3 * (n // 2)), "Acquisition")
        own = {**acquired, **said, **({} if each is None else each(n))}
        datasets.append(slice_at(one, n, **{name: value for name, value in own.items() if name not in without}))
    return save(folder, datasets)


def check_suv(folder, factor, pixels=None, slope=2.5):
    """Check that a series in SUV is its stored numbers by slope and factor."""
    stored = (random(4) if pixels is None else pixels).astype(np.float64)
    volume = ws.open(folder, suv=True)
    np.testing.assert_allclose(volume.samples, stored * slope * factor, rtol=1e-5)
    assert volume.value_unit == "SUV"
    [step] = volume.facts.processing
    assert step.startswith("SUV by")
    return volume


def expected(minutes, dose=DOSE, half_life_s=F18_S):
    """Factor from Bq/ml to SUV, by the law of decay."""
    left = dose * math.exp(-math.log(2) * 60 * minutes / half_life_s)
    return WEIGHT * 1000 / left


def test_the_units_and_uptake_of_a_pet_fault_13(wavesplat, tmp_path):
    # 66 261 Bq/ml are 19.5 by a factor of 2.945e-4: the dose that is left for it, an hour after the injection.
    dose = WEIGHT * 1000 / 2.945e-4 * 2 ** (3600 / F18_S)
    pixels = random(4)
    pixels[1, 2, 3] = 22087
    injected = (SCAN - timedelta(hours=1)).strftime("%Y%m%d%H%M%S")
    of_drug = drug(RadionuclideTotalDose=f"{dose:.10g}", RadiopharmaceuticalStartDateTime=injected)
    folder = pet(tmp_path / "pet", pixels, of_drug=of_drug, RescaleSlope=3)
    plain = ws.open(folder)
    assert plain.value_unit == "Bq/ml"
    assert plain.value_range[1] == 66261
    assert "to 66261 Bq/ml" in wavesplat("info", folder).stdout
    volume = check_suv(folder, 2.945e-4, pixels, slope=3)
    assert volume.value_range[1] == pytest.approx(19.51, abs=0.01)
    told = wavesplat("info", folder, "--suv").stdout
    assert "19.5139 SUV" in told
    assert "72.5 kg" in told


def test_decay_from_a_dated_injection_to_the_start_of_the_series(tmp_path):
    volume = check_suv(pet(tmp_path / "pet"), expected(65))
    assert volume.guesses == ()


def test_an_injection_without_a_date_is_of_the_day_of_the_scan(tmp_path):
    timed = drug(RadiopharmaceuticalStartDateTime=None, RadiopharmaceuticalStartTime="092500")
    check_suv(pet(tmp_path / "a", of_drug=timed), expected(65))
    late = drug(RadiopharmaceuticalStartDateTime=None, RadiopharmaceuticalStartTime="234500")
    after_midnight = datetime(2020, 3, 2, 0, 30)
    folder = pet(tmp_path / "b", of_drug=late, **at(after_midnight, "Series"), **at(after_midnight, "Acquisition"))
    check_suv(folder, expected(45))


def test_values_that_are_corrected_to_the_injection(tmp_path):
    said = ["ATTN", "DECAY"]  # as QIBA writes it, in place of DICOM's DECY
    check_suv(pet(tmp_path / "pet", DecayCorrection="ADMIN", CorrectedImage=said), expected(0))


def test_each_slice_has_its_own_slope(tmp_path):
    pixels = random(4)
    folder = pet(tmp_path / "pet", pixels, each=lambda n: {"RescaleSlope": 1.0 + n})
    slopes = np.arange(1.0, 5.0)[:, None, None]
    np.testing.assert_allclose(ws.open(folder, suv=True).samples, pixels * slopes * expected(65), rtol=1e-5)


#: A series that was processed a day after the scan.
LATER = at(SCAN + timedelta(days=1), "Series")


def test_the_start_of_the_scan_by_the_reference_time_of_a_frame(tmp_path):
    # The mean count rate of a frame of 180 s of F-18 is 89.87 s after its start: where the decay has the mean value.
    rate = math.log(2) / F18_S
    mean = np.mean(np.exp(-rate * (np.arange(180_000) + 0.5) / 1000))
    offset = -math.log(mean) / rate

    def frame(n):
        begin = 180 * (n // 2)
        return {"FrameReferenceTime": f"{1000 * (begin + offset):.3f}", "ActualFrameDuration": 180_000}

    volume = check_suv(pet(tmp_path / "pet", each=frame, **LATER), expected(65))
    assert "FrameReferenceTime" in volume.guesses[0]


def test_the_start_of_the_scan_by_ge(tmp_path):
    folder = pet(tmp_path / "pet", **LATER)
    from pydicom import dcmread

    for file in folder.iterdir():
        dataset = dcmread(file)
        block = dataset.private_block(0x0009, "GEMS_PETD_01", create=True)
        block.add_new(0x0D, "DT", (SCAN - timedelta(minutes=5)).strftime("%Y%m%d%H%M%S.00"))
        dataset.save_as(file)
    assert check_suv(folder, expected(60)).guesses == ()


def test_else_the_start_of_the_first_frame_is_a_guess(tmp_path):
    volume = check_suv(pet(tmp_path / "pet", **LATER), expected(65))
    assert "as the start of its first frame" in volume.guesses[0]


@pytest.mark.parametrize(("element", "number", "factor"), [(0x00, 0.0003, 0.0003), (0x09, 2.0, 2.0 * expected(65))])
def test_counts_of_philips_have_private_factors(tmp_path, element, number, factor):
    folder = pet(tmp_path / "pet", Units="CNTS")
    from pydicom import dcmread

    with pytest.raises(FileError, match=r"counts, and the scanner's factor \(7053,1000\) is missing"):
        ws.open(folder, suv=True)
    for file in folder.iterdir():
        dataset = dcmread(file)
        dataset.private_block(0x7053, "Philips PET Private Group", create=True).add_new(element, "DS", str(number))
        dataset.save_as(file)
    check_suv(folder, factor)
    assert ws.open(folder).value_unit == "counts"


def suv_by_qiba(file):
    """SUV of a file by body weight, element by element after the vendor-neutral pseudo-code.

    Source: QIBA Profile FDG-PET/CT, version 1.13 (RSNA, 2016), appendix G, the case of every vendor. No line of it is
    shared with the reader.
    """
    from pydicom import dcmread

    said = dcmread(file)
    values = said.pixel_array * float(said.RescaleSlope) + float(said.RescaleIntercept)
    if said.Units == "GML":
        return values
    private = said.get((0x7053, 0x1000))
    if said.Units == "CNTS" and private is not None:
        return values * float(private.value)
    if said.Units == "CNTS":
        values = values * float(said[0x7053, 0x1009].value)
    drug = said.RadiopharmaceuticalInformationSequence[0]
    scan = datetime.strptime(said.SeriesDate + said.SeriesTime[:6], "%Y%m%d%H%M%S")
    acquired = datetime.strptime(said.AcquisitionDate + said.AcquisitionTime[:6], "%Y%m%d%H%M%S")
    if scan > acquired:
        scan = datetime.strptime(said[0x0009, 0x100D].value[:14], "%Y%m%d%H%M%S")
    began = datetime.strptime(said.SeriesDate + drug.RadiopharmaceuticalStartTime[:6], "%Y%m%d%H%M%S")
    decay = (scan - began).total_seconds() % 86400
    dose = float(drug.RadionuclideTotalDose) * 2 ** (-decay / float(drug.RadionuclideHalfLife))
    return values * float(said.PatientWeight) * 1000 / dose


SIEMENS = {"Manufacturer": "SIEMENS"}
GE_LATER = {"Manufacturer": "GE MEDICAL SYSTEMS", **at(SCAN + timedelta(days=1), "Series")}
COUNTS = {"Manufacturer": "Philips Medical Systems", "Units": "CNTS"}
GE_SCAN = (0x0009, "GEMS_PETD_01", 0x0D, "DT", SCAN.strftime("%Y%m%d%H%M%S.00"))
PHILIPS = (0x7053, "Philips PET Private Group")


@pytest.mark.parametrize(
    ("changes", "private"),
    [
        (SIEMENS, None),
        ({**SIEMENS, "Units": "GML"}, None),
        (GE_LATER, GE_SCAN),
        (COUNTS, (*PHILIPS, 0x00, "DS", "0.000551")),
        (COUNTS, (*PHILIPS, 0x09, "DS", "1.8723")),
    ],
    ids=["Siemens", "SUV already", "GE, processed a day later", "Philips, to SUV", "Philips, to Bq/ml"],
)
def test_uptake_is_that_of_the_published_pseudo_code_for_each_vendor(tmp_path, changes, private):
    from pydicom import dcmread

    timed = drug(RadiopharmaceuticalStartDateTime=None, RadiopharmaceuticalStartTime="092500")

    def own_slope(n):
        return {"RescaleSlope": 1.0 + 0.5 * n, **at(SCAN + timedelta(minutes=3 * n), "Acquisition")}

    folder = pet(tmp_path / "pet", of_drug=timed, each=own_slope, without=("RescaleSlope",), **changes)
    files = sorted(folder.iterdir())
    for n, file in enumerate(files):
        said = dcmread(file)
        said.RescaleSlope = own_slope(n)["RescaleSlope"]
        if private is not None:
            group, creator, *element = private
            said.private_block(group, creator, create=True).add_new(*element)
        said.save_as(file)
    by_height = sorted(files, key=lambda file: float(dcmread(file).ImagePositionPatient[2]))
    wanted = np.stack([suv_by_qiba(file) for file in by_height])
    np.testing.assert_allclose(ws.open(folder, suv=True).samples, wanted, rtol=2e-5)


def test_values_that_are_uptake_already(tmp_path):
    folder = pet(tmp_path / "a", Units="GML", SUVType="BW")
    check_suv(folder, 1.0)
    assert ws.open(folder).value_unit == "SUV"
    lean = pet(tmp_path / "b", Units="GML", SUVType="LBM")
    assert ws.open(lean).value_unit == "SUV (lean mass)"
    with pytest.raises(FileError, match="SUV by LBM"):
        ws.open(lean, suv=True)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"without": ["PatientWeight"]}, r"PatientWeight \(0010,1030\) is missing or 0"),
        ({"PatientWeight": 0}, "PatientWeight"),
        ({"of_drug": drug(RadionuclideTotalDose=None)}, r"RadionuclideTotalDose \(0018,1074\) is missing"),
        ({"of_drug": drug(RadionuclideTotalDose=350)}, "is 350, too little for Bq"),
        ({"of_drug": drug(RadionuclideHalfLife=None)}, r"RadionuclideHalfLife \(0018,1075\) is missing"),
        ({"of_drug": drug(RadiopharmaceuticalStartDateTime=None)}, r"RadiopharmaceuticalStartTime .* is missing"),
        ({"of_drug": drug(RadiopharmaceuticalStartDateTime="20200305")}, "Radiopharmaceutical.* is missing"),
        ({"of_drug": drug(RadiopharmaceuticalStartDateTime="20200302100000")}, "one of both times is wrong"),
        ({"without": ["RadiopharmaceuticalInformationSequence"]}, "RadionuclideTotalDose"),
        ({"without": ["DecayCorrection"]}, r"DecayCorrection \(0054,1102\) is missing"),
        ({"DecayCorrection": "NONE"}, "DecayCorrection .* is NONE"),
        ({"CorrectedImage": ["DECY"]}, "corrected for attenuation"),
        ({"CorrectedImage": ["ATTN"]}, r"corrected for decay: CorrectedImage \(0028,0051\) has no DECY, it says ATTN"),
        ({"without": ["Units"]}, r"no Units \(0054,1001\)"),
        ({"Units": "PROPCPS"}, "the values are in PROPCPS"),
        ({"without": ["SeriesTime", "AcquisitionTime"]}, "time of the scan, are missing"),
        ({"each": lambda n: {"PatientWeight": 70 + n}}, r"differ in PatientWeight"),
        ({"each": lambda _: {"RescaleSlope": 0}}, "values as they are stored"),
        ({"modality": "CT"}, "is no PET"),
    ],
)
def test_uptake_is_refused_with_the_reason(tmp_path, changes, told):
    with pytest.raises(FileError, match=f"suv: .*{told}"):
        ws.open(pet(tmp_path / "pet", **changes), suv=True)


def test_other_formats_have_no_uptake(tmp_path):
    np.save(tmp_path / "a.npy", np.zeros((3, 4, 5)))
    with pytest.raises(ArgumentError, match=r"suv= has no meaning for this kind of file \(only for: dicom\)"):
        ws.open(tmp_path / "a.npy", suv=True)


def test_times_are_in_uptake_too(tmp_path):
    pixels = random(6)
    said = [at(SCAN + timedelta(seconds=60 * (n // 3)), "Acquisition") for n in range(6)]
    folder = pet(tmp_path / "pet", pixels, each=said.__getitem__)
    datasets = sorted(folder.iterdir())
    from pydicom import dcmread

    for n, file in enumerate(datasets):
        dataset = dcmread(file)
        dataset.ImagePositionPatient = [10, 20, 1.5 * (n % 3)]
        dataset.save_as(file)
    series = ws.open_series(folder, suv=True)
    assert series.times == (0, 60)
    np.testing.assert_allclose(series[1].samples, pixels[3:] * 2.5 * expected(65), rtol=1e-5)


# Units


@pytest.mark.parametrize(
    ("attributes", "unit", "told"),
    [
        ({"modality": "CT"}, "HU", ""),
        ({"modality": "CT", "RescaleType": "HU"}, "HU", ""),
        ({"modality": "CT", "RescaleType": "MGML"}, "mg/ml", ""),
        ({"modality": "CT", "RescaleType": "EDW"}, "electron density of water", ""),
        ({"modality": "CT", "RescaleType": "US"}, "HU", "as in every CT: RescaleType .* is US, and names no unit"),
        ({"modality": "CR", "RescaleType": "OD"}, "10⁻³ optical density", ""),
        ({"modality": "MR"}, "a.u.", ""),
        ({"modality": "MR", "RescaleType": "normalized"}, "a.u.", ""),
        ({"modality": "MR", "RescaleType": "10^-6 mm^2/s"}, "10^-6 mm^2/s", ""),
        (
            {"modality": "CT", "RescaleType": "iodine concentration in mg/ml"},
            "iodine concentration in",
            "own unit, 'iodine",
        ),
        ({"modality": "PT", "Units": "CPS"}, "counts/s", ""),
        ({"modality": "PT", "Units": "NONE"}, None, ""),
        ({"modality": "PT", "Units": "STDDEV"}, "standard deviations", ""),
        ({"modality": "PT", "Units": "KBQML"}, "KBQML", r"'KBQML': Units \(0054,1001\) has a word .* not define"),
        ({"modality": "PT", "Units": "CM2ML"}, "SUV (body surface)", ""),
        ({"modality": "PT", "Units": "GML", "SUVType": "XYZ"}, "SUV (XYZ)", "'XYZ': SUVType"),
        ({"modality": "RTDOSE", "DoseUnits": "GY"}, "Gy", ""),
        ({"modality": "RTDOSE", "DoseUnits": "RELATIVE"}, "relative dose", ""),
        ({"modality": "RTDOSE", "DoseUnits": "CGY"}, "CGY", "'CGY': DoseUnits"),
        ({"modality": "XA"}, None, ""),
        ({"modality": "CT", "RescaleSlope": 0}, None, ""),
    ],
)
def test_units_are_those_of_the_header_or_said_to_be_unknown(tmp_path, attributes, unit, told):
    folder = save(tmp_path / "a", [slice_at(one, n, **attributes) for n, one in enumerate(random(3))])
    if attributes.get("RescaleSlope") == 0:
        with pytest.warns(ws.errors.FileWarning, match="values as they are stored"):
            assert ws.open(folder).value_unit is unit
        return
    volume = ws.open(folder)
    assert volume.value_unit == unit
    assert bool(volume.guesses) == bool(told)
    assert not told or re.search(told, volume.guesses[0])


def test_files_of_several_units_are_said_to_be(tmp_path):
    units = ("HU", "MGML", "HU")
    folder = save(tmp_path / "a", [slice_at(one, n, RescaleType=units[n]) for n, one in enumerate(random(3))])
    volume = ws.open(folder)
    assert volume.value_unit is None
    assert "files of the series name HU, mg/ml" in volume.guesses[0]


@pytest.mark.parametrize(("slope", "unit"), [(2.0, "µm²/s"), (0.5, "a.u.")])
def test_units_of_real_world_values(tmp_path, slope, unit):
    """Units of parametric maps; where their slope is another, the values that are read are not in that unit."""
    code = {"CodeValue": "um2/s", "CodingSchemeDesignator": "UCUM", "CodeMeaning": "um2/s"}
    mapping = {"RealWorldValueSlope": slope, "RealWorldValueIntercept": 0.0, "MeasurementUnitsCodeSequence": code}
    said = {"modality": "MR", "RescaleSlope": 2, "RescaleIntercept": 0}
    datasets = [
        slice_at(one, n, **said, RealWorldValueMappingSequence=sequence(mapping)) for n, one in enumerate(random(3))
    ]
    volume = ws.open(save(tmp_path / "a", datasets))
    assert volume.value_unit == unit
    assert bool(volume.guesses) == (slope != 2)


def test_units_of_frames(tmp_path):
    shared = {"PixelValueTransformationSequence": {"RescaleSlope": 2, "RescaleIntercept": 0, "RescaleType": "US"}}
    places = [{"PlanePositionSequence": {"ImagePositionPatient": [0, 0, z]}} for z in (0, 2, 4)]
    measures = {
        "PixelMeasuresSequence": {"PixelSpacing": [1, 1]},
        "PlaneOrientationSequence": {"ImageOrientationPatient": [1, 0, 0, 0, 1, 0]},
    }
    dataset = base(random(3), modality="MR", NumberOfFrames=3)
    dataset.SharedFunctionalGroupsSequence = sequence({**measures, **shared})
    dataset.PerFrameFunctionalGroupsSequence = sequence(*places)
    assert ws.open(save(tmp_path / "a", [dataset])).value_unit == "a.u."
    dataset.SharedFunctionalGroupsSequence[0].PixelValueTransformationSequence[0].RescaleType = "T1 [ms]"
    assert ws.open(save(tmp_path / "b", [dataset])).value_unit == "T1 [ms]"


def test_units_are_shown_on_bars_and_reports(wavesplat, tmp_path):
    volume = ws.open(pet(tmp_path / "pet"), suv=True)
    assert ws.render(volume, size=(64, 64)).report["shown"][0]["values"] == "SUV"
    assert ws.slice(volume).report["shown"][0]["values"] == "SUV"
    done = wavesplat("slice", tmp_path / "pet", "--suv", "--colorbar", "-o", tmp_path / "a.svg", "--size", "256")
    assert done.returncode == 0, done.stderr
    assert ">SUV<" in (tmp_path / "a.svg").read_text()


@pytest.mark.parametrize("order", ["pet over ct", "ct over pet"])
@pytest.mark.parametrize("command", ["slice", "render"])
def test_a_pet_is_in_uptake_beside_a_ct(wavesplat, tmp_path, command, order):
    pet(tmp_path / "pet")
    save(tmp_path / "ct", [slice_at(one, n) for n, one in enumerate(random(4))])
    names = ["pet", "ct"] if order == "ct over pet" else ["ct", "pet"]
    one, other = (tmp_path / name for name in names)
    picture = ("-o", tmp_path / "a.png", "--size", "64", "--json", "--suv")
    done = wavesplat(command, one, "--layer", f"{other}:hot:0,9", *picture)
    assert done.returncode == 0, done.stderr
    units = {layer["name"]: layer["values"] for layer in json.loads(done.stdout)["report"]["shown"]}
    assert units == {"PET": "SUV", "CT": "HU"}
    without = wavesplat(command, tmp_path / "ct", "--layer", f"{tmp_path / 'ct'}:hot", *picture)
    assert "no volume of the picture is one" in without.stderr
    pet(tmp_path / "pet", without=["PatientWeight"])
    assert "PatientWeight" in wavesplat(command, one, "--layer", f"{other}:hot:0,9", *picture).stderr


@pytest.mark.parametrize("scan", ["ct", "pet"])
def test_isolines_of_a_pet_are_in_uptake(wavesplat, tmp_path, scan):
    pet(tmp_path / "pet")
    save(tmp_path / "ct", [slice_at(one, n) for n, one in enumerate(random(4))])
    values = ws.open(tmp_path / "pet", suv=True).samples
    level = f"{float(np.median(values)):.3g}"
    lines = ("--isolines", f"{tmp_path / 'pet'}:{level}", "-o", tmp_path / "a.png", "--size", "64", "--json")
    done = wavesplat("slice", tmp_path / scan, *lines, "--suv")
    assert done.returncode == 0, done.stderr
    (line,) = json.loads(done.stdout)["report"]["lines"]
    assert line["name"].endswith(f"{level} SUV")


def test_units_go_on_to_other_programs(tmp_path):
    import SimpleITK

    volume = ws.Volume(np.ones((3, 4, 5), np.float32) * 2, facts=ws.Facts(value_unit="Bq/ml"))
    volume.save(tmp_path / "a.nrrd")
    assert ws.open(tmp_path / "a.nrrd").value_unit == "Bq/ml"
    assert ws.Volume(volume.to_sitk()).value_unit == "Bq/ml"
    SimpleITK.WriteImage(volume.to_sitk(), str(tmp_path / "b.nrrd"))
    assert ws.open(tmp_path / "b.nrrd").value_unit == "Bq/ml"
    assert ws.Volume(volume.to_xarray()).value_unit == "Bq/ml"
    assert volume.smoothed(1).value_unit == "Bq/ml"
    assert ws.Facts.from_json(volume.facts.as_json()).value_unit == "Bq/ml"


@pytest.mark.parametrize("unit", ["a\nb", "x" * 99, 3])
def test_a_unit_is_a_short_text(unit):
    with pytest.raises(ArgumentError, match="value_unit is"):
        ws.Facts(value_unit=unit)
