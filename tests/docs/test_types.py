"""Type checkers accept the Python of README and guides, strictly and without any plugin,
and so they do the programs of `examples` and the notebooks.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CHECKERS = {
    "mypy": ("-m", "mypy", "--strict", "--config-file="),
    "basedpyright": ("-m", "basedpyright", "--level", "error", "--pythonpath", sys.executable),
}


@pytest.mark.slow
@pytest.mark.parametrize("checker", CHECKERS)
def test_a_type_checker_accepts_the_python_of_the_guides(checker: str, tmp_path: Path) -> None:
    guides = 0
    for guide in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))):
        text = guide.read_text(encoding="utf-8")
        blocks = re.findall(r"^```python([^\n]*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
        guides += bool(blocks)
        files: dict[str, str] = {}  # without a title one may go on from another
        for opening, block in blocks:
            title = re.search(r'title="(.*)"', opening)
            file = title[1] if title else f"{guide.stem.lower()}.py"
            files[file] = files.get(file, "") + "\n" + block
        for file, text in files.items():
            (tmp_path / file).write_text(text, encoding="utf-8")
    assert guides > 8
    for program in (
        *ROOT.glob("examples/*.py"),
        *ROOT.glob("examples/programs/*.py"),
        *ROOT.glob("examples/*/*/__init__.py"),
    ):
        name = program.parent.name if program.stem == "__init__" else program.stem
        shutil.copy(program, tmp_path / f"example_{name}.py")
    for book in ROOT.glob("docs/notebooks/*.ipynb"):
        cells = json.loads(book.read_text("utf-8"))["cells"]
        code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        (tmp_path / f"notebook_{book.stem}.py").write_text("\n".join(code), encoding="utf-8")
    # In a folder of its own, so that no settings of the project count.
    command = [sys.executable, *CHECKERS[checker], "."]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
