"""Plans as they were printed before they became a list of actions, from plans as they are now.

It shows that the new form says all that the old one said. Documents that hold plans (results and
their steps) are converted wherever a plan stands in them.
"""

from __future__ import annotations

from typing import Any

Document = dict[str, Any]

_PREDICTED = (
    "holds", "poured", "received", "spilled", "left", "level_after", "lid_force", "nearest_angle",
    "nearest_force", "slide_force", "topple_force", "lifting_force", "lid_torque",
    "turning_torque", "lid_angle",
)  # fmt: skip
_COMMON = ("status", "aim", "probability", "defaults", "considered", "satisfying", "notes")
_OF_A_MOVE = ("prediction", "margins", "displacement")


def old_document(doc: Any) -> Any:
    """A document with every plan in it as it was printed before."""
    if isinstance(doc, list):
        return [old_document(each) for each in doc]
    if not isinstance(doc, dict):
        return doc
    if doc.get("status") == "planned" and "actions" in doc:
        return _old_pushes(doc) if doc["actions"][0]["kind"] == "push" else _old_handling(doc)
    return {key: old_document(value) for key, value in doc.items()}


def _old_pushes(plan: Document) -> Document:
    first, *later = map(_old_move, plan["actions"])
    assert plan["committed"] == 1
    assert all(move.pop("displacement") is None for move in later)
    return {key: plan[key] for key in _COMMON} | first | {"later": later}


def _old_move(action: Document) -> Document:
    push = {k: v for k, v in action.items() if k not in ("kind", *_OF_A_MOVE)}
    return {"push": push} | {key: action[key] for key in _OF_A_MOVE}


def _old_handling(plan: Document) -> Document:
    steps = [dict(action) for action in plan["actions"]]
    assert plan["committed"] == len(steps)
    predicted = dict.fromkeys(_PREDICTED)
    for step in steps:
        predicted |= step.pop("prediction", None) or {}
    grasp = steps.pop(0) if steps[0]["kind"] == "grasp" else None
    held = grasp is not None and grasp.pop("held")
    if grasp is not None:
        del grasp["kind"]
    return {key: plan[key] for key in (*_COMMON, "object", "speed")} | {
        "kind": "handling",
        "action": plan["task"],
        "grasp": grasp,
        "held": held,
        "steps": steps,
        "prediction": predicted,
        "clear_of": plan["limits"]["clear_of"],
    }
