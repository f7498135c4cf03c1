"""What all rooms stand on: memory, threads, optional libraries, and checks of values."""
