"""Steps of a command in an order, with others between them, by which all can be done."""
