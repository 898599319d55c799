"""Routes of questions about a table that need no session: parse, plan, ask, predict, map."""

from __future__ import annotations

from fastapi import APIRouter
from starlette.responses import Response

from nlcontrol.questions.push_prediction import PushPrediction
from nlcontrol.results.result import Result
from nlcontrol.service.documents import Affordances, FaceMap, Offer, Understanding
from nlcontrol.service.http.openapi_document import PROBLEMS
from nlcontrol.service.http.request_bodies import (
    TableMapBody,
    TableObjectBody,
    TablePredictBody,
    TableSaidBody,
)
from nlcontrol.service.http.service_access import (
    Service,
    answer_of,
    require_bounded_sentence,
)

ROUTER = APIRouter(prefix="/v1", tags=["planning"], responses=PROBLEMS)


@ROUTER.post("/parse", operation_id="parse", response_model=Understanding)
async def parse(body: TableSaidBody, service: Service) -> Response:
    """Reads a sentence: its frames, or why it is not understood."""
    require_bounded_sentence(body, service.settings)
    return await answer_of(service.call_planner("parse", body.table, **body.arguments))


@ROUTER.post("/plan", operation_id="plan", response_model=Offer)
async def plan(body: TableSaidBody, service: Service) -> Response:
    """Plans a sentence; the offer bears no plan id, since nothing of it can be executed."""
    require_bounded_sentence(body, service.settings)
    return await answer_of(service.call_planner("plan", body.table, **body.arguments))


@ROUTER.post("/ask", operation_id="ask", response_model=Result)
async def ask(body: TableSaidBody, service: Service) -> Response:
    """Answers a question; a sentence that is none is planned."""
    require_bounded_sentence(body, service.settings)
    return await answer_of(service.call_planner("ask", body.table, **body.arguments))


@ROUTER.post("/predict", operation_id="predict", response_model=PushPrediction)
async def predict(body: TablePredictBody, service: Service) -> Response:
    """Predicts a push at a place of a face."""
    return await answer_of(service.call_planner("predict", body.table, **body.arguments))


@ROUTER.post("/map", operation_id="map", response_model=FaceMap)
async def map_face(body: TableMapBody, service: Service) -> Response:
    """Predicts pushes all over a face."""
    return await answer_of(service.call_planner("map", body.table, **body.arguments))


@ROUTER.post("/affordances", operation_id="affordances", response_model=Affordances)
async def affordances(body: TableObjectBody, service: Service) -> Response:
    """Lists what the robot can bring about with an object, and for the rest, why not."""
    return await answer_of(service.call_planner("affordances", body.table, **body.arguments))
