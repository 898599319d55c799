"""What other packages bring: entry points of the group `nlcontrol.objectmodels`.

An entry point names a class of models (a new *kind*, whose name then stands in the `format` of
model files), a model, a path of a model file or of a folder of them, an iterable of these, or a
function without arguments that returns one of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from importlib.metadata import EntryPoint, entry_points
from itertools import islice
from os import PathLike
from pathlib import Path

from objectmodels.errors import ModelError
from objectmodels.files.plugin_loading import PluginError, package_name, place_of, taken_in
from objectmodels.models.object_model import ObjectModel

GROUP = "nlcontrol.objectmodels"
"""Entry points of other packages that bring object models."""

MOST_OFFERS = 10_000
"""Models that one plug-in may bring."""

Offer = type[ObjectModel] | ObjectModel | Path
"""What a plug-in brings, one at a time."""


def plugin_offers(entry: str | None = None) -> Iterator[tuple[str, Offer | ModelError]]:
    """Offers of the installed plug-ins, each with its place; errors of the broken ones.

    A plug-in that fails takes no other one down. Kinds come first, so that model files of one
    plug-in may be of a kind of another one.

    Args:
        entry: name of one entry point, or of one package, or `module:object` as an entry point
            would name it; all that are installed if not given.

    Raises:
        ModelError: `unknown_plugin` if none is called so.
    """
    found: list[tuple[str, Offer | ModelError]] = []
    for point in _entry_points(entry):
        place = place_of(point)
        try:
            found += [(place, offer) for offer in taken_in(point, _offers)]
        except PluginError as failure:
            found.append((place, _plugin_error(place, failure)))
    yield from sorted(found, key=lambda offer: not isinstance(offer[1], type))


def _entry_points(entry: str | None) -> list[EntryPoint]:
    installed = sorted(entry_points(group=GROUP), key=lambda p: (package_name(p), p.name))
    named = [point for point in installed if entry in (None, point.name, package_name(point))]
    if named or entry is None:
        return named
    if ":" in entry:
        return [EntryPoint(entry, entry, GROUP)]
    names = ", ".join(point.name for point in installed) or "none"
    raise ModelError(
        "unknown_plugin",
        f"no plug-in of object models is called {entry!r}; installed: {names}",
        suggestions=("name the object itself, like my_package:MyModel",),
    )


def _offers(thing: object) -> list[Offer]:
    """All offers in what an entry point names; raises ValueError if they do not end."""
    found = list(islice(_offers_from(thing), MOST_OFFERS + 1))
    if len(found) > MOST_OFFERS:
        raise ValueError(f"it offers more than {MOST_OFFERS} models")
    return found


def _offers_from(thing: object) -> Iterator[Offer]:
    """The offers in what an entry point names."""
    if isinstance(thing, type):
        if not issubclass(thing, ObjectModel):
            raise TypeError(f"{thing.__name__} is not a subclass of ObjectModel")
        yield thing
    elif isinstance(thing, ObjectModel):
        yield thing
    elif isinstance(thing, str | PathLike):
        yield Path(thing)
    elif callable(thing):
        yield from _offers_from(thing())
    elif isinstance(thing, Iterable):
        for each in thing:
            yield from _offers_from(each)
    else:
        raise TypeError(
            f"expected a class, a model, a path or a function, found {type(thing).__name__}"
        )


def _plugin_error(place: str, failure: PluginError) -> ModelError:
    cause = failure.__cause__
    if isinstance(cause, ModelError):
        return ModelError(
            cause.code, f"{place}: {cause.message}", path=cause.path, suggestions=cause.suggestions
        )
    return ModelError(
        "broken_plugin",
        f"{place} failed: {failure}",
        suggestions=("mend or uninstall the package",),
    )
