"""Traces saved and read again; what is no trace is refused with a code."""

from __future__ import annotations

import pickle
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from objectmodels.errors import ModelError
from sim.traces.trace import FORMAT, UNITS, Trace
from tests.unit.sim.traces.test_trace import N, trace

WHOLE = replace(
    trace(0.5, 0.1, 2, 1.0),
    contents={"a mug/green": np.linspace(1.0, 0.0, N)},
    lids={"jar": np.zeros(N)},
    seen_lids={"jar": np.full(N, 1e-3)},
    sightings={"jar": np.ones((4, 8))},
    sighted_lids={"jar": np.ones((4, 2))},
    sighted_levels={"jar": np.ones((3, 2))},
    lid_poses={"jar": np.ones((N, 7))},
    spilled=np.linspace(0.0, 1.0, N),
)


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    WHOLE.save(tmp_path / "run.npz")
    return tmp_path / "run.npz"


def _changed(path: Path, **arrays: object) -> Path:
    with np.load(path) as file:
        np.savez(path, **{**dict(file), **arrays})
    return path


WITHOUT_JOINTS = replace(WHOLE, joints=np.zeros((N, 0)), joint_names=())


@pytest.mark.parametrize("given", [WHOLE, WITHOUT_JOINTS, trace(0.5, 0.1, 1, 0.0)])
def test_what_is_saved_is_read(given: Trace, tmp_path: Path) -> None:
    given.save(tmp_path / "run.npz")
    read = Trace.load(tmp_path / "run.npz")
    assert read == given
    assert list(read.tips) == list(given.tips)
    assert read.contacts == given.contacts
    assert read.joint_names == given.joint_names


def test_traces_are_equal_if_all_in_them_is() -> None:
    assert pickle.loads(pickle.dumps(WHOLE)) == WHOLE
    assert replace(WHOLE, detail="other") != WHOLE
    assert replace(WHOLE, spilled=WHOLE.spilled + 1e-9) != WHOLE
    assert replace(WHOLE, lids={}) != WHOLE


def test_the_file_says_its_form_and_all_units(saved: Path) -> None:
    with np.load(saved) as file:
        assert str(file["format"]) == FORMAT
        assert {key.partition("/")[0] for key in UNITS} <= {k.partition("/")[0] for k in file}


def test_the_guide_names_every_array(saved: Path) -> None:
    guide = (Path(__file__).parents[4] / "docs" / "watching.md").read_text(encoding="utf-8")
    rows = guide.partition("| array |")[2].partition("What is no such file")[0]
    with np.load(saved) as file:
        told = {k if k.startswith("contacts/") else k.partition("/")[0] for k in file}
    assert [key for key in told if f"`{key}" not in rows] == []
    assert FORMAT in rows


@pytest.mark.parametrize(
    "arrays",
    [
        {"format": np.array("nlcontrol-trace/2")},
        {"end": np.array("never")},
        {"seed": np.array("0")},
        {"time": np.zeros((N, 1))},
        {"poses/box": np.zeros((N - 1, 7))},
        {"phase": np.zeros(N)},
        {"joints": np.zeros((N, 3))},
        {"contacts/time": np.zeros(2)},
        {"felt/finger_0": np.array([None] * N, object)},
    ],
)
def test_what_does_not_fit_is_refused(saved: Path, arrays: dict[str, object]) -> None:
    with pytest.raises(ModelError) as raised:
        Trace.load(_changed(saved, **arrays))
    assert raised.value.code == "bad_trace"
    assert raised.value.suggestions


def test_sizes_that_a_file_only_states_cost_nothing(saved: Path) -> None:
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (100000000000,)}"
    header = header.ljust(117) + b"\n"
    with zipfile.ZipFile(saved, "a") as file:
        file.writestr("lids/cup.npy", b"\x93NUMPY\x01\x00\x76\x00" + header)
    with pytest.raises(ModelError) as raised:
        Trace.load(saved)
    assert raised.value.code == "bad_trace"


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"\x93NUMPY", b"\0" * 1000])
def test_other_files_are_no_traces(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    path.write_bytes(content)
    with pytest.raises(ModelError) as raised:
        Trace.load(path)
    assert raised.value.code == "bad_trace"


def test_damage_anywhere_is_noticed(saved: Path) -> None:
    whole, rng = saved.read_bytes(), np.random.default_rng(0)
    codes = set()
    for place in rng.integers(0, len(whole), 60).tolist():
        saved.write_bytes(whole[:place] + bytes([whole[place] ^ 0x5A]) + whole[place + 1 :])
        try:
            assert Trace.load(saved) == WHOLE  # only a date was damaged, say
        except ModelError as error:
            codes.add(error.code)
    assert codes == {"bad_trace"}


def test_a_trace_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ModelError) as raised:
        Trace.load(tmp_path / "none.npz")
    assert raised.value.code == "unreadable_file"
