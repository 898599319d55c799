"""Drawing of an offer: what its plan predicts, or what stands in its way."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nlcontrol.reports.predicted_places import end_poses, plan_contacts
from nlcontrol.service.documents import Drawing

if TYPE_CHECKING:
    from nlcontrol.results.result import Result


def offer_drawing(result: Result) -> Drawing | None:
    """The drawing of a plan or of a refusal; None if no object on the table is meant."""
    step = result.steps[-1] if result.steps else None
    if step is None or step.basis is None:
        return None
    contacts = plan_contacts(step.plan, step.basis.target.pose.R_WB) if step.plan else ()
    return Drawing(
        object=step.basis.target.name,
        ghosts=tuple(end_poses([step])),
        contacts=tuple(contacts),
        marks=step.marks,
    )
