"""Goals of all kinds in worlds drawn by seed: what is accepted, what is kept, what is refused.

`worlds` draws a world and its sentence, `cases` carries one out in a process of its own, `final`
measures how far off it ended, `tables` counts. `refusal_judge` looks by brute force for what
was refused, `confirm` has it do so for many cases.
Run it as `python -m benchmarks.goals`; `docs/benchmarks.md` says how to read it.
"""
