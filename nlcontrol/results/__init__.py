"""Result, step and JSON schema: values."""
