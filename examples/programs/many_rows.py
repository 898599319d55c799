"""Plans a sentence for many seeds, on all cores."""

from nlcontrol import batch
from nlcontrol.batches import BatchRow

if __name__ == "__main__":  # since the processes that plan read this file, too
    rows = [BatchRow(text="push the mug 5 cm away", seed=seed) for seed in range(4)]
    for row in batch(rows, plan_only=True, workers=2):
        print(row.line, row.status)
