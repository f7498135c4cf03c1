"""The base of all rooms: memory, threads, optional libraries, and checks of values."""
