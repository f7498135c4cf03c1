"""The interactive viewer: its state, the session that draws, the server on this machine, and the notebook widget."""
