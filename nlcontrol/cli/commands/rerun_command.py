"""`rerun`: a run that somebody bundled, repeated and compared."""

from __future__ import annotations

from pathlib import Path

import click

from nlcontrol.cli.console.console_output import (
    FILE,
    Narrator,
    json_option,
    print_answer,
    print_error,
    print_json,
)


@click.command("rerun")
@click.argument("bundle", type=FILE)
@json_option
def command(bundle: Path, as_json: bool) -> int:
    """Repeat the run in BUNDLE and compare the results.

    BUNDLE is a file written by `say --bundle` or by the service.
    """
    from nlcontrol.service.bundle import read_bundle, report_lines, rerun

    found = read_bundle(bundle)
    with Narrator() as narrate:
        report = rerun(found, narrate)
    if report.error is None:
        return print_answer(report.model_dump(mode="json"), report_lines(report), as_json=as_json)
    if as_json:
        print_json(report.model_dump(mode="json"))
    else:
        print_answer({}, report_lines(report), as_json=False)
        print_error(report.error, as_json=False)
    return report.error.status.exit
