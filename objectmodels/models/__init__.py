"""Object models: shapes, parts, vessel, parameters."""
