"""What stands on what: stacks, and things that hang over the edge of a table."""
