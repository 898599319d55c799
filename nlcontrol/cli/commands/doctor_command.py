"""`doctor`: is everything there that a run needs?"""

from __future__ import annotations

import base64
import csv
import ctypes
import hashlib
import importlib.metadata
import importlib.util
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import click

from nlcontrol import __version__
from nlcontrol.cli.console.console_output import json_option, print_json
from nlcontrol.errors import INTERNAL, OK, ControlError
from nlcontrol.installed_versions import DISTRIBUTION
from nlcontrol.package_imports import SIBLINGS, home, misplaced_packages

_EGL_VENDORS = (Path("/usr/share/glvnd/egl_vendor.d"), Path("/etc/glvnd/egl_vendor.d"))


@dataclass(frozen=True)
class Finding:
    """The finding of one check.

    Attributes:
        name: what.
        ok: whether it is as it should be.
        essential: whether a sentence cannot be carried out without it.
        message: what was found.
        suggestion: what to do if it is not ok.
    """

    name: str
    ok: bool
    essential: bool
    message: str
    suggestion: str = ""


@click.command("doctor")
@click.option("--run", "runs", is_flag=True, help="Also carry out a sentence (half a minute).")
@json_option
def command(runs: bool, as_json: bool) -> int:
    """Check that everything a run needs is installed."""
    findings = list(examine_all())
    if runs:
        findings.append(_examine_by_use("simulation", _use_simulation))
    ok = all(f.ok for f in findings if f.essential)
    if as_json:
        print_json({"ok": ok, "findings": [asdict(f) for f in findings]})
        return OK if ok else INTERNAL
    for f in findings:
        mark = "✓" if f.ok else ("✗" if f.essential else "–")
        click.echo(f"{mark} {f.name}: {f.message}")
        if f.suggestion and not f.ok:
            click.echo(f"    → {f.suggestion}")
    click.echo("All essentials are there." if ok else "Something essential is missing.")
    return OK if ok else INTERNAL


def examine_all() -> Iterator[Finding]:
    """Check everything, in the order in which a run needs it."""
    yield Finding("nlcontrol", True, True, __version__)
    version = ".".join(map(str, sys.version_info[:3]))
    yield Finding(
        "Python", sys.version_info >= (3, 11), True, version, "nlcontrol needs Python 3.11 or newer"
    )
    wrong = [f"{name} is {path or 'missing'}" for name, path in misplaced_packages()]
    yield Finding(
        "packages", not wrong, True, "; ".join(wrong) or "all five beside each other", "rename it"
    )
    foreign = list(foreign_files(Path(home())))
    yield Finding(
        "files of the packages",
        not foreign,
        True,
        "; ".join(foreign) or "nobody else's",
        "install nlcontrol in an environment of its own, without that distribution",
    )
    yield _examine_drake()
    yield _examine_by_use("object models", _use_registry)
    yield _examine_own_models()
    yield _examine_by_use("scenes", _use_scenes)
    yield _examine_by_use("grammar", _use_grammar)
    yield _examine_by_use("planner", _use_planner)
    yield _examine_egl()


def foreign_files(folder: Path) -> Iterator[str]:
    """Files of other distributions in our packages in a folder, and files changed there.

    Packages with everyday names may be those of another distribution too, and who is installed
    last writes over the other's files.
    """
    for found in importlib.metadata.distributions(path=[str(folder)]):
        for path, digest, *_ in csv.reader((found.read_text("RECORD") or "").splitlines()):
            if path.partition("/")[0] not in ("nlcontrol", *SIBLINGS):
                continue
            if found.name != DISTRIBUTION:
                yield f"{path} belongs to {found.name} {found.version}"
            elif digest and digest != f"sha256={_digest(folder / path)}":
                yield f"{path} is not as it was installed"


def _digest(path: Path) -> str:
    """SHA-256 of a file as the record of an installation states it; empty without the file."""
    if not path.is_file():
        return ""
    found = hashlib.sha256(path.read_bytes()).digest()
    return base64.urlsafe_b64encode(found).rstrip(b"=").decode()


def _examine_drake() -> Finding:
    found = importlib.util.find_spec("pydrake") is not None
    version = importlib.metadata.version("drake") if found else "not installed"
    return Finding("Drake", found, True, version, "pip install 'drake>=1.51'")


def _examine_by_use(name: str, what: Callable[[], str]) -> Finding:
    """A finding from code that may fail in any way: reporting that is what this is for."""
    try:
        return Finding(name, True, True, what())
    except Exception as raised:
        return Finding(
            name, False, True, f"{type(raised).__name__}: {raised}", "install nlcontrol again"
        )


def _use_registry() -> str:
    from objectmodels import Registry

    registry = Registry.built_in()
    for problem in registry.problems:
        raise problem
    return ", ".join(registry.names())


def _examine_own_models() -> Finding:
    """Models of plug-ins and of the user; a broken one stops no run."""
    from objectmodels import Registry
    from objectmodels.registry.model_registry import user_folder

    registry = Registry.default()
    own = [name for name in registry.names() if not registry.place(name).startswith("built in")]
    problems = [str(problem) for problem in registry.problems]
    return Finding(
        "plug-ins and your own models (optional)",
        not problems,
        False,
        "; ".join(problems) or ", ".join(own) or f"none; yours go to {user_folder()}",
        "mend or remove what was skipped",
    )


def _use_scenes() -> str:
    from nlcontrol.session.controller import Controller
    from sim.truth.scene_file import built_in_scenes

    names = built_in_scenes()
    for name in names:
        Controller(name)  # reads the scene and finds the model of each of its objects
    return ", ".join(names)


def _use_grammar() -> str:
    import grammar

    return grammar.parse("push the ice tea box away without toppling it").paraphrase


def _use_planner() -> str:
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.conversation import Conversation

    result = Conversation(Controller("kitchen")).say("push the ice tea box away", plan_only=True)
    if result.error:
        raise ControlError(result.error)
    return result.status


def _use_simulation() -> str:
    from nlcontrol.session.controller import Controller
    from nlcontrol.session.conversation import Conversation

    start = time.monotonic()
    result = Conversation(Controller("kitchen")).say("push the mug 2 cm to the left")
    if result.error:
        raise ControlError(result.error)
    return f"{len(result.checks)} verdicts, all held, in {time.monotonic() - start:.0f} s"


def _examine_egl() -> Finding:
    """Pictures are drawn without a display, by Mesa's software renderer through EGL."""
    present = {
        "libegl1": _can_load("libEGL.so.1"),
        "libegl-mesa0": any(next(folder.glob("*mesa*"), None) for folder in _EGL_VENDORS),
        "libgl1-mesa-dri": any(Path("/usr/lib").glob("*/dri/*swrast_dri.so")),
    }
    missing = [package for package, there in present.items() if not there]
    return Finding(
        "pictures (optional)",
        not missing,
        False,
        f"missing Debian packages: {', '.join(missing)}" if missing else "EGL is there",
        f"apt-get install {' '.join(missing)}",
    )


def _can_load(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
