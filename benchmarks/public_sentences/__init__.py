"""Sentences of public sources, read beside what they mean by rule."""
