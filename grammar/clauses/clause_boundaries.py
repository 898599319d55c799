"""One sentence, several clauses: where a command ends and the next begins.

A new verb begins a new clause; what stands between the last "and" or "then" and that verb belongs
to the new clause ("… and gently topple it"). After "then" a clause may do without its verb ("then
to the left"). A question is one clause.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain, pairwise, takewhile

from grammar.clauses.clause_parts import Parts, unexpected_part
from grammar.errors import ParseError
from grammar.phrases import phrase_parts as ph
from grammar.words.normalisation import Normalised

_JOINTS = (ph.Separator, ph.Next)
_HEADS = (ph.Verb, ph.Explore)
_WHERE_TO = (ph.Direction, ph.Heading, ph.Toward, ph.AwayFrom, ph.Place, ph.Length)
_TELLING = (ph.Place, ph.Side, ph.ThatIs)
_SAYING = (*_HEADS, *_WHERE_TO, ph.Thing, ph.Amount)
_EMPHASIS = ("actually", "make it", "make that", "rather")
"""Marks of correction that correct nothing within a command."""

_OPENINGS = (ph.Filler, ph.Amount, ph.Constraint, ph.Avoid, ph.Remark)
"""What may stand before a verb."""

_OPPOSITE = {"left": "right", "right": "left", "away": "toward", "toward": "away"}


def clauses_of(parts: Sequence[ph.Part], sentence: Normalised) -> list[Parts]:
    """Splits the parts of a sentence into those of its clauses, joints left out.

    Raises:
        ParseError: `several_commands`, `unexpected_words`, `incomplete`, `unsupported_question`.
    """
    parts = _with_topic_in_place(_without_requests(parts, sentence))
    parts = _require_joints_join(_with_named_way(parts), sentence)
    if isinstance(parts[0], ph.Separator | ph.Next) and parts[0].word in ("and", "but", "then"):
        parts[0] = ph.Filler(parts[0].span, anywhere=False, goes_on=True)
    parts = _with_corrections_first(parts, sentence)
    parts = _without_denied_ways(_with_open_condition(parts, sentence), sentence)
    if any(isinstance(part, ph.Ask) for part in parts):
        return [_question_parts(parts, sentence)]
    remarked = any(isinstance(part, ph.Remark) for part in parts) or _asks_further(parts)
    if sentence.question and not (remarked or _is_request(parts)):
        raise _unclear_question_error(sentence)
    clauses: list[Parts] = [[]]
    for i, part in enumerate(parts):
        if isinstance(part, _HEADS) and any(isinstance(p, _HEADS) for p in clauses[-1]):
            clauses.append(_take_opening(clauses[-1], part, sentence))
        elif _goes_on(part, clauses, parts[i + 1 :]):
            clauses.append([])
        clauses[-1].append(part)
    return _with_shared_way([_without_joints(clause, ph.Separator) for clause in clauses])


def _with_open_condition(parts: Parts, sentence: Normalised) -> Parts:
    """Takes "and if you push it?" for "what happens if you push it?"."""
    said = [part for part in parts if not isinstance(part, ph.Filler | ph.Separator)]
    asked = any(isinstance(part, ph.Ask) for part in parts)
    if asked or not (sentence.question and said and isinstance(said[0], ph.If)):
        return parts
    return [ph.Ask(p.span, query="predict") if p is said[0] else p for p in parts]


def _without_denied_ways(parts: Parts, sentence: Normalised) -> Parts:
    """Takes "to the left, not to the right" for emphasis; "away but not to the left" forbids."""
    ways = {part.value for part in parts if isinstance(part, ph.Direction)}
    for before, part in pairwise(parts):
        opposed = isinstance(part, ph.NotThere) and _OPPOSITE.get(str(part.value)) in ways
        if isinstance(part, ph.NotThere) and (not opposed or _is_but(before)):
            hint = "to the left, not to the right"
            raise sentence.error_at(part.span, "unbound_words", "forbids a way to go", hint)
    return [
        ph.Filler(part.span, anywhere=True) if isinstance(part, ph.NotThere) else part
        for part in parts
    ]


def _is_but(part: ph.Part) -> bool:
    return isinstance(part, ph.Separator) and part.word == "but"


def _with_shared_way(clauses: list[Parts]) -> list[Parts]:
    """Takes "push first the mug and then the jar to the left" for both to the left."""
    bare = list(takewhile(_names_only, clauses))
    said = [part for part in chain(*clauses[len(bare) :][:1]) if not isinstance(part, ph.Next)]
    match said:
        case [ph.Thing(), *way] if any(isinstance(part, _WHERE_TO) for part in way) and all(
            isinstance(part, (*_WHERE_TO, ph.Constraint)) for part in way
        ):
            return [*([*clause, *way] for clause in bare), *clauses[len(bare) :]]
    return clauses


def _names_only(clause: Parts) -> bool:
    """Check for "push first the mug", "then the jar": a thing, and nothing said of it."""
    said = [part for part in clause if not isinstance(part, ph.Next | ph.Verb)]
    return len(said) == 1 and isinstance(said[0], ph.Thing)


def _with_named_way(parts: Parts) -> Parts:
    """Takes "the mug, 5 cm away" for the same with the mug, 5 cm away."""
    said = [part for part in parts if not isinstance(part, ph.Filler | ph.Next)]
    match said:
        case [ph.Thing() as thing, ph.Separator(word=","), *way] if way and all(
            isinstance(part, (ph.Direction, ph.Length, ph.Amount)) for part in way
        ):
            start = thing.span[0]
            return [ph.Remark((start, start), "same"), *parts]
    return parts


def _goes_on(joint: ph.Part, clauses: list[Parts], rest: Parts) -> bool:
    """Check for a joint before a clause without its verb.

    It stands behind "then", or is of a thing and where it goes, after such a pair ("…, and the jar
    to the left"), or of a length and its direction ("10 cm away and 5 cm to the left").
    """
    if isinstance(joint, ph.Next):
        paused = rest[:1] and isinstance(rest[0], ph.Separator) and not _heads(rest)
        if paused and not any(isinstance(p, ph.Separator) for p in clauses[-1][-1:]):
            return False  # "push it away then, gently"
        return joint.word == "then" and bool(_without_joints(clauses[-1]))
    if not isinstance(joint, ph.Separator):
        return False
    if _is_way(rest):
        return joint.word != "." and any(_is_way(clauses[-1][i:]) for i in range(len(clauses[-1])))
    if not isinstance(rest[0], ph.Thing):
        return False
    thing = next((i for i, p in enumerate(clauses[-1]) if isinstance(p, ph.Thing)), None)
    went = thing is not None and any(isinstance(p, _WHERE_TO) for p in clauses[-1][thing:])
    verbs = [part for clause in clauses for part in clause if isinstance(part, ph.Verb)]
    headed = bool(verbs) and not verbs[-1].passive
    return headed and went and len(rest) > 1 and isinstance(rest[1], _WHERE_TO)


def _is_way(parts: Parts) -> bool:
    """Check for parts that begin with a length and its direction, in any order."""
    match parts[:2]:
        case [ph.Length(), ph.Direction(implied=False)] | [
            ph.Direction(implied=False),
            ph.Length(),
        ]:
            return True
    return False


def _without_joints(clause: Parts, *kinds: type[ph.Part]) -> Parts:
    return [part for part in clause if not isinstance(part, kinds or _JOINTS)]


def _take_opening(clause: Parts, verb: ph.Part, sentence: Normalised) -> Parts:
    """Takes from a clause what opens the next one, back to the joint between them."""
    last = max((i for i, part in enumerate(clause) if isinstance(part, _JOINTS)), default=None)
    if last is None or not all(isinstance(part, _OPENINGS) for part in clause[last + 1 :]):
        suggestion = f'put "then" before it: "…, then {sentence.words_as_written(verb.span)} …"'
        raise sentence.error_at(
            verb.span, "several_commands", "begins a second command", suggestion
        )
    opening = clause[last + 1 :]
    del clause[last:]
    return opening


def _require_joints_join(parts: Sequence[ph.Part], sentence: Normalised) -> Parts:
    """The parts, once every joint is found to join something."""
    said = [part for part in parts if not isinstance(part, ph.Filler)]
    if isinstance(parts[-1], ph.Filler) and said and isinstance(said[-1], ph.Separator):
        said.pop()  # "…, thank you"
    for before, part, after in zip([None, *said], said, [*said[1:], None], strict=False):
        if not isinstance(part, ph.Separator):
            continue
        if after is None:
            last = f'"{sentence.words_as_written(part.span)}"'
            suggestion = f"leave out {last}, or say what comes then"
            raise ParseError(
                "incomplete", f"the sentence ends after {last}", part.span, (suggestion,)
            )
        if before is None and part.word not in (",", "and", "but"):
            raise _joint_error(part, sentence)
        doubled = isinstance(after, ph.Separator)
        avoids = isinstance(after, ph.Avoid | ph.FurtherNoTouch)
        if doubled or (part.word == "or" and not avoids):
            raise _joint_error(after if doubled else part, sentence)
    return list(parts)


def _with_corrections_first(parts: Parts, sentence: Normalised) -> Parts:
    """The parts, once nothing but their beginning or their end corrects an earlier sentence.

    "Push it actually 5 cm" corrects nothing; "push it, then no, turn it" takes back one knows not
    what.
    """
    out: Parts = []
    begun = False
    for i, part in enumerate(parts):
        if begun and isinstance(part, ph.Remark) and part.dialogue == "correct":
            words = sentence.words_as_written(part.span).casefold()
            if words in _EMPHASIS and i < len(parts) - 1:
                continue
            if i < len(parts) - 1 or len(_heads(parts)) > 1:
                raise unexpected_part(part, sentence)
        begun = begun or isinstance(part, _SAYING)
        out.append(part)
    return out


def _heads(parts: Parts) -> Parts:
    return [part for part in parts if isinstance(part, _HEADS)]


def _joint_error(part: ph.Part, sentence: Normalised) -> ParseError:
    """A joint that joins nothing, or that leaves a choice."""
    if not isinstance(part, ph.Separator) or part.word != "or":
        return unexpected_part(part, sentence)
    suggestion = "say the one that is meant"
    return sentence.error_at(part.span, "unexpected_words", "leaves a choice", suggestion)


def _without_requests(parts: Sequence[ph.Part], sentence: Normalised) -> Parts:
    """Takes "can you" for a request, unless it ends in a question mark and nothing says please."""
    pleads = _is_request(parts)
    return [
        part
        if not isinstance(part, ph.Ask) or part.query not in (None, "possible")
        else replace(part, query="possible")
        if not pleads and (part.query or sentence.question)
        else ph.Filler(part.span, False)
        for part in parts
    ]


def _asks_further(parts: Sequence[ph.Part]) -> bool:
    """Check for a question that goes on with the one before: "and the mug?"."""
    heads = any(isinstance(part, _HEADS) for part in parts)
    return not heads and any(isinstance(part, ph.Filler) and part.goes_on for part in parts)


def _with_topic_in_place(parts: Parts) -> Parts:
    """Takes "the box, push it away" for "push the box away", with what tells the box apart."""
    end = next((i for i, part in enumerate(parts) if isinstance(part, ph.Separator)), 0)
    match parts[:end], parts[end:]:
        case [ph.Thing(ref=ref), *told], [ph.Separator(word="," | "."), *rest]:
            row = (ph.Constraint, ph.Direction) if ref.ordinal else ()  # "from the right"
            for ask in rest:  # "the box, is it heavy?"
                if isinstance(ask, ph.Ask) and ask.thing and ask.thing.ref.pronoun and not told:
                    about = replace(ask, thing=replace(ask.thing, ref=ref))
                    return [about if part is ask else part for part in rest]
            it = next((p for p in rest if isinstance(p, ph.Thing) and p.ref.pronoun), None)
            if it is None or not all(isinstance(p, (*_TELLING, *row)) for p in told):
                return parts
            if told and isinstance(told[0], ph.Place):
                told = [ph.ThatIs(told[0].span), *told]
            topic = [replace(it, ref=ref), *told]
            return [p for part in rest for p in (topic if part is it else [part])]
    return parts


def _is_request(parts: Sequence[ph.Part]) -> bool:
    """Check for words that make a request of a question: please, could you, would you mind."""
    return any(isinstance(part, ph.Filler) and part.asks for part in parts)


def _unclear_question_error(sentence: Normalised) -> ParseError:
    span = len(sentence.original.rstrip()) - 1, len(sentence.original.rstrip())
    written = sentence.words_as_written((0, span[0])).rstrip("?! ")
    return ParseError(
        "unsupported_question",
        "with a question mark it is not clear whether this is to be done or to be answered",
        span,
        (f'to have it done: "{written}"', f'to ask: "can you {written}?"'),
    )


def _question_parts(parts: Parts, sentence: Normalised) -> Parts:
    """The parts of a question, which is about one action."""
    verbs = _heads(parts)
    asks = [part for part in parts if isinstance(part, ph.Ask)]
    actions = 0 if asks[0].query in ("value", "affordances") else 1
    asked = sentence.question or any(isinstance(part, ph.If) for part in parts)
    if verbs and asks[0].query == "predict" and asks[0].span > verbs[0].span and not asked:
        raise unexpected_part(asks[0], sentence)  # "push it, and see what happens"
    others = [ask for ask in asks[1:] if not _is_same_question(asks[0], ask)]
    extra: Parts = [*verbs[actions:], *others]
    if extra:
        raise sentence.error_at(
            extra[0].span,
            "unsupported_question",
            "asks about a second action; one at a time is answered",
            "ask one question for each action",
        )
    return _without_joints(parts)


def _is_same_question(first: ph.Ask, second: ph.Ask) -> bool:
    """Check for two parts of one question: "if you push it, what happens, will it topple"."""
    return first.query == second.query == "predict" and None in (first.event, second.event)
