"""Maps as table and drawing, beside an experiment."""
