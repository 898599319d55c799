"""Frames in plain words: what was understood.

The words are chosen so that reading them gives the same frames again, up to spans.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import groupby

from grammar.frames import command as g
from grammar.paraphrasing.clause_wording import Phrasing
from grammar.paraphrasing.object_wording import Choice, is_said_twice, no_words
from grammar.words.lexicon import Lexicon, default_lexicon

_LIMITS = ("no_topple", "no_tilt", "no_turn", "no_slide")
"""Constraints with which "how hard" asks for the most, not for the least."""

_TOLD_BY_SIDES = ("lift", "open", "close", "pour", "parameters")
"""Goals for which "in the middle" behind the object tells it apart."""

_MUTUAL = ("in_row", "together", "stacked", "place_of")
"""Places of several objects that are said at once."""

_STANDING = {"upright": "upright", "topple": "lying", "open": "open", "close": "closed"}
"""What is asked to be so already → how it is called."""

_JOINED = ("PARTICLE", "REGION", "UPON", "DIRECTION", "RELATION")
"""Terminals whose phrases may begin with another one: "down at the bottom", "further away from"."""

_LONGEST_JOINED, _MOST_RANKS = 8, 8
"""Words of the longest of them, and phrases of one meaning of which each is tried."""

_EVERY = "…"  # for their names

_OPENINGS: dict[str, tuple[str, str]] = {
    "possible": ("POSSIBLE", ""),
    "how_hard": ("HOW_HARD", "least"),
    "where": ("WHERE", ""),
    "why": ("WHY_DID", ""),
}


def paraphrase(
    said: g.Frame | Sequence[g.Frame],
    lexicon: Lexicon | None = None,
    choose: Choice | None = None,
) -> str:
    """Return frames in plain words, those of nlcontrol's own language by default.

    Of the phrases that mean the same, `choose` picks one; the first by default.

    Raises:
        ValueError: if the language has no words for it.
    """
    frames = (said,) if isinstance(said, g.Frame) else said
    lexicon = default_lexicon() if lexicon is None else lexicon
    words = _words_for(frames, lexicon, choose)
    if choose is None and is_misread(words, frames, lexicon):
        others = _others_once(frames, lexicon)
        return next((each for each in others if not is_misread(each, frames, lexicon)), words)
    return words


def is_misread(text: str, frames: Sequence[g.Frame], lexicon: Lexicon) -> bool:
    """Check for words of frames that met by chance, and mean something else together.

    Words said twice are read as stammered, "from the left that is left of" as a correction, "set it
    down" with "at the bottom" as "set it" with "down at the bottom", and "further" with "away from
    it" as "further away from it", which is the same as "away from it".
    """
    words = text.casefold().replace(" that is ", " ").replace(",", " ,").split()
    if is_said_twice(words):
        return True
    firsts = {f.goal.words.particle for f in frames}
    if any(f.dialogue for f in frames):
        firsts |= {phrase.split()[-1] for phrase in lexicon.terminals["MORE"]}
    return any(
        " ".join(words[i:end]) in lexicon.terminals[terminal]
        for i, word in enumerate(words)
        if word in firsts
        for end in range(i + 2, min(i + _LONGEST_JOINED, len(words)) + 1)
        for terminal in _JOINED
    )


def _others_once(frames: Sequence[g.Frame], lexicon: Lexicon) -> Iterator[str]:
    """The same in other words: each phrase in turn is another one that means the same."""
    asked: list[Sequence[str]] = []

    def choose_first(phrases: Sequence[str]) -> str:
        asked.append(phrases)
        return phrases[0]

    _words_for(frames, lexicon, choose_first)
    for rank in range(1, _MOST_RANKS):
        for place, phrases in enumerate(asked):
            if rank < len(phrases):
                chosen = iter([*(each[0] for each in asked[:place]), phrases[rank]])
                yield _words_for(frames, lexicon, partial(_chosen, chosen))


def _chosen(chosen: Iterator[str], phrases: Sequence[str]) -> str:
    return next(chosen, phrases[0])


def _words_for(frames: Sequence[g.Frame], lexicon: Lexicon, choose: Choice | None) -> str:
    speaker = _Speaker(lexicon, choose)
    clauses: list[str] = []
    for shared, group in groupby(frames, speaker.shared_words):
        if shared is None:
            clauses += map(speaker.frame_words, group)
        else:
            *names, last = [speaker.object_words(f.object) for f in group if f.object is not None]
            every = " and ".join([*([", ".join(names)] if names else []), last])
            clauses.append(shared.replace(_EVERY, every))
    return ", then ".join(clauses)


class _Speaker(Phrasing):
    """Says whole frames."""

    def frame_words(self, frame: g.Frame) -> str:
        """One frame: a command, a question or a remark."""
        if frame.dialogue is not None:
            return self._remark_words(_with_it(frame), frame.dialogue)
        if frame.query is not None:
            return self._question_words(_with_it(frame), frame.query)
        return self._command_words(frame)

    def shared_words(self, frame: g.Frame) -> str | None:
        """A frame without its object, if that stands to others so that they are said at once."""
        is_mutual = isinstance(frame.goal, g.Place) and frame.goal.relation in _MUTUAL
        if frame.query not in (None, "possible") or frame.dialogue or not is_mutual:
            return None
        if frame.query is not None:
            return self._question_words(frame, frame.query, name=_EVERY)
        return self._command_words(frame, name=_EVERY)

    # --- commands -----------------------------------------------------------------------------

    def _command_words(self, frame: g.Frame, name: str | None = None, more: str = "") -> str:
        """A clause; `name` stands for the object, `more` behind the goal."""
        if frame.object is None or frame.action is None:
            raise no_words(f"action {frame.action} without an object")
        goal = frame.goal
        if isinstance(goal, g.Parameters) and goal.which:
            return self._exploration_words(frame, goal.which, more)
        verb, result = self._verb_and_result(frame)
        constraints = list(frame.constraints)
        words = []
        if constraints and (manner := self.manner_words(constraints[0])):
            words.append(manner)
            constraints.pop(0)
        words += [verb, name or self._of_a_part(frame)]
        if goal.words.particle:
            words.append(goal.words.particle)
        words += [*result, *self.goal_words(goal), *([more] if more else [])]
        words += self._constraint_words(goal, constraints)
        return " ".join(words)

    def _verb_and_result(self, frame: g.Frame) -> tuple[str, list[str]]:
        """The verb, and the result if another outcome than its own is wanted."""
        action, goal = frame.action or "", frame.goal
        if action in goal.words.verbs:
            verb, thing = goal.words.verbs[action], frame.object
            if isinstance(goal, g.Open | g.Close) and goal.part and thing is not None:
                # Only what is called "the …" has a "lid of the …".
                moved = "take" if isinstance(goal, g.Open) else "put"
                verb = verb if self.object_words(thing).startswith("the ") else moved
            return verb, []
        if action in g.Displace.words.verbs and goal.words.outcomes:
            event = self.phrase_for("EVENT", goal.words.outcomes[0])
            return g.Displace.words.verbs[action], [f"so that it {event}"]
        raise no_words(f"action {action}, goal {goal.kind}")

    def _of_a_part(self, frame: g.Frame) -> str:
        """The object; with its part, if that is opened; with its contents, if they are poured."""
        assert frame.object is not None
        name, goal = self.object_words(frame.object), frame.goal
        if isinstance(goal, g.Open | g.Close) and goal.part:
            if name.startswith("the "):
                return f"the {goal.part} of {name}"
            if goal.part not in self.lexicon.lids:
                raise no_words(f"the {goal.part} of {name}")
            return f"the {goal.part} {'off' if isinstance(goal, g.Open) else 'on'} {name}"
        return f"{self.portion_words(goal)}{name}" if isinstance(goal, g.Pour) else name

    def _constraint_words(self, goal: g.Goal, constraints: Sequence[g.Constraint]) -> list[str]:
        said = ("direction", "heading", "toward", "away_from", "reference")
        directed = any(getattr(goal, field, None) is not None for field in said)
        of_object = goal.kind in _TOLD_BY_SIDES
        return self.constraint_words(constraints, directed=directed, of_object=of_object)

    def _exploration_words(self, frame: g.Frame, which: Sequence[str], more: str) -> str:
        words = [f"find out {self._property_words(frame, which)}", *self.goal_words(frame.goal)]
        words += [more] if more else []
        return " ".join([*words, *self._constraint_words(frame.goal, frame.constraints)])

    def _property_words(self, frame: g.Frame, which: Sequence[str]) -> str:
        """The mass and the friction of an object."""
        if frame.object is None or not which:
            raise no_words("a property without an object")
        if frame.object.text == "its":
            return " and ".join(self.phrase_for("ITS_PROPERTY", name) for name in which)
        *others, last = which
        known = self.lexicon.phrases_for("THE_PROPERTY_OF", last)
        of = "THE_PROPERTY_OF" if known else "THE_SIDE_OF"
        said = [self.phrase_for("THE_PROPERTY", name) for name in others]
        properties = " and ".join([*said, self.phrase_for(of, last)])
        return f"{properties} {self.object_words(frame.object)}"

    # --- questions ----------------------------------------------------------------------------

    def _question_words(self, frame: g.Frame, query: g.Query, name: str | None = None) -> str:
        """A question; `name` stands for the object of what could be done."""
        if query in ("value", "affordances", "did", "seen"):
            return f"{self._told_of_words(frame, query)}?"
        if query == "why" and isinstance(frame.goal, g.Parameters):
            return f"{self.phrase_for('HOW_SURE')}?"
        if query == "capable":
            return self._capable_words(frame)
        if query == "compare":
            return self._comparison_words(frame)
        if query == "why" and frame.action is None:
            return f"{' '.join([self.phrase_for('WHY'), *self._told_words(frame)])}?"
        if query == "predict":
            return f"{self._prediction_words(frame)}?"
        if query not in _OPENINGS:
            raise no_words(f"the question {query}")
        if frame.negated:
            return f"{self.phrase_for('WHY_DID', 'not')} {self._command_words(frame)}?"
        event = [] if frame.event is None else [self._to_make(frame.event)]
        clause = self._command_words(frame, name)
        terminal, sense = _OPENINGS[query]
        if query == "how_hard" and not event and any(c.kind in _LIMITS for c in frame.constraints):
            sense = "most"
        return f"{' '.join([self.phrase_for(terminal, sense), clause, *event])}?"

    def _told_of_words(self, frame: g.Frame, query: g.Query) -> str:
        """A question for what is known, seen or was done, without its mark."""
        if query == "value" and isinstance(frame.goal, g.State):
            return self._state_words(frame, frame.goal)
        if query == "value" and isinstance(frame.goal, g.Parameters):
            which = frame.goal.which
            if frame.goal.than or which == ("distance",):
                return self._distance_words(frame, frame.goal)
            return f"{self.phrase_for('WHAT_IS')} {self._property_words(frame, which)}"
        if query == "affordances" and frame.object is not None:
            return f"{self.phrase_for('WHAT_CAN')} {self.object_words(frame.object)}"
        if query == "seen" and isinstance(frame.goal, g.Place):
            return f"{self.phrase_for('WHAT_IS')} {' '.join(self.goal_words(frame.goal))}"
        said = {"affordances": "WHAT_CAN_YOU_DO", "did": "WHAT_DID", "seen": "SEEN"}
        if query not in said:
            raise no_words(f"the question {query}")
        return self.phrase_for(said[query])

    def _capable_words(self, frame: g.Frame) -> str:
        thing = frame.object
        asked = frame.model_copy(update={"object": g.ObjectRef(text="it", pronoun=True)})
        opening = self.phrase_for("WHICH_CAN")
        if thing is not None:
            can = self.phrase_for("CAN_YOU")
            opening = f"{self.phrase_for('WHICH_OF')} {self.object_words(thing)} {can}"
        words = self._command_words(asked, name=" ").split()
        return f"{opening} {' '.join(words)}?"

    def _comparison_words(self, frame: g.Frame) -> str:
        if not isinstance(frame.goal, g.Parameters) or frame.object is None:
            raise no_words("a comparison of nothing")
        (which,), others = frame.goal.which, frame.goal.than
        if not others:
            if not frame.object.qualities:
                raise no_words("a comparison that does not say what is looked for")
            most = self.phrase_for("SUPERLATIVE", f"{which} {frame.object.qualities[0]}")
            name = frame.object.text.partition(" ")[2]
            if name:
                return f"{self.phrase_for('WHICH')} {name} {self.phrase_for('IS_IT')} the {most}?"
            return f"{self.phrase_for('WHICH_IS')} {most}?"
        than, more = self.object_words(others[0]), self.phrase_for("COMPARATIVE", which)
        return f"{self.phrase_for('IS_IT')} {self.object_words(frame.object)} {more} than {than}?"

    def _state_words(self, frame: g.Frame, state: g.State) -> str:
        if frame.object is None:
            raise no_words("a question about nothing")
        is_it = f"{self.phrase_for('IS_IT')} {self.object_words(frame.object)}"
        if (said := _STANDING.get(state.kind)) is not None:
            return f"{is_it} {self.phrase_for('STANDING', said)}"
        if isinstance(state, g.Displace) and isinstance(state.away_from, str):
            edge = self.phrase_for("FROM_REGION", state.away_from)
            return f"{self.phrase_for('HOW_FAR')} {self.object_words(frame.object)} {edge}"
        if isinstance(state, g.SetDown):
            return f"{is_it} {self.phrase_for('ON_TABLE')}"
        return f"{is_it} {' '.join(self.goal_words(state))}"

    def _distance_words(self, frame: g.Frame, goal: g.Parameters) -> str:
        if goal.which != ("distance",) or len(goal.than) > 1 or frame.object is None:
            raise no_words("a value that compares two things")
        words = [self.phrase_for("HOW_FAR"), self.object_words(frame.object)]
        for other in goal.than:
            words += [self.phrase_for("FROM"), self.object_words(other)]
        return f"{' '.join(words)}"

    def _to_make(self, event: g.Event) -> str:
        return f"{self.phrase_for('TO_MAKE')} it {self.phrase_for('EVENT_INFINITIVE', event)}"

    def _prediction_words(self, frame: g.Frame) -> str:
        if frame.event is None:
            return f"{self.phrase_for('WHAT_IF')} you {self._command_words(frame)}"
        if frame.object is None:
            raise no_words(f"event {frame.event} without an object")
        if frame.event == "ends_up":
            where, name = self.phrase_for("WHERE_WILL"), self.object_words(frame.object)
            asked = self._command_words(frame, name="it")
            return f"{where} {name} {self.phrase_for('ENDS_UP')} if you {asked}"
        happens = self.phrase_for("EVENT_INFINITIVE", frame.event)
        partly = isinstance(frame.goal, g.Pour | g.Open | g.Close)
        name, text = self.object_words(frame.object), frame.object.text
        if partly or name not in (text, f"the {text}", f'"{text}"'):
            return f"if you {self._command_words(frame)}, will it {happens}"
        return f"will {name} {happens} if you {self._command_words(frame, name='it')}"

    # --- remarks ------------------------------------------------------------------------------

    def _remark_words(self, frame: g.Frame, dialogue: g.Dialogue) -> str:
        if dialogue == "undo" and frame.object is not None:
            return f"{self.phrase_for('UNDO_OF')} {self.object_words(frame.object)}"
        if dialogue == "thank":
            return "thank you"
        if dialogue in ("undo", "stop", "do"):
            return self.phrase_for(dialogue.upper())
        if isinstance(frame.goal, g.Parameters) and frame.goal.than:
            return f"{self.phrase_for('THAN')} {self.object_words(frame.goal.than[0])}?"
        if dialogue in ("same", "repeat") and frame.object is not None and frame.action is None:
            opening = "SAME" if dialogue == "same" else "MIND"
            about = self.phrase_for(opening, ending="" if opening == "SAME" else "about")
            return f"{about} {self.object_words(frame.object)}"
        if dialogue == "correct":
            return f"no, {self._correction_words(frame)}"
        word = self.phrase_for(dialogue.upper())
        if frame.action is not None:
            return self._command_words(frame, more=word)
        if frame.object is not None and dialogue != "reverse":
            raise no_words(f"{dialogue} with an object and no action")
        if frame.object is not None:
            word = f"{self.phrase_for('SAME')} {self.object_words(frame.object)}, {word}"
        words = [word, *self._much_words(frame.goal), *self.goal_words(frame.goal)]
        return " ".join([*words, *self._constraint_words(frame.goal, frame.constraints)])

    def _correction_words(self, frame: g.Frame) -> str:
        if frame.action is not None:
            return self._command_words(frame)
        words = self._told_words(frame)
        if frame.object is not None and isinstance(frame.goal, g.Place):
            words.insert(1, ",")
        return " ".join(words).replace(" ,", ",")

    def _told_words(self, frame: g.Frame) -> list[str]:
        """Words for what a remark names: an object, where it goes, how."""
        words = [] if frame.object is None else [self.object_words(frame.object)]
        how = self._constraint_words(frame.goal, frame.constraints)
        return [*words, *self._much_words(frame.goal), *self.goal_words(frame.goal), *how]

    def _much_words(self, goal: g.Goal) -> list[str]:
        """Words for how much of a liquid a remark says, which names none: "no, 50 ml"."""
        portion = self.portion_words(goal) if isinstance(goal, g.Pour) else ""
        return [portion.removesuffix("of ").strip()] if portion else []


def _with_it(frame: g.Frame) -> g.Frame:
    """Adds the object that questions and remarks leave out: "why did you push?", "pull again"."""
    if frame.action is None or frame.object is not None or frame.query == "capable":
        return frame
    return frame.model_copy(update={"object": g.ObjectRef(text="it", pronoun=True)})
