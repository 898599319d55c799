"""A clause without a verb: a remark on what was said or done before, or a question about it.

"No, the mug", "5 cm", "and slower", "would it topple?": what it does not say is as it was before,
so little of it is a remark. Which sentence it is about, the session knows.
"""

from __future__ import annotations

from collections.abc import Sequence

from grammar.clauses.clause_parts import Clause, no_verb, several_objects, unexpected_part
from grammar.clauses.clause_subjects import NOBODY
from grammar.clauses.consistency import require_consistent
from grammar.clauses.constraint_builder import constraints_of
from grammar.clauses.goal_builder import goal_builder_for
from grammar.errors import ParseError
from grammar.frames import command as g
from grammar.phrases import phrase_parts as ph
from grammar.words.lexicon import Lexicon, Verb
from grammar.words.normalisation import Normalised

GOES_ON = (ph.Direction, ph.Heading, ph.Toward, ph.AwayFrom, ph.Place, ph.Length, ph.Angle,
           ph.Sense, ph.Amount, ph.Share, ph.Volume)  # fmt: skip
"""Parts that say what should become of the object, also without a verb."""

_SAYS = (*GOES_ON, ph.Constraint, ph.Avoid)
"""These, and those that say how."""

_SAID_TOGETHER: tuple[set[g.Dialogue], ...] = ({"repeat", "more"}, {"repeat", "reverse"},
                                                 {"do", "more"}, {"same", "reverse"})  # fmt: skip
"""Remarks of which the second says how the first is meant."""

_ASKED_OF_LAST = ("predict", "possible", "how_hard", "why")
"""Questions about an action, which may be the last one."""


def joint_dialogue(remarks: Sequence[ph.Remark], sentence: Normalised) -> g.Dialogue | None:
    """Act of all remarks together: "no, again" corrects; "again and again" is too much.

    Raises:
        ParseError: `unexpected_words`.
    """
    again = [remark for remark in remarks if remark.dialogue == "repeat"]
    if len(again) > 1:
        raise unexpected_part(again[1], sentence)
    said = {remark.dialogue for remark in remarks}
    if len(said - {"correct"}) > 1 and said - {"correct"} not in _SAID_TOGETHER:
        raise unexpected_part(remarks[-1], sentence)
    for dialogue in ("reverse", "stop", "undo", "correct", "do", "same", "repeat", "more"):
        if dialogue in said:
            return dialogue
    return None


def _without_comparisons(remarks: Sequence[ph.Remark], parts: Sequence[ph.Part]) -> list[ph.Remark]:
    """The remarks; of "slower" behind "the same with the mug" only how it is done."""
    if not any(remark.dialogue == "same" for remark in remarks):
        return list(remarks)
    how = {part.span for part in parts if isinstance(part, ph.Constraint)}
    return [each for each in remarks if each.dialogue != "more" or each.span not in how]


_BACK = frozenset({"back", "back off", "back up", "come back", "get back", "give back", "go back"})
"""Words of going back that name no direction, once they are reworded."""


class RemarkReader:
    """Reads a clause that has no verb, given its remarks and its other parts."""

    def __init__(
        self,
        parts: Sequence[ph.Part],
        remarks: Sequence[ph.Remark],
        lexicon: Lexicon,
        sentence: Normalised,
    ) -> None:
        self._lexicon = lexicon
        self._sentence = sentence
        self._things = [part for part in parts if isinstance(part, ph.Thing)]
        self._excluded = [part for part in parts if isinstance(part, ph.NotThis)]
        self._parts = [part for part in parts if not isinstance(part, ph.Thing | ph.NotThis)]
        self._remarks = _without_comparisons(remarks, parts)

    def question(self, ask: ph.Ask) -> g.Frame:
        """The frame of a question about what was said last: "what if at the top?".

        Raises:
            ParseError: `incomplete`, or with the words that do not fit.
        """
        for remark in self._remarks:
            if remark.dialogue not in ("do", "same", "repeat", "correct"):
                raise unexpected_part(remark, self._sentence)
        self._things = [*([ask.thing] if ask.thing else []), *self._things]
        asks_more = bool(self._things or self._remarks or self._parts)
        words = self._sentence.words_as_written(ask.span).casefold()
        asks_more = asks_more or ask.query == "possible" or words.startswith("how much force")
        if ask.query not in _ASKED_OF_LAST or not asks_more:
            raise ParseError(
                "incomplete",
                "the question does not say what is done to the object",
                ask.span,
                ('ask, for example, "will it topple if you push it at the top?"',),
            )
        frame = self._frames_as("repeat", ask)[0]
        if ask.query == "why":
            frame = frame.model_copy(update={"dialogue": None})
        asked = {"query": ask.query, "event": ask.event, "negated": ask.negated}
        return frame.model_copy(update=asked)

    def frames(self) -> list[g.Frame]:
        """The frames of a remark: undo that, a bit more to the left, no, the coffee box.

        Raises:
            ParseError: with the words that do not fit.
        """
        if self._sentence.question and (superlative := self._superlative()):
            return [superlative]
        self._require_what_is_not_meant()
        self._require_no_denial_behind()
        self._take_back()
        dialogue = self._dialogue()
        if dialogue is None:
            raise no_verb(self._sentence, [*self._things, *self._parts])
        alike = any(remark.dialogue == "same" for remark in self._remarks)
        if dialogue in ("more", "do", "reverse") and self._things and not alike:
            raise no_verb(self._sentence, self._things)
        if dialogue == "stop" and self._things:
            raise several_objects(self._things[0], self._sentence)
        return self._frames_as(dialogue)

    def _superlative(self) -> g.Frame | None:
        """The frame of "and the heaviest?", which asks who it is."""
        if self._remarks or len(self._things) != 1:
            return None
        (thing,) = self._things
        which = self._lexicon.terminals["SUPERLATIVE"].get(thing.ref.text.casefold())
        if which is None or not all(isinstance(part, ph.Filler) for part in self._parts):
            return None
        goal = g.Parameters(which=(which.split()[0],), spans=(thing.span,))
        return g.Frame(query="compare", object=thing.ref, goal=goal, spans=(thing.span,))

    def _require_what_is_not_meant(self) -> None:
        """Refuses "not that gently", which is not "not that one"."""
        for part in self._excluded:
            after = self._sentence.original[part.span[1] :].strip()
            if part.thing.ref.text.casefold() == "that" and after[:1].isalpha():
                raise unexpected_part(part, self._sentence)

    def _require_no_denial_behind(self) -> None:
        """Refuses "undo that. Oops, no", of which it is not clear what is left."""
        said = sorted((*self._things, *self._parts, *self._remarks), key=lambda part: part.span)
        for last in said[1:][-1:]:
            word = self._sentence.words_as_written(last.span).casefold()
            if isinstance(last, ph.Remark) and word in self._lexicon.terminals["NO"]:
                raise unexpected_part(last, self._sentence)

    def _take_back(self) -> None:
        """Takes "back" alone for the other way, unless it corrects, or goes farther."""
        back = [p for p in self._parts if isinstance(p, ph.Direction) and self._is_back(p)]
        if back and not {"correct", "more"} & {remark.dialogue for remark in self._remarks}:
            self._parts = [part for part in self._parts if part not in back]
            self._remarks.append(ph.Remark(back[0].span, "reverse"))

    def _is_back(self, part: ph.Part) -> bool:
        return self._sentence.words_as_written(part.span).casefold() in _BACK

    def _dialogue(self) -> g.Dialogue | None:
        """The act that its remarks say, or that little is said."""
        things, fillers = self._things, [p for p in self._parts if isinstance(p, ph.Filler)]
        question = self._sentence.question and not any(part.asks for part in fillers)
        goes_on = any(part.goes_on for part in fillers)
        dialogue = joint_dialogue(self._remarks, self._sentence)
        said = [part for part in self._parts if part not in fillers]
        if dialogue == "undo" and any(isinstance(p, ph.Length | ph.Amount) for p in said):
            return "reverse"  # "go back 2 cm"
        if dialogue == "more" and question and any(isinstance(p, ph.Constraint) for p in said):
            return "repeat"  # "and lower?"
        if dialogue in ("repeat", "do") and things and not goes_on:
            return None
        if (
            dialogue == "do"
            and len(self._remarks) > 1
            and not any(isinstance(p, ph.Constraint) for p in said)
        ):
            raise unexpected_part(self._remarks[-1], self._sentence)  # "do it more"
        if dialogue is not None:
            return dialogue
        written = [self._sentence.words_as_written(part.span).casefold() for part in said]
        if any(words.startswith("another ") for words in written):
            return "more"  # "another 5 cm"
        how = all(isinstance(part, ph.Constraint) for part in said)  # "do not push it too hard"
        if any(words.startswith("do not ") and not how for words in written):
            return "do"
        if any(words.startswith("do ") and not words.startswith("do not ") for words in written):
            return "do"  # "do it gently"
        if self._excluded and things:
            return "correct"
        if goes_on and (things or any(isinstance(p, _SAYS) for p in said)):
            return "repeat" if question or not things else "same"
        if things or not said or question:
            return None
        named = any(isinstance(p, ph.Avoid) and p.thing and not p.thing.ref.pronoun for p in said)
        bare = all(isinstance(part, _SAYS) for part in said) and not named
        return "correct" if bare else None  # "10 cm", "to the left", "with one finger"

    def _frames_as(self, dialogue: g.Dialogue, *asks: ph.Ask) -> list[g.Frame]:
        """The frames for what is said, one for each object."""
        things, alike = self._things, list[ph.Thing]()
        if dialogue == "same":  # of "the mug, the same" only the mug is an object
            alike = [each for each in things if "same" in each.ref.qualities]
            things = [each for each in things if each not in alike] or things
            alike = [each for each in alike if each not in things]
        elif len(things) > 1:
            raise several_objects(things[1], self._sentence)
        goal, constraints = self._goal_and_constraints(dialogue, things)
        spans = [part.span for part in (*asks, *self._remarks, *self._excluded, *alike)]
        frame = g.Frame(
            dialogue=dialogue, goal=goal, constraints=constraints, spans=tuple(sorted(spans))
        )
        frames = [frame.model_copy(update={"object": each.ref}) for each in things] or [frame]
        for each in frames:
            require_consistent(each, self._sentence)
        return frames

    def _goal_and_constraints(
        self, dialogue: g.Dialogue, things: Sequence[ph.Thing]
    ) -> tuple[g.Goal, tuple[g.Constraint, ...]]:
        """The goal as far as it is said, and how it is to be reached."""
        thing = things[0] if things else NOBODY
        rest, constraints = constraints_of(self._parts, thing, self._lexicon, self._sentence)
        rest = [p for p in rest if not (isinstance(p, ph.Particle) and p.optional)]
        content = [part for part in rest if not isinstance(part, ph.Filler)]
        if dialogue in ("undo", "stop") and (content or constraints):
            raise unexpected_part((content or self._remarks)[0], self._sentence)
        if dialogue == "correct" and not (content or constraints or things):
            raise ParseError(
                "incomplete",
                "the sentence does not say what was meant",
                self._remarks[0].span,
                ('say, for example, "no, the coffee box"', 'or "no, to the left"'),
            )
        turns = any(isinstance(part, ph.Angle | ph.Sense) for part in content)
        clause = Clause(rest, Verb("turn" if turns else "push", ""), self._sentence)
        goal: g.Goal = g.NoGoal()
        if clause.has_part(*GOES_ON):
            pours = any(isinstance(part, ph.Volume) for part in content)
            kind = Verb("", "rotate" if turns else "pour" if pours else "displace")
            goal = goal_builder_for(kind, None, clause)(clause)
        clause.require_all_taken("")
        return goal, constraints
