"""Routes of what the host has: its health, scenes and objects, and the schema of all answers."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from fastapi import APIRouter, Request
from starlette.responses import Response

from nlcontrol import __version__, json_schema
from nlcontrol.errors import error, known_errors_raised
from nlcontrol.json_document import document_text
from nlcontrol.service.documents import (
    Health,
    ObjectDescription,
    ObjectList,
    ObjectSummary,
    SceneGeometry,
    SceneList,
    SceneSummary,
)
from nlcontrol.service.http.openapi_document import PROBLEMS
from nlcontrol.service.http.request_guard import BrowserLogin
from nlcontrol.service.http.responses import LoginBody, ObjectPath, Service, document_response
from objectmodels.registry.model_registry import kind_of
from sim.truth.scene_file import load_scene
from sim.views.viewer_recording import believed_scene

if TYPE_CHECKING:
    from objectmodels import ObjectModel

ROUTER = APIRouter(prefix="/v1", tags=["host"], responses=PROBLEMS)


@ROUTER.get("/health", operation_id="health", response_model=Health)
async def health(service: Service) -> Response:
    """Tells that the service is there, and what it has to do."""
    return document_response(Health(version=__version__, **service.health()))


@ROUTER.post("/login", operation_id="login", status_code=204, openapi_extra={"security": []})
async def log_in(body: LoginBody, request: Request) -> Response:
    """Gives a browser the cookie that stands for the token; there is none where none is needed."""
    login: BrowserLogin | None = request.app.state.login
    if login is None:
        return Response(status_code=204)
    if not login.accepts(body.secret):
        await asyncio.sleep(login.penalty())
        raise error(
            "wrong_token",
            "that is not the token of this service, and no code of a login that is still good",
            suggestions=("type the token that whoever runs the service has given it",),
        )
    is_secure = request.headers.get("origin", "").startswith("https:")
    return Response(status_code=204, headers={"Set-Cookie": login.cookie(is_secure=is_secure)})


@ROUTER.get("/schema", operation_id="json_schema", response_model=dict[str, Any])
def schema() -> Response:
    """Sends the JSON schema of the documents, as `nlcontrol schema` prints it."""
    return Response(document_text(json_schema.schema(), None), media_type="application/json")


@ROUTER.get("/scenes", operation_id="list_scenes", response_model=SceneList)
def list_scenes(service: Service) -> Response:
    """Lists the scenes that may be asked for."""
    return document_response(SceneList(scenes=tuple(map(_scene_summary, service.scenes()))))


@ROUTER.get("/objects", operation_id="list_objects", response_model=ObjectList)
def list_objects(service: Service) -> Response:
    """Lists the object models of the host."""
    return document_response(ObjectList(objects=tuple(map(_object_summary, service.objects()))))


@ROUTER.get("/objects/{name}", operation_id="read_object", response_model=ObjectDescription)
def read_object(name: ObjectPath) -> Response:
    """Tells what is believed about an object, by its name or a synonym."""
    from objectmodels import Registry

    with known_errors_raised():
        model = Registry.default().find_one(name)
    return document_response(
        ObjectDescription(
            summary=_object_summary(model),
            model=model.model_dump(mode="json"),
            geometry=SceneGeometry(source="belief", **believed_scene(name, {name: model})),
        )
    )


def _scene_summary(name: str) -> SceneSummary:
    return SceneSummary(name=name, objects=tuple(item.name for item in load_scene(name).objects))


def _object_summary(model: ObjectModel) -> ObjectSummary:
    return ObjectSummary(
        name=model.name,
        synonyms=tuple(model.synonyms),
        kind=kind_of(model),
        size=model.extents,
        mass=model.mass,
        mass_sd=model.mass_sd,
        friction=model.friction,
        friction_sd=model.friction_sd,
    )
