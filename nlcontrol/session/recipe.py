"""Recipe of a controller: all that it takes to build one elsewhere that goes on in the same way.

A simulated world follows from its scene, its seed and what was done in it, so a recipe has these:
scene, seed, defaults, models and beliefs at the beginning, and every sentence and look since. To
rebuild is to do all that again, in simulation. What was done in another way is not in it, such as a
plan that was executed by itself, beliefs changed later by hand, or a motion that was stopped: then
there is no recipe.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import ConfigDict, Field
from pydantic_core import to_jsonable_python

from nlcontrol.errors import ControlError, error
from nlcontrol.json_document import Document, DocumentPart
from nlcontrol.session.executor import Executor, Motion
from nlcontrol.text_format import encodable_text
from objectmodels import ObjectModel, Registry
from objectmodels.registry.model_registry import model_document
from sim.simulated_executor import SimulatedExecutor

if TYPE_CHECKING:
    from nlcontrol.session.frame_documents import Frames
    from planner.types.defaults import Defaults


class JournalEntry(DocumentPart):
    """A sentence that was said, or a look if there is none.

    Attributes:
        said: the sentence, or the frames in its place as JSON has them.
        conversation: number of the conversation in which it was said.
        motion: permission to move as in `Session.say`; `never` if it was only planned.
        begun: simulated time at its beginning [s]; None before there was a world.
        proposes: number of the proposal in its conversation, if it was planned as one.
        executes: number of the proposal that was carried out; `said` is its text.
    """

    said: str | dict[str, Any] | list[Any] | None = None
    conversation: int = 0
    motion: Motion | None = None
    begun: float | None = None
    proposes: int | None = None
    executes: int | None = None

    @classmethod
    def of(cls, said: str | Frames, conversation: int, motion: Motion | None) -> JournalEntry:
        """The deed of a sentence, or of frames."""
        try:
            plain = encodable_text(said) if isinstance(said, str) else to_jsonable_python(said)
        except ValueError:
            plain = ""  # no more understood than those frames
        return cls(said=plain, conversation=conversation, motion=motion)


LOOKED = JournalEntry()
"""The robot looked."""

MOST_DEEDS = 1000
"""Deeds of a recipe; to do more again would take hours, and to keep them memory without end."""


class Recipe(Document):
    """Recipe of a controller, as data.

    Attributes:
        scene: the scene as it is, without the defaults that it sets.
        seed: seed of all randomness.
        defaults: values by their names [SI].
        registry: every model that is known, as in a model file.
        beliefs: the models of the objects at the beginning, by the names of the objects.
        deeds: deeds in their order.
    """

    model_config = ConfigDict(defer_build=True, frozen=True, extra="forbid")

    scene: dict[str, Any]
    seed: int
    defaults: dict[str, Any]
    registry: tuple[dict[str, Any], ...]
    beliefs: dict[str, dict[str, Any]]
    deeds: Annotated[tuple[JournalEntry, ...], Field(max_length=MOST_DEEDS)]


class Journal:
    """Record of what was done with a robot, for its recipe.

    Args:
        executor: the robot; of one that is not simulated nothing is kept.
        models: believed models, as they change.

    Attributes:
        deeds: deeds so far.
        beliefs: the models before that.
        conversations: number of those that were begun.
    """

    def __init__(self, executor: Executor, models: Mapping[str, ObjectModel]) -> None:
        self.deeds: list[JournalEntry] = []
        self.beliefs = dict(models)
        self.conversations = 0
        self._executor = executor if isinstance(executor, SimulatedExecutor) else None
        self._after: tuple[float, dict[str, ObjectModel]] = (0.0, self.beliefs)
        self._busy = self._gap = self._overflown = False

    @contextmanager
    def deed(self, deed: JournalEntry, models: Mapping[str, ObjectModel]) -> Iterator[None]:
        """Context in which something is done; what is done for it is no deed of its own."""
        if self._executor is None or self._busy:
            yield
            return
        self._note_others(models)
        self._busy, begun = True, self._executor.time
        place = begun if self._executor.is_built else None
        try:
            yield
        except BaseException:
            self._gap = True
            raise
        finally:
            self._busy = False
            self._after = self._executor.time, dict(models)
            if deed.said is not None or self._executor.time > begun:
                self._note(deed.model_copy(update={"begun": place}))

    def _note(self, deed: JournalEntry) -> None:
        """Notes a deed, unless there are too many of them for a recipe."""
        if len(self.deeds) < MOST_DEEDS:
            self.deeds.append(deed)
        else:
            self._overflown = True

    def interrupt(self) -> None:
        """Notes that something was not done to its end."""
        self._gap = True

    def _note_others(self, models: Mapping[str, ObjectModel]) -> None:
        """Notes what was done in another way since the last deed."""
        assert self._executor is not None
        if not self.deeds:
            self.beliefs = dict(models)
            self._after = self._after[0], self.beliefs
        if (self._executor.time, models) != self._after:
            self._gap = True

    def recipe(
        self, registry: Registry, models: Mapping[str, ObjectModel], defaults: Defaults
    ) -> Recipe:
        """The recipe of a controller, from its journal and from what it has now.

        Raises:
            ControlError: `not_repeatable`.
        """
        if self._executor is None:
            raise _not_repeatable("the robot is not a simulated one, so its world is not made anew")
        self._note_others(models)
        if self._overflown:
            raise _not_repeatable(f"more than {MOST_DEEDS} sentences were said, and looks made")
        if self._gap:
            raise _not_repeatable("not all that was done were sentences and looks, and whole ones")
        return Recipe(
            scene=self._executor.scene_document(),
            seed=self._executor.seed,
            defaults=asdict(defaults),
            registry=tuple(map(model_document, registry)),
            beliefs={name: model_document(model) for name, model in self.beliefs.items()},
            deeds=tuple(self.deeds),
        )


def _not_repeatable(message: str) -> ControlError:
    hint = "ask for the recipe earlier, or keep the results and traces (`Trace.save`)"
    return error("not_repeatable", message, suggestions=(hint,))
