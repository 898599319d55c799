"""Generated files and options: whatever is in them, there is a model, a scene, data, or an error.

Each error is one of ours, with a code, a suggestion and a message that can be printed; no case
takes 10 s or 1 GB. `NLCONTROL_ATTACKS=20000` makes as many cases.
"""

from __future__ import annotations

import json
import resource
import time
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
import trimesh
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from nlcontrol.errors import CODES, FAMILIES, exception_info
from nlcontrol.json_document import SCHEMA_VERSION
from nlcontrol.outcome_maps.face_experiment import Record
from nlcontrol.service.bundle import (
    RerunReport,
    RunBundle,
    read_bundle,
    report_lines,
    rerun,
    run_request,
)
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from objectmodels import ModelError, ObjectModel, Registry
from objectmodels.descriptions.description_import import import_description
from objectmodels.descriptions.description_reading import Format, description_texts
from objectmodels.descriptions.mesh_import import FORMATS, import_mesh
from objectmodels.identification.touch_log import read_data
from objectmodels.registry.model_registry import load_model, save_model
from sim.truth.scene_file import load_scene, sample_world
from tests.attacks.bad_files import (
    ROOT,
    good_bytes,
    mutated,
    names,
    numbers,
    spliced,
    yaml_files,
)
from tests.sizes import ATTACKS

MOST_SECONDS, MOST_MEMORY = 10.0, 2**30  # of processor time; of memory on top of what is held

CELLS = ["nan", "inf", "-1", "1e300", "", "x", '"', ",", ";", "\n", "\r", "\x00", "0,5", "9" * 400,
         "slide", "topple", "#", "\n" * 50, "," * 200, "\ufeff", "e", "."]  # fmt: skip
LINES = ["{", "}", "[" * 5000, "9" * 5000, "null", "NaN", "1e999", "\n", "\x00", '"', "\ud800", ":"]


def attacks(share: float) -> Callable[[Any], Any]:
    """A share of the cases of a run."""
    return settings(
        max_examples=max(10, round(share * ATTACKS)), suppress_health_check=list(HealthCheck)
    )


def attack(action: Callable[[], object]) -> object:
    """What an attack ends in; None if that is a good error."""
    begun = time.process_time()
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most, hard = resource.getrlimit(resource.RLIMIT_AS)
    held = pages * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + MOST_MEMORY, hard))
    try:
        return action()
    except Exception as raised:
        info = exception_info(raised)
        if info.code in {"internal", "broken_kind"}:
            raise
        assert info.code in CODES or info.family in FAMILIES
        assert info.suggestions, info
        for text in (info.message, info.path or "", *info.suggestions):
            assert text.isprintable(), info
            assert len(text) < 1000, info
        return None
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (most, hard))
        assert time.process_time() - begun < MOST_SECONDS


def use(model: ObjectModel, folder: Path) -> None:
    """What any command does with a model: its faces, forces, the ways it lies, its file."""
    for face in model.faces():
        points, normals = face.points_at([0.0], [0.5 * (face.bottom + face.top)])
        heights = model.cone_thresholds(points, normals).critical_height
        assert not np.isnan(heights).any()
        for exact in (False, True):
            model.thresholds(points, -normals, exact=exact)
    assert model.rests
    save_model(model, folder / "again.yaml")
    assert load_model(folder / "again.yaml") == model


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("attacks")


@attacks(0.35)
@given(content=yaml_files("objectmodels/registry/builtin"))
def test_model_files(folder: Path, content: bytes) -> None:
    path = folder / "a.yaml"
    path.write_bytes(content)
    model = attack(lambda: load_model(path))
    if isinstance(model, ObjectModel):
        attack(lambda: use(model, folder))
    registry = Registry()
    registry.load(folder / "..")
    attack(lambda: registry.load(folder))


@attacks(0.3)
@given(content=yaml_files("sim/scenes"))
def test_scene_files(folder: Path, content: bytes) -> None:
    path = folder / "scene.yaml"
    path.write_bytes(content)
    attack(lambda: sample_world(load_scene(path), 0).cell)


@attacks(0.15)
@given(content=spliced(good_bytes("examples/*.csv"), CELLS) | st.binary(max_size=300))
def test_data_files(folder: Path, content: bytes) -> None:
    path = folder / "data.csv"
    path.write_bytes(content)
    model = Registry.built_in().get("ice tea box")
    attack(lambda: read_data([path], model))


@cache
def _bundle() -> tuple[Any, ...]:
    """Request and result of a run, as JSON."""
    controller = Controller()
    conversation = Conversation(controller)
    conversation.plan("push the mug 2 cm to the left")
    result = conversation.say("where is the mug?")
    request = run_request(controller, result).model_dump_json()
    return json.loads(request), json.loads(result.to_json())


@attacks(0.02)
@given(changes=st.data(), packed=st.booleans())
def test_bundles(folder: Path, changes: st.DataObject, packed: bool) -> None:
    path = folder / "run.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED if packed else 0) as members:
        for name, good in zip(("request.json", "result.json"), _bundle(), strict=True):
            text = json.dumps(changes.draw(mutated([good]) | st.just(good)))
            members.writestr(name, text.encode("utf-8", "surrogatepass"))
        if changes.draw(st.integers(0, 9)) == 0:
            members.writestr("trace.npz", changes.draw(st.binary(max_size=30)))
    if changes.draw(st.integers(0, 9)) == 0:
        path.write_bytes(changes.draw(spliced([path.read_bytes()], ["\x00", "PK\x01\x02"])))
    bundle = attack(lambda: read_bundle(path))
    if isinstance(bundle, RunBundle):
        report = attack(lambda: rerun(bundle))
        if isinstance(report, RerunReport):
            assert all(line.isprintable() for line in report_lines(report))


def _meshes() -> list[bytes]:
    box: Any = trimesh.creation.box(extents=(0.06, 0.08, 0.2))
    exported = [box.export(file_type=ending) for ending in ("stl", "obj", "ply", "off", "glb")]
    return [text.encode() if isinstance(text, str) else text for text in exported]


@attacks(0.1)
@given(content=spliced(_meshes(), CELLS) | st.binary(max_size=300), ending=st.sampled_from(FORMATS))
def test_mesh_files(folder: Path, content: bytes, ending: str) -> None:
    path = folder / f"a.{ending}"
    path.write_bytes(content)
    attack(lambda: import_mesh(path, name="a", mass=1.0))


def _descriptions() -> list[bytes]:
    known = Registry.built_in()
    named = [(name, form) for name in ("book", "mug") for form in get_args(Format)]
    return [
        text.encode()
        for name, form in named
        for text in description_texts(known.get(name).model_copy(update=STANDING), form).values()
    ]


STANDING = {"support": "corners"}  # few feet, so that most of a file is about something else
XML = ['"0 0"', '"nan nan nan"', '"1e300 1e300 1e300"', '"-1"', '""', '"0"', "<", ">", "/>", "&a;",
       "</link>", "<joint/>", "<link/>", "<!DOCTYPE a>", "<!--", "]]>", 'type="mesh"', 'size=""',
       'rpy="9 9 9"', 'quat="0 0 0 0"', 'euler="1 2 3"', "<geometry><mesh/></geometry>", "x:y",
       '<mesh filename="../a.xml"/>', "<sphere><radius>1</radius></sphere>", " " * 50,
       "\x00", 'friction=""', 'solref=" "', 'eulerseq="xxy"']  # fmt: skip


@attacks(0.2)
@given(
    content=spliced(_descriptions(), XML),
    mass=st.none() | numbers,
    friction=st.none() | numbers,
)
def test_descriptions(
    folder: Path, content: bytes, mass: float | None, friction: float | None
) -> None:
    path = folder / "a.xml"
    path.write_bytes(content)
    model = attack(lambda: import_description(path, mass=mass, friction=friction))
    if isinstance(model, ObjectModel):
        attack(lambda: use(model, folder))


@attacks(0.05)
@given(
    name=names, mass=st.none() | numbers, density=st.none() | numbers, friction=st.none() | numbers,
    synonyms=st.lists(names, max_size=2).map(tuple),
    unit=st.sampled_from(["m", "mm", "in", ""]), up=st.sampled_from(["+z", "-x", "z"]),
)  # fmt: skip
def test_options_of_import(folder: Path, **options: Any) -> None:
    path = folder / "box.stl"
    path.write_bytes(_meshes()[0])
    attack(lambda: import_mesh(path, **options))


HEAD = f'{{"format": "touches", "schema_version": "{SCHEMA_VERSION}"}}\n'.encode()
LINE = (
    b'{"key": "k", "object": "mug", "face": "front", "point": [0, 0, 0], "direction": [1, 0, 0], '
    b'"by": "force", "seed": 0, "outcome": "slide", "force": 1.0, "detail": ""}\n'
)


@attacks(0.05)
@given(content=spliced([HEAD + LINE + LINE], LINES))
def test_records(folder: Path, content: bytes) -> None:
    path = folder / "touches.jsonl"
    path.write_bytes(content)
    attack(lambda: Record(path))


def test_a_good_file_of_each_kind_is_read(tmp_path: Path) -> None:
    """The attacks begin at files that are good, so that they come far."""
    (tmp_path / "touches.jsonl").write_bytes(HEAD + LINE)
    assert Record(tmp_path / "touches.jsonl").results
    for number, content in enumerate(_meshes()):
        path = tmp_path / f"a.{FORMATS[number]}"
        path.write_bytes(content)
        assert import_mesh(path, name="a", mass=1.0)
    with pytest.raises(ModelError):
        load_model(ROOT / "README.md")
