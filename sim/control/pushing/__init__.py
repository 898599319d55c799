"""Force control of a push, its guards and estimators."""
