"""Files are written whole or not at all, and nothing is left over."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from objectmodels.errors import ModelError
from objectmodels.files import yaml_documents
from objectmodels.files.yaml_documents import lock_folder, remove_file, replace_file


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_failed_write_leaves_the_older_file(tmp_path: Path) -> None:
    path = tmp_path / "run.html"
    path.write_text("older")

    def fail_halfway() -> None:
        with replace_file(path) as temporary:
            temporary.write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail_halfway()
    assert path.read_text() == "older"
    with replace_file(path) as temporary:
        temporary.write_text("newer")
    assert path.read_text() == "newer"
    assert names(tmp_path) == ["run.html"]
    assert path.stat().st_mode & 0o044  # others may read it, as with any written file


@pytest.mark.parametrize("name", ["", "x" * 300, "file/x.yaml", "pipe"])
def test_what_cannot_be_written_is_an_error_and_changes_nothing(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "file").write_text("old")
    with pytest.raises(ModelError) as raised, replace_file(tmp_path / name) as temporary:
        temporary.write_text("new")
    assert raised.value.code == "cannot_write"
    assert raised.value.suggestions
    assert names(tmp_path) == ["file", "pipe"]


def test_a_full_disk_is_told_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: Path) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(yaml_documents, "_sync", fail)
    with pytest.raises(ModelError, match="space") as raised, replace_file(tmp_path / "a"):
        pass
    assert raised.value.code == "cannot_write"
    assert names(tmp_path) == []


def test_both_file_and_folder_are_synced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[str] = []
    monkeypatch.setattr(yaml_documents, "_sync", lambda path: synced.append(path.suffix))
    with replace_file(tmp_path / "a.yaml"):
        pass
    assert synced == [".yaml", ""]


def test_leftovers_of_killed_processes_are_removed(tmp_path: Path) -> None:
    for name, age in ((".nlcontrol-old.tmp", 3600.0), (".nlcontrol-new.tmp", 1.0), ("own", 3600.0)):
        (tmp_path / name).touch()
        os.utime(tmp_path / name, (time.time() - age, time.time() - age))
    with replace_file(tmp_path / "a"):
        pass
    assert names(tmp_path) == [".nlcontrol-new.tmp", "a", "own"]


def test_a_locked_folder_is_waited_for_a_while(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(yaml_documents, "_PATIENCE", 0.05)
    folder = tmp_path / "new" / "folder"
    with lock_folder(folder), pytest.raises(ModelError) as raised, lock_folder(folder):
        pass
    assert raised.value.code == "cannot_write"
    with lock_folder(folder):
        pass


def test_what_is_gone_cannot_be_removed(tmp_path: Path) -> None:
    with pytest.raises(ModelError) as raised:
        remove_file(tmp_path / "a")
    assert (raised.value.code, bool(raised.value.suggestions)) == ("cannot_write", True)
