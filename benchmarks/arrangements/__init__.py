"""Swaps, rows, cleared places, headings, stacks and standing up, in worlds drawn by seed.

`wishes` says what a sentence asks in terms of true poses, `arranged_worlds` draws worlds and
sentences, `arranged_labels` tells by shapes alone which of them a person would say, and
`arranged_cases` carries one out. Run it as `python -m benchmarks.arrangements`;
`docs/benchmarks.md` says how to read it.
"""
