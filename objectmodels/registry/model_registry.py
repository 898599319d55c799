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
from collections.abc import Collection, Iterator, Mapping
from functools import cache
from importlib.resources import as_file, files
from pathlib import Path
from types import MappingProxyType

from objectmodels.errors import ModelError, fold_text, suggest
from objectmodels.models.calibration import require_calibration
from objectmodels.models.object_model import ObjectModel
from objectmodels.models.predictor import own_predictions
from objectmodels.registry.model_files import BUILT_IN_KINDS, kind_of, load_model
from objectmodels.registry.plugin_offers import Offer, plugin_offers
from objectmodels.registry.user_folder import user_folder


class Registry:
    """Object models by name.

    Attributes:
        problems: errors of the files and plug-ins that were skipped.
    """

    def __init__(self) -> None:
        self._kinds: dict[str, type[ObjectModel]] = dict(BUILT_IN_KINDS)
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
