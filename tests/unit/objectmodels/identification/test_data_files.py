"""Data files of a real robot: what is read, and that every mistake names its row and column."""

from __future__ import annotations

import re
from math import radians
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from objectmodels import BoxModel, ModelError, Registry
from objectmodels.identification import Trial
from objectmodels.identification.touch_log import ANGLE_SD, COLUMNS, FORCE_SHARE, read_data
from tests.sizes import examples

EXAMPLES = Path(__file__).parents[4] / "examples"
MODEL = Registry.built_in().get("ice tea box")
HEADER = "moved,x_m,y_m,z_m,fx_n,fy_n,fz_n"
SLIDE, TOPPLE = "slide,-0.045,0,0.04,3.5,0,0", "topple,-0.045,0,0.21,2.1,0,0"


def read(tmp_path: Path, text: str, model: BoxModel | None = None) -> tuple[object, ...]:
    path = tmp_path / "data.csv"
    path.write_bytes(text.encode())
    return read_data([path], model or MODEL).trials


def refused(tmp_path: Path, text: str) -> ModelError:
    with pytest.raises(ModelError) as error:
        read(tmp_path, text)
    assert error.value.code == "bad_data"
    assert str(error.value.path).startswith(str(tmp_path / "data.csv"))
    return error.value


def test_a_row_is_a_trial(tmp_path: Path) -> None:
    path = tmp_path / "data.csv"
    path.write_text(
        f"{HEADER},force_sd_n,tilt_deg,turn_deg,travel_m,nx,ny,nz,repetition\n"
        f"{SLIDE},0.1,,-3,0.03,,,,2\n"
        f"{TOPPLE},,10,,,,,,\n"
        "slip,-0.045,0,0.05,2,1.4,0,,,,,-1,0,0,\n",
        encoding="utf-8",
    )
    reading = read_data([path], MODEL)
    slide, topple, slip = reading.trials
    assert reading.assumed == (False, True, True)
    assert (slide.moved, slide.point, slide.force) == ("slide", (-0.045, 0.0, 0.04), (3.5, 0, 0))
    assert (slide.force_sd, slide.repetition, slide.source) == (0.1, 2, "row 2")
    assert slide.turn_rate == pytest.approx(-radians(3.0) / 0.03)
    assert slide.turn_rate_sd == pytest.approx(ANGLE_SD / 0.03)
    assert (topple.tilt, topple.tilt_sd) == (radians(10.0), ANGLE_SD)
    assert topple.force_sd == pytest.approx(FORCE_SHARE * 2.1)
    assert topple.turn_rate is None
    assert slip.normal == (-1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "text",
    [
        f"# a comment\n\n{HEADER}\n  # another\n{SLIDE}\n,,,,,,\n",
        f"\ufeff{HEADER}\r\n{SLIDE}\r\n",
        f"{HEADER}\r{SLIDE}\r",
        f"{HEADER}\n{SLIDE}".replace(",", ";"),
        f"{HEADER}\n{SLIDE}".replace(",", ";").replace(".", ","),
        f"{HEADER.upper()}\n{SLIDE.replace('slide', ' Slide ')}",
        "force_n,ux,uy,uz,moved,x_m,y_m,z_m,note\n3.5,1,0,0,slide,-0.045,0,0.04,\"a, b\"",
    ],
)  # fmt: skip
def test_the_same_trial_in_many_hands(tmp_path: Path, text: str) -> None:
    (trial,) = read_data([_written(tmp_path, text)], MODEL).trials
    assert (trial.moved, trial.point, trial.force) == ("slide", (-0.045, 0.0, 0.04), (3.5, 0, 0))


def _written(folder: Path, text: str, name: str = "data.csv") -> Path:
    path = folder / name
    path.write_bytes(text.encode())
    return path


@pytest.mark.parametrize(
    ("row", "where", "words"),
    [
        ("slide,-0.045,0,180,3.5,0,0", "row 4: z_m", "above the object, 0.23 m high.*millimetres"),
        ("slide,-45,0,0.04,3.5,0,0", "row 4: x_m", "beside the object.*millimetres"),
        ("slide,0,-4.5,0.04,0,3.5,0", "row 4: y_m", "beside the object.*centimetres"),
        ("slide,-0.045,0,-0.2,3.5,0,0", "row 4: z_m", "below the table"),
        ("slide,-0.000045,0,0.00004,3.5,0,0", "row 4: x_m", "in the middle of the base"),
        ("slide,-0.045,0,0.04,3500,0,0", "row 4: fx_n", "3.69 N.*millinewtons"),
        ("topple,-0.045,0,0.21,0.0021,0,0", "row 4: fx_n", "to topple there.*kilonewtons"),
        ("slide,-0.045,0,0.04,-3.5,0,0", "row 4: fx_n", "pulls.*other sign"),
        ("slide,-0.045,0,0.04,0,0,0", "row 4: fx_n", "moves nothing"),
        ("topple,-0.045,0,0.21,0,0,-3", "row 4: fz_n", "vertical"),
        ("slide,-0.045,0,0.04,nan,0,0", "row 4: fx_n", "'nan'.*finite"),
        ("slide,-0.045,0,0.04,3.5,-inf,0", "row 4: fy_n", "'-inf'.*finite"),
        ("slide,-0.045,0,0.04,3.5,0,1e999", "row 4: fz_n", "finite"),
        ("slide,-0.045,0,0.04,3_5,0,0", "row 4: fx_n", "'3_5'"),
        ("slide,-0.045,0,0.04,3.5 N,0,0", "row 4: fx_n", "'3.5 N'"),
        ("slide,-0.045,0,0.04,3.5,,0", "row 4: fy_n", "empty"),
        ("slided,-0.045,0,0.04,3.5,0,0", "row 4: moved", "did you mean 'slide'"),
        (",-0.045,0,0.04,3.5,0,0", "row 4: moved", "slide, topple or slip"),
        ("slide,-0.045,0,0.04,3.5,0", "row 4", "6 cells, the header 7"),
        ('slide,-0.045,0,0.04,3.5,0,"0', "row 4", "not CSV"),
    ],
)
def test_mistakes_in_a_row_are_named(tmp_path: Path, row: str, where: str, words: str) -> None:
    error = refused(tmp_path, f"# touches\n{HEADER}\n{SLIDE}\n{row}\n{TOPPLE}\n")
    assert error.path == f"{tmp_path / 'data.csv'}: {where}"
    assert re.search(words, str(error)), str(error)


@pytest.mark.parametrize(
    ("columns", "cells", "column", "words"),
    [
        ("force_sd_n", "50", "force_sd_n", "larger than the force itself.*millinewtons"),
        ("force_sd_n", "0", "force_sd_n", "at least"),
        ("turn_deg,travel_m", "5,30", "travel_m", "millimetres"),
        ("turn_deg,travel_m", "5,", "travel_m", "required"),
        ("turn_deg,travel_m", "500,0.03", "turn_deg", "180"),
        ("tilt_deg", "5", "tilt_deg", "has no tilt"),
        ("repetition", "1.5", "repetition", "whole number"),
    ],
)
def test_mistakes_beside_the_force(
    tmp_path: Path, columns: str, cells: str, column: str, words: str
) -> None:
    error = refused(tmp_path, f"{HEADER},{columns}\n{SLIDE},{cells}\n")
    assert str(error.path).endswith(f"row 2: {column}")
    assert re.search(words, str(error)), str(error)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no table"),
        ("# nothing\n\n", "no table"),
        (HEADER, "no rows"),
        (HEADER.replace("z_m,", "") + "\nslide,1,2,3,4,5", "lacks the column z_m"),
        (HEADER.replace("fx_n,fy_n,fz_n", "note") + "\n", "no rows"),
        (HEADER.replace("x_m", "x_mm") + "\n" + SLIDE, "'x_mm'.*did you mean 'x_m'"),
        (HEADER + ",weather\n" + SLIDE + ",fine", "'weather'.*known: moved"),
        (HEADER.replace("y_m", "x_m") + "\n" + SLIDE, "'x_m' is given twice"),
        (HEADER + ",\n" + SLIDE + ",", "no name"),
        (HEADER + ",force_n\n" + SLIDE + ",3", "has both"),
        (HEADER.replace(",fx_n,fy_n,fz_n", "") + "\nslide,-0.045,0,0.04", "lacks the columns fx_n"),
        ("moved,x_m,y_m,z_m,force_n,ux,uy,uz\nslide,-0.045,0,0.04,3,1,1,0", "length 1.41"),
        ("moved,x_m,y_m,z_m,force_n,ux,uy,uz\nslide,-0.045,0,0.04,-3,1,0,0", "above 0"),
        (HEADER + ",nx,ny,nz\nslip,-0.045,0,0.04,2,1,0,1,0,0", "points out of the object"),
        (HEADER + ",nx,ny,nz\nslip,-0.045,0,0.04,2,0,0,-1,0,0", "straight into the face"),
        (HEADER + "\nslip,-0.045,0,0.04,2,1,0", "nx: is required"),
    ],
)
def test_tables_that_are_none(tmp_path: Path, text: str, words: str) -> None:
    error = refused(tmp_path, text)
    assert re.search(words, str(error)), str(error)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    latin = tmp_path / "latin.csv"
    latin.write_bytes("moved,Notiz für später".encode("latin-1"))
    for path in (latin, tmp_path / "missing.csv", tmp_path):
        with pytest.raises(ModelError) as error:
            read_data([path], MODEL)
        assert error.value.code == "unreadable_file"


def test_several_files_name_themselves(tmp_path: Path) -> None:
    first = _written(tmp_path, f"{HEADER}\n{SLIDE}", "a.csv")
    second = _written(tmp_path, f"{HEADER}\n{TOPPLE}", "b.csv")
    sources = [trial.source for trial in read_data([first, second], MODEL).trials]
    assert sources == ["a.csv: row 2", "b.csv: row 2"]


def test_what_lies_a_little_beside_is_taken(tmp_path: Path) -> None:
    # A fingertip's radius of error is none in the unit.
    assert read(tmp_path, f"{HEADER}\nslide,-0.053,0,0.04,3.5,0,0")
    refused(tmp_path, f"{HEADER}\nslide,-0.057,0,0.04,3.5,0,0")


_CELL = st.one_of(
    st.sampled_from(["slide", "topple", "slip", "", "0", "-0.045", "0.04", "1", "3.5", "1e-300"]),
    st.floats().map(str),
    st.text(max_size=8),
)


@settings(max_examples=examples(300), deadline=None)
@given(
    header=st.one_of(
        st.just(HEADER),
        st.just("trial,time_s,fx_n,fy_n,fz_n,x_m,y_m,z_m,moved"),
        st.lists(st.sampled_from([*COLUMNS, "time_s", "trial"]), max_size=12).map(",".join),
        st.text(max_size=30),
    ),
    rows=st.lists(st.lists(_CELL, min_size=5, max_size=10), max_size=16),
    raw=st.one_of(st.none(), st.binary(max_size=60)),
)
def test_garbage_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory,
    header: str,
    rows: list[list[str]],
    raw: bytes | None,
) -> None:
    text = "\n".join([header, *map(",".join, rows)])
    path = tmp_path_factory.getbasetemp() / "garbage.csv"
    path.write_bytes(text.encode("utf-8", "surrogatepass") if raw is None else raw)
    error: ModelError | None = None
    trials: tuple[Trial, ...] = ()
    try:
        trials = read_data([path], MODEL).trials
    except ModelError as raised:
        error = raised
    if error is not None:
        assert error.code in ("bad_data", "unreadable_file"), error
        assert str(error.path).startswith(str(path))
    assert all(np.isfinite([*t.point, *t.force, t.force_sd]).all() for t in trials)


# -- recordings -------------------------------------------------------------------------------


def test_the_sample_files_are_those_of_their_script(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(EXAMPLES))
    __import__("make_ice_tea").main(tmp_path)
    for name in ("ice_tea_trials.csv", "ice_tea_series.csv"):
        made, kept = (folder / name for folder in (tmp_path, EXAMPLES))
        for trial, other in zip(
            read_data([made], MODEL).trials, read_data([kept], MODEL).trials, strict=True
        ):
            # Another machine may round the last digit of a sample otherwise.
            assert trial.force == pytest.approx(other.force, abs=2e-4)
            assert trial.point == pytest.approx(other.point, abs=2e-5)


def test_the_onsets_of_recordings() -> None:
    trials = read_data([EXAMPLES / "ice_tea_series.csv"], MODEL).trials
    assert [t.moved for t in trials] == ["slide"] * 3 + ["topple"] * 8
    onsets = [t for t in trials if t.moved == "topple" and t.tilt == 0.0]
    held = [t for t in trials if t.tilt > 0.0]
    weight, (x, y, c_z) = 0.85 * 9.81, (0.003, -0.002, 0.09)
    for trial, arm in zip(onsets, (0.045 - x, 0.045 + x, 0.045 + y, 0.045 - y), strict=True):
        size = float(np.linalg.norm(trial.force))
        # The noise of a sample is 1 %; some 25 of them lie on the way that is fitted.
        assert size == pytest.approx(weight * arm / 0.21, rel=0.02)
        assert abs(size - weight * arm / 0.21) < 4.0 * trial.force_sd
    for trial, arm in zip(held, (0.045 - x, 0.045 + x, 0.045 + y, 0.045 - y), strict=True):
        moment = weight * (arm * np.cos(trial.tilt) - c_z * np.sin(trial.tilt))
        assert float(np.linalg.norm(trial.force)) == pytest.approx(moment / 0.21, rel=0.02)
        # The finger stayed level on a side face, which it met lower and lower.
        along = max(abs(trial.point[0]), abs(trial.point[1]))
        assert along == pytest.approx(0.045, abs=5e-4)
        assert 0.19 < trial.point[2] < 0.205
    # The exact tier's turn rates [rad/m]; the yaw's noise of 0.1° over 10 mm allows 0.2.
    assert [t.turn_rate for t in trials[:3]] == pytest.approx([-1.05, 9.1, -8.6], abs=0.4)


def _series(**changes: str) -> str:
    """A short recording of a slide; `changes` are of the seventh sample's cells."""
    columns = ["trial", "moved", "time_s", "fx_n", "fy_n", "fz_n", "x_m", "y_m", "z_m"]
    lines = [",".join(columns)]
    for k in range(60):
        t, way = 0.05 * k, 0.01 * max(0.05 * k - 1.0, 0.0)
        sample = f"a,slide,{t:.2f},{min(3.6 * t, 3.6):.3f},0,0,{way - 0.045:.5f},0,0.04"
        cells = dict(zip(columns, sample.split(","), strict=True))
        lines.append(",".join((cells | changes if k == 6 else cells).values()))
    return "\n".join(lines)


def test_a_recording_of_a_slide(tmp_path: Path) -> None:
    (trial,) = read_data([_written(tmp_path, _series())], MODEL).trials
    assert (trial.moved, trial.source, trial.turn_rate) == ("slide", "trial a", None)
    assert trial.force == pytest.approx((3.6, 0.0, 0.0), rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "where", "words"),
    [
        ({"fx_n": "nan"}, "row 8: fx_n", "finite"),
        ({"time_s": "0"}, "row 8: time_s", "does not increase within trial a"),
        ({"moved": "topple"}, "row 8: moved", "not the same all through trial a"),
        ({"trial": ""}, "row 8: trial", "empty"),
        ({"trial": "b"}, "row 8: trial", "trial b has 1 samples"),
    ],
)
def test_mistakes_in_a_recording(
    tmp_path: Path, changes: dict[str, str], where: str, words: str
) -> None:
    error = refused(tmp_path, _series(**changes))
    assert str(error.path).endswith(where)
    assert re.search(words, str(error)), str(error)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (",0.04\n", ",40\n", "z_m: 40 lies above the object.*millimetres"),
        (",3.600,", ",3600,", "fx_n: a force of 3.6.* N is far from.*millinewtons"),
        (",slide,", ",slip,", "moved: found 'slip'"),
        (",moved,", ",note,", "do not tell what moved"),
    ],
)
def test_wrong_units_in_a_recording(tmp_path: Path, old: str, new: str, words: str) -> None:
    text = _series().replace(old, new)
    if "3600" in new:
        lines = [line.split(",") for line in _series().splitlines()]
        scaled = [[*c[:3], str(1e3 * float(c[3])), *c[4:]] for c in lines[1:]]
        text = "\n".join(",".join(cells) for cells in [lines[0], *scaled])
    error = refused(tmp_path, text)
    assert re.search(words, str(error)), str(error)


def test_times_in_milliseconds(tmp_path: Path) -> None:
    lines = [line.split(",") for line in _series().splitlines()]
    scaled = [[*c[:2], str(1e3 * float(c[2])), *c[3:]] for c in lines[1:]]
    error = refused(tmp_path, "\n".join(",".join(cells) for cells in [lines[0], *scaled]))
    assert "milliseconds" in str(error)


def test_a_recording_in_which_nothing_moved_is_left_out(tmp_path: Path) -> None:
    standing = "\n".join(_series().splitlines()[:18])
    reading = read_data([_written(tmp_path, standing)], MODEL)
    assert reading.trials == ()
    assert "trial a: nothing moved" in reading.unused[0]


def test_a_force_that_rises_twice_is_not_said_to_have_moved_nothing(tmp_path: Path) -> None:
    # A finger of a stiff arm at 2.5 mm/s: 2 N from 0.5 s on, 6 N from 3.2 s on.
    time = np.arange(0.0, 5.0, 0.02)
    force = 2.0 * np.clip((time - 0.5) / 0.2, 0.0, 1.0) + 4.0 * np.clip((time - 3.2) / 0.2, 0, 1)
    rows = [
        f"a,slide,{t:.2f},{f:.3f},0,0,{-0.045 + 0.0025 * t:.5f},0,0.04"
        for t, f in zip(time, force, strict=True)
    ]
    header = "trial,moved,time_s,fx_n,fy_n,fz_n,x_m,y_m,z_m"
    reading = read_data([_written(tmp_path, "\n".join([header, *rows]))], MODEL)
    assert reading.trials == ()
    assert "nothing moved" not in reading.unused[0]
    # From 0.54 s, where the force passes a twentieth of its largest, to 4.98 s.
    assert "11.1 mm" in reading.unused[0]
    assert "6.00 N" in reading.unused[0]


@pytest.mark.parametrize(
    ("columns", "row", "read_cell", "refused_cell"),
    [
        ("turn_deg,travel_m", f"{SLIDE},0.02,", "0.0012", "0.0008"),  # a millimetre or more
        ("turn_deg,travel_m", f"{SLIDE},5,", "0.9", "1.1"),  # a metre or less
        ("force_sd_n", f"{SLIDE},", "0.0005", "0.00025"),  # a ten-thousandth of 3.5 N
        ("tilt_deg,tilt_sd_deg", f"{TOPPLE},10,", "0.0013", "0.0008"),  # a thousandth of a degree
        ("nx,ny,nz", "slip,-0.045,0,0.05,2,0.028,0,-1,0,", "0", "0.3"),  # 2 % off unit length
        ("nx,ny,nz", "slip,-0.045,0,0.05,2,0.5,0,", "-1.015,0,0", "-1.03,0,0"),
    ],
)
def test_what_is_out_of_all_proportion_is_refused(
    tmp_path: Path, columns: str, row: str, read_cell: str, refused_cell: str
) -> None:
    assert read(tmp_path, f"{HEADER},{columns}\n{row}{read_cell}")
    refused(tmp_path, f"{HEADER},{columns}\n{row}{refused_cell}")


@pytest.mark.parametrize(("aside", "slips"), [("0.014", False), ("0.028", True)])
def test_a_force_straight_into_a_face_is_no_slip(tmp_path: Path, aside: str, slips: bool) -> None:
    text = f"{HEADER},nx,ny,nz\nslip,-0.045,0,0.05,2,{aside},0,-1,0,0"
    assert read(tmp_path, text) if slips else refused(tmp_path, text)


@pytest.mark.parametrize(("times", "is_read"), [(300.0, True), (380.0, False)])
def test_a_recording_lasts_up_to_a_quarter_of_an_hour(
    tmp_path: Path, times: float, is_read: bool
) -> None:
    lines = [line.split(",") for line in _series().splitlines()]
    scaled = [[*c[:2], str(times * float(c[2])), *c[3:]] for c in lines[1:]]
    text = "\n".join(",".join(cells) for cells in [lines[0], *scaled])
    assert read(tmp_path, text) if is_read else refused(tmp_path, text)


@pytest.mark.parametrize(("factor", "is_read"), [(45.0, True), (55.0, False)])
def test_a_force_is_refused_from_fifty_times_the_believed_one_on(
    tmp_path: Path, factor: float, is_read: bool
) -> None:
    believed = float(MODEL.thresholds([(-0.045, 0.0, 0.04)], [(1.0, 0.0, 0.0)]).slide[0])
    text = f"{HEADER}\nslide,-0.045,0,0.04,{factor * believed},0,0"
    assert read(tmp_path, text) if is_read else refused(tmp_path, text)


def test_poses_before_and_after_make_the_motion_of_a_row(tmp_path: Path) -> None:
    """The object turned by 10° about its origin, and its origin went 5 mm along x."""
    header = f"{HEADER},turn_deg,dx_m,dy_m"
    (trial,) = read_data([_written(tmp_path, f"{header}\n{SLIDE},10,0.005,0\n")], MODEL).trials
    half = radians(5.0)
    # In the axes half-way the contact at (−45, 0) mm goes a chord across, the origin 5° right.
    travel = 0.005 * np.cos(half)
    aside = -0.005 * np.sin(half) - 2.0 * 0.045 * np.sin(half)
    assert trial.turn_rate == pytest.approx(2.0 * half / travel)
    assert trial.drift == pytest.approx(aside / travel)
    for row, column, words in (
        (f"{SLIDE},10,-0.005,0", "dx_m", "poses do not fit together"),
        (f"{SLIDE},10,5,0", "dx_m", "millimetres"),
        (f"{SLIDE},10,0.005,", "dy_m", "is required here"),
    ):
        error = refused(tmp_path, f"{header}\n{row}\n")
        assert str(error.path).endswith(f"row 2: {column}")
        assert re.search(words, str(error))
