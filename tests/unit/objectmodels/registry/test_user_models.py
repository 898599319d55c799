"""The user's own models: none takes another one's file, and of several writers none loses."""

from __future__ import annotations

import os
from contextlib import nullcontext, suppress
from multiprocessing import get_context
from pathlib import Path

import pytest

from objectmodels import BoxModel, ModelError, Registry
from objectmodels.registry.model_registry import remove_model, rename_model, store_model
from tests.patience import PATIENCE


def box(name: str, *, mass: float = 1.0) -> BoxModel:
    return BoxModel(name=name, size=(0.1, 0.1, 0.1), mass=mass, friction=0.4)


def test_names_that_look_alike_are_two_files(objects_folder: Path) -> None:
    for name in ("red box", "red_box", "red/box", "x" * 100, "x" * 99, "箱" * 100, "★"):
        store_model(Registry.default(), box(name))
    registry = Registry.default()
    assert registry.problems == ()
    assert {"red box", "red_box", "red/box", "x" * 100, "x" * 99, "箱" * 100, "★"} <= set(
        registry.names()
    )
    assert len(list(objects_folder.iterdir())) == 7


def test_a_broken_file_is_not_written_over(objects_folder: Path) -> None:
    (objects_folder / "crate.yaml").write_text("name: crate, half")
    path, replaced = store_model(Registry.default(), box("crate"), replace=True)
    assert (path.name, replaced) == ("crate_2.yaml", None)
    assert (objects_folder / "crate.yaml").read_text() == "name: crate, half"


def test_a_file_that_is_being_written_is_no_model_yet(objects_folder: Path) -> None:
    path, _ = store_model(Registry.default(), box("crate"))
    (objects_folder / ".nlcontrol-x.yaml").write_bytes(path.read_bytes())
    assert Registry.default().problems == ()


def test_ones_own_model_is_replaced_only_if_that_is_asked_for(objects_folder: Path) -> None:
    store_model(Registry.default(), box("crate"))
    with pytest.raises(ModelError) as raised:
        store_model(Registry.default(), box("Crate", mass=2.0))
    assert raised.value.code == "duplicate_name"
    store_model(Registry.default(), box("Crate", mass=2.0), replace=True)
    assert [path.name for path in objects_folder.iterdir()] == ["crate.yaml"]
    assert Registry.default().get("crate").mass == 2.0


def test_a_model_is_checked_against_what_others_wrote_meanwhile(objects_folder: Path) -> None:
    early = Registry.default()
    store_model(Registry.default(), box("crate"))
    with pytest.raises(ModelError) as raised:
        store_model(early, box("crate", mass=2.0))
    assert raised.value.code == "duplicate_name"
    assert Registry.default().get("crate").mass == 1.0
    assert len(list(objects_folder.iterdir())) == 1


def test_a_model_that_is_gone_cannot_be_removed_again(objects_folder: Path) -> None:
    store_model(Registry.default(), box("crate"))
    assert remove_model("Crate") == ("crate", objects_folder / "crate.yaml")
    for name, code in (("crate", "unknown_object"), ("mug", "not_yours")):
        with pytest.raises(ModelError) as raised:
            remove_model(name)
        assert (raised.value.code, bool(raised.value.suggestions)) == (code, True)


@pytest.mark.parametrize(
    "name", ["", " ", "a ", "a\nb", "\x1b[31m", "a\u202eb", "\ud800", "x" * 101]
)
def test_names_can_be_printed(name: str) -> None:
    with pytest.raises(ModelError) as raised:
        rename_model(box("crate"), name)
    assert raised.value.code == "bad_value"
    assert str(raised.value).isprintable()
    with pytest.raises(ValueError, match="name"):
        box(name)


def _add_and_remove(number: int) -> None:
    """One process: two models of its own, one of them removed, and one that all want to add."""
    for name in (f"own {number}", f"gone {number}", "common"):
        with suppress(ModelError) if name == "common" else nullcontext():
            store_model(Registry.default(), box(name))
    remove_model(f"gone {number}")
    os._exit(0)


def test_of_several_writers_none_loses_a_model(objects_folder: Path) -> None:
    processes = [get_context("fork").Process(target=_add_and_remove, args=(k,)) for k in range(6)]
    for process in processes:
        process.start()
    for process in processes:
        process.join(PATIENCE)
    assert [process.exitcode for process in processes] == [0] * 6
    registry = Registry.default()
    assert registry.problems == ()
    assert set(registry.names()) - set(Registry.built_in().names()) == {
        "common", *(f"own {k}" for k in range(6)),
    }  # fmt: skip
    assert len(list(objects_folder.iterdir())) == 7
