"""The analytic arm."""
