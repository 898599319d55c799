"""The application: routes behind their guard."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastapi import APIRouter, FastAPI

from nlcontrol import __version__
from nlcontrol.service.http import (
    host_routes,
    page_routes,
    run_routes,
    session_routes,
)
from nlcontrol.service.http.openapi_document import PROBLEMS, openapi_document
from nlcontrol.service.http.problem_documents import answer_problems
from nlcontrol.service.http.request_guard import BrowserLogin, RequestGuard
from nlcontrol.service.http.session_routes import add_questions

if TYPE_CHECKING:
    from nlcontrol.service.http.responses import HttpSettings
    from nlcontrol.service.planning_service import PlanningService

_PLANNING = APIRouter(prefix="/v1", tags=["planning"], responses=PROBLEMS)
add_questions(_PLANNING, session=False)

ROUTERS = (
    host_routes.ROUTER,
    _PLANNING,
    session_routes.ROUTER,
    run_routes.ROUTER,
    page_routes.ROUTER,
)
"""All routes, by what they are about."""


def service_app(
    service: PlanningService, settings: HttpSettings, login: BrowserLogin | None = None
) -> RequestGuard:
    """The application that answers for a service.

    Args:
        service: service that has started.
        settings: settings of the HTTP interface.
        login: login of browsers; a new one if not given and the settings have a token.
    """
    app = routes_app()
    app.state.service = service
    app.state.http_settings = settings
    app.state.streams = 0  # that are open
    guard = RequestGuard(app, settings, service.settings.body_bytes, login)
    app.state.login = guard.login
    return guard


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
    answer_problems(app, ROUTERS)
    app.openapi = lambda: openapi_document(app, ROUTERS)  # type: ignore[method-assign]
    return app
