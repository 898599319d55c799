"""The one reader: regular files alone, and no more of them than a limit."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from objectmodels.errors import ModelError, printable
from objectmodels.files.yaml_documents import LIMITS, read_bytes, read_text

MOST = int(LIMITS["model_file"].most)


def refusal(path: Path) -> ModelError:
    with pytest.raises(ModelError) as raised:
        read_text(path, "model_file")
    assert raised.value.code == "unreadable_file"
    assert raised.value.path == printable(str(path))
    assert raised.value.suggestions
    return raised.value


def test_a_file_and_a_link_to_it_are_read(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"\xef\xbb\xbfa\r\n")
    (tmp_path / "b").symlink_to(tmp_path / "a")
    assert read_bytes(tmp_path / "b", "model_file") == b"\xef\xbb\xbfa\r\n"
    assert read_text(tmp_path / "b", "model_file") == "a\r\n"


def test_pipes_folders_and_devices_are_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "endless").symlink_to("/dev/zero")
    for path in (tmp_path / "pipe", tmp_path / "endless", tmp_path):
        assert "plain file" in refusal(path).suggestions[0]


def test_no_more_is_read_than_the_limit(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_bytes(b"#" * MOST)
    assert len(read_bytes(path, "model_file")) == MOST
    path.write_bytes(b"#" * (MOST + 1))
    assert str(MOST) in refusal(path).message


@pytest.mark.parametrize("name", ["missing", "a\0b", "x" * 300, "a/b", "\x1b[31m", "\udcff"])
def test_paths_that_lead_nowhere(tmp_path: Path, name: str) -> None:
    error = refusal(tmp_path / name)
    assert str(error).isprintable()


def test_what_is_no_text_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"caf\xe9")
    assert "byte 4" in refusal(tmp_path / "a").message
