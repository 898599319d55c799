"""`mcp`: the tools of a planning session for a language model, over standard input and output."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from nlcontrol.cli.console.command_options import Settings, world_options
from nlcontrol.errors import error
from nlcontrol.interruption import SIGNALS, Terminated

if TYPE_CHECKING:
    from nlcontrol.service.methods import PlanningSession


@click.command("mcp")
@world_options
@click.option("--allow-motion", is_flag=True, help="Offer the tool that carries out a plan.")
@click.option("--url", help="Use a session at this server instead of a local one.")
@click.option(
    "--token-file",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    help="File holding the token of that server.",
)
def command(
    scene: str,
    seed: int,
    settings: Settings,
    allow_motion: bool,
    url: str | None,
    token_file: Path | None,
) -> None:
    """Serve tools to a language model over standard input and output (MCP).

    The tools look, ask, predict and plan; with --allow-motion they also execute.
    """
    try:
        from nlcontrol.mcp.stdio_server import serve, take_standard_output
    except ModuleNotFoundError as raised:
        if (raised.name or "").partition(".")[0] not in ("mcp", "mcp_types", "anyio"):
            raise
        raise error(
            "missing_extra",
            "`nlcontrol mcp` needs the package mcp, which is not installed",
            suggestions=("install from the checkout: pip install '.[mcp]'",),
        ) from raised
    # First of all, so that nothing that a session loads can write between the protocol's lines.
    output = take_standard_output()

    def open_session() -> PlanningSession:
        if url is None:
            from nlcontrol.service.session import Session

            return Session(scene, seed=seed, defaults=dict(settings), approval="plan")
        from nlcontrol.service.remote_session import Client

        token = None if token_file is None else token_file.read_text("utf-8").strip()
        sessions = Client(url, token=token).sessions
        return sessions.open(scene, seed=seed, defaults=dict(settings), approval="plan")

    from objectmodels import Registry

    known = [name for model in Registry.default() for name in (model.name, *model.synonyms)]
    try:
        serve(open_session, output, allow_motion=allow_motion, known=known)
    except (KeyboardInterrupt, Terminated):
        # The session is closed, and the robot at rest. A thread still reads standard input, which
        # nothing ends, and for which Python would wait.
        os._exit(SIGNALS.exit_code)
