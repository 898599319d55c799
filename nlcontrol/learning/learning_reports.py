"""Reports of learning, as values: lessons of pushes and grasps, of a fit, of an exploration.

They stand apart from the code that fills them in, so that a result which holds none loads none of
it.
"""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from nlcontrol.errors import ErrorInfo
from nlcontrol.json_document import Document, DocumentPart
from nlcontrol.text_format import with_sd_text
from objectmodels.identification.trial import Statistics

_METRES = {
    "friction_radius": "friction radius",
    "com_x": "centre of mass, x",
    "com_y": "centre of mass, y",
    "com_z": "centre of mass, z",
}  # told in millimetres
_MOVED, _SURER = 0.3, 0.8  # a change is told from this on: in standard deviations, and their ratio


class Change(DocumentPart):
    """One parameter before and after.

    Attributes:
        parameter: its name.
        before, before_sd: what was believed, and its standard deviation [SI].
        after, after_sd: what is believed now.
    """

    parameter: str
    before: float
    before_sd: float
    after: float
    after_sd: float

    @property
    def matters(self) -> bool:
        """True if it is worth reporting: another value, or one that is known better."""
        moved = abs(self.after - self.before) > _MOVED * self.before_sd
        return moved or self.after_sd < _SURER * self.before_sd

    @property
    def text(self) -> str:
        """In words."""
        figures = ((self.before, self.before_sd), (self.after, self.after_sd))
        if self.parameter in _METRES:
            before, after = (f"{1e3 * x + 0.0:.1f} ± {1e3 * sd:.1f}" for x, sd in figures)
            return f"{_METRES[self.parameter]} {before} → {after} mm"
        before, after = (with_sd_text(x, sd) for x, sd in figures)
        unit = " kg" if self.parameter == "mass" else ""
        return f"{self.parameter.replace('_', ' ')} {before} → {after}{unit}"


class Lesson(DocumentPart):
    """Lesson of one push, or of what hung on the fingers.

    Attributes:
        object: its name in the scene.
        moved: what gave way; `none` if nothing did; `lift` if it was lifted.
        force: felt then [N].
        surprise: how far that was from what was predicted, in standard deviations.
        contradicts: whether the push was stopped because it went otherwise than predicted.
        why: in words, if so.
        changes: of what is believed.
    """

    object: str
    moved: Literal["slide", "topple", "slip", "lift", "none"]
    force: float
    surprise: float
    contradicts: bool
    why: str | None
    changes: tuple[Change, ...]

    @property
    def text(self) -> str:
        """In a sentence."""
        if self.moved == "lift":
            now = "; ".join(change.text for change in self.changes)
            return f"The {self.object} hung on the fingers with {self.force:.2f} N: {now}"
        moved = {"slide": "slid", "topple": "tilted", "slip": "let the finger slip"}
        what = moved.get(self.moved, "stood still")
        begun = f"{self.why}: the {self.object}" if self.why else f"The {self.object}"
        told = [change.text for change in self.changes if change.matters]
        rest = "; ".join(told) or "as believed"
        return f"{begun} {what} at {self.force:.2f} N: {rest}"


class FittedParameter(BaseModel):
    """A parameter that was found; SI units.

    Attributes:
        value: what was found.
        sd: its standard deviation.
        percent: that in percent of the value; null for the horizontal centre of mass.
        low, high: where it lies with a probability of 95 %.
        believed, believed_sd: what was believed before.
    """

    model_config = ConfigDict(defer_build=True, frozen=True)

    value: float
    sd: float
    percent: float | None
    low: float
    high: float
    believed: float
    believed_sd: float


class FitReport(Document):
    """Findings of a fit of data files; SI units.

    Attributes:
        object: name of the model.
        files: the data files.
        trials: number of those used, by what moved.
        assumed: number of trials whose force came without a standard deviation.
        parameters: those found, by name.
        correlations: of those found, from 0.3 on.
        unidentified: what the data do not tell, kept as believed, each with the experiment that
            would find it; empty if parameters were asked for.
        dropped: trials left out, each with the reason.
        rms: root mean square of the relative errors of the predicted forces.
        friction_spread: relative standard deviation of the friction from slide to slide.
        noise: factor by which the stated standard deviations were too small.
        support: how the base carries the object, the one that predicts best.
        notes: what else a reader should know.
        saved, output: files written, if any.
        instead_of: where the model comes from whose place the saved one takes, if it takes one.
    """

    ok: bool = True
    object: str
    files: tuple[str, ...]
    trials: dict[str, int]
    assumed: int
    parameters: dict[str, FittedParameter]
    correlations: tuple[tuple[str, str, float], ...]
    unidentified: dict[str, str]
    dropped: dict[str, str]
    rms: float
    friction_spread: float
    noise: float
    support: str | tuple[tuple[float, ...], ...]
    notes: tuple[str, ...]
    saved: str | None = None
    output: str | None = None
    instead_of: str | None = None


class TouchMade(BaseModel):
    """One touch in a few words.

    Attributes:
        experiment: what was tried.
        outcome: what came of it.
        as_meant: whether it showed what it was to show.
        force: at which something moved [N]; null if nothing did.
    """

    model_config = ConfigDict(defer_build=True, frozen=True)

    experiment: str
    outcome: str
    as_meant: bool
    force: float | None


class ExplorationReport(Document):
    """Findings of an exploration; SI units.

    Attributes:
        ok: all was found that was asked for.
        object: name in the scene.
        scene, seed: of the world.
        touches: one after another.
        repeated: each parameter over the repetitions.
        parameters: each parameter by the joint fit of all trials.
        correlations: of those found, from 0.3 on.
        friction_spread: relative standard deviation of the friction from slide to slide.
        rms: root mean square of the relative errors of the predicted forces.
        support: how the base carries the object, the one that predicts best.
        given_up: experiments that were tried in vain, with the reason.
        dropped: trials left out of the fit, each with the reason.
        notes: what else a reader should know.
        truth: how the object really is, if an observer was asked.
        saved: file of the fitted model, if it was kept.
        instead_of: file of the model whose place it takes.
        files: what was written, by kind.
        error: `interrupted` if it was stopped; the rest then is what the touches until then tell.
    """

    ok: bool = True
    object: str
    scene: str
    seed: int
    touches: tuple[TouchMade, ...]
    repeated: dict[str, Statistics]
    parameters: dict[str, FittedParameter]
    correlations: tuple[tuple[str, str, float], ...]
    friction_spread: float
    rms: float
    support: str | tuple[tuple[float, ...], ...]
    given_up: tuple[str, ...]
    dropped: dict[str, str]
    notes: tuple[str, ...]
    truth: dict[str, float] | None = None
    saved: str | None = None
    instead_of: str | None = None
    files: dict[str, str] = Field(default_factory=dict)
    error: ErrorInfo | None = None
