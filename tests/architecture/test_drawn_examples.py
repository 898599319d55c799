"""By default the same random examples are drawn everywhere, whatever was loaded or run before."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar.paraphrasing.sentence_sampler import Sampler
from tests.architecture.product import ROOT
from tests.property.test_grammar_properties import KINDS

pytestmark = pytest.mark.skipif(not settings().derandomize, reason="new examples are drawn")


def examples_drawn() -> list[object]:
    drawn: list[object] = []

    @settings(max_examples=300)
    @given(st.tuples(st.integers(), st.floats(), st.text(), st.binary()))
    def take(example: object) -> None:
        drawn.append(repr(example))

    take()
    return drawn


def test_what_is_loaded_changes_no_example(tmp_path: Path) -> None:
    before = examples_drawn()
    module = tmp_path / "loaded_later.py"
    rows = "".join(f"    ({n}, {n}.5, 'word {n}', b'bytes {n}'),\n" for n in range(2000, 2040))
    module.write_text(f"ROWS = [\n{rows}]\n")
    spec = importlib.util.spec_from_file_location("loaded_later", module)
    assert spec is not None
    assert spec.loader is not None
    sys.modules["loaded_later"] = loaded = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(loaded)
        assert examples_drawn() == before
    finally:
        del sys.modules["loaded_later"]


def test_no_example_is_kept_from_an_earlier_run() -> None:
    assert settings().database is None


def sentences_and_phrases() -> str:
    """What the tests of the language draw from, and what they draw for some seeds."""
    sentences = [Sampler(Random(seed)).draw_sentence().text for seed in range(50)]
    return repr((sentences, sorted((kind, list(said)) for kind, said in KINDS.items())))


def test_the_order_of_sets_changes_no_sentence() -> None:
    program = f"from {__name__} import sentences_and_phrases as told; print(told())"
    other = "1" if sys.flags.hash_randomization else "random"
    told = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | {"PYTHONHASHSEED": other},
        cwd=ROOT, capture_output=True, text=True, encoding="utf-8", check=True,
    )  # fmt: skip
    assert told.stdout.rstrip("\n") == sentences_and_phrases()
