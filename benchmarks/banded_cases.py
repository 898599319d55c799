"""What the benchmarks share that set margins of random cases beside what becomes of them in Drake.

Cases within a band about the limit that decides are set apart.
"""

from __future__ import annotations

import argparse


def banded_options(doc: str | None) -> argparse.Namespace:
    """How many cases, of which seed, and the band; `doc` is that of the benchmark."""
    parser = argparse.ArgumentParser(description=(doc or "").splitlines()[0])
    parser.add_argument("--cases", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--band", type=float, default=0.05, help="share of the limit")
    return parser.parse_args()


def agreement_text(agree: int, judged: int, cases: int) -> str:
    """How many of the judged cases are as predicted, and how many of all lie within the band."""
    share = 100.0 * agree / max(judged, 1)
    return f"{agree} of {judged} as predicted ({share:.1f} %); {cases - judged} within the band"
