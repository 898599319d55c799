"""The request of a run: what was asked, where, by which versions, and how it can be repeated."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from nlcontrol.errors import ControlError
from nlcontrol.installed_versions import installed_versions, platform_name
from nlcontrol.json_document import Document
from nlcontrol.session.recipe import Recipe

if TYPE_CHECKING:
    from nlcontrol.results.result import Result
    from nlcontrol.session.controller import Controller


class RunRequest(Document):
    """Request of a run, with all that it takes to repeat it.

    Attributes:
        format: of the bundle, and its version.
        text: the sentence.
        scene: name of the scene.
        seed: of everything random.
        digest: of what was believed when it was planned; null if nobody asked.
        versions: of nlcontrol, Python and the libraries that decide on numbers.
        platform: system, processor and C library.
        recipe: of the controller, with the run as its last deed; null if it cannot be repeated.
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
        controller: that carried it out.
        result: of the run.
        digest: of what was believed when it was planned.
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
