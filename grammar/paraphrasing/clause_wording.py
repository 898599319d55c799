"""Quantities, goals and constraints in words that are read back as the same.

The words are the lexicon's own: of the phrases that mean the same the first, or any other that a
caller chooses.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from decimal import Decimal
from typing import Any, cast

from grammar.frames import command as g
from grammar.paraphrasing.object_wording import Naming, no_words

_WAYS = {0.25: "0.25", 0.5: "0.5", 0.75: "0.75", 1 / 3: "1/3", 2 / 3: "2/3", 1.0: "1"}
_COUNTS = ("one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
_TIMES = {0.25: "a quarter of ", 1 / 3: "a third of ", 0.5: "half ", 2 / 3: "two thirds of ",
          0.75: "three quarters of ", 1.0: "", 2.0: "twice "}  # fmt: skip
_TOUCHES = ("touching", "in_line", "next_to")


class Phrasing(Naming):
    """Says the parts of frames in the words of a lexicon."""

    # --- quantities ---------------------------------------------------------------------------

    def length_words(self, length: float | g.RelativeLength) -> str:
        """A length in centimetres, or in millimetres below one; exact, so that it is read back."""
        if isinstance(length, g.RelativeLength):
            return self._relative_length_words(length)
        metres = Decimal(repr(length))
        if metres < Decimal("0.01"):
            return f"{_plain_number(metres * 1000)} {self.phrase_for('LENGTH_UNIT', '0.001')}"
        return f"{_plain_number(metres * 100)} {self.phrase_for('LENGTH_UNIT', '0.01')}"

    def _relative_length_words(self, length: g.RelativeLength) -> str:
        times = _TIMES.get(length.value, f"{_plain_number(length.value)} times ")
        if length.side is None:
            raise no_words("lengths measured in objects without a side")
        if length.of.text == "its":
            return f"{times}its {length.side}"
        return f"{times}the {length.side} of {self.object_words(length.of)}"

    def angle_words(self, radians: float) -> str:
        """An angle in degrees, or in radians if only they are exact."""
        degrees = round(math.degrees(radians), 9)
        if math.radians(degrees) == radians:
            return f"{_plain_number(degrees)} {self.phrase_for('ANGLE_UNIT', 'degree')}"
        return f"{_plain_number(radians)} {self.phrase_for('ANGLE_UNIT', 'radian')}"

    def bound_words(self, bound: g.Bound) -> str:
        """A bound, with a space behind it."""
        return "" if bound == "exact" else f"{self.phrase_for('BOUND', bound)} "

    # --- goals --------------------------------------------------------------------------------

    def goal_words(self, goal: g.Goal) -> list[str]:
        """Words of a goal, each phrase on its own."""
        match goal:
            case g.Displace():
                return self._displace_words(goal)
            case g.Place():
                return self._place_words(goal)
            case g.Topple(direction=str(direction)):
                return [self.phrase_for("DIRECTION", direction)]
            case g.Tilt() | g.Rotate():
                return self._turn_words(goal)
            case g.Lift():
                return self._lift_words(goal)
            case g.Pour():
                into = [f"into {self.object_words(goal.into)}"] if goal.into else []
                return into if goal.fill is None else [*into, self._fill_words(goal.fill)]
            case g.Parameters(method=str(method)):
                return [self.phrase_for("METHOD", method)]
            case _:
                return []

    def portion_words(self, goal: g.Pour) -> str:
        """Words for how much is poured, with a space behind them."""
        if goal.volume is not None:
            millilitres = _plain_number(Decimal(repr(goal.volume)) * 1_000_000)
            return f"{millilitres} {self.phrase_for('VOLUME_UNIT', '0.000001')} of "
        if goal.amount is not None:
            return f"a {goal.amount if goal.amount == 'little' else 'lot'} of "
        if goal.fraction is None:
            return ""
        if goal.fraction not in _WAYS:
            raise no_words(f"a share of {goal.fraction}")
        return f"{self.phrase_for('PORTION', _WAYS[goal.fraction], ending='of')} "

    def _fill_words(self, share: float) -> str:
        until = f"{self.phrase_for('UNTIL')} it"
        if share in _WAYS:
            return f"{until} {self.phrase_for('IS_FULL', _WAYS[share])}"
        percent = _plain_number(Decimal(repr(share)) * 100)
        return f"{until} {self.phrase_for('IS_AT')} {percent} {self.phrase_for('PERCENT')}"

    def _way_words(self, share: float | None) -> list[str]:
        if share is None:
            return []
        ways = {**_WAYS, 2.0: "2"}
        if share not in ways:
            raise no_words(f"a share of {share} of the way")
        return [self.phrase_for("WAY", ways[share])]

    def _amount_words(self, amount: g.Amount | None) -> list[str]:
        return [self.phrase_for("AMOUNT", amount)] if amount else []

    def _lift_words(self, goal: g.Lift) -> list[str]:
        if goal.height is None:
            return self._amount_words(goal.amount)
        length = f"{self.bound_words(goal.bound)}{self.length_words(goal.height)}"
        if goal.above is None:
            return [f"by {length}"]
        return [f"{length} {self.phrase_for('HEIGHT_REFERENCE', goal.above)}"]

    def _turn_words(self, goal: g.Tilt | g.Rotate) -> list[str]:
        words = self._orientation_words(goal) if isinstance(goal, g.Rotate) else []
        if isinstance(goal, g.Rotate) and goal.sense:
            words.append(self.phrase_for("SENSE", goal.sense))
        if isinstance(goal, g.Tilt) and goal.direction:
            words.append(self.phrase_for("DIRECTION", goal.direction))
        if goal.angle is not None:
            words.append(f"by {self.bound_words(goal.bound)}{self.angle_words(goal.angle)}")
        return words + self._amount_words(goal.amount)

    def _orientation_words(self, goal: g.Rotate) -> list[str]:
        words = []
        for said, thing, place in (
            (goal.facing, "FACING", "FACING_WAY"),
            (goal.parallel_to, "PARALLEL", "PARALLEL_EDGE"),
        ):
            if isinstance(said, g.ObjectRef):
                words.append(f"{self.phrase_for(thing)} {self.object_words(said)}")
            elif said is not None:
                words.append(self.phrase_for(place, said))
        return words

    def _displace_words(self, goal: g.Displace) -> list[str]:
        words = self._way_words(goal.fraction)
        if goal.direction is not None:
            pair = (goal.direction,) if isinstance(goal.direction, str) else goal.direction
            words.append(" and ".join(self.phrase_for("DIRECTION", part) for part in pair))
        if goal.heading is not None:
            words.append(f"{self.phrase_for('HEADING')} {self.angle_words(goal.heading)}")
        if isinstance(goal.toward, str):
            words.append(self.phrase_for("TOWARD_REGION", goal.toward))
        elif goal.toward is not None:
            words.append(f"{self.phrase_for('TOWARD')} {self.object_words(goal.toward)}")
        if isinstance(goal.away_from, str):
            words.append(self.phrase_for("AWAY_FROM_REGION", goal.away_from))
        elif goal.away_from is not None:
            away = self.phrase_for("RELATION", "away_from")
            words.append(f"{away} {self.object_words(goal.away_from)}")
        if goal.distance is not None:
            words.append(f"by {self.bound_words(goal.bound)}{self.length_words(goal.distance)}")
        return words + self._amount_words(goal.amount)

    def _place_words(self, goal: g.Place) -> list[str]:
        words = self._way_words(goal.fraction)
        match goal.reference:
            case g.Point(x=x, y=y):
                words.append(f"to x {_plain_number(x)} y {_plain_number(y)}")
            case str():
                if goal.relation == "clear_of":
                    words.append(self.phrase_for("OUT_OF_REGION", goal.reference))
                elif goal.relation == "over":
                    words.append(self.phrase_for("OVER_REGION", goal.reference))
                    if goal.distance is not None:
                        words.append(f"by {self.length_words(goal.distance)}")
                elif goal.distance is not None:
                    words.append(self.length_words(goal.distance))
                    words.append(self.phrase_for("FROM_REGION", goal.reference))
                else:
                    words.append(self.phrase_for("REGION_OF_TABLE", goal.reference))
            case _:
                if goal.distance is not None:
                    words.append(self.length_words(goal.distance))
                if goal.reference:
                    words.append(self._relation_words(goal.relation, goal.reference))
                else:
                    words.append(self.phrase_for("MUTUAL", goal.relation))
        return words

    # --- constraints --------------------------------------------------------------------------

    def manner_words(self, constraint: g.Constraint) -> str | None:
        """Gently, hard, slowly, quickly; None for anything else."""
        said = constraint.words.terminal == "MANNER"
        return self.phrase_for("MANNER", constraint.kind) if said else None

    def constraint_words(
        self, constraints: Sequence[g.Constraint], *, directed: bool, of_object: bool = False
    ) -> list[str]:
        """Everything that must hold on the way.

        Where "in the middle" would tell the object apart, `of_object` asks for "at its middle".
        """
        words: list[str] = []
        listed = False
        for constraint in constraints:
            avoided = constraint.words.terminal == "AVOIDING"
            if isinstance(constraint, g.ContactRegion):
                words.append(self._contact_words(constraint, directed, of_object))
            elif avoided:
                doing = self.phrase_for("AVOIDING", constraint.kind)
                words.append(f"{'or' if listed else self.phrase_for('WITHOUT')} {doing} it")
            else:
                words.append(self._one_constraint_words(constraint))
            listed = avoided
        return words

    def _one_constraint_words(self, constraint: g.Constraint) -> str:
        if manner := self.manner_words(constraint):
            return manner
        match constraint:
            case g.NoTouch():
                return self._no_touch_words(constraint)
            case g.Effector():
                return _effector_words(constraint)
            case g.Until():
                return self._until_words(constraint)
            case _:
                words, value = constraint.words, cast(Any, constraint).value
                return words.phrase.format(self._value_words(value, words.unit))

    def _value_words(self, value: float, unit: str) -> str:
        if unit == "m":
            return self.length_words(value)
        return self.angle_words(value) if unit == "rad" else f"{_plain_number(value)} {unit}"

    def _no_touch_words(self, clause: g.NoTouch) -> str:
        if clause.clearance is not None and clause.object is not None:
            if clause.clearance == 0.0:
                raise no_words("a clearance of nothing")
            clearance = self.length_words(clause.clearance)
            return f"keeping {clearance} away from {self.object_words(clause.object)}"
        touching = f"{self.phrase_for('WITHOUT')} {self.phrase_for('TOUCHING')}"
        if clause.object is None:
            return f"{touching} {self.phrase_for('ANYTHING')}"
        return f"{touching} {self.object_words(clause.object)}"

    def _until_words(self, clause: g.Until) -> str:
        until = f"{self.phrase_for('UNTIL')} it"
        if clause.event in _TOUCHES:
            if clause.object is None:
                raise no_words(f"an event {clause.event} without an object")
            touches = self.phrase_for("TOUCHES", clause.event)
            return f"{until} {touches} {self.object_words(clause.object)}"
        if clause.event == "edge":
            return f"{until} {self.phrase_for('REACHES_EDGE', 'edge')}"
        return f"{until} {self.phrase_for('EVENT', clause.event)}"

    def _contact_words(self, contact: g.ContactRegion, directed: bool, of_object: bool) -> str:
        # "From the left" also means "to the right" unless a direction is said; keep it for then.
        words = []
        if contact.region:
            words.append(self.phrase_for("REGION", contact.region, of_object=of_object))
        if contact.height:
            words.append(self._height_words(contact.height))
        if contact.face:
            from_side = directed and contact.face != "top"
            terminal = "FROM_SIDE" if from_side else "FACE"
            words.append(self.phrase_for(terminal, contact.face, of_object=of_object))
        return " ".join(words)

    def _height_words(self, height: g.ContactHeight) -> str:
        value = f"{self.bound_words(height.bound)}{self.length_words(height.value)}"
        if not isinstance(height.value, g.RelativeLength):
            reference = self.phrase_for("HEIGHT_REFERENCE", height.origin)
            if height.bound == "exact":
                return f"at {value} {reference}"
            if height.origin == "top":
                return f"{value} {reference}"
            bound = self.phrase_for("HEIGHT_BOUND", height.bound)
            return f"{bound} {self.length_words(height.value)} {reference}"
        if height.origin == "top":
            raise no_words("a height below the top measured in objects")
        return f"at {value}"


def _effector_words(effector: g.Effector) -> str:
    if (effector.count or 1) > len(_COUNTS):
        raise no_words(f"{effector.count} {effector.tool}s")
    count = "your" if effector.count is None else _COUNTS[effector.count - 1]
    plural = "s" if (effector.count or 1) > 1 else ""
    words = ("with", count, effector.side or "", effector.tool + plural)
    return " ".join(word for word in words if word)


def _plain_number(value: float | Decimal) -> str:
    text = f"{Decimal(repr(value)) if isinstance(value, float) else value:f}"
    return re.sub(r"\.?0+$", "", text) if "." in text else text
