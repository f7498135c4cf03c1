"""Files of any kind: paths, addresses, stores, JSON texts, and checks before memory is allocated."""
