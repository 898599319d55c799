"""Batches: many rows of sentence, scene and seed, on all cores or on a cluster."""

from __future__ import annotations

from nlcontrol.batches.batch import BatchProgress as BatchProgress
from nlcontrol.batches.rows import BatchRow as BatchRow
from nlcontrol.batches.rows import DrawnScene as DrawnScene
from nlcontrol.batches.rows import RowResult as RowResult
