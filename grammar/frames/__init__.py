"""The contract: goals, constraints, their words and conflicts."""
