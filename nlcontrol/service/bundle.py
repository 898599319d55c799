"""Bundles: a run with all that it takes to repeat it, and how a repetition compares.

Two runs of the same request beside each other: what came out otherwise, by how much, from when.

Numbers are the same if they are so to the last digit.
"""

from __future__ import annotations

import io
import json
import tempfile
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from nlcontrol.errors import ControlError, ErrorInfo, error, known_errors_raised
from nlcontrol.installed_versions import installed_versions, platform_name
from nlcontrol.json_document import Document, DocumentPart, finite_or_none, is_readable
from nlcontrol.reports.replay_story import replay_story
from nlcontrol.session.controller import Controller
from nlcontrol.session.conversation import Conversation
from nlcontrol.session.frame_execution import Proposal
from nlcontrol.session.recipe import Recipe
from objectmodels import Registry
from objectmodels.errors import printable
from objectmodels.files.yaml_documents import LIMITS, read_bytes, replace_file
from objectmodels.registry.model_registry import model_from_document
from planner.types.defaults import Defaults
from sim.simulated_executor import SimulatedExecutor, simulation
from sim.traces.trace import UNITS, Trace
from sim.views.viewer_recording import save_replay

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.service.documents import NumberedEvent
    from sim.supervision import Progress


_LONGEST = 200  # characters of a place or a value; a bundle may come from anybody


class Difference(DocumentPart):
    """Something that came out otherwise.

    Attributes:
        part: part of the bundle that differs.
        place: in it: a version's name, a field such as `steps[0].status`, an array such as
            `poses/mug`.
        recorded: value in the bundle, as text; null if there was none.
        repeated: now.
        largest: difference of numbers, in `unit`.
        unit: unit of the numbers, where it is known; `""` for a number without one.
        begins: time of the trace from which on it differs [s].
    """

    part: Literal["version", "result", "trace"]
    place: str
    recorded: str | None = None
    repeated: str | None = None
    largest: float | None = None
    unit: str | None = None
    begins: float | None = None


def version_differences(
    recorded: Mapping[str, str], repeated: Mapping[str, str]
) -> Iterator[Difference]:
    """Versions that are not the same."""
    for name in sorted(recorded.keys() | repeated.keys()):
        was, now = recorded.get(name), repeated.get(name)
        if was != now:
            texts = {"recorded": _short(was), "repeated": _short(now)}
            yield Difference(part="version", place=printable(name[:_LONGEST]), **texts)


def result_differences(
    recorded: Mapping[str, Any], repeated: Mapping[str, Any]
) -> Iterator[Difference]:
    """Fields of two results, as JSON, that are not the same."""
    for key in dict.fromkeys((*recorded, *repeated)):
        # Fields of a result that tell of its reports and not of the run.
        if key not in ("files", "explanation"):
            yield from _value_differences(key, recorded.get(key), repeated.get(key))


def _value_differences(place: str, recorded: Any, repeated: Any) -> Iterator[Difference]:
    if isinstance(recorded, dict) and isinstance(repeated, dict):
        for key in dict.fromkeys((*recorded, *repeated)):
            yield from _value_differences(f"{place}.{key}", recorded.get(key), repeated.get(key))
    elif isinstance(recorded, list) and isinstance(repeated, list):
        if len(recorded) != len(repeated):
            lengths = f"{len(recorded)} items", f"{len(repeated)} items"
            yield _result_difference(place, *lengths)
        for index, (was, now) in enumerate(zip(recorded, repeated, strict=False)):
            yield from _value_differences(f"{place}[{index}]", was, now)
    elif _is_number(recorded) and _is_number(repeated):
        if recorded != repeated:
            texts = _short(recorded), _short(repeated)
            yield _result_difference(place, *texts, _distance(recorded, repeated))
    elif recorded != repeated:
        yield _result_difference(place, _short(recorded), _short(repeated))


def _result_difference(
    place: str, recorded: str | None, repeated: str | None, largest: float | None = None
) -> Difference:
    return Difference(
        part="result",
        place=printable(place[:_LONGEST]),
        recorded=recorded,
        repeated=repeated,
        largest=largest,
    )


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _distance(a: float, b: float) -> float | None:
    """Distance of two numbers from each other; None if that is no number itself."""
    try:
        return finite_or_none(abs(b - a))
    except OverflowError:  # of an integer beyond all floats
        return None


def _short(value: object) -> str | None:
    return None if value is None else printable(str(value)[:_LONGEST])


def trace_differences(recorded: Trace | None, repeated: Trace | None) -> Iterator[Difference]:
    """Arrays of two traces that are not the same; of unlike lengths as far as both go."""
    if recorded is None or repeated is None:
        if recorded is not repeated:
            yield _trace_difference("", _length(recorded), _length(repeated))
        return
    was, now = recorded.arrays(), repeated.arrays()
    for name in dict.fromkeys((*was, *now)):
        if name in was and name in now:
            arrays = np.atleast_1d(was[name]), np.atleast_1d(now[name])
            yield from _array_differences(name, *arrays, recorded.time)
        else:
            yield _trace_difference(name, _shape(was.get(name)), _shape(now.get(name)))


def _array_differences(
    name: str, recorded: NDArray[Any], repeated: NDArray[Any], time: NDArray[np.float64]
) -> Iterator[Difference]:
    """The differences of an array; of poses, those of the places and of the quaternions."""
    if recorded.shape != repeated.shape:
        yield _trace_difference(name, _shape(recorded), _shape(repeated))
    if recorded.shape[1:] != repeated.shape[1:]:
        return
    n = min(len(recorded), len(repeated))
    times = time[:n] if len(recorded) == len(time) else None
    unit = UNITS.get(name, UNITS.get(name.partition("/")[0], ""))
    if not unit.startswith("quaternion"):
        yield from _row_differences(name, unit, recorded[:n], repeated[:n], times)
        return
    for part, its_unit, columns in (("place", "m", slice(4, 7)), ("quaternion", "", slice(4))):
        rows = recorded[:n, columns], repeated[:n, columns]
        yield from _row_differences(f"{name} ({part})", its_unit, *rows, times)


def _row_differences(
    place: str,
    unit: str,
    recorded: NDArray[Any],
    repeated: NDArray[Any],
    times: NDArray[np.float64] | None,
) -> Iterator[Difference]:
    """The difference of arrays of one shape, the first index of which may go by times [s]."""
    differs = recorded != repeated
    if not differs.any():
        return
    first = int(np.argmax(differs.reshape(len(differs), -1).any(axis=1)))
    begins = None if times is None else finite_or_none(times[first])
    if recorded.dtype.kind == "U" or repeated.dtype.kind == "U":
        texts = _short(recorded[first]), _short(repeated[first])
        yield _trace_difference(place, *texts, begins=begins)
        return
    largest = finite_or_none(np.max(np.abs(recorded[differs] - repeated[differs])))
    yield _trace_difference(place, None, None, largest=largest, unit=unit, begins=begins)


def _length(trace: Trace | None) -> str | None:
    return None if trace is None else f"{len(trace.time)} samples"


def _shape(array: NDArray[Any] | None) -> str | None:
    return None if array is None else f"shape {array.shape}"


def _trace_difference(
    place: str, recorded: str | None, repeated: str | None, **figures: Any
) -> Difference:
    return Difference(part="trace", place=place, recorded=recorded, repeated=repeated, **figures)


# From a recipe to a controller that goes on as the one that it was taken from.


def rebuild_controller(recipe: Recipe) -> Controller:
    """Builds a controller to which all has happened that its recipe says.

    Raises:
        ControlError: `bad_recipe`.
    """
    return repeat_recipe(recipe)[0]


def repeat_recipe(
    recipe: Recipe, *, exact: bool = True, progress: Progress | None = None
) -> tuple[Controller, Result | None]:
    """The same, and the result of the last deed; None if that was a look, or there is none.

    Args:
        recipe: recipe of a controller.
        exact: whether every deed must begin at its recorded time.
        progress: called with what happens in the simulation.

    Raises:
        ControlError: `bad_recipe`.
    """
    controller, result = _first_controller(recipe), None
    conversations: dict[int, Conversation] = {}
    proposals: dict[tuple[int, int | None], Proposal] = {}
    for deed in recipe.deeds:
        executor = simulation(controller.executor)
        # The world is built even where the time does not matter: that decides how a look is made.
        if deed.begun is not None and deed.begun != executor.world.time and exact:
            raise _bad_recipe(f"“{deed.said}” was said at another time")
        if deed.said is None:
            controller.look()
            result = None
            continue
        if deed.conversation not in conversations:
            conversations[deed.conversation] = Conversation(controller)
        conversation = conversations[deed.conversation]
        if deed.proposes is not None:
            proposal = conversation.plan(deed.said)
            proposals[deed.conversation, deed.proposes] = proposal
            result = proposal.result
        elif deed.executes is not None:
            approved = proposals.get((deed.conversation, deed.executes))
            if approved is None or (approved.intention is None and exact):
                raise _bad_recipe(f"“{deed.said}” was not planned before")
            result = approved.result  # which refuses it, where another version has planned
            if approved.intention is not None:
                result = conversation.execute(approved, progress=progress)
        else:
            result = conversation.say(deed.said, motion=deed.motion, progress=progress)
    return controller, result


def _first_controller(recipe: Recipe) -> Controller:
    """The controller before anything was done."""
    try:
        with known_errors_raised():
            kinds = Registry.default().kinds
            registry = Registry()
            for document in recipe.registry:
                registry.add(model_from_document(document, "recipe", kinds))
            if recipe.scene.get("models"):
                raise ValueError("its scene names files of this machine")
            controller = Controller(
                executor=SimulatedExecutor.from_document(recipe.scene, seed=recipe.seed),
                registry=registry,
                defaults=Defaults(**recipe.defaults),
            )
            controller.models = {
                name: model_from_document(document, "recipe", kinds)
                for name, document in recipe.beliefs.items()
            }
            names = {item.name for item in controller.cell.objects}
            if names != controller.models.keys():
                odd = ", ".join(sorted(names ^ controller.models.keys())[:5])
                raise ValueError(f"its beliefs are not of the scene's objects: {odd}")
    except (ValueError, TypeError, ControlError) as raised:
        raise _bad_recipe(str(raised)) from raised
    return controller


def _bad_recipe(message: str) -> ControlError:
    hint = "take one that `Controller.recipe` made with this version"
    told = printable(" ".join(message[:500].split()))  # a recipe may come from anybody
    return error("bad_recipe", f"it cannot be rebuilt: {told}", suggestions=(hint,))


# A run repeated from its bundle: the same to the digit, or what came out otherwise.


class RerunReport(Document):
    """Comparison of a run with its repetition.

    Attributes:
        ok: result and trace are the same to the digit.
        text: the sentence.
        samples: number of samples of the trace; 0 if nothing moved.
        differences: versions that are others, fields and arrays that came out otherwise; the first
            of each.
        found: number of fields and arrays that came out otherwise.
        error: `run_differs` if any did.
    """

    ok: bool
    text: str
    samples: int
    differences: tuple[Difference, ...]
    found: int
    error: ErrorInfo | None = None


def rerun(bundle: RunBundle, progress: Progress | None = None) -> RerunReport:
    """Does all again that led to a run, and the run, in simulation; then compares.

    Args:
        bundle: bundle of the run.
        progress: called with what happens in the simulation.

    Raises:
        ControlError: `not_repeatable`, `bad_recipe`.
    """
    request = bundle.request
    if request.recipe is None or not request.recipe.deeds:
        raise error(
            "not_repeatable",
            f"this run has no recipe: {printable(request.why_not or 'nothing was done')}",
            suggestions=("read its result, events and replay, which the bundle holds",),
        )
    _, result = repeat_recipe(request.recipe, exact=False, progress=progress)
    repeated = {} if result is None else json.loads(result.to_json())
    trace = None if result is None else result.trace
    versions = version_differences(
        {**request.versions, "platform": request.platform},
        {**installed_versions(), "platform": platform_name()},
    )
    others = tuple(versions)
    came_out = tuple(
        chain(
            result_differences(bundle.result, repeated),
            trace_differences(bundle.trace, trace),
        )
    )
    # The first 50 differences are told.
    return RerunReport(
        ok=not came_out,
        text=printable(request.text),
        samples=0 if bundle.trace is None else len(bundle.trace.time),
        differences=(*others, *came_out[:50]),
        found=len(came_out),
        error=_differs(len(came_out), others) if came_out else None,
    )


def _differs(found: int, others: tuple[Difference, ...]) -> ErrorInfo:
    names = ", ".join(f"{each.place} {each.recorded}" for each in others)
    hint = "report it with the bundle: with the same versions nothing may differ"
    if others:
        hint = f"repeat it with {names}, if it has to be the same to the digit"
    return ErrorInfo(
        code="run_differs",
        message=f"{found} fields and arrays came out otherwise",
        suggestions=(hint,),
        numbers={"found": found},
    )


def report_lines(report: RerunReport) -> Iterator[str]:
    """A report in words."""
    if report.ok:
        moved = f" and its trace of {report.samples} samples" if report.samples else ""
        yield f"Repeated to the digit: the result of “{report.text}”{moved}."
    else:
        yield f"It came out otherwise: “{report.text}”."
    for each in report.differences:
        told = []
        if each.recorded is not None or each.repeated is not None:
            told.append(
                f"{each.recorded or 'nothing'} in the bundle, {each.repeated or 'nothing'} now"
            )
        if each.largest is not None:
            told.append(f"up to {each.largest:.3g} {each.unit or ''}".rstrip())
        if each.begins is not None:
            told.append(f"from {each.begins:.3f} s on")
        yield f"  {each.part} {each.place}: {', '.join(told)}"
    untold = report.found - sum(each.part != "version" for each in report.differences)
    if untold > 0:
        yield f"  and {untold} more"


# The request of a run: what was asked, where, by which versions, and how it can be repeated.


class RunRequest(Document):
    """Request of a run, with all that it takes to repeat it.

    Attributes:
        format: format of the bundle, with its version.
        text: the sentence.
        scene: name of the scene.
        seed: seed of all randomness.
        digest: digest of the beliefs at planning; null if it was not planned first.
        versions: versions of nlcontrol, Python and the numerical libraries.
        platform: system, processor and C library.
        recipe: recipe of the session, with the run as its last deed; null if it cannot be repeated.
        why_not: the reason then.
    """

    format: Literal["nlcontrol-run/1"] = "nlcontrol-run/1"
    text: str
    scene: str
    seed: int
    digest: str | None = None
    versions: dict[str, str]
    platform: str
    recipe: Recipe | None
    why_not: str | None = None


def run_request(controller: Controller, result: Result, digest: str | None = None) -> RunRequest:
    """The request of a run that has just ended, which was the last that the controller did.

    Args:
        controller: controller that carried the run out.
        result: result of the run.
        digest: digest of the beliefs at planning.
    """
    recipe, why_not = None, None
    try:
        recipe = controller.recipe()
    except ControlError as raised:
        why_not = str(raised)
    return RunRequest(
        text=result.text,
        scene=result.scene,
        seed=result.seed,
        digest=digest,
        versions=installed_versions(),
        platform=platform_name(),
        recipe=recipe,
        why_not=why_not,
    )


# A run in one zip file: what was asked, where, by which versions, and what came of it.
#
# The members are `request.json` (a `RunRequest`), `result.json`, and where there are any
# `events.json`, `trace.npz` and `replay.html`. A bundle is read with mistrust: members by their
# names alone, within limits of size, nothing pickled, and nothing unpacked to the disk but the
# trace, under a name of our own. Events and replay are for readers and browsers; they are never
# read here.


_MOST_MEMBERS = 100
_BROKEN = (zipfile.BadZipFile, zlib.error, ValueError, EOFError, OSError, RuntimeError)


@dataclass(frozen=True)
class RunBundle:
    """A bundle, as it was read.

    Attributes:
        request: request of the run.
        result: result of the run, as JSON; empty if it has none.
        trace: trace of the run; None if nothing moved.
    """

    request: RunRequest
    result: dict[str, Any]
    trace: Trace | None


def bundle_run(
    controller: Controller, result: Result, path: Path, *, events: Sequence[NumberedEvent] = ()
) -> None:
    """Writes the bundle of the run that a controller has just done, with trace and replay.

    Args:
        controller: controller that carried the run out.
        result: result of the run.
        path: path of the bundle.
        events: events of the run.

    Raises:
        ModelError: `cannot_write`.
    """
    trace = replay = None
    with tempfile.TemporaryDirectory() as folder:
        if result.trace is not None:
            trace, replay = Path(folder) / "trace.npz", Path(folder) / "replay.html"
            result.trace.save(trace)
            scene = simulation(controller.executor).scene
            save_replay(result.trace, scene, replay, story=replay_story(result))
        request = run_request(controller, result)
        write_bundle(path, request, result, events=events, trace=trace, replay=replay)


def write_bundle(
    path: Path,
    request: RunRequest,
    result: Result | None,
    *,
    events: Sequence[NumberedEvent] = (),
    trace: Path | None = None,
    replay: Path | None = None,
) -> None:
    """Writes the bundle of a run, whole or not at all.

    Args:
        path: path of the bundle.
        request: request of the run.
        result: result of the run; None if it has none.
        events: events of the run.
        trace: file of the run's trace.
        replay: file of the run's replay.

    Raises:
        ModelError: `cannot_write`.
    """
    texts = {"request.json": request.model_dump_json()}
    if result is not None:
        texts["result.json"] = result.to_json()
    if events:
        texts["events.json"] = json.dumps([each.model_dump(mode="json") for each in events])
    with replace_file(path) as temporary, zipfile.ZipFile(temporary, "w") as members:
        for name, text in texts.items():
            members.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)
        for name, file, packed in (
            ("trace.npz", trace, zipfile.ZIP_STORED),  # which is packed already
            ("replay.html", replay, zipfile.ZIP_DEFLATED),
        ):
            if file is not None:
                members.writestr(zipfile.ZipInfo(name), file.read_bytes(), packed)


def read_bundle(path: Path) -> RunBundle:
    """The bundle that `write_bundle` wrote.

    Raises:
        ControlError: `unreadable_file`, or `bad_bundle` if it holds something else.
    """
    with known_errors_raised():
        content = read_bytes(path, "bundle_file")
    try:
        # Its list of members is read as a whole, so it may not be long.
        if content.count(b"PK\x01\x02") > _MOST_MEMBERS:
            raise ValueError(f"it has more than {_MOST_MEMBERS} members")
        with zipfile.ZipFile(io.BytesIO(content)) as members:
            request = RunRequest.model_validate_json(_member(members, "request.json"))
            return RunBundle(request, _result_in(members), _trace_in(members))
    except (*_BROKEN, KeyError, NotImplementedError, RecursionError, ControlError) as raised:
        message = str(raised)
        if isinstance(raised, ValidationError):
            first = raised.errors(include_url=False, include_input=False)[0]
            message = f"request.json: {'.'.join(map(str, first['loc']))}: {first['msg']}"
        bad_bundle = error(
            "bad_bundle",
            f"{path} is no bundle of a run: {printable(message[:300])}",
            suggestions=("give a file that `say --bundle` or the service has written",),
        )
        raise bad_bundle from raised


def _member(members: zipfile.ZipFile, name: str) -> bytes:
    """Contents of a member, of a size within the limit whatever the file says of it."""
    most = int(LIMITS["bundle_part"].most)
    with members.open(name) as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise ValueError(f"{name} unpacks to more than {most} bytes")
    return content


def _result_in(members: zipfile.ZipFile) -> dict[str, Any]:
    if "result.json" not in members.namelist():
        return {}
    result = json.loads(_member(members, "result.json"))
    if not isinstance(result, dict) or not is_readable(str(result.get("schema_version"))):
        raise ValueError("its result is none that this version reads")
    return result


def _trace_in(members: zipfile.ZipFile) -> Trace | None:
    if "trace.npz" not in members.namelist():
        return None
    with tempfile.NamedTemporaryFile(suffix=".npz") as file:
        file.write(_member(members, "trace.npz"))
        file.flush()
        with known_errors_raised():
            return Trace.load(file.name)
