"""Refusals since the hand does not get there, by the first obstacle that stands in its way."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Any

from planner.refusals.refusal_builder import no_plan
from planner.types.refusal import NoPlanError

if TYPE_CHECKING:
    from planner.types.robot import ReachAnswer


def no_push_reached(
    name: str, answers: Sequence[ReachAnswer], spared: Collection[str]
) -> NoPlanError:
    """Dead end since contacts exist on an object, but the hand gets to none of them."""
    last, words = _obstacle(answers, spared, object=name)
    numbers = {"ways": float(len(answers)), **last.numbers}
    return no_plan(_code(words, "pushes_blocked", "no_push_reached"), numbers, **words)


def search_given_up(
    name: str, answers: Sequence[ReachAnswer], spared: Collection[str]
) -> NoPlanError:
    """Dead end since the search ended before the hand could make a whole way."""
    failed = [answer for answer in answers if not answer.ok]
    _, words = _obstacle(failed, spared, object=name)
    numbers = {"looks": float(len(answers)), "out_of_reach": float(len(failed))}
    code = "search_blocked" if words["blocker"] else "search_given_up"
    return NoPlanError(no_plan(code, numbers, **words).refusal, ends_search=True)


def no_grasp_reached(
    doing: str, name: str, answers: Sequence[ReachAnswer], spared: Collection[str], *, held: bool
) -> NoPlanError:
    """Dead end since there are ways with a whole hand, but it cannot make them."""
    last, words = _obstacle(answers, spared, object=name, doing=doing)
    code = _code(words, "grasps_blocked", "no_grasp_reached")
    if held:
        code = _code(words, "blocked_in_hand", "no_reach_in_hand")
    one = len(answers) == 1
    return no_plan(
        code,
        {"ways": float(len(answers)), **last.numbers},
        are="is" if one else "are",
        number="one way" if one else f"{len(answers)} ways",
        **words,
    )


def _code(words: dict[str, Any], blocked: str, beyond: str) -> str:
    return blocked if words["blocker"] else "no_way_past" if words["other"] else beyond


def _obstacle(
    answers: Sequence[ReachAnswer], spared: Collection[str], **words: Any
) -> tuple[ReachAnswer, dict[str, Any]]:
    """The first answer that names an obstacle, else the nearest miss; and the words of a refusal.

    What is spared stays where it is, since the sentence tells a place by it: that it is met, as
    `other`, is no more than that no way was found past it.
    """
    met = [each for each in answers if each.reason == "obstacle" and each.blocker]
    found = next((each for each in met if each.blocker not in spared), None)
    last = found or min(answers, key=lambda each: each.numbers.get("lacks", 0.0))
    other = met[0].blocker if met and not found else None
    return last, {**words, "last": last.message, "blocker": found and found.blocker, "other": other}
