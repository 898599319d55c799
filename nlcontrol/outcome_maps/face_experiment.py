"""An experiment all over a face: its record, its runs, and the prediction beside it.

An experiment all over a face beside its prediction: do the classes agree, and the forces?

The prediction is what the robot believes; the experiment is how the simulated world really is, and
what moved there was judged by its observer. Classes are compared where the prediction is decided:
where its two thresholds are too close to call, either class is as predicted. Forces are compared
wherever something moved in both. A face may be pushed in several ways; each is an experiment of its
own beside the same prediction.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor
from contextlib import closing
from dataclasses import asdict, dataclass
from functools import cached_property, partial
from importlib.metadata import version
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from nlcontrol import __version__
from nlcontrol.errors import error, known_errors_raised
from nlcontrol.json_document import SCHEMA_VERSION, is_readable
from nlcontrol.outcome_maps import outcome_map_table as maps
from nlcontrol.parallel_tasks import run_all
from nlcontrol.references.object_names import find_by_name, names_on_table
from nlcontrol.text_format import join_words
from objectmodels.errors import ModelError
from objectmodels.files.yaml_documents import error_of_system, read_bytes
from objectmodels.mechanics.outcome_map import OutcomeMap
from sim import face_experiment as appliedforce
from sim.face_experiment import Contact, FingerTouch, Touch, TouchResult, Way
from sim.simulated_executor import fresh_robot
from sim.truth.observer import Moved
from sim.truth.scene_file import Scene, built_in_scenes, load_scene

if TYPE_CHECKING:
    from objectmodels import ObjectModel, Registry
    from sim.robots.cell_description import CellDescription, CellObject


# Results of experiments, kept in a file of JSON lines, so that a broken run can go on.
#
# The first line names the format and its version, each further one a result with the key of all
# that determines it. Results are added as they come. What a run that was killed left of its last
# line is ignored, and overwritten by the next result.


FORMAT = "touches"

_HEAD = json.dumps({"format": FORMAT, "schema_version": SCHEMA_VERSION}).encode() + b"\n"


class _Line(BaseModel):
    """A result as it stands in the file; what it is the result of is for people."""

    model_config = ConfigDict(defer_build=True, extra="ignore", strict=True, allow_inf_nan=False)

    key: str
    object: str
    face: str
    point: list[float]
    direction: list[float]
    by: Way
    seed: int
    outcome: Moved | None
    force: Annotated[float, Field(ge=0.0)] | None
    detail: str


class Record:
    """Results by key.

    Args:
        path: of the file; it need not exist.

    Raises:
        ControlError: `bad_record` if the file is something else, or damaged.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        content = _read(path)
        self._size = content.rfind(b"\n") + 1
        # Refuses a file of something else, or of another version.
        other = ("give another file with --record",)
        version = _version(content.partition(b"\n")[0])
        if version is not None and not is_readable(version):
            message = f"{path} has version {version}, this program reads version {SCHEMA_VERSION}"
            raise error("bad_record", message, suggestions=other)
        if version is None and not _HEAD.startswith(content):
            message = (
                f"{path} is not a record of touches: it does not begin with {_HEAD.decode()!r}"
            )
            raise error("bad_record", message, suggestions=other)
        self._known: dict[str, TouchResult] = {}
        for number, text in enumerate(content[: self._size].splitlines()[1:], start=2):
            line = _parse_line(text, path, number)
            self._known[line.key] = TouchResult(line.outcome, line.force, line.detail)

    @property
    def results(self) -> Mapping[str, TouchResult]:
        """Those known by key, a read-only view."""
        return MappingProxyType(self._known)

    def add(self, key: str, contact: Contact, by: Way, seed: int, result: TouchResult) -> None:
        """Adds a push with its result at the end of the file, by the key of all that decides it."""
        line = _Line(
            key=key,
            object=contact.object,
            face=contact.face,
            point=list(contact.point),
            direction=list(contact.direction),
            by=by,
            seed=seed,
            outcome=result.outcome,
            force=result.force,
            detail=result.detail,
        )
        text = json.dumps(line.model_dump(), ensure_ascii=False, allow_nan=False).encode() + b"\n"
        try:
            with self.path.open("ab") as file:
                file.truncate(self._size)
                file.write(text if self._size else _HEAD + text)
                file.flush()
                os.fsync(file.fileno())
        except OSError as raised:
            raise error_of_system(
                "cannot_write", "cannot be written", self.path, raised
            ) from raised
        self._size += len(text) + (0 if self._size else len(_HEAD))
        self._known[key] = result


def _read(path: Path) -> bytes:
    if not os.path.lexists(path):
        return b""
    try:
        return read_bytes(path, "record_file")
    except ModelError as raised:
        message = f"{raised.path}: {raised.message}"
        raise error("bad_record", message, suggestions=raised.suggestions) from raised


def _version(head: bytes) -> str | None:
    """Version that the first line of a record names; None if it is no such line."""
    try:
        said = json.loads(head)
    except (ValueError, RecursionError):
        return None
    if not isinstance(said, dict) or str(said.get("format")).partition("/")[0] != FORMAT:
        return None
    return str(said.get("schema_version", "1"))


def _parse_line(text: bytes, path: Path, number: int) -> _Line:
    try:
        return _Line.model_validate_json(text)
    except ValidationError as raised:
        fault = raised.errors(include_url=False)[0]
        where = ".".join(str(part) for part in fault["loc"])
        damage_error = error(
            "bad_record",
            f"{path}, line {number}: {f'{where}: ' if where else ''}{fault['msg']}",
            suggestions=("remove that line: its push is then carried out anew", "use another file"),
        )
        raise damage_error from raised


# Many pushes carried out in simulation, in parallel, and going on where a run was broken off.
#
# A push is plain data and its result depends on that alone, so that it does not matter which
# process carries it out, or in what order. Any executor of `concurrent.futures` will do. A result
# is known by a digest of all that determines it: the scene with its truth and time step, the
# contact, the way of pushing and what a robot believes then, the seed, and the versions of this
# package and of the simulator.


Believed = Mapping[str, "ObjectModel"]
"""The robot's models of a scene's objects, by their names in it."""

WAYS: Mapping[Way, Callable[[Believed], Touch]] = {
    "force": lambda believed: appliedforce.touch,
    "robot": lambda believed: FingerTouch(believed, fresh_robot),
}
"""The ways of pushing; a robot goes by what it believes, a force by nothing."""

Report = Callable[[int, int], None]
"""Told how many pushes of how many are done."""


def object_on_table(
    name: str, cell: CellDescription, models: Believed, registry: Registry
) -> CellObject:
    """The object on the table of that name or synonym, of which enough words will do.

    Raises:
        ControlError: `ambiguous_object`, `unknown_object` or `not_on_table`.
    """
    found = find_by_name(name, names_on_table(cell.objects, models))
    if len(found) > 1:
        names = tuple(candidate.name for candidate in found)
        raise error(
            "ambiguous_object", f"{name!r} may be {join_words(names, 'or')}", suggestions=names
        )
    if found:
        return next(item for item in cell.objects if item.name == found[0].name)
    with known_errors_raised():
        model = registry.find_one(name)
    scenes_with = [
        f"it stands in another: --scene {name}"
        for name in built_in_scenes()
        if model.name in [item.model for item in load_scene(name).objects]
    ]
    raise error(
        "not_on_table",
        f"the {model.name} does not stand in the scene {cell.name}, so that nobody "
        "knows how it really is",
        suggestions=(*scenes_with, f"there stand: {join_words(cell.names)}"),
    )


class FaceExperiment:
    """Pushes to be carried out, of which some may have been.

    Args:
        scene: the world as it is.
        contacts: the pushes, each a different one.
        by: how an object is pushed.
        believed: what the robot goes by, if it is the one that pushes.
        seed: of everything random.
        record: where results are kept; nowhere if not given.

    Attributes:
        missing: contacts of which no result is known, by key.
    """

    def __init__(
        self,
        scene: Scene,
        contacts: Iterable[Contact],
        *,
        by: Way = "force",
        believed: Believed | None = None,
        seed: int = 0,
        record: Record | None = None,
    ) -> None:
        self._scene, self._by, self._seed, self._record = scene, by, seed, record
        believed = dict(believed or {}) if by == "robot" else {}
        self._touch = WAYS[by](believed)
        beliefs = {name: model.model_dump(mode="json") for name, model in believed.items()}
        drake = version("drake")
        world = _digest(scene.model_dump(mode="json"), by, beliefs, seed, __version__, drake)
        pushes = {contact: _digest(world, asdict(contact)) for contact in contacts}
        self._keys = tuple(pushes.values())
        kept = record.results if record else {}
        self._results = {key: kept[key] for key in self._keys if key in kept}
        self.missing = {key: c for c, key in pushes.items() if key not in kept}

    def run(
        self,
        *,
        executor: Executor | None = None,
        workers: int | None = None,
        report: Report = lambda done, total: None,
    ) -> tuple[TouchResult, ...]:
        """Carries out what is missing; returns the results of all contacts, in their order.

        Args:
            executor: carries out the pushes; it is not shut down. Processes of this machine if not
                given.
            workers: how many processes; as many as there are processors if not given.
            report: told of the progress.

        Raises:
            ControlError: `worker_lost` if the executor has ended, or a push two processes; what was
                done by then is kept.
        """
        total = len(self.missing)
        if total:
            report(0, total)
            with closing(self._carried_out(executor, workers)) as results:
                for done, (key, result) in enumerate(results, start=1):
                    self._results[key] = result
                    report(done, total)
            self.missing = {}
        return tuple(self._results[key] for key in self._keys)

    def _carried_out(
        self, executor: Executor | None, workers: int | None
    ) -> Generator[tuple[str, TouchResult]]:
        """Results in the order of the contacts, kept before they are handed on."""
        touch = partial(self._touch, self._scene, seed=self._seed)
        results = run_all(touch, self.missing.values(), executor=executor, workers=workers)
        try:
            with closing(results):
                for (key, contact), result in zip(self.missing.items(), results, strict=True):
                    if self._record:
                        self._record.add(key, contact, self._by, self._seed, result)
                    yield key, result
        except BrokenExecutor as raised:
            raise error(
                "worker_lost",
                "a process that carried out pushes has ended",
                suggestions=("run it again with --record: what was done is kept there",),
            ) from raised


def _digest(*parts: object) -> str:
    text = json.dumps(parts, sort_keys=True, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


BY = {"force": "a force applied directly", "robot": "the robot's finger"}
"""Ways of pushing in words."""


@dataclass(frozen=True)
class Comparison:
    """Prediction and experiment over n contacts of a face.

    Attributes:
        chart: the prediction.
        results: the experiment, in the order of the chart's contacts.
        object: the object's name in the scene.
        face: how the face is called.
        scene: name of the scene.
        by: how it was pushed.
        seed: of everything random.
    """

    chart: OutcomeMap
    results: tuple[TouchResult, ...]
    object: str
    face: str
    scene: str
    by: Way
    seed: int

    @cached_property
    def outcome(self) -> NDArray[np.str_]:
        """First motion: `slide`, `topple`, `none`, or empty if not carried out, shape (n,)."""
        return np.array([result.outcome or "" for result in self.results], dtype="<U6")

    @cached_property
    def force(self) -> NDArray[np.float64]:
        """Force at which it moved, inf if it never did, nan if not carried out, shape (n,) [N]."""
        nothing = np.where(self.outcome == "none", np.inf, np.nan)
        measured = np.array([result.force for result in self.results], dtype=float)
        return np.where(np.isnan(measured), nothing, measured)

    @property
    def left_out(self) -> int:
        """Number of pushes that were not carried out."""
        return int((self.outcome == "").sum())

    @cached_property
    def is_comparable(self) -> NDArray[np.bool_]:
        """Contacts whose classes are compared, shape (n,)."""
        return np.asarray((self.outcome != "") & (self.chart.outcome != "undecided"))

    @cached_property
    def agrees(self) -> NDArray[np.bool_]:
        """Those of them where the classes are the same, shape (n,)."""
        return np.asarray(self.is_comparable & (self.outcome == self.chart.outcome))

    @property
    def agreement(self) -> float | None:
        """Share of the compared contacts that agree; None if there are none."""
        count = int(self.is_comparable.sum())
        return float(self.agrees.sum() / count) if count else None

    @cached_property
    def error(self) -> NDArray[np.float64]:
        """Predicted force over the measured one, less one; nan where either is none, shape (n,)."""
        both = np.isfinite(self.force) & np.isfinite(self.chart.force)
        measured = np.where(both, self.force, np.nan)
        return np.asarray(np.where(both, self.chart.force, np.nan) / measured - 1.0)

    @property
    def median_error(self) -> float | None:
        """Median size of the force's error; None if there is none."""
        errors = np.abs(self.error[np.isfinite(self.error)])
        return float(np.median(errors)) if errors.size else None


def contacts_of(chart: OutcomeMap, name: str, face: str) -> list[Contact]:
    """The pushes of a map, to be carried out on the object of that name in the scene."""
    _, normals = chart.face.points_at(chart.lateral, chart.height)
    return [
        Contact(name, face, tuple(p), tuple(n), tuple(u))
        for p, n, u in zip(
            chart.points.tolist(), normals.tolist(), chart.directions.tolist(), strict=True
        )
    ]


def agreement_text(found: Comparison) -> str:
    """Agreement of an experiment with the prediction, in a sentence."""
    share, median, compared = found.agreement, found.median_error, int(found.is_comparable.sum())
    undecided = len(found.results) - compared - found.left_out
    classes = "at none of 0" if share is None else f"at {100 * share:.1f} % of {compared}"
    forces = "none" if median is None else f"median error {100 * median:.1f} %"
    return f"same class {classes} contacts ({undecided} undecided); force: {forces}"


def _reasons(found: Comparison) -> list[str]:
    """Why pushes were not carried out, the most frequent reason first."""
    counted = Counter(r.detail for r in found.results if r.outcome is None)
    return [f"not carried out at {n}: {why}" for why, n in counted.most_common()]


def comparison_lines(experiments: Sequence[Comparison]) -> list[str]:
    """The maps of experiments with the same prediction in letters, and how far they agree.

    They stand side by side, the top row first.
    """
    first = experiments[0]
    chart = first.chart
    titles = [f"experiment by {BY[found.by]}" for found in experiments]
    sides = [*(found.outcome for found in experiments), chart.outcome]
    lines = [
        f"{first.object}, {first.face} face, seen from outside",
        f"from left to right: {', '.join(titles)}, prediction",
        *(
            f"{1e3 * z:5.0f} mm  " + "   |   ".join(maps.letters(chart, o, row) for o in sides)
            for z, row in maps.rows(chart)
        ),
        maps.key(chart),
        f"prediction: {chart.friction} friction",
    ]
    for found in experiments:
        lines += [
            f"experiment: pushed by {BY[found.by]} in the scene {found.scene}, seed {found.seed}",
            *(f"  {line}" for line in (agreement_text(found), *_reasons(found))),
        ]
    return lines


def comparison_document(experiments: Sequence[Comparison]) -> dict[str, Any]:
    """A comparison as plain data: the map, and of each contact what was measured; SI units.

    Of several experiments with the same prediction, the documents by their ways.
    """
    each = {str(found.by): _document(found) for found in experiments}
    return each if len(each) > 1 else each[experiments[0].by]


def _document(found: Comparison) -> dict[str, Any]:
    predicted = maps.map_document(found.chart, found.face)
    rows = zip(
        predicted["contacts"],
        found.results,
        found.is_comparable,
        found.agrees,
        found.error,
        strict=True,
    )
    return predicted | {
        "object": found.object,
        "model": found.chart.model.name,
        "scene": found.scene,
        "by": found.by,
        "seed": found.seed,
        "compared": int(found.is_comparable.sum()),
        "agreement": found.agreement,
        "median_force_error": found.median_error,
        "contacts": [
            contact
            | {
                "measured_outcome": result.outcome,
                "measured_force": result.force,
                "detail": result.detail,
                "agrees": bool(agrees) if compared else None,
                "force_error": float(error) if np.isfinite(error) else None,
            }
            for contact, result, compared, agrees, error in rows
        ],
    }


def save_table(experiments: Sequence[Comparison], path: Path) -> None:
    """Writes comparisons as CSV: one row for each push, units in the header."""
    measured = ("measured_outcome", "measured_force")
    predicted = ("outcome", "force", "slide", "topple")
    maps.write_rows(
        ({"by": found.by} | row for found in experiments for row in _document(found)["contacts"]),
        ("by", *maps.PLACE, *measured, *predicted, "agrees", "force_error"),
        path,
    )
