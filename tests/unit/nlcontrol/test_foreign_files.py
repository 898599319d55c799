"""Files of other distributions in our packages, as `doctor` finds them."""

from __future__ import annotations

import base64
import hashlib
from pathlib import Path

from nlcontrol.cli.commands.doctor_command import examine_all, foreign_files
from nlcontrol.installed_versions import DISTRIBUTION


def install(folder: Path, name: str, content: str) -> None:
    """Put a package `planner` there, as an installer of a distribution would."""
    (folder / "planner").mkdir(exist_ok=True)
    (folder / "planner" / "__init__.py").write_text(content, encoding="utf-8")
    digest = base64.urlsafe_b64encode(hashlib.sha256(content.encode()).digest()).decode()
    info = folder / f"{name}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (info / "RECORD").write_text(
        f"planner/__init__.py,sha256={digest.rstrip('=')},9\n{name}-1.0.dist-info/RECORD,,\n"
    )


def test_another_distribution_that_writes_over_a_package_is_named(tmp_path: Path) -> None:
    install(tmp_path, DISTRIBUTION, "ours")
    assert list(foreign_files(tmp_path)) == []
    install(tmp_path, "flights", "theirs")
    assert sorted(foreign_files(tmp_path)) == [
        "planner/__init__.py belongs to flights 1.0",
        "planner/__init__.py is not as it was installed",
    ]


def test_a_file_that_is_gone_is_told(tmp_path: Path) -> None:
    install(tmp_path, DISTRIBUTION, "ours")
    (tmp_path / "planner" / "__init__.py").unlink()
    assert list(foreign_files(tmp_path)) == ["planner/__init__.py is not as it was installed"]


def test_all_is_well_here() -> None:
    assert [found for found in examine_all() if found.essential and not found.ok] == []
