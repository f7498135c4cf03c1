"""Readers: a folder for formats that belong together, a module per family; `opening` chooses one."""
