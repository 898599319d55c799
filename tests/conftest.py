"""What every test shares."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers
from hypothesis.internal.constants_ast import Constants

from objectmodels.registry.model_registry import FOLDER_VARIABLE
from tests.browser_tests import browser_account

# How long an example takes says more about the machine than about the code. By default the same
# examples are drawn everywhere, so that a run judges a change alone; `.ci/long` draws new ones.
_UNTIMED = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("same", _UNTIMED, derandomize=True)
settings.register_profile("new", _UNTIMED, print_blob=True)
settings.load_profile(os.environ.get("NLCONTROL_EXAMPLES", "same"))
if settings().derandomize:
    # Else Hypothesis draws constants of the modules that happen to be loaded, which depend on the
    # tests before, and on whether a folder above the checkout is called "tests".
    providers._get_local_constants = Constants


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> Iterator[None]:
    """Says as the last but the closing line whether the tests in a browser were skipped."""
    yield
    account = browser_account(terminalreporter.stats)
    if account is not None:
        terminalreporter.write_line(account)


@pytest.fixture(scope="session", autouse=True)
def _no_models_of_the_user(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Whoever runs the tests may have models of their own; these must not count."""
    os.environ[FOLDER_VARIABLE] = str(tmp_path_factory.mktemp("objects"))


@pytest.fixture(scope="session", autouse=True)
def _control_c_is_heard() -> None:
    """What a shell starts in the background ignores control-C, and so would what it starts."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def objects_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder for the user's models, of this test alone."""
    folder = tmp_path / "objects"
    folder.mkdir()
    monkeypatch.setenv(FOLDER_VARIABLE, str(folder))
    return folder
