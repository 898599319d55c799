"""What models predict beside what engines do, over random cases of many kinds.

`python -m benchmarks.engines` has one table of cases: they are drawn by seed, rolled out, and
counted in one way.
"""
