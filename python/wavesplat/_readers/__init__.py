"""Readers: a folder for what belongs together, a module per family of formats; `opening` chooses one."""
