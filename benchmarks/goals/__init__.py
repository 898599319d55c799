"""Sentences in worlds drawn by seed: what is accepted, what comes about, what is refused.

`drawn_worlds` draws worlds, `sentences` what is said there, `sense`, `hand_sense` and `wish_sense`
tell by shapes and weights alone whether a person would say it. `cases` carries a case out, `judge`
and `wishes` tell by true poses what came of it, `tables` counts. `refusal_judge` looks by brute
force for what was refused. `talks` holds conversations, `fixed` says the same sentences in many
worlds. Run it as `python -m benchmarks.goals`; `docs/benchmarks.md` says how to read it.
"""
