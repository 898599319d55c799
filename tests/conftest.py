"""What every test shares."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
from hypothesis import settings

from objectmodels.registry.user_folder import FOLDER_VARIABLE

# How long an example takes says more about the machine than about the code. The gate draws the
# same examples each time, so that it judges a change alone; all others draw new ones.
settings.register_profile("untimed", deadline=None)
settings.register_profile("gate", deadline=None, derandomize=True)
settings.load_profile(os.environ.get("NLCONTROL_EXAMPLES", "untimed"))


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
