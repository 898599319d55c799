"""`objects`: the models that the robot knows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from nlcontrol.cli.output import print_json
from nlcontrol.errors import OK

if TYPE_CHECKING:
    from objectmodels import BoxModel

_json = click.option("--json", "as_json", is_flag=True, help="Answer with one JSON document.")


@click.group("objects")
def group() -> None:
    """The object models that the robot knows."""


@group.command("list")
@_json
def list_(as_json: bool) -> int:
    """List the models of the registry."""
    from objectmodels import Registry

    registry = Registry.default()
    models = list(registry)
    for problem in registry.problems:
        click.echo(f"skipped: {problem}", err=True)
    if as_json:
        print_json([model.model_dump(mode="json") for model in models])
        return OK
    for model in models:
        size = " × ".join(f"{1e3 * side:.0f}" for side in model.size)
        click.echo(f"{model.name:20} {size} mm, {model.mass:.3f} kg, μ {model.friction:.3f}")
    return OK


@group.command()
@click.argument("name")
@_json
def show(name: str, as_json: bool) -> int:
    """Show what is believed about the object NAME, and where the figures come from."""
    model = _find(name)
    if as_json:
        print_json(model.model_dump(mode="json"))
        return OK
    for line in _lines(model):
        click.echo(line)
    return OK


def _find(name: str) -> BoxModel:
    """The one model of that name or synonym; else the registry's own error."""
    from objectmodels import Registry

    registry = Registry.default()
    found = registry.find(name)
    return registry.get(found[0] if len(found) == 1 else name)


def _lines(model: BoxModel) -> list[str]:
    rows = [
        ("size", " × ".join(f"{1e3 * side:.0f}" for side in model.size) + " mm"),
        ("mass", f"{model.mass:.4f} ± {model.mass_sd:.4f} kg"),
        ("friction, table", f"{model.friction:.4f} ± {model.friction_sd:.4f}"),
        ("friction, finger", f"{model.finger_friction:.3f} ± {model.finger_friction_sd:.3f}"),
        (
            "centre of mass",
            ", ".join(
                f"{1e3 * c:.0f} ± {1e3 * sd:.0f}"
                for c, sd in zip(model.com, model.com_sd, strict=True)
            )
            + " mm from the middle of the base",
        ),
        (
            "friction radius",
            f"{1e3 * model.friction_radius:.1f} ± {1e3 * model.friction_radius_sd:.1f} mm "
            f"({model.support})",
        ),
        ("also called", ", ".join(model.synonyms) or "–"),
        ("source", model.provenance.source),
        ("method", model.provenance.method),
    ]
    heights = (
        ("away or toward", model.size[0] / 2 / model.friction),
        ("left or right", model.size[1] / 2 / model.friction),
    )
    for way, height in heights:
        verdict = f"above {1e3 * height:.0f} mm" if height < model.size[2] else "never"
        rows.append((f"topples {way}", f"{verdict}, pushed level at the middle of a face"))
    return [model.name, *(f"  {key:24} {value}" for key, value in rows)]
