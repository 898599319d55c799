"""From the parts of a sentence to its frames: clause by clause, command, question or remark."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest
from typing import Any, cast

from grammar.clauses.action_reader import ActionReader
from grammar.clauses.clause_boundaries import clauses_of
from grammar.clauses.clause_parts import (
    Clause,
    Parts,
    no_verb,
    unexpected_part,
)
from grammar.clauses.clause_subjects import (
    NOBODY,
    attach_objects,
    clause_objects,
    sets_lid_down,
    with_lid_as_pronoun,
)
from grammar.clauses.constraint_builder import complete_avoidances, constraints_of
from grammar.clauses.counted_objects import (
    require_countable,
    require_no_other_meant,
    with_exception,
    with_listed_exceptions,
    without_both,
)
from grammar.clauses.object_descriptions import attach_descriptions
from grammar.clauses.remark_reader import GOES_ON, RemarkReader, joint_dialogue
from grammar.clauses.ways_back import with_ways_back
from grammar.frames import command as g
from grammar.phrases import phrase_parts as ph
from grammar.words.lexicon import Lexicon, Verb
from grammar.words.normalisation import Normalised

_ALL_TAKEN = ("them", "both", "each", "each of them", "both of them", "all of them")
_ON_THE_TABLE = ("push", "pull", "slide", "move", "turn", "tilt", "topple", "lift")
"""Actions for which a thing need not be held before."""

_RESTORING = ("upright", "set_down", "close")
"""Goals of which "again" says that it was so before."""


def frames_of(
    parts: Sequence[ph.Part], lexicon: Lexicon, sentence: Normalised
) -> tuple[g.Frame, ...]:
    """Puts the parts of a sentence together.

    Raises:
        ParseError: with the words that do not fit.
    """
    frames: list[g.Frame] = []
    previous: Parts = []
    for clause in _in_order(clauses_of(with_listed_exceptions(parts), sentence)):
        headed = any(isinstance(p, ph.Verb | ph.Explore | ph.Remark) for p in clause)
        said = clause
        if frames and not headed:
            said = _complete_clause(clause, previous, lexicon, sentence)
        said = with_lid_as_pronoun(said, previous, lexicon, sentence)
        read = _ClauseReader(said, lexicon, sentence).read_frames()
        if frames and sets_lid_down(read[0], frames[-1], lexicon):
            opened = frames.pop()  # as it does anyway
            spans = tuple(sorted((*opened.spans, *read[0].spans, *read[0].goal.spans)))
            read = [opened.model_copy(update={"spans": spans})]
        read = _with_what_is_taken(frames, read, sentence)
        require_no_other_meant(said, [*frames, *read], sentence)
        frames += read
        previous = said
    require_countable(frames, sentence)
    return with_ways_back(frames, sentence)


def _goes_farther(frame: g.Frame) -> bool:
    """Check for "push the mug further away", of which nothing has to be said before."""
    thing, goal = frame.object, frame.goal
    named = thing is not None and not thing.pronoun
    return named and getattr(goal, "direction", None) == "away"


def _with_what_is_taken(
    frames: list[g.Frame], read: list[g.Frame], sentence: Normalised
) -> list[g.Frame]:
    """Frames about what was only taken before, which is done to each; "take" is taken away."""
    then = read[0]
    several = then.object is not None and then.object.text.casefold() in _ALL_TAKEN
    taken = list[g.Frame]()
    while frames and _only_takes(frames[-1], then, sentence) and (several or not taken):
        taken.insert(0, frames.pop())
    each = (
        then.model_copy(update={"object": t.object, "spans": (*t.spans, *then.spans)})
        for t in taken
    )
    return [*each, *read[1:]] if taken else read


def _only_takes(frame: g.Frame, then: g.Frame, sentence: Normalised) -> bool:
    """Check for "take" of "take the tin and push it", which lifts nothing by itself."""
    plain = frame.model_copy(update={"object": None, "spans": ()}) == g.Frame(
        action="lift", goal=g.Lift()
    )
    verb = sentence.words_as_written(frame.spans[0]).casefold() if frame.spans else ""
    it = then.object is not None and (then.object.pronoun or then.object.text in _ALL_TAKEN)
    return plain and verb in ("take", "grab") and it and then.action in _ON_THE_TABLE


def _in_order(clauses: list[Parts]) -> list[Parts]:
    """The clauses as they are done: "before you lift it, push it" pushes first."""
    first = clauses[0]
    if len(clauses) > 1 and isinstance(first[0], ph.Next) and first[0].word == "before":
        clauses = [clauses[1], first, *clauses[2:]]
    return [[part for part in clause if not isinstance(part, ph.Next)] for clause in clauses]


def _complete_clause(
    clause: Parts, previous: Parts, lexicon: Lexicon, sentence: Normalised
) -> Parts:
    """A clause without its verb ("then to the left") goes on with verb and object of the last."""
    head = next((part for part in previous if isinstance(part, ph.Verb)), None)
    things = [part for part in clause if isinstance(part, ph.Thing)]
    if (
        head is not None
        and things
        and any(isinstance(part, ph.Thing) for part in previous)
        and things == [p for p in clause if not isinstance(p, ph.Filler)]
    ):
        return _with_other_things(previous, things)
    if head is None or not any(isinstance(part, GOES_ON) for part in clause):
        raise no_verb(sentence, clause)
    particle = next((part for part in previous if isinstance(part, ph.Particle)), None)
    verb: Parts = [head]
    if particle is not None and lexicon.find_verb(head.word, particle.word):
        verb.append(particle)  # "up" of "push it up" is a direction
    thing = [] if things else [part for part in previous if isinstance(part, ph.Thing)][:1]
    return [*verb, *thing, *clause]


def _with_other_things(clause: Parts, things: Sequence[ph.Thing]) -> Parts:
    """The same with others: "push the mug away, then the jar"."""
    first = next(i for i, part in enumerate(clause) if isinstance(part, ph.Thing))
    rest = [part for part in clause[first:] if not isinstance(part, ph.Thing | ph.Except)]
    return [*clause[:first], *things, *rest]


def _with_meant_verb(parts: Sequence[ph.Part], lexicon: Lexicon, sentence: Normalised) -> Parts:
    """Takes "give it a push" for "push it", "I want it further left" for "move it further left"."""
    strokes = [part for part in parts if isinstance(part, ph.Stroke)]
    wishes = [part for part in parts if isinstance(part, ph.Wish)]
    rest = [part for part in parts if not isinstance(part, ph.Stroke | ph.Wish)]
    verb = next((part for part in rest if isinstance(part, ph.Verb)), None)
    given = verb is not None and lexicon.verbs.get(verb.word) == lexicon.verbs["give"]
    if verb is not None and given and len(strokes) == 1:
        meant = replace(verb, word=strokes[0].verb, completed=strokes[0].span)
        return [meant if part is verb else part for part in _with_receiver(rest)]
    if verb is not None and (told := [wish for wish in wishes if wish.state]):
        raise unexpected_part(told[0], sentence)  # "push the box is supposed to be"
    if strokes or not wishes or verb is not None:
        return [part for part in parts if not isinstance(part, ph.Wish)]
    if _says_only_how_far(rest):  # "it should be 6 cm"
        rest = [part for part in rest if not isinstance(part, ph.Thing)]
    elif any(isinstance(part, GOES_ON) for part in rest):
        wish = wishes[0]
        verb = ph.Verb(wish.span, "move", passive=True, completed=wish.state)
        return [verb, *rest]
    elif wishes[0].state:
        raise no_verb(sentence, rest)
    return [ph.Remark(wishes[0].span, "correct"), *rest]


def _says_only_how_far(parts: Parts) -> bool:
    """Check for an amount of "it", which corrects what was said of that."""
    goal = [part for part in parts if isinstance(part, GOES_ON)]
    named = any(isinstance(part, ph.Thing) and not part.ref.pronoun for part in parts)
    return bool(goal) and not named and all(isinstance(p, ph.Length | ph.Angle) for p in goal)


def _with_receiver(parts: Parts) -> Parts:
    """Takes the thing in "give a push to the tin" for what is pushed."""
    place = next((part for part in parts if isinstance(part, ph.Place)), None)
    if place is None or place.relation != "to" or any(isinstance(p, ph.Thing) for p in parts):
        return parts
    (ref,) = cast("tuple[g.ObjectRef]", place.reference)
    return [ph.Thing(place.span, ref) if part is place else part for part in parts]


class _ClauseReader:
    """Reads one clause."""

    def __init__(self, parts: Sequence[ph.Part], lexicon: Lexicon, sentence: Normalised) -> None:
        self._lexicon = lexicon
        self._sentence = sentence
        parts = complete_avoidances(_with_meant_verb(parts, lexicon, sentence), lexicon)
        self._parts = attach_descriptions(
            attach_objects(parts, lexicon, sentence), lexicon, sentence
        )

    def read_frames(self) -> list[g.Frame]:
        """The frames of the clause, one for each of its objects."""
        remarks, explore = self._take_parts(ph.Remark), self._take_parts(ph.Explore)
        if explore:
            return self._with_remarks([self._exploration_frame(explore[0])], remarks)
        ask = self._take_parts(ph.Ask)
        verbs = [part for part in self._parts if isinstance(part, ph.Verb)]
        self._require_there_is_clear(ask)
        if ask and not verbs:
            return [self._question_frame(ask, remarks)]
        if ask or any(isinstance(part, GOES_ON) for part in self._parts):
            # "What happens if you push it harder?", "lift it 10 cm more slowly"
            how = [part.span for part in self._parts if isinstance(part, ph.Constraint)]
            remarks = [remark for remark in remarks if remark.span not in how]
        if ask and remarks:
            raise unexpected_part(remarks[0], self._sentence)
        if ask and ask[0].query in ("value", "affordances", "seen", "did", "compare"):
            raise unexpected_part(verbs[0], self._sentence)
        if not verbs:
            return RemarkReader(self._parts, remarks, self._lexicon, self._sentence).frames()
        excluded = self._take_parts(ph.NotThis)
        excepted = self._take_parts(ph.Except)
        things = without_both(
            clause_objects(self._parts, ask, remarks, self._lexicon, self._sentence)
        )
        if any(thing.ref.quantifier in ("all", "rest") for thing in things):
            excepted, excluded = [*excepted, *excluded], []
        for part in excluded:
            if part.thing.ref.pronoun:  # "push the mug. Not that"
                raise unexpected_part(part, self._sentence)
        for part in excepted:
            things = with_exception(things, part, self._sentence)
        self._take_parts(ph.Thing)
        if not ask:
            self._require_no_condition()
        reader = ActionReader(self._parts, ask, self._lexicon, self._sentence)
        frames = [reader.frame_about(thing) for thing in things]
        if ask and ask[0].query == "capable" and things == [NOBODY]:
            frames = [frame.model_copy(update={"object": None}) for frame in frames]
        return self._with_remarks(frames, remarks, excluded)

    def _with_remarks(
        self,
        frames: list[g.Frame],
        remarks: Sequence[ph.Remark],
        excluded: Sequence[ph.NotThis] = (),
    ) -> list[g.Frame]:
        """The frames of a clause, with what its remarks do to them."""
        dialogue = joint_dialogue(remarks, self._sentence)
        if dialogue in ("undo", "stop"):
            raise unexpected_part(remarks[0], self._sentence)
        if dialogue == "do":
            self._require_emphasis(frames[0], remarks[-1])
        restored = dialogue == "repeat" and frames[0].goal.kind in _RESTORING
        anew = dialogue == "correct" and self._says_all(frames[0], remarks)
        if dialogue == "more":
            ends = any(isinstance(p, ph.Result) for p in self._parts)  # "so it is further left"
            anew = ends or _goes_farther(frames[0])
        if restored or anew or dialogue == "do":
            dialogue = None  # "stand it up again"; "go ahead, push it"
        spans = tuple(part.span for part in (*remarks, *excluded))
        if not spans:
            return frames
        return [
            frame.model_copy(update={"dialogue": dialogue, "spans": spans + frame.spans})
            for frame in frames
        ]

    def _says_all(self, frame: g.Frame, remarks: Sequence[ph.Remark]) -> bool:
        """Check for "actually" or ", as I said" at a whole command, of which nothing is left open.

        Raises:
            ParseError: `unexpected_words` at "no" behind a command, which takes it back.
        """
        thing = frame.object
        if thing is None or thing.pronoun or not frame.goal.spans:
            return False
        words = {self._sentence.words_as_written(part.span).casefold() for part in remarks}
        behind = remarks[0].span > max(*frame.goal.spans, *thing.spans)
        if behind and not self._sentence.question and words & self._lexicon.terminals["NO"].keys():
            raise unexpected_part(remarks[0], self._sentence)
        return behind or words <= {"actually", "rather", "instead"}

    def _require_emphasis(self, frame: g.Frame, remark: ph.Remark) -> None:
        """Takes "do it" beside a command as said of that command; before it, of another one.

        Raises:
            ParseError: `unexpected_words`.
        """
        words = self._sentence.words_as_written(remark.span).casefold()
        if words.startswith(("do ", "make ")) and remark.span < min(frame.spans):
            raise unexpected_part(remark, self._sentence)

    # --- parts --------------------------------------------------------------------------------

    def _take_parts(self, *kinds: type[ph.Part]) -> list[Any]:
        taken = [part for part in self._parts if isinstance(part, kinds)]
        if taken:
            self._parts = [part for part in self._parts if not isinstance(part, kinds)]
        return taken

    def _require_there_is_clear(self, ask: Sequence[ph.Ask]) -> None:
        for part in self._take_parts(ph.There):
            if not any(each.query == "why" for each in ask) and not self._points(part):
                raise self._sentence.error_at(
                    part.span, "unexpected_words", "does not say where",
                    "next to the mug", "to the middle of the table", "10 cm to the left",
                )  # fmt: skip

    def _points(self, there: ph.There) -> bool:
        """Check for "here" of "the box here", if it is told elsewhere where that goes."""
        said = self._sentence.original
        told = any(
            not thing.ref.pronoun and not said[thing.span[1] : there.span[0]].strip()
            for thing in self._parts
            if isinstance(thing, ph.Thing)
        )
        return told and any(isinstance(part, GOES_ON) for part in self._parts)

    def _require_no_condition(self) -> None:
        """Lets "when you push it" follow a restriction; else a condition belongs to a question."""
        restricted = False
        for part, after in zip_longest(self._parts, self._parts[1:]):
            restricted = restricted or isinstance(part, ph.Avoid | ph.Constraint)
            told = restricted and isinstance(after, ph.Verb)
            if isinstance(part, ph.If) and not told:
                raise unexpected_part(part, self._sentence)

    # --- questions and remarks ----------------------------------------------------------------

    def _exploration_frame(self, part: ph.Explore) -> g.Frame:
        rest, constraints = constraints_of(self._parts, part.thing, self._lexicon, self._sentence)
        clause = Clause(rest, Verb("explore", "parameters"), self._sentence)
        how = clause.take_value(ph.Method)
        clause.require_all_taken("find out")
        return g.Frame(
            action="explore",
            object=part.thing.ref,
            goal=g.Parameters(which=part.which, method=how, spans=(part.span, *clause.all_spans)),
            constraints=constraints,
            spans=(part.span,),
        )

    def _question_frame(self, asks: Sequence[ph.Ask], remarks: Sequence[ph.Remark]) -> g.Frame:
        """A question without a verb: how heavy, what can you do with, why."""
        ask, *more = asks
        if more:
            raise unexpected_part(more[0], self._sentence)
        if not ask.whole:
            return RemarkReader(self._parts, remarks, self._lexicon, self._sentence).question(ask)
        if remarks:
            raise unexpected_part(remarks[0], self._sentence)
        if ask.query == "why" and self._parts and ask.state is None:
            return RemarkReader(self._parts, remarks, self._lexicon, self._sentence).question(ask)
        Clause(self._parts, Verb("push", "contact"), self._sentence).require_all_taken(
            "this question"
        )
        goal: g.Goal = ask.state or g.NoGoal()
        if ask.which or ask.than:
            goal = g.Parameters(which=ask.which, than=ask.than, spans=(ask.span,))
        return g.Frame(
            query=ask.query,
            dialogue="repeat" if ask.than and not ask.which else None,
            object=None if ask.thing is None else ask.thing.ref,
            goal=goal,
            spans=(ask.span,),
        )
