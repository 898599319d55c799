"""Models that other packages bring, and the user's own folder."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import pytest
from pydantic import Field

from objectmodels import BoxModel, ModelError, ObjectModel, Polygon, Registry, sides
from objectmodels.files import plugin_loading
from objectmodels.geometry.side_faces import Face
from objectmodels.registry import model_registry
from objectmodels.registry.model_registry import save_model, user_folder
from tests.patience import PATIENCE

BOX = BoxModel(name="crate", size=(0.1, 0.1, 0.2), mass=1.0, friction=0.4)


class Slab(ObjectModel):
    """A plate of some thickness."""

    version: ClassVar[int] = 3
    side: Annotated[float, Field(alias="side_m")]
    kind: Literal["slab"] = "slab"

    @property
    def footprint(self) -> Polygon:
        return Polygon.rectangle(self.side, self.side)

    @property
    def top(self) -> float:
        return 0.02

    def faces(self, headings: Any = None) -> tuple[Face, ...]:
        return sides(self.footprint, self.top)


SLAB = """\
format: slab/3
name: paving slab
side_m: 0.3
mass_kg: 4.0
friction_table: 0.6
provenance: {source: a test}
"""


class Found:
    """Entry points that load what a test gives them."""

    def __init__(self, **things: object) -> None:
        self.things = things

    def __call__(self, *, group: str) -> Iterator[EntryPoint]:
        assert group == "nlcontrol.objectmodels"
        for name, thing in self.things.items():
            yield _point(name, thing)


def _point(name: str, thing: object) -> EntryPoint:
    class Point(EntryPoint):
        def load(self) -> object:
            if isinstance(thing, Exception):
                raise thing
            return thing

    return Point(name, f"{name}_package:thing", model_registry.GROUP)


Install = Callable[..., Registry]


@pytest.fixture
def install(monkeypatch: pytest.MonkeyPatch) -> Install:
    """Makes the default registry with some plug-ins."""

    def made(**things: object) -> Registry:
        monkeypatch.setattr(model_registry, "entry_points", Found(**things))
        return Registry.default()

    return made


@pytest.mark.parametrize("thing", [BOX, [BOX], lambda: BOX, lambda: iter([BOX])])
def test_models_come_as_one_or_many_or_from_a_function(install: Install, thing: object) -> None:
    registry = install(carton=thing)
    assert registry.get("crate") == BOX
    assert registry.place("crate") == "plug-in 'carton' of carton_package"
    assert registry.problems == ()


def test_a_kind_serves_the_files_of_any_plugin(install: Install, tmp_path: Path) -> None:
    (tmp_path / "slab.yaml").write_text(SLAB, encoding="utf-8")
    registry = install(a_folder=tmp_path, the_kind=Slab)
    slab = registry.get("paving slab")
    assert isinstance(slab, Slab)
    assert slab.thresholds([[-0.15, 0, 0.01]], [[1, 0, 0]]).slide.item() == pytest.approx(
        0.6 * 4.0 * 9.81
    )
    assert registry.kinds["slab"] is Slab
    # What is written is read again.
    save_model(slab, tmp_path / "again.yaml")
    other = Registry()
    other.add_kind(Slab)
    other.load(tmp_path / "again.yaml")
    assert other.get("paving slab") == slab


class Fragile(Slab):
    """A kind that fails on every file."""

    kind: Literal["fragile"] = "fragile"  # type: ignore[assignment]

    @property
    def footprint(self) -> Polygon:
        raise KeyError("side")


def test_a_kind_that_fails_takes_no_command_down(install: Install, objects_folder: Path) -> None:
    (objects_folder / "a.yaml").write_text(SLAB.replace("slab/3", "fragile/3"), encoding="utf-8")
    registry = install(the_kind=Fragile)
    assert [problem.code for problem in registry.problems] == ["broken_kind"]
    assert registry.problems[0].suggestions
    assert len(registry) == len(Registry.built_in())


@pytest.mark.parametrize(
    ("thing", "words"),
    [
        (ImportError("no module named physics"), ["broken_plugin", "ImportError", "physics"]),
        (7, ["broken_plugin", "found int"]),
        (dict, ["broken_plugin", "not a subclass"]),
        (lambda: 1 / 0, ["broken_plugin", "ZeroDivisionError"]),
        (ObjectModel, ["bad_kind", "name its kind"]),
        (Path("/nowhere/at/all.yaml"), ["unreadable_file", "all.yaml"]),
        (BOX.model_copy(update={"name": "mug"}), ["duplicate_name", "broken_package", "built in"]),
    ],
)
def test_a_broken_plugin_takes_nothing_down(
    install: Install, thing: object, words: list[str]
) -> None:
    registry = install(broken=thing, good=BOX)
    assert "crate" in registry
    assert "ice tea box" in registry
    (problem,) = registry.problems
    for word in words:
        assert word in f"{problem.code} {problem}"


def test_a_kind_may_not_take_the_name_of_another(install: Install) -> None:
    class Box(BoxModel):
        """Another box."""

    (problem,) = install(mine=Box).problems
    assert problem.code == "duplicate_name"
    assert "'box'" in problem.message


def test_a_model_of_the_user_takes_the_place_of_a_built_in_one(
    install: Install, objects_folder: Path
) -> None:
    assert user_folder() == objects_folder
    save_model(BOX, objects_folder / "crate.yaml")
    save_model(BOX.model_copy(update={"name": "mug"}), objects_folder / "mug.yaml")
    (objects_folder / "bad.yaml").write_text("format: box/1\n", encoding="utf-8")
    registry = install()
    assert registry.place("crate") == str(objects_folder / "crate.yaml")
    assert registry.place("mug") == str(objects_folder / "mug.yaml")
    assert registry.replaced_place("mug") == "built in (mug.yaml)"
    assert [problem.code for problem in registry.problems] == ["missing_key"]


def test_a_copy_is_a_registry_of_its_own() -> None:
    registry = Registry.built_in()
    other = registry.copy()
    other.add(BOX)
    assert "crate" in other
    assert "crate" not in registry


def test_one_name_or_synonym_calls_one_model() -> None:
    registry = Registry.built_in()
    assert registry.find_one("tomato soup").name == "soup can"
    registry.add(BOX.model_copy(update={"synonyms": ("can",)}))
    with pytest.raises(ModelError) as error:
        registry.find_one("can")
    assert error.value.code == "ambiguous_object"
    assert "soup can or crate" in str(error.value)


ODD = {
    "leaves": "raise SystemExit(3)",
    "closes": "raise GeneratorExit",
    "sleeps": "import time; time.sleep(600)",
    "endless": "from itertools import repeat; from tests.unit.objectmodels.registry."
    "test_model_plugins import BOX; OFFER = repeat(BOX)",
}


@pytest.mark.parametrize("kind", ODD)
def test_a_plug_in_that_does_not_behave_costs_itself(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(plugin_loading, "LOADING_TIME", 0.5 if kind == "sleeps" else PATIENCE)
    (tmp_path / f"odd_{kind}.py").write_text(ODD[kind])
    points = [EntryPoint("odd", f"odd_{kind}:OFFER", model_registry.GROUP)]
    monkeypatch.setattr(model_registry, "entry_points", lambda group: points)
    ((_, failure),) = model_registry.plugin_offers()
    assert isinstance(failure, ModelError)
    assert failure.code == "broken_plugin"


def test_what_a_plug_in_prints_stays_out_of_standard_output(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    code = "import os; print('hello'); os.write(1, b'there'); OFFER = ()"
    (tmp_path / "odd_prints.py").write_text(code)
    points = [EntryPoint("odd", "odd_prints:OFFER", model_registry.GROUP)]
    monkeypatch.setattr(model_registry, "entry_points", lambda group: points)
    assert list(model_registry.plugin_offers()) == []
    said = capfd.readouterr()
    assert said.out == ""
    assert "there" in said.err
