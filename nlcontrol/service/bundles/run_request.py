"""The request of a run: what was asked, where, by which versions, and how it can be repeated."""

from __future__ import annotations

import importlib.metadata
import platform
import sys
from typing import TYPE_CHECKING, Literal

from nlcontrol.errors import ControlError
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


def installed_versions() -> dict[str, str]:
    """Versions of nlcontrol, of Python and of the libraries that decide on numbers."""
    python = f"{sys.implementation.name} {platform.python_version()}"
    packages = ("nlcontrol", "drake", "numpy", "scipy")
    return {"python": python} | {name: importlib.metadata.version(name) for name in packages}


def platform_name() -> str:
    """System, processor and C library, as far as they decide on numbers."""
    return " ".join(filter(None, (platform.system(), platform.machine(), *platform.libc_ver())))


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
