"""The registry: finding, refusing duplicates, surviving broken files."""

from __future__ import annotations

from pathlib import Path

import pytest

from objectmodels import BoxModel, ModelError, Registry, suggest
from objectmodels.registry.model_registry import free_file

BINS = ("storage bina", "storage bin x")
TWO = ("red tea carton", "red tea cartons")
"""About equally near to what was written."""

FILE = """\
format: box/1
name: {name}
synonyms: [{synonyms}]
size_m: [0.1, 0.2, 0.3]
mass_kg: 1.0
friction_table: 0.4
provenance: {{source: a test}}
"""


def box(name: str, *synonyms: str) -> BoxModel:
    return BoxModel(name=name, synonyms=synonyms, size=(0.1, 0.1, 0.1), mass=1.0, friction=0.4)


def test_built_in_models_carry_the_figures() -> None:
    registry = Registry.built_in()
    assert len(registry) == 13
    assert registry.problems == ()
    tea = registry.get("ice tea box")
    assert (tea.mass, tea.mass_sd) == (0.9952, 0.0375)
    assert (tea.friction, tea.friction_sd) == (0.378, 0.0689)
    assert (tea.finger_friction, tea.finger_friction_kinetic) == (0.693, 0.567)
    assert tea.extents == (0.09, 0.09, 0.23)
    cereal, coffee = registry.get("cereal box"), registry.get("coffee box")
    assert (cereal.extents, cereal.mass) == ((0.052, 0.192, 0.26), 0.2413)
    assert (coffee.extents, coffee.mass) == ((0.062, 0.093, 0.18), 0.5102)
    for model in registry:
        assert model.com_sd[2] > 0
        assert "estimate" in model.provenance.method
        assert model.provenance.source != "not stated"
        for value, deviation in zip(model.means[:3], model.deviations[:3], strict=True):
            assert deviation > 0.03 * value


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("ice tea box", ["ice tea box"]),
        ("  Ice  TEA\tbox ", ["ice tea box"]),
        ("ice tea", ["ice tea"]),
        ("large ice tea", ["ice tea box"]),
        ("coffee pack", ["coffee box"]),
        ("iced tee box", []),
        ("box", []),
        ("", []),
    ],
)
def test_find_is_exact_but_for_case_and_space(text: str, names: list[str]) -> None:
    assert Registry.default().find(text) == names


def test_shared_synonyms_find_both() -> None:
    registry = Registry()
    registry.add(box("red box", "box"))
    registry.add(box("blue box", "box"))
    assert registry.find("box") == ["red box", "blue box"]


@pytest.mark.parametrize(
    "second", [box("Red  Box"), box("blue box", "red box"), box("carton"), box("x", "Red box")]
)
def test_duplicate_names_are_refused_with_both_places(second: BoxModel) -> None:
    registry = Registry()
    registry.add(box("red box", "carton"), place="here.yaml")
    with pytest.raises(ModelError) as error:
        registry.add(second, place="there.yaml")
    assert error.value.code == "duplicate_name"
    assert "here.yaml" in str(error.value)
    assert "there.yaml" in str(error.value)
    assert registry.names() == ("red box",)


def test_a_broken_file_takes_no_other_down(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(FILE.format(name="crate", synonyms=""))
    (tmp_path / "b.yaml").write_text("mass_kg: lots")
    (tmp_path / "c.yaml").write_text(FILE.format(name="crate", synonyms=""))
    (tmp_path / "d.yaml").write_text(FILE.format(name="chest", synonyms="trunk"))
    registry = Registry()
    registry.load(tmp_path)
    assert registry.names() == ("crate", "chest")
    assert [problem.code for problem in registry.problems] == ["unknown_format", "duplicate_name"]
    assert registry.place("chest") == str(tmp_path / "d.yaml")
    with pytest.raises(ModelError, match=r"b\.yaml"):
        registry.load(tmp_path / "b.yaml")


def test_a_users_model_takes_the_place_of_a_built_in_one_of_its_name(objects_folder: Path) -> None:
    (objects_folder / "a.yaml").write_text(FILE.format(name="Ice tea  box", synonyms="tea box"))
    (objects_folder / "b.yaml").write_text(FILE.format(name="ice tea box", synonyms=""))
    (objects_folder / "c.yaml").write_text(FILE.format(name="crate", synonyms="mug"))
    registry = Registry.default()
    assert len(registry) == len(Registry.built_in())
    assert registry.find_one("tea box").mass == 1.0
    assert registry.place("ice tea box") == str(objects_folder / "a.yaml")
    assert registry.replaced_place("ice tea box") == "built in (ice_tea_box.yaml)"
    assert registry.replaced_place("mug") is None
    # A second one of that name is one too many, and a synonym takes over nothing.
    assert [problem.code for problem in registry.problems] == ["duplicate_name"] * 2
    assert registry.copy().replaced_place("ice tea box") == registry.replaced_place("ice tea box")
    (objects_folder / "a.yaml").unlink()
    (objects_folder / "b.yaml").unlink()
    assert Registry.default().find_one("ice tea box").mass == 0.9952


@pytest.mark.parametrize("name", ["../crate", "a/b", "..", "C:\\x", "soup can", "Dose für Suppe"])
def test_a_models_file_lies_in_the_users_folder(objects_folder: Path, name: str) -> None:
    path = free_file(name)
    assert path.parent == objects_folder
    assert not path.name.startswith(".")
    assert path.suffix == ".yaml"


def test_unknown_names_get_suggestions() -> None:
    with pytest.raises(ModelError) as error:
        Registry.default().get("iced tee box")
    assert error.value.code == "unknown_object"
    assert error.value.suggestions == ("did you mean 'ice tea box'?",)
    with pytest.raises(ModelError, match="known: none"):
        Registry().get("anything")


def test_the_registry_reads_like_a_collection() -> None:
    registry = Registry.default()
    assert len(registry) == len(registry.names()) == 13
    assert "Ice Tea Box" in registry
    assert "teapot" not in registry
    assert [model.name for model in registry] == list(registry.models)
    with pytest.raises(TypeError):
        registry.models["x"] = box("x")  # type: ignore[index]


@pytest.mark.parametrize(
    ("text", "names", "expected"),
    [
        ("iced tee box", ["ice tea box", "cereal box", "coffee box"], ("ice tea box",)),
        ("COFEE BOX", ["ice tea box", "cereal box", "coffee box"], ("coffee box",)),
        ("teapot", ["ice tea box", "cereal box", "coffee box"], ()),
        ("box c", ["box a", "box b"], ("box b", "box a")),  # a near tie: neither is guessed
        ("ice tea box", ["ice tea boxes", "ice tea packs", "ice tea bags"], ("ice tea boxes",)),
        ("red tea cartn", ["red tea carton", "red tea cartons"], TWO),
        # As similar as 95.7, 91.7 and 90.0 of 100: what is within 5 is as likely meant.
        ("storage bin", ["stora bin", "storage bin x", "storage bina"], BINS),
        ("x", [], ()),
    ],
)
def test_suggestions(text: str, names: list[str], expected: tuple[str, ...]) -> None:
    assert suggest(text, names) == expected
