"""The registry: which object models there are, by name and synonym.

A registry is a plain value that is filled explicitly; nothing registers itself by being imported.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib.resources import as_file, files
from pathlib import Path
from types import MappingProxyType

from objectmodels.box import BoxModel
from objectmodels.errors import ModelError
from objectmodels.modelfile import load_model
from objectmodels.suggest import fold, suggest


class Registry:
    """Object models by name.

    Attributes:
        problems: errors of the files that `load` skipped.
    """

    def __init__(self) -> None:
        self._models: dict[str, BoxModel] = {}
        self._places: dict[str, str] = {}
        self._problems: list[ModelError] = []

    @classmethod
    def default(cls) -> Registry:
        """A registry of the built-in models."""
        registry = cls()
        with as_file(files("objectmodels") / "models") as folder:
            registry.load(folder)
        return registry

    def add(self, model: BoxModel, *, place: str = "added by the program") -> None:
        """Adds a model.

        Args:
            model: the model; its name must not be a name or synonym of another one, nor may one
                of its synonyms be the name of another one. Synonyms may be shared.
            place: where it comes from, for error messages.

        Raises:
            ModelError: `duplicate_name`, with both places.
        """
        words = {fold(model.name): model.name, **{fold(word): word for word in model.synonyms}}
        for other in self:
            taken = fold(other.name)
            clash = words.get(taken)
            if clash is None and fold(model.name) in map(fold, other.synonyms):
                clash = model.name
            if clash is not None:
                raise ModelError(
                    "duplicate_name",
                    f"{clash!r} of {place} is already used by {other.name!r}, "
                    f"{self._places[taken]}",
                    path=place,
                    suggestions=("give one of the two another name",),
                )
        self._models[fold(model.name)] = model
        self._places[fold(model.name)] = place

    def load(self, path: Path | str) -> None:
        """Adds a model file, or every `*.yaml` file of a folder.

        A file given by itself must be good. In a folder a broken file is skipped and its error
        kept in `problems`, so that it does not take the others down.

        Args:
            path: file or folder.

        Raises:
            ModelError: what `load_model` and `add` raise, for a file given by itself;
                `unreadable_file` if there is no such path.
        """
        path = Path(path)
        if not path.is_dir():
            self.add(load_model(path), place=str(path))
            return
        for file in sorted(path.glob("*.yaml")):
            try:
                self.load(file)
            except ModelError as error:
                self._problems.append(error)

    def get(self, name: str) -> BoxModel:
        """The model of that name.

        Raises:
            ModelError: `unknown_object`, with suggestions.
        """
        try:
            return self._models[fold(name)]
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
        wanted = fold(text)
        return [model.name for model in self if wanted in map(fold, (model.name, *model.synonyms))]

    def place(self, name: str) -> str:
        """Where the model of that name comes from; raises as `get` does."""
        return self._places[fold(self.get(name).name)]

    @property
    def models(self) -> Mapping[str, BoxModel]:
        """All models by name, a read-only view."""
        return MappingProxyType({model.name: model for model in self})

    @property
    def problems(self) -> tuple[ModelError, ...]:
        """Errors of the files that `load` skipped."""
        return tuple(self._problems)

    def __iter__(self) -> Iterator[BoxModel]:
        return iter(self._models.values())

    def __len__(self) -> int:
        return len(self._models)

    def __contains__(self, name: str) -> bool:
        return fold(name) in self._models
