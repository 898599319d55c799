"""The notebooks run from top to bottom in a kernel, and their results show themselves."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.patience import PATIENCE

nbformat = pytest.importorskip("nbformat", reason="the extra dev has it")
nbclient = pytest.importorskip("nbclient", reason="the extra dev has it")

FOLDER = Path(__file__).parents[2] / "docs" / "notebooks"
BOOKS = sorted(FOLDER.glob("*.ipynb"))


def run_book(path: Path) -> list[Any]:
    """The outputs of all cells of a notebook."""
    book = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(
        book,
        timeout=int(PATIENCE),
        kernel_name="python3",
        resources={"metadata": {"path": str(FOLDER)}},
    ).execute()
    return [output for cell in book.cells for output in cell.get("outputs", ())]


SHOWN = {
    "a_batch": ["'planned': 12"],
    "a_model_of_your_own": ["file       good", "push the milk carton"],
    "fit_measured_data": ["value [SI]", "Thresholds"],
    "plan_and_execute": ["push the ice tea box, probability", "done", "held"],
    "predict_and_map": ["Thresholds", "Prediction", "<svg"],
}


@pytest.mark.parametrize("path", BOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_shows_its_results(path: Path) -> None:
    outputs = run_book(path)
    told = json.dumps(outputs, ensure_ascii=False)
    assert [words for words in SHOWN[path.stem] if words not in told] == []
    assert "missed" not in told
    assert "False" not in told


def test_no_output_is_kept_in_them() -> None:
    assert len(BOOKS) == len(SHOWN) == 5
    for path in BOOKS:
        for cell in json.loads(path.read_text("utf-8"))["cells"]:
            assert not cell.get("outputs"), path.name
            assert cell.get("execution_count") is None, path.name
