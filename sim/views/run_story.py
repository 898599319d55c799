"""Story of a run: what a replay tells besides the motion. Plain data, made by whoever knows it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class StoryWord:
    """A piece of the sentence, and the part of a frame that it set; empty if it set none.

    Attributes:
        text: of it.
        part: name of the part, or `problem`.
        start, end: where it stands in the sentence.
    """

    text: str
    part: str
    start: int
    end: int


@dataclass(frozen=True)
class StoryLine:
    """A line of text.

    Attributes:
        heading: of it, short; or empty.
        text: of it.
    """

    heading: str
    text: str


@dataclass(frozen=True)
class StoryRow:
    """Words, and a parameter of the controller with its value that they became."""

    words: str
    part: str
    parameter: str
    value: str
    problem: bool = False


@dataclass(frozen=True)
class StoryClause:
    """A verdict.

    Attributes:
        verdict: `held`, `not_held` or `unknown`.
        said: its words, empty if it is implied, and `spans` where they stand.
        quantity: what was measured.
        measured, asked: with their units.
    """

    verdict: str
    said: str
    spans: tuple[tuple[int, int], ...]
    quantity: str
    measured: str
    asked: str


@dataclass(frozen=True)
class Ghost:
    """An object as it is predicted for the end.

    Attributes:
        name: of it.
        pose: X_WB: quaternion (w, x, y, z) and place in W [m].
    """

    name: str
    pose: tuple[float, ...]


@dataclass(frozen=True)
class ContactMark:
    """A place on an object where it is to be touched.

    Attributes:
        since: when it counts [s].
        name: of the object.
        place: in its B [m].
        normal: outward unit normal there, in B.
    """

    since: float
    name: str
    place: tuple[float, float, float]
    normal: tuple[float, float, float]


@dataclass(frozen=True)
class RunStory:
    """Everything that is told about a run.

    Attributes:
        title: of the page; the sentence.
        words: the sentence in pieces that together are its text.
        understood: the same in the robot's words.
        left_out: words of the sentence that set nothing.
        status: of the result, empty without one; `ok` whether every clause held.
        prediction: what was foreseen.
        rows: from the words to the controller.
        clauses: verdicts.
        ghosts: predicted end poses.
        contacts: where objects were to be touched, in order of time.
        notes: what else is to be said.
    """

    title: str
    words: tuple[StoryWord, ...] = ()
    understood: str = ""
    left_out: tuple[str, ...] = ()
    status: str = ""
    ok: bool = False
    prediction: tuple[StoryLine, ...] = ()
    rows: tuple[StoryRow, ...] = ()
    clauses: tuple[StoryClause, ...] = ()
    ghosts: tuple[Ghost, ...] = ()
    contacts: tuple[ContactMark, ...] = ()
    notes: tuple[str, ...] = ()
