"""Documents of a session as a language model reads them: the decisive part of each.

A result has 8 to 13 kB; here are its outcome, the figures that decided and the verdicts.
Numbers are in SI units, places in W.
"""

from __future__ import annotations

from functools import singledispatch
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

from nlcontrol.mcp.tool_answers import ToolAnswer, error_answer
from nlcontrol.plan_text import deciding_figures, plan_lines
from nlcontrol.questions.push_prediction import PushPrediction
from nlcontrol.results.result import Result
from nlcontrol.service.documents import Affordances, Offer, RunInfo, TableView
from nlcontrol.text_format import quantity, words

if TYPE_CHECKING:
    from nlcontrol.checks.verdicts import Check
    from planner.affordances import Affordance


@singledispatch
def document_answer(document: BaseModel, detail: bool) -> ToolAnswer:
    """The decisive part of a document: its text, and numbers if it has any.

    Args:
        document: that answers a question.
        detail: the whole of it is wanted too.
    """
    content = document.model_dump(mode="json")
    simple = (str, int, float, bool)
    return ToolAnswer(
        ok=True,
        status="answered",
        message=content.pop("text", "") or "the answer stands in its facts",
        facts={name: value for name, value in content.items() if isinstance(value, simple)},
        document=content if detail else None,
    )


@document_answer.register
def _table_answer(view: TableView, detail: bool) -> ToolAnswer:
    """The table as it is believed to be."""
    figures = {"mass", "mass_sd", "friction", "friction_sd"}  # for which there are questions
    seen = [
        item.model_dump(mode="json", exclude_defaults=True, exclude=figures)
        for item in view.objects
    ]
    names = ", ".join(item.name for item in view.objects)
    holds = f"; the hand holds the {view.held}" if view.held else ""
    known = "seen by the camera" if view.source == "camera" else "stated by the caller"
    return ToolAnswer(
        ok=True,
        status="seen",
        message=f"{len(seen)} objects, {known}: {names}{holds}.",
        facts={"source": view.source, "time": view.time},
        from_others=[*seen, *([{"held": view.held}] if view.held else [])],
        document=view.model_dump(mode="json") if detail else None,
    )


@document_answer.register
def _offer_answer(offer: Offer, detail: bool) -> ToolAnswer:
    """A plan that waits to be approved, or the reason why there is none."""
    changes = {"plan_id": offer.plan_id, "expires_in": offer.expires_in}
    return _result_answer(offer.result, detail).model_copy(update=changes)


def run_answer(info: RunInfo, detail: bool) -> ToolAnswer:
    """The outcome of a run so far."""
    if info.result is not None:
        return _result_answer(info.result, detail).model_copy(update={"run_id": info.run_id})
    if info.error is not None:
        return error_answer(info.error).model_copy(
            update={"status": info.state, "run_id": info.run_id}
        )
    return ToolAnswer(
        ok=True,
        status=info.state,
        run_id=info.run_id,
        message="it is on its way; there is no verdict yet",
    )


@document_answer.register
def _result_answer(result: Result, detail: bool) -> ToolAnswer:
    """The outcome of a sentence."""
    answer = _outcome(result)
    return answer.model_copy(
        update={
            "ok": result.ok,
            "status": result.status,
            "understood": result.paraphrase,
            "without": list(result.left_out),
            "verdicts": [_verdict(check, result.text) for check in result.checks],
            "notes": [
                *result.notes,
                *(learnt.text for step in result.steps for learnt in step.lessons),
            ],
            "facts": answer.facts | _execution_facts(result),
            "document": result.model_dump(mode="json", exclude_none=True) if detail else None,
        }
    )


def _lessons(result: Result) -> list[str]:
    return [learnt.text for step in result.steps for learnt in step.lessons]


def _outcome(result: Result) -> ToolAnswer:
    """The sentence and the figures that matter most: an error, an answer, verdicts or a plan."""
    if result.error is not None:
        return error_answer(result.error)
    answer = ToolAnswer(ok=result.ok, status=result.status)
    if result.answer is not None:
        told = result.answer
        return answer.model_copy(
            update={
                "message": " ".join([told.text, *told.lines[:8]]),
                "numbers": told.numbers,
                "probability": told.probability,
                "suggestions": list(told.suggestions),
            }
        )
    if result.checks:
        held = sum(check.ok for check in result.checks)
        message = f"{held} of {len(result.checks)} clauses held"
        return answer.model_copy(update={"message": f"{message}: {result.paraphrase}"})
    if result.plan is not None:
        return answer.model_copy(
            update={
                "message": " ".join(map(str.strip, plan_lines(result.plan))).removeprefix("Plan: "),
                "numbers": deciding_figures(result.plan),
                "probability": result.plan.probability,
            }
        )
    return answer.model_copy(update={"message": " ".join(result.notes) or "nothing is to be done"})


def _verdict(check: Check, text: str) -> dict[str, Any]:
    """A clause with what was asked and what was measured."""
    fields = check.model_dump(mode="json", exclude={"spans"}, exclude_none=True)
    fields["asked"] = fields.pop("expected")
    return {**fields, "words": words(text, check.spans)} if check.spans else fields


def _execution_facts(result: Result) -> dict[str, Any]:
    """The trace in a few numbers, and what the sentence left open."""
    facts: dict[str, Any] = {}
    if result.execution is not None:
        facts["execution"] = result.execution.model_dump(mode="json", exclude_none=True)
    if result.defaults:
        facts["defaults"] = [default.model_dump(mode="json") for default in result.defaults]
    return facts


@document_answer.register
def _prediction_answer(prediction: PushPrediction, detail: bool) -> ToolAnswer:
    """The prediction of one push."""
    numbers = {
        name: value
        for name in ("onset", "slide", "topple", "slide_sd", "topple_sd")
        if (value := getattr(prediction, name)) is not None
    }
    return ToolAnswer(
        ok=True,
        status="predicted",
        message=prediction.text,
        numbers=numbers,
        facts={
            "outcome": prediction.outcome,
            "nominal": prediction.nominal,
            "probability": prediction.probability,
        },
        document=prediction.model_dump(mode="json") if detail else None,
    )


@document_answer.register
def _affordances_answer(found: Affordances, detail: bool) -> ToolAnswer:
    """Outcomes that the robot can bring about with an object; for the others, why not."""
    can = [each for each in found.affordances if each.can]
    outcomes = dict.fromkeys(f"{each.outcome} {each.direction}".strip() for each in can)
    return ToolAnswer(
        ok=True,
        status="answered",
        message=f"the robot can: {', '.join(outcomes) or 'nothing'}",
        facts={
            "can": [_affordance_text(each) for each in can],
            "cannot": [
                f"{each.outcome} {each.direction}: {each.message}"
                for each in found.affordances
                if not each.can
            ],
        },
        document=found.model_dump(mode="json") if detail else None,
    )


def _affordance_text(found: Affordance) -> str:
    said = f"{found.outcome} {found.direction}".strip()
    if found.least_force is None:
        return said
    return f"{said}, from the {found.face}, with {quantity(found.least_force, 'N')} at least"
