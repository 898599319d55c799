"""Registry of object models, by name and synonym.

A registry is a plain value that is filled explicitly; nothing registers itself by being imported.
The default one is filled from these sources, in this order: the built-in models, plug-ins (entry
points of other packages), the user's folder. A scene and the program may add
more. A name belongs to the source that was there first; what comes later is reported and skipped.
One exception: a model in the user's folder takes the place of a built-in or plug-in model of the
very same name. So what was fitted to the user's own object is what the robot goes by, and the other
one is back when that file is removed. Synonyms take over nothing.
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from importlib.resources import as_file, files
from itertools import count, islice
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml
from pydantic import TypeAdapter, ValidationError

from objectmodels.errors import ModelError, fold_text, suggest
from objectmodels.files.plugin_loading import PluginError, package_name, place_of, taken_in
from objectmodels.files.yaml_documents import (
    Fault,
    Name,
    first_fault,
    lock_folder,
    read_mapping,
    remove_file,
    replace_file,
    short_text,
)
from objectmodels.models.kinds import KINDS
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.predictor import own_predictions, require_calibration

# Model files: a YAML file with units in its keys, read into an object model and written again.
#
# A file begins with `format: KIND/VERSION`, e.g. `box/1`; the kind is a class of model, whose
# fields are the file's keys (by their aliases, which carry the units). It is read strictly: what
# is unknown, of another type or out of range is an error that names file, key, what was found and
# what was expected. See `objectmodels/registry/builtin/` for examples.

Kinds = Mapping[str, type[ObjectModel]]

_SUPPORTS = "corners, uniform, or three or more points [x, y] or [x, y, weight]"


def kind_of(model: ObjectModel | type[ObjectModel]) -> str:
    """Name of a model's kind, as in `format: KIND/VERSION`."""
    cls = model if isinstance(model, type) else type(model)
    return str(cls.model_fields["kind"].default)


def load_model(path: Path, kinds: Kinds = KINDS) -> ObjectModel:
    """Reads a model file.

    Args:
        path: the YAML file.
        kinds: classes of model by name.

    Raises:
        ModelError: `unreadable_file`, `bad_yaml`, `unknown_format`, `missing_key`, `unknown_key`,
            `bad_value` or `broken_kind`; names the file, the key, what was found and expected.
    """
    return model_from_document(read_mapping(path, "model_file"), str(path), kinds)


def model_from_document(content: Mapping[str, Any], path: str, kinds: Kinds = KINDS) -> ObjectModel:
    """The model of which `content` stands in a file, as `model_document` has it.

    Raises:
        ModelError: as `load_model` does; names `path`.
    """
    cls = _class_of(content, path, kinds)
    stated = {key: value for key, value in content.items() if key != "format"}
    if "provenance" not in stated:
        raise ModelError(
            "missing_key",
            "is required, but not given",
            path=f"{path}: provenance",
            suggestions=("say where the figures come from: `provenance: {source: …}`",),
        )
    if "kind" in stated:
        raise ModelError(
            "unknown_key",
            "is not a key of this format",
            path=f"{path}: kind",
            suggestions=("the kind stands in `format`",),
        )
    try:
        return cls.model_validate(stated, by_alias=True, by_name=False)
    except ValidationError as error:
        raise _model_fault(error, cls).error(path) from error
    except Exception as error:  # kinds of plug-ins may fail in any way
        raise ModelError(
            "broken_kind",
            f"{cls.__name__} fails on it: {type(error).__name__}: {short_text(str(error))}",
            path=path,
            suggestions=("mend or uninstall the package that the kind is from",),
        ) from error


def model_document(model: ObjectModel) -> dict[str, Any]:
    """Contents of a model's file."""
    stated = model.model_dump(mode="json", by_alias=True, exclude_unset=True, exclude={"kind"})
    stated.setdefault("provenance", model.provenance.model_dump(exclude_none=True))
    return {"format": f"{kind_of(model)}/{type(model).version}", **stated}


def save_model(model: ObjectModel, path: Path) -> None:
    """Writes a model file, whole or not at all; only what was stated, not what follows from it.

    Raises:
        ModelError: `cannot_write`.
    """
    text = yaml.safe_dump(
        model_document(model), sort_keys=False, allow_unicode=True, default_flow_style=None
    )
    with replace_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _class_of(content: Mapping[str, Any], path: str, kinds: Kinds) -> type[ObjectModel]:
    known = [f"{kind}/{cls.version}" for kind, cls in kinds.items()]
    found = content.get("format")
    if found in known:
        return kinds[str(found).split("/")[0]]
    what = f"format {short_text(found)}" if "format" in content else "no `format`"
    raise ModelError(
        "unknown_format",
        f"{what}, expected one of: {', '.join(known)}",
        path=path,
        suggestions=(f"begin the file with `format: {known[0]}`",),
    )


def _model_fault(error: ValidationError, cls: type[ObjectModel]) -> Fault:
    """The fault of a model file."""
    fault = first_fault(error, cls)
    if not fault.key.startswith("support.") and fault.key != "support":
        return fault
    # A union, of which pydantic names one branch only.
    (found, *_) = (e["input"] for e in error.errors() if e["loc"][:1] == ("support",))
    message = f"found {short_text(found)}, expected {_SUPPORTS}"
    return Fault("bad_value", "support", message, fault.suggestions)


# What other packages bring: entry points of the group `nlcontrol.objectmodels`.
#
# An entry point names a class of models (a new *kind*, whose name then stands in the `format` of
# model files), a model, a path of a model file or of a folder of them, an iterable of these, or a
# function without arguments that returns one of them.

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


FOLDER_VARIABLE = "NLCONTROL_OBJECTS"
"""Environment variable that names the user's folder of models."""

_LONGEST = 50  # characters of a file's name; each of them may take four bytes of 255


def user_folder() -> Path:
    """The folder of the user's own models, where `objects add` and `import` put them."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    data = os.environ.get("APPDATA" if os.name == "nt" else "XDG_DATA_HOME")
    home = Path(data) if data else Path.home() / ".local" / "share"
    return home / "nlcontrol" / "objects"


def free_file(name: str) -> Path:
    """A file in the user's folder that is not there yet, for a model of that name."""
    plain = re.sub(r"[^\w.+-]+", "_", name).lstrip(".")[:_LONGEST] or "_"
    names = (plain if number == 1 else f"{plain}_{number}" for number in count(1))
    files = (user_folder() / f"{name}.yaml" for name in names)
    return next(file for file in files if not os.path.lexists(file))


class Registry:
    """Object models by name.

    Attributes:
        problems: errors of the files and plug-ins that were skipped.
    """

    def __repr__(self) -> str:
        return f"<Registry of {len(list(self))} object models>"

    def __init__(self) -> None:
        self._kinds: dict[str, type[ObjectModel]] = dict(KINDS)
        self._models: dict[str, ObjectModel] = {}
        self._places: dict[str, str] = {}
        self._replaced: dict[str, str] = {}
        self._problems: list[ModelError] = []

    @classmethod
    def default(cls) -> Registry:
        """A registry of the built-in models, those of plug-ins and those of the user."""
        registry = cls.built_in()
        registry.load_plugins()
        folder = user_folder()
        if os.path.isdir(folder):
            registry.load(folder, over=registry.names())
        return registry

    def copy(self) -> Registry:
        """A registry with the same contents, to add more to."""
        other = Registry()
        other._kinds, other._models = dict(self._kinds), dict(self._models)
        other._places, other._problems = dict(self._places), list(self._problems)
        other._replaced = dict(self._replaced)
        return other

    @classmethod
    def built_in(cls) -> Registry:
        """A registry of the built-in models alone."""
        return _built_in().copy()

    @classmethod
    def of_plugin(cls, entry: str) -> Registry:
        """A registry of the models of one plug-in, and of all others of the kinds that it brings.

        Args:
            entry: see `plugin_offers`.

        Raises:
            ModelError: `unknown_plugin`.
        """
        known, registry = cls.default(), cls()
        registry._kinds |= known._kinds
        registry.load_plugins(entry)
        kinds = [offer for _, offer in plugin_offers(entry) if isinstance(offer, type)]
        for model in known:
            if type(model) in kinds and model.name not in registry:
                registry.add(model, place=known.place(model.name))
        return registry

    def load_plugins(self, entry: str | None = None) -> None:
        """Adds kinds and models of the installed plug-ins; the broken ones go to `problems`.

        Args:
            entry: see `plugin_offers`, whose errors this raises.
        """
        for place, offer in plugin_offers(entry):
            try:
                self.take(offer, place)
            except ModelError as error:
                self._problems.append(error)

    def take(self, offer: Offer | ModelError, place: str) -> None:
        """Adds what a plug-in brings: a kind, a model, a file or a folder.

        Raises:
            ModelError: the one that stands for a broken plug-in; what `add_kind`, `add` and `load`
                raise.
        """
        if isinstance(offer, ModelError):
            raise offer
        if isinstance(offer, type):
            self.add_kind(offer, place=place)
        elif isinstance(offer, ObjectModel):
            self.add(offer, place=place)
        else:
            self.load(offer, place=place)

    def add_kind(self, cls: type[ObjectModel], *, place: str = "added by the program") -> None:
        """Adds a kind of model, so that model files may be of it.

        Args:
            cls: the class; the default of its field `kind` is the kind's name.
            place: where it comes from, for error messages.

        Raises:
            ModelError: `bad_kind`, `duplicate_name`.
        """
        if "kind" not in cls.model_fields or not isinstance(cls.model_fields["kind"].default, str):
            raise ModelError(
                "bad_kind",
                f"{cls.__name__} of {place} does not name its kind",
                suggestions=('give it a field `kind: Literal["crate"] = "crate"`',),
            )
        kind = kind_of(cls)
        taken = self._kinds.get(kind)
        if taken is not None and taken is not cls:
            raise ModelError(
                "duplicate_name",
                f"the kind {kind!r} of {place} is already that of {taken.__module__}",
                suggestions=("give one of the two another name",),
            )
        self._kinds[kind] = cls

    @property
    def kinds(self) -> Mapping[str, type[ObjectModel]]:
        """The kinds of model that files may be of, by name, a read-only view."""
        return MappingProxyType(self._kinds)

    def add(
        self,
        model: ObjectModel,
        *,
        place: str = "added by the program",
        over: Collection[str] = (),
    ) -> None:
        """Adds a model.

        Args:
            model: the model; its name must not be a name or synonym of another one, nor may one
                of its synonyms be the name of another one. Synonyms may be shared.
            place: where it comes from, for error messages.
            over: names of models whose place it takes if it is called exactly so.

        Raises:
            ModelError: `duplicate_name`, with both places; `not_calibrated` if it has predictions
                of its own and these do not hold for the pushes that it has seen.
        """
        if own_predictions(type(model), ObjectModel):
            require_calibration(model, model.seen_pushes, model.name)
        name = fold_text(model.name)
        taken_over = name in map(fold_text, over)
        words = {name: model.name, **{fold_text(word): word for word in model.synonyms}}
        for other in self:
            taken = fold_text(other.name)
            if taken_over and taken == name:
                continue
            clash = words.get(taken)
            if clash is None and name in map(fold_text, other.synonyms):
                clash = model.name
            if clash is not None:
                raise ModelError(
                    "duplicate_name",
                    f"{clash!r} of {place} is already used by {other.name!r}, "
                    f"{self._places[taken]}",
                    path=place,
                    suggestions=("give one of the two another name",),
                )
        if name in self._models:
            self._replaced[name] = self._places[name]
        self._models[name] = model
        self._places[name] = place

    def load(
        self, path: Path | str, *, place: str | None = None, over: Collection[str] = ()
    ) -> None:
        """Adds a model file, or every `*.yaml` file of a folder.

        A file given by itself must be good. In a folder a broken file is skipped and its error
        kept in `problems`, so that it does not take the others down.

        Args:
            path: file or folder.
            place: where it comes from, for people; the path if not given.
            over: names of models whose place one of the same name takes, the first one of them.

        Raises:
            ModelError: what `load_model` and `add` raise, for a file given by itself;
                `unreadable_file` if there is no such path.
        """
        path = Path(path)
        if not os.path.isdir(path):
            self._load_file(path, place, over)
            return
        # Hidden files are those that are being written, or that others keep beside their own.
        for file in sorted(path.glob("[!.]*.yaml")):
            free = [name for name in over if self.replaced_place(name) is None]
            try:
                self._load_file(file, place, free)
            except ModelError as error:
                self._problems.append(error)

    def _load_file(self, path: Path, place: str | None, over: Collection[str]) -> None:
        where = f"{place} ({path.name})" if place else str(path)
        self.add(load_model(path, self._kinds), place=where, over=over)

    def get(self, name: str) -> ObjectModel:
        """The model of that name.

        Raises:
            ModelError: `unknown_object`, with suggestions.
        """
        try:
            return self._models[fold_text(name)]
        except KeyError:
            raise ModelError(
                "unknown_object",
                f"there is no object model named {name!r}",
                suggestions=tuple(f"did you mean '{near}'?" for near in suggest(name, self.names()))
                or (f"known: {', '.join(self.names()) or 'none'}",),
            ) from None

    def names(self) -> tuple[str, ...]:
        """Names of all models, in the order of their adding."""
        return tuple(model.name for model in self)

    def find(self, text: str) -> list[str]:
        """Names of the models called exactly so, by name or synonym.

        Case and the amount of white space do not count. Several if they share a synonym, none if
        nothing fits.
        """
        wanted = fold_text(text)
        return [
            model.name for model in self if wanted in map(fold_text, (model.name, *model.synonyms))
        ]

    def find_one(self, text: str) -> ObjectModel:
        """The one model of that name or synonym.

        Raises:
            ModelError: `unknown_object`, with suggestions; `ambiguous_object` if several share the
                synonym.
        """
        found = self.find(text)
        if len(found) > 1:
            raise ModelError(
                "ambiguous_object",
                f"{text!r} may be {' or '.join(found)}",
                suggestions=tuple(f"say '{name}'" for name in found),
            )
        return self.get(found[0] if found else text)

    def place(self, name: str) -> str:
        """Origin of the model of that name; raises as `get` does."""
        return self._places[fold_text(self.get(name).name)]

    def replaced_place(self, name: str) -> str | None:
        """Origin of the model that the one of this name replaced; None if it replaced none."""
        return self._replaced.get(fold_text(name))

    @property
    def models(self) -> Mapping[str, ObjectModel]:
        """All models by name, a read-only view."""
        return MappingProxyType({model.name: model for model in self})

    @property
    def problems(self) -> tuple[ModelError, ...]:
        """Errors of the files that `load` skipped."""
        return tuple(self._problems)

    def __iter__(self) -> Iterator[ObjectModel]:
        return iter(self._models.values())

    def __len__(self) -> int:
        return len(self._models)

    def __contains__(self, name: str) -> bool:
        return fold_text(name) in self._models


@cache
def _built_in() -> Registry:
    """The built-in models, read once, since neither the files nor a model ever changes."""
    registry = Registry()
    with as_file(files("objectmodels.registry") / "builtin") as folder:
        registry.load(folder, place="built in")
    return registry


# The user's own models: how one is put among them, and taken away again.
#
# Every change is made under a lock of the folder, on what stands in it then, so that of several
# processes none undoes what another one did.


def place_model(registry: Registry, model: ObjectModel, *, replace: bool = False) -> Path:
    """Puts a model into a registry as one of the user's own, and names the file for it.

    Nothing is written: on a copy of a registry this tells beforehand whether it can be kept. The
    file is a new one, unless it replaces the user's own model of that name.

    Args:
        registry: takes the model.
        model: the model.
        replace: whether it takes the place of a model of that very name.

    Raises:
        ModelError: `duplicate_name` if a name of it is taken otherwise.
    """
    own = replace and model.name in registry and _is_own(Path(registry.place(model.name)))
    path = Path(registry.place(model.name)) if own else free_file(model.name)
    registry.add(model, place=str(path), over=registry.names() if replace else ())
    return path


def store_model(
    registry: Registry, model: ObjectModel, *, replace: bool = False
) -> tuple[Path, str | None]:
    """Puts a model among the user's own, and into a registry.

    Args:
        registry: see `place_model`.
        model: see `place_model`.
        replace: see `place_model`.

    Returns:
        The file, and where the model comes from whose place it takes, if not the user's own.

    Raises:
        ModelError: as `place_model`; `cannot_write`.
    """
    place_model(registry.copy(), model, replace=replace)
    with lock_folder(user_folder()):
        path = place_model(Registry.default(), model, replace=replace)
        save_model(model, path)
    registry.add(model, place=str(path), over=(model.name,))
    replaced = registry.replaced_place(model.name)
    return path, None if replaced == str(path) else replaced


def remove_model(text: str) -> tuple[str, Path]:
    """Removes one of the user's own models.

    Args:
        text: its name, or a synonym.

    Returns:
        Its name, and the file that is gone.

    Raises:
        ModelError: as `Registry.find_one`; `not_yours`; `cannot_write`.
    """
    _own_model(text)
    with lock_folder(user_folder()):
        name, path = _own_model(text)  # unless another process removed it meanwhile
        remove_file(path)
    return name, path


def rename_model(model: ObjectModel, name: str) -> ObjectModel:
    """The model under another name; its synonyms stay with the model that they belong to.

    Raises:
        ModelError: `bad_value` if it cannot be a name.
    """
    try:
        TypeAdapter(Name).validate_python(name, strict=True)
    except ValidationError as error:
        raise ModelError(
            "bad_value",
            f"{short_text(name)} cannot be a name",
            suggestions=("take a name of letters and digits, like 'red box'",),
        ) from error
    return model.model_copy(update={"name": name, "synonyms": ()})


def _own_model(text: str) -> tuple[str, Path]:
    """Name and file of one of the user's own models."""
    registry = Registry.default()
    name = registry.find_one(text).name
    place = registry.place(name)
    if not _is_own(Path(place)):
        raise ModelError(
            "not_yours",
            f"the {name} is not one of your own models: it comes from {place}",
            suggestions=(f"your own are in {user_folder()}",),
        )
    return name, Path(place)


def _is_own(path: Path) -> bool:
    return path.parent == user_folder()
