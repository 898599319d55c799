"""Contacts, sequences, topples, turns, strategies."""
