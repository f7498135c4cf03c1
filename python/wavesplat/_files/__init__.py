"""Files of any kind: what can be written where, JSON texts, and checks before memory is taken."""
