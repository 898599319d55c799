"""Who may ask: the guard before every request, and the login of a browser."""
