"""A client whose service is killed in the midst of a run, and started again."""

from __future__ import annotations

from pathlib import Path

import pytest

from nlcontrol import Client
from nlcontrol.errors import ControlError
from tests.patience import PATIENCE
from tests.service_process import serving


@pytest.mark.slow
def test_a_run_that_was_cut_off_is_told_so(tmp_path: Path) -> None:
    store = ("--store", str(tmp_path / "store"), "--planners", "1")
    with serving(*store) as server:
        robot = Client(server.url, timeout=PATIENCE).sessions.open()
        run = robot.start("push the mug 10 cm to the left")
        assert next(run.events()).event.kind == "understood"
        server.process.kill()
        server.process.wait()
        with pytest.raises(ControlError) as raised:
            robot.look()
        assert raised.value.code == "no_service"
    with serving(*store, "--port", server.url.rpartition(":")[2]):
        with pytest.raises(ControlError) as raised:
            run.result(PATIENCE)
        assert raised.value.code == "cut_off"
        assert raised.value.info.suggestions
        info = run.info()
        assert info.state == "cut_off"
        assert [told.number for told in run.events()] == list(range(1, info.events + 1))
        with pytest.raises(ControlError) as raised:
            robot.look()
        assert raised.value.code == "unknown_session"
        robot.close()
        with Client(server.url, timeout=PATIENCE).sessions.open() as robot:
            assert robot.plan("push the mug 3 cm to the left").plan_id
