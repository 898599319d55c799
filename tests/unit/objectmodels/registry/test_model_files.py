"""Model files: the strict schema, and errors that say where, what and what instead."""

from __future__ import annotations

from pathlib import Path

import pytest

from objectmodels import ModelError, Registry
from objectmodels.files.yaml_documents import LIMITS
from objectmodels.registry.model_registry import load_model, save_model

GOOD = """\
format: box/1
name: crate
size_m: [0.1, 0.2, 0.3]
mass_kg: 1.5
friction_table: 0.4
provenance: {source: a test}
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "crate.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_units_are_in_the_keys_and_defaults_are_the_model_s(tmp_path: Path) -> None:
    model = load_model(written(tmp_path, GOOD))
    assert (model.name, model.extents, model.mass) == ("crate", (0.1, 0.2, 0.3), 1.5)
    assert model.com == (0.0, 0.0, 0.15)
    assert model.provenance.source == "a test"


def test_all_keys_reach_the_model(tmp_path: Path) -> None:
    text = GOOD + (
        "mass_kg_sd: 0.1\nfriction_table_sd: 0.05\nfriction_table_kinetic: 0.3\n"
        "friction_finger: 0.7\nfriction_finger_sd: 0.07\nfriction_finger_kinetic: 0.6\n"
        "centre_of_mass_m: [0.01, 0, 0.1]\ncentre_of_mass_m_sd: [0.001, 0.002, 0.003]\n"
        "support: corners\nfriction_radius_m: 0.06\nfriction_radius_m_sd: 0.006\n"
        "synonyms: [wooden crate]\n"
    )
    m = load_model(written(tmp_path, text))
    assert (m.mass_sd, m.friction_sd, m.friction_kinetic) == (0.1, 0.05, 0.3)
    assert (m.finger_friction, m.finger_friction_sd, m.finger_friction_kinetic) == (0.7, 0.07, 0.6)
    assert (m.com, m.com_sd) == ((0.01, 0.0, 0.1), (0.001, 0.002, 0.003))
    assert (m.support, m.friction_radius, m.friction_radius_sd) == ("corners", 0.06, 0.006)
    assert m.synonyms == ("wooden crate",)


@pytest.mark.parametrize(
    ("line", "code", "words"),
    [
        ("mass_kg: 1:30", "bad_value", ["mass_kg", "'1:30'", "number"]),
        ("mass_kg: yes", "bad_value", ["mass_kg", "'yes'"]),
        ("mass_kg: true", "bad_value", ["mass_kg", "True"]),
        ("mass_kg: 1_000", "bad_value", ["mass_kg", "'1_000'"]),
        ("mass_kg: 017", "bad_value", ["mass_kg", "'017'"]),
        ("mass_kg: .nan", "bad_value", ["mass_kg", "nan", "finite"]),
        ("mass_kg: .inf", "bad_value", ["mass_kg", "inf", "finite"]),
        ("mass_kg: -1.0", "bad_value", ["mass_kg", "-1.0", "greater than"]),
        ("mass_kg: 1 kg", "bad_value", ["mass_kg", "'1 kg'"]),
        ("mass_kg:", "bad_value", ["mass_kg", "None"]),
        ("name: 12", "bad_value", ["name", "12", "string"]),
        ("size_m: 0.1", "bad_value", ["size_m", "0.1"]),
        ("size_m: [0.1, 0.2]", "missing_key", ["size_m.2"]),
        ("size_m: [0.1, 0.2, big]", "bad_value", ["size_m.2", "'big'"]),
        ("format: box/2", "unknown_format", ["box/2", "box/1"]),
        (
            "provenance: {sources: x}",
            "unknown_key",
            ["provenance.sources", "did you mean 'source'?"],
        ),
        ("provenance: {date: 2010-13-45x}", "bad_value", ["provenance.date"]),
    ],
)
def test_wrong_values_are_named(tmp_path: Path, line: str, code: str, words: list[str]) -> None:
    key = line.partition(":")[0]
    kept = [old for old in GOOD.splitlines() if not old.startswith(f"{key}:")]
    path = written(tmp_path, "\n".join([*kept, line]))
    with pytest.raises(ModelError) as error:
        load_model(path)
    assert error.value.code == code
    for word in (str(path), *words):
        assert word in str(error.value)


def test_values_that_are_plain_in_yaml_1_2_are_read_so(tmp_path: Path) -> None:
    text = GOOD.replace("mass_kg: 1.5", "mass_kg: 15e-1").replace("crate", "no")
    text = text.replace("a test}", "off, date: 2010-05-01}")
    model = load_model(written(tmp_path, text))
    assert (model.name, model.mass) == ("no", 1.5)
    assert (model.provenance.source, model.provenance.date) == ("off", "2010-05-01")


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        (GOOD.replace("name: crate\n", ""), "missing_key", ["name", "required"]),
        (GOOD.replace("mass_kg", "mass"), "unknown_key", ["did you mean 'mass_kg'?"]),
        (GOOD + "friction_tabel_sd: 0.1\n", "unknown_key", ["did you mean 'friction_table_sd'?"]),
        (GOOD + "com: [0, 0, 0]\n", "unknown_key", ["com"]),
        (GOOD.replace("format: box/1\n", ""), "unknown_format", ["begin the file"]),
        (GOOD + "mass_kg: 2.0\n", "bad_yaml", ["mass_kg", "twice", "line 7"]),
        (GOOD + "1: 2\n", "bad_yaml", ["not text"]),
        (
            GOOD + "centre_of_mass_m: [0.06, 0, 0.1]\n",
            "bad_value",
            ["centre_of_mass_m", "0.06", "topples by itself"],
        ),
        ("- a\n- b\n", "bad_yaml", ["list"]),
        ("", "bad_yaml", ["nothing"]),
        ("a: [1, 2\n", "bad_yaml", ["line"]),
        ("a: !!python/object:os.system {}\n", "bad_yaml", ["python/object"]),
        ("[" * 20_000, "bad_yaml", []),
        ("[" * 900_000, "bad_yaml", []),
    ],
)
def test_broken_files_are_explained(tmp_path: Path, text: str, code: str, words: list[str]) -> None:
    path = written(tmp_path, text)
    with pytest.raises(ModelError) as error:
        load_model(path)
    assert error.value.code == code
    for word in (str(path), *words):
        assert word in str(error.value)


def test_unreadable_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="No such file") as error:
        load_model(tmp_path / "missing.yaml")
    assert error.value.code == "unreadable_file"
    (tmp_path / "latin.yaml").write_bytes(b"name: caf\xe9\n")
    with pytest.raises(ModelError, match="UTF-8"):
        load_model(tmp_path / "latin.yaml")
    (tmp_path / "large.yaml").write_bytes(b"#" * (int(LIMITS["model_file"].most) + 1))
    with pytest.raises(ModelError, match="at most"):
        load_model(tmp_path / "large.yaml")


PRISM = """\
format: prism/1
name: tin
corners_m: [[0.05, 0], [0, 0.05], [-0.05, 0], [0, -0.05]]
height_m: 0.1
mass_kg: 0.5
friction_table: 0.4
provenance: {source: a test}
"""
CAN = """\
format: cylinder/1
name: can
radius_m: 0.03
height_m: 0.1
mass_kg: 0.5
friction_table: 0.4
provenance: {source: a test}
"""


@pytest.mark.parametrize(
    ("good", "line", "words"),
    [
        (PRISM, "corners_m: [[0.05, 0], [0.01, 0.01], [0, 0.05], [-0.05, -0.05]]", ["convex"]),
        (PRISM, "corners_m: [[0.05, 0], [0, 0.05]]", ["at least 3"]),
        (PRISM, "corners_m: [[1, 1], [2, 1], [1, 2]]", ["[1.3333, 1.3333]", "encloses [0, 0]"]),
        (PRISM, "corners_m: [[0.05, 0], [0, x], [-0.05, 0]]", ["corners_m.1.1", "'x'"]),
        (PRISM, "centre_of_mass_m: [0.04, 0.04, 0.05]", ["topples by itself", "0.04"]),
        (PRISM, "height_m: no", ["height_m", "'no'", "number"]),
        (CAN, "radius_m: -0.03", ["radius_m", "-0.03", "greater than"]),
        (CAN, "base_radius_m: 0", ["base_radius_m"]),
        (CAN, "centre_of_mass_m: [0.029, 0.029, 0.05]", ["topples by itself"]),
        (CAN, "centre_of_mass_m: [0, 0, 0.2]", ["inside the object, 0.1 m high", "0.2"]),
        (CAN, "support: round", ["support", "'round'", "corners", "uniform"]),
        (CAN, "support: [[0, 0], [0.01, 0], [0.02, 0]]", ["line"]),
        (CAN, "support: [[0.01, 0], [0, 0.01], [0.1, 0]]", ["outside of the base"]),
        (
            CAN,
            "correlations: [[mass, wait, 0.5]]",
            ["correlations", "wait", "one of: mass"],
        ),
        (CAN, "size_m: [0.1, 0.1, 0.1]", ["size_m", "not a key"]),
        (CAN, "kind: box", ["kind", "not a key"]),
    ],
)
def test_wrong_shapes_are_named(tmp_path: Path, good: str, line: str, words: list[str]) -> None:
    key = line.partition(":")[0]
    kept = [old for old in good.splitlines() if not old.startswith(f"{key}:")]
    path = written(tmp_path, "\n".join([*kept, line]))
    with pytest.raises(ModelError) as error:
        load_model(path)
    for word in (str(path), *words):
        assert word in str(error.value)


def test_a_huge_file_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "huge.yaml"
    with path.open("wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(ModelError, match="at most 1000000 bytes") as error:
        load_model(path)
    assert str(path) in str(error.value)


@pytest.mark.parametrize("name", Registry.built_in().names())
def test_every_model_is_written_and_read_again(tmp_path: Path, name: str) -> None:
    model = Registry.built_in().get(name)
    save_model(model, tmp_path / "x.yaml")
    assert load_model(tmp_path / "x.yaml") == model
    written_keys = {line.split(":")[0] for line in (tmp_path / "x.yaml").read_text().splitlines()}
    assert "friction_radius_m" not in written_keys  # it follows from the support
    # Once more, byte for byte; and nothing else is left in the folder.
    first = (tmp_path / "x.yaml").read_bytes()
    save_model(load_model(tmp_path / "x.yaml"), tmp_path / "x.yaml")
    assert (tmp_path / "x.yaml").read_bytes() == first
    assert [file.name for file in tmp_path.iterdir()] == ["x.yaml"]


def test_what_cannot_be_written_leaves_the_old_file(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("old", encoding="utf-8")
    with pytest.raises(ModelError) as error:
        save_model(Registry.built_in().get("mug"), tmp_path / "file" / "x.yaml")
    assert error.value.code == "cannot_write"
    assert (tmp_path / "file").read_text(encoding="utf-8") == "old"
