"""A run in one zip file: what was asked, where, by which versions, and what came of it.

The members are `request.json` (a `RunRequest`), `result.json`, and where there are any
`events.json`, `trace.npz` and `replay.html`. A bundle is read with mistrust: members by their names
alone, within limits of size, nothing pickled, and nothing unpacked to the disk but the trace, under
a name of our own. Events and replay are for readers and browsers; they are never read here.
"""

from __future__ import annotations

import io
import json
import tempfile
import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from nlcontrol.errors import ControlError, error, known_errors_raised
from nlcontrol.json_document import is_readable
from nlcontrol.reports.replay_story import replay_story
from nlcontrol.service.bundles.run_request import RunRequest, run_request
from objectmodels.errors import printable
from objectmodels.files.yaml_documents import LIMITS, read_bytes, replace_file
from sim.simulated_executor import simulation
from sim.traces.trace import Trace
from sim.views.viewer_recording import save_replay

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.service.documents import NumberedEvent
    from nlcontrol.session.controller import Controller

_MOST_MEMBERS = 100
_DIRECTORY_ENTRY = b"PK\x01\x02"
_BROKEN = (zipfile.BadZipFile, zlib.error, ValueError, EOFError, OSError, RuntimeError)


@dataclass(frozen=True)
class RunBundle:
    """A bundle, as it was read.

    Attributes:
        request: of the run.
        result: of it, as JSON; empty if it has none.
        trace: of it; None if nothing moved.
    """

    request: RunRequest
    result: dict[str, Any]
    trace: Trace | None


def bundle_run(
    controller: Controller, result: Result, path: Path, *, events: Sequence[NumberedEvent] = ()
) -> None:
    """Writes the bundle of the run that a controller has just done, with trace and replay.

    Args:
        controller: that carried it out.
        result: of the run.
        path: of the bundle.
        events: of the run.

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
        path: of the bundle.
        request: of the run.
        result: of it; None if it has none.
        events: of it.
        trace: file of its trace.
        replay: file of its replay.

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
        if content.count(_DIRECTORY_ENTRY) > _MOST_MEMBERS:
            raise ValueError(f"it has more than {_MOST_MEMBERS} members")
        with zipfile.ZipFile(io.BytesIO(content)) as members:
            request = RunRequest.model_validate_json(_member(members, "request.json"))
            return RunBundle(request, _result_in(members), _trace_in(members))
    except (*_BROKEN, KeyError, NotImplementedError, RecursionError, ControlError) as raised:
        raise _bad_bundle(path, raised) from raised


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


def _bad_bundle(path: Path, raised: Exception) -> ControlError:
    message = str(raised)
    if isinstance(raised, ValidationError):
        first = raised.errors(include_url=False, include_input=False)[0]
        message = f"request.json: {'.'.join(map(str, first['loc']))}: {first['msg']}"
    return error(
        "bad_bundle",
        f"{path} is no bundle of a run: {printable(message[:300])}",
        suggestions=("give a file that `say --bundle` or the service has written",),
    )
