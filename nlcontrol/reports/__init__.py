"""Results as text, tables, drawings."""
