"""Batches: equal digests wherever rows are carried out, rates beside a plain loop's, memory.

`proof` carries the same rows out in every way while processes are killed, `rates` compares with a
loop, `memory` watches workers over many rows. docs/batch.md has the figures.
"""
