"""The bundle of a run in a store, made when somebody first asks for it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nlcontrol.errors import error
from nlcontrol.installed_versions import installed_versions, platform_name
from nlcontrol.service.bundles.run_bundle import write_bundle
from nlcontrol.service.bundles.run_request import RunRequest

if TYPE_CHECKING:
    from nlcontrol.service.documents import RunInfo
    from nlcontrol.service.store.run_store import RunStore


def bundle_file(store: RunStore, run_id: str) -> Path:
    """The bundle of a run that has ended, in whichever way; it is kept beside the other files.

    Raises:
        ControlError: `unknown_run`, `run_under_way`, `no_file`; what the store does not take.
    """
    info = store.run(run_id)
    if info.state in ("queued", "running"):
        raise error(
            "run_under_way",
            f"the run {run_id} has not ended",
            suggestions=("ask for its bundle when it has",),
        )
    if store.file(run_id, "bundle") is None:
        request = _request(store, info)
        with store.write_file(run_id, "bundle") as path:
            write_bundle(
                path,
                request,
                info.result,
                events=store.events(run_id),
                trace=store.file(run_id, "trace"),
                replay=store.file(run_id, "replay"),
            )
    found = store.file(run_id, "bundle")
    if found is None:
        raise error(
            "no_file",
            f"the bundle of the run {run_id} has gone as it was written",
            suggestions=("ask again",),
        )
    return found


def _request(store: RunStore, info: RunInfo) -> RunRequest:
    """The request of a run; without a recipe if there is none that can be read."""
    path = store.file(info.run_id, "request")
    why_not = f"it was not carried out to its end: {info.state}"
    if path is not None:
        try:
            return RunRequest.model_validate_json(path.read_bytes())
        except ValueError:
            why_not = "its request in the store is damaged"
    spec = store.session_spec(info.session_id)
    return RunRequest(
        text=info.text,
        scene="" if spec is None else spec.scene,
        seed=0 if spec is None else spec.seed,
        versions=installed_versions(),
        platform=platform_name(),
        recipe=None,
        why_not=why_not,
    )
