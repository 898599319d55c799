"""Random sentences of the language with the frames that they mean, for those who extend it.

A frame is drawn first, then said: with each phrase picked from all those of the lexicon that mean
the same. So a sentence and its frames are known before any parser has seen them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from random import Random
from typing import Any, NamedTuple, TypeVar, cast, get_args

from grammar.clauses.consistency import first_contradiction
from grammar.clauses.object_descriptions import SIDES_COUNTED_FROM
from grammar.frames import command as g
from grammar.frames.constraints import CONSTRAINTS, new_constraint
from grammar.frames.vocabulary import Unit
from grammar.paraphrasing.command_wording import is_misread, paraphrase
from grammar.words.lexicon import Lexicon, default_lexicon

T = TypeVar("T")

NOUNS = ("box", "mug", "ice tea box", "soup can", "jar", "tea tin", "bottle", "block")
_DIRECTIONS: tuple[g.Direction, ...] = get_args(g.Direction)
_RELATIONS: tuple[g.Relation, ...] = (
    "next_to", "left_of", "right_of", "in_front_of", "behind", "touching", "on",
)  # fmt: skip
_GAPS = ("next_to", "left_of", "right_of", "in_front_of", "behind")
_REGIONS: tuple[g.TableRegion, ...] = get_args(g.TableRegion)
_FRACTIONS = (0.25, 0.5, 0.75, 1 / 3, 2 / 3)
_PROPERTIES = ("mass", "friction", "height", "width", "length", "size", "centre_of_mass",
               "fill")  # fmt: skip
_SHIFTING = ("push", "pull", "move", "slide")
_OF_SEVERAL = (*_SHIFTING, "turn", "tilt", "topple", "lift", "place")
_RANKED: tuple[g.Quality, ...] = ("left", "right", "near", "far", "tall", "small", "heavy", "wide")


class Sample(NamedTuple):
    """A sentence, and the frames that it means."""

    text: str
    frames: tuple[g.Frame, ...]


def random_sentences(
    seed: int = 0, *, lexicon: Lexicon | None = None, nouns: Sequence[str] = NOUNS
) -> Iterator[Sample]:
    """Yields random sentences with their frames, without end, about objects with these nouns.

    The same seed gives the same sentences.
    """
    sampler = Sampler(Random(seed), lexicon=lexicon, nouns=nouns)
    while True:
        yield sampler.draw_sentence()


class Sampler:
    """Draws frames about objects with some nouns, and says them in the words of a lexicon."""

    def __init__(
        self, rng: Random, *, lexicon: Lexicon | None = None, nouns: Sequence[str] = NOUNS
    ) -> None:
        self._rng = rng
        self._lexicon = default_lexicon() if lexicon is None else lexicon
        self._nouns = nouns

    def draw_sentence(self) -> Sample:
        """A sentence and its frames."""
        vague = [f" {phrase}" for phrase in self._lexicon.vague if " " in phrase]
        while True:
            frames = self._draw_frames()
            text = paraphrase(frames, self._lexicon, self._rng.choice)
            # "Too" and "far" may have met by chance, or "left" and "left".
            met = any(phrase in text for phrase in vague)
            if not (met or is_misread(text, frames, self._lexicon)):
                return Sample(text, frames)

    def _draw_frames(self) -> tuple[g.Frame, ...]:
        """One frame, or two commands."""
        first = self.draw_frame()
        second = self.draw_frame() if self._rng.random() < 0.2 else first
        # Of "take the lid off it, then put it on the mug" the lid is put there.
        lid = isinstance(first.goal, g.Open | g.Close) and first.goal.part
        alone = second is first or lid or any(f.query or f.dialogue for f in (first, second))
        return (first,) if alone else (first, second)

    def draw_frame(self) -> g.Frame:
        """A frame that does not contradict itself."""
        while True:
            kind = self._rng.random()
            asked = self._draw_question if kind < 0.85 else self._draw_remark
            frame = self._draw_command() if kind < 0.6 else asked()
            if first_contradiction(frame) is None:
                return frame

    # --- choices ------------------------------------------------------------------------------

    def _draw_perhaps(self, draw: Callable[[], T], chance: float = 0.5) -> T | None:
        return draw() if self._rng.random() < chance else None

    def _pick(self, options: Sequence[T]) -> T:
        return self._rng.choice(options)

    def _draw_length(self) -> float:
        return self._rng.randint(1, 300) / self._pick((1000, 100))

    def _draw_angle(self) -> float:
        return math.radians(self._rng.randint(1, 360))

    def _draw_bound(self) -> g.Bound:
        return self._pick(("exact", "exact", "at_least", "at_most"))

    def _draw_measure(self) -> float | g.RelativeLength:
        if self._rng.random() < 0.7:
            return self._draw_length()
        its = g.ObjectRef(text="its", pronoun=True)
        of = its if self._rng.random() < 0.6 else self._draw_thing()
        side = self._pick(("width", "height", "length"))
        return g.RelativeLength(value=self._rng.randint(1, 8) / 2, of=of, side=side)

    # --- objects ------------------------------------------------------------------------------

    def _draw_thing(self) -> g.ObjectRef:
        """A thing by its name, perhaps with an adjective."""
        noun = self._pick(self._nouns)
        adjective = self._draw_perhaps(lambda: self._pick(sorted(self._lexicon.adjectives)), 0.3)
        if adjective is None:
            return g.ObjectRef(text=noun)
        quality = self._lexicon.adjectives[adjective]
        return g.ObjectRef(text=f"{adjective} {noun}", qualities=(quality,), noun=noun)

    def _draw_other(self, thing: g.ObjectRef) -> g.ObjectRef:
        """A thing of another name."""
        while (other := self._draw_thing()).text == thing.text:
            pass
        return other

    def _draw_counted(self) -> g.ObjectRef:
        """Which of a row: "the third box from the left", "the second tallest box"."""
        noun, quality = self._pick(self._nouns), self._pick(_RANKED)
        said = {word for word, meant in self._lexicon.adjectives.items() if meant == quality}
        told = noun if quality in SIDES_COUNTED_FROM else f"{self._pick(sorted(said))} {noun}"
        ordinals = sorted(self._lexicon.numbers.ordinals.values())
        return g.ObjectRef(text=told, qualities=(quality,), noun=noun, ordinal=self._pick(ordinals))

    def _draw_several(self) -> g.ObjectRef:
        """Some of several: "all the boxes except for the red box and the mug"."""
        noun, quantifier = self._pick(self._nouns), self._pick(get_args(g.Quantifier))
        plural = f"{noun}es" if noun.endswith(("s", "x", "ch", "sh")) else f"{noun}s"
        one = quantifier in ("all", "any") and self._rng.random() < 0.5
        few = self._pick((0, 0, 1, 2)) if quantifier in ("all", "rest") else 0
        return g.ObjectRef(
            text=noun if one else plural,
            noun=noun,
            quantifier=quantifier,
            exceptions=tuple(self._draw_thing() for _ in range(few)),
        )

    def _draw_object(self) -> g.ObjectRef:
        if self._rng.random() < 0.2:
            return g.ObjectRef(text="it", pronoun=True)
        ref = self._draw_counted() if self._rng.random() < 0.1 else self._draw_thing()
        if self._rng.random() < 0.85:
            return ref
        relation = self._pick(_RELATIONS)
        return ref.model_copy(update={"relation": relation, "reference": (self._draw_thing(),)})

    # --- goals --------------------------------------------------------------------------------

    def _draw_displace(self) -> g.Displace:
        where: dict[str, Any] = {}
        match self._rng.randint(0, 7):
            case 0 | 1 | 2:
                where["direction"] = self._pick(_DIRECTIONS)
            case 3:
                where["direction"] = (self._pick(("away", "toward")), self._pick(("left", "right")))
            case 4:
                where["heading"] = self._draw_angle()
            case 5:
                where["toward"] = self._pick((self._draw_thing(), "edge", "left_edge"))
            case 6:
                where["away_from"] = self._pick((self._draw_thing(), "edge", "right_edge"))
            case _:
                pass
        if isinstance(where.get("toward"), g.ObjectRef) and self._rng.random() < 0.3:
            return g.Displace(**where, fraction=self._pick(_FRACTIONS))
        if self._rng.random() < 0.5:
            return g.Displace(**where, distance=self._draw_measure(), bound=self._draw_bound())
        return g.Displace(**where, amount=self._pick((None, "little", "lot")))

    def _draw_place(self) -> g.Place:
        match self._rng.randint(0, 5):
            case 0:
                x, y = (self._rng.randint(-90, 90) / 100 for _ in range(2))
                return g.Place(relation="at", reference=g.Point(x=x, y=y))
            case 1:
                region = self._pick(_REGIONS)
                if region.endswith("edge") and self._rng.random() < 0.3:
                    hangs = self._draw_perhaps(self._draw_length)
                    return g.Place(relation="over", reference=region, distance=hangs)
                fraction = self._draw_perhaps(lambda: self._pick(_FRACTIONS), 0.2)
                return g.Place(relation="at", reference=region, fraction=fraction)
            case 2:
                first = self._draw_thing()
                things = (first, self._draw_other(first))
                return g.Place(relation="between", reference=things)
            case _:
                relation = self._pick(_RELATIONS)
                gap = self._draw_perhaps(self._draw_length, 0.3) if relation in _GAPS else None
                return g.Place(relation=relation, reference=(self._draw_thing(),), distance=gap)

    def _draw_goal(self, action: str) -> g.Goal:
        if action in _SHIFTING:
            return self._draw_displace() if self._rng.random() < 0.7 else self._draw_place()
        amount: g.Amount | None = self._pick((None, None, "little", "lot"))
        angle = self._draw_perhaps(self._draw_angle) if amount is None else None
        bound = self._draw_bound() if angle is not None else "exact"
        match action:
            case "turn":
                sense: g.Sense | None = self._pick((None, "cw", "ccw"))
                return g.Rotate(angle=angle, sense=sense, bound=bound, amount=amount)
            case "tilt":
                way = self._draw_perhaps(lambda: self._pick(_DIRECTIONS))
                return g.Tilt(angle=angle, direction=way, bound=bound, amount=amount)
            case "topple":
                return g.Topple(direction=self._draw_perhaps(lambda: self._pick(_DIRECTIONS)))
            case "lift":
                if angle is None:
                    return g.Lift(amount=amount)
                return g.Lift(height=self._draw_measure(), bound=bound)
            case "place":
                if self._rng.random() < 0.6:
                    return self._draw_place()
                return g.Upright() if self._rng.random() < 0.5 else g.SetDown()
            case "pour":
                return self._draw_pour()
            case "open" | "close":
                part = self._draw_perhaps(lambda: self._pick(sorted(self._lexicon.lids)))
                return g.Open(part=part) if action == "open" else g.Close(part=part)
            case "hand_over":
                return g.HandOver()
            case _:
                which = self._draw_perhaps(lambda: (self._pick(_PROPERTIES),), 0.7)
                method: g.Method | None = self._pick((None, None, "lift", "tilt"))
                return g.Parameters(which=which or (), method=method)

    def _draw_pour(self) -> g.Pour:
        """Everything, or so much of it; or until what it is poured into is so full."""
        how_much: dict[str, Any] = self._pick(
            (
                {},
                {"amount": self._pick(("little", "lot"))},
                {"fraction": self._pick((*_FRACTIONS, 1.0))},
                {"volume": float(Decimal(self._rng.randint(1, 2000)) / 1_000_000)},
                {"fill": self._pick((*_FRACTIONS, 1.0, self._rng.randint(1, 100) / 100))},
            )
        )
        fills = "fill" in how_much
        into = self._draw_thing() if fills else self._draw_perhaps(self._draw_thing, 0.8)
        return g.Pour(into=into, **how_much)

    # --- constraints --------------------------------------------------------------------------

    def _draw_constraints(self) -> tuple[g.Constraint, ...]:
        kinds = self._rng.sample([*CONSTRAINTS], self._pick((0, 0, 1, 1, 2, 3)))
        # "Without tilting it without tilting it more than 5 degrees" says one thing, with a slip.
        forbidden = {CONSTRAINTS[kind].words.limit for kind in kinds}
        return tuple(self._draw_constraint(kind) for kind in kinds if kind not in forbidden)

    def _draw_constraint(self, kind: str) -> g.Constraint:
        unit = CONSTRAINTS[kind].words.unit
        match kind:
            case "no_touch":
                return self._draw_no_touch()
            case "contact":
                return self._draw_contact()
            case "effector":
                return self._draw_effector()
            case "until":
                return self._draw_until()
        return new_constraint(kind, **({"value": self._draw_value(unit)} if unit else {}))

    def _draw_value(self, unit: Unit) -> float:
        match unit:
            case "rad":
                return self._draw_angle()
            case "N":
                return self._rng.randint(1, 200) / 10
            case "m/s":
                return self._rng.randint(1, 50) / 100
            case "s":
                return float(self._rng.randint(1, 20))
        return self._draw_length()

    def _draw_no_touch(self) -> g.NoTouch:
        if self._rng.random() < 0.2:
            return g.NoTouch(object=None)
        other = self._draw_thing()
        return g.NoTouch(object=other, clearance=self._draw_perhaps(self._draw_length, 0.4))

    def _draw_contact(self) -> g.ContactRegion:
        face = self._draw_perhaps(lambda: self._pick(("front", "back", "left", "right", "top")))
        region = self._draw_perhaps(lambda: self._pick(("top", "middle", "bottom")))
        if region is None and self._rng.random() < 0.5:
            value, origin = self._draw_length(), self._pick(("table", "top"))
            height = g.ContactHeight(value=value, origin=origin, bound=self._draw_bound())
            return g.ContactRegion(face=face, height=height)
        return g.ContactRegion(face=face or (None if region else "front"), region=region)

    def _draw_effector(self) -> g.Effector:
        tool, count = self._pick((("finger", None), ("finger", 1), ("finger", 2), ("hand", None)))
        side = self._draw_perhaps(lambda: self._pick(("left", "right"))) if count is None else None
        return g.Effector.model_validate({"tool": tool, "count": count, "side": side})

    def _draw_until(self) -> g.Until:
        event = self._pick(("touching", "in_line", "next_to", "edge", "about_to_tip", "tips",
                            "moves"))  # fmt: skip
        named = event in ("touching", "in_line", "next_to")
        other = self._draw_thing() if named else None
        return g.Until.model_validate({"event": event, "object": other})

    # --- frames -------------------------------------------------------------------------------

    def _draw_command(self) -> g.Frame:
        action = self._pick((*_SHIFTING, *_SHIFTING, "turn", "tilt", "topple", "lift", "place",
                             "open", "close", "pour", "explore", "hand_over"))  # fmt: skip
        several = action in _OF_SEVERAL and self._rng.random() < 0.15
        thing = self._draw_several() if several else self._draw_object()
        goal, constraints = self._draw_goal(action), self._draw_constraints()
        return g.Frame(action=cast(Any, action), object=thing, goal=goal, constraints=constraints)

    def _draw_handling(self) -> g.Frame:
        """A command about one object that does more than find something out."""
        while True:
            frame = self._draw_command()
            several = frame.object is not None and frame.object.quantifier
            if not (several or isinstance(frame.goal, g.Parameters)):
                return frame

    def _draw_question(self) -> g.Frame:
        query = self._pick(get_args(g.Query))
        if query == "value" and self._rng.random() < 0.3:
            thing = self._draw_thing()
            other = (self._draw_other(thing),)
            place = g.Place(relation="behind", reference=other)
            apart = g.Parameters(which=("distance",), than=other)
            state = self._pick((g.Upright(), g.SetDown(), place, apart))
            return g.Frame(query="value", object=thing, goal=state)
        if query == "value":
            goal = g.Parameters(which=(self._pick(_PROPERTIES),))
            return g.Frame(query="value", object=self._draw_object(), goal=goal)
        if query in ("did", "seen"):
            return g.Frame.model_validate({"query": query})
        if query == "compare":
            than, which = (self._draw_thing(),), (self._pick(("mass", "height", "width", "size")),)
            goal = g.Parameters(which=which, than=than)
            return g.Frame(query="compare", object=self._draw_thing(), goal=goal)
        if query == "capable":
            return g.Frame(query="capable", action="topple", goal=self._draw_goal("topple"))
        if query == "affordances":
            return g.Frame(query="affordances", object=self._draw_object())
        if query == "why" and self._rng.random() < 0.5:
            return g.Frame(query="why")
        frame = self._draw_handling()
        events: list[g.Event | None] = [None, "slides", "tips", "tilts", "turns", "moves"]
        if query == "predict":
            events += ["spills", "holds"]
        asked = query in ("predict", "how_hard", "where")
        event = self._pick(events) if asked else None
        stops = query in ("how_hard", "where")
        kept = tuple(c for c in frame.constraints if not (stops and isinstance(c, g.Until)))
        negated = query == "why" and self._rng.random() < 0.5
        update = {"query": query, "event": event, "constraints": kept, "negated": negated}
        return frame.model_copy(update=update)

    def _draw_remark(self) -> g.Frame:
        dialogue = self._pick(("undo", "stop", "repeat", "more", "correct"))
        match dialogue:
            case "undo" | "stop":
                return g.Frame.model_validate({"dialogue": dialogue})
            case "correct":
                said = self._pick(("object", "goal", "command"))
                if said == "command":
                    return self._draw_handling().model_copy(update={"dialogue": "correct"})
                if said == "object":
                    return g.Frame(dialogue="correct", object=self._draw_thing())
                return g.Frame(dialogue="correct", goal=self._draw_said_displace())
            case _:
                goal: g.Goal = (
                    g.NoGoal() if self._rng.random() < 0.3 else self._draw_said_displace()
                )
                return g.Frame.model_validate({"dialogue": dialogue, "goal": goal})

    def _draw_said_displace(self) -> g.Displace:
        """Somewhere; a direction, a distance or an amount is always said."""
        while (goal := self._draw_displace()) == g.Displace():
            pass
        return goal
