"""The application: routes behind their guard."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastapi import FastAPI

from nlcontrol import __version__
from nlcontrol.service.http import (
    host_routes,
    page_routes,
    planning_routes,
    run_routes,
    session_routes,
)
from nlcontrol.service.http.event_streams import Listeners
from nlcontrol.service.http.openapi_document import openapi_document
from nlcontrol.service.http.problem_documents import answer_problems
from nlcontrol.service.http.request_guard import RequestGuard

if TYPE_CHECKING:
    from nlcontrol.service.http.http_settings import HttpSettings
    from nlcontrol.service.planning_service import PlanningService

ROUTERS = (
    host_routes.ROUTER,
    planning_routes.ROUTER,
    session_routes.ROUTER,
    run_routes.ROUTER,
    page_routes.ROUTER,
)
"""All routes, by what they are about."""


def service_app(service: PlanningService, settings: HttpSettings) -> RequestGuard:
    """The application that answers for a service."""
    app = routes_app()
    app.state.service = service
    app.state.http_settings = settings
    app.state.listeners = Listeners(settings.listeners)
    return RequestGuard(app, settings, service.settings.body_bytes)


def routes_app() -> FastAPI:
    """All routes, without a service behind them and without their guard."""
    app = FastAPI(
        title="nlcontrol",
        version=__version__,
        summary="Look, plan, approve, do, verify.",
        openapi_url="/v1/openapi.json",
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
    )
    for router in ROUTERS:
        app.include_router(router)
    answer_problems(app)
    app.openapi = lambda: openapi_document(app, ROUTERS)  # type: ignore[method-assign]
    return app
