"""The viewer's session: its state, its changes, and the frames that it draws."""
