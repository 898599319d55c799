"""Conversations of ten sentences in hard worlds, each judged by where everything truly is then."""
