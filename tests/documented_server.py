"""The command line, with a service each of whose answers is compared with its document.

`python -m tests.documented_server serve …` is `nlcontrol serve …`; what the document does not have
is added to the file that `NLCONTROL_TEST_UNDOCUMENTED` names.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any
from unittest.mock import patch

from nlcontrol.interruption import SIGNALS

FAULTS_VARIABLE = "NLCONTROL_TEST_UNDOCUMENTED"


def main() -> None:
    """Runs the command line; signals wait until it is loaded."""
    SIGNALS.hold()
    from nlcontrol.cli import main as run_command_line
    from nlcontrol.service.http import web_server
    from nlcontrol.service.http.service_app import service_app
    from tests.documented_answers import DocumentedApp

    def documented_app(*given: Any) -> DocumentedApp:
        return DocumentedApp(service_app(*given), Path(os.environ[FAULTS_VARIABLE]))

    with patch.object(web_server, "service_app", documented_app):
        run_command_line()


if __name__ == "__main__":
    main()
