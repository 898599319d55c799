"""The record of an execution."""
