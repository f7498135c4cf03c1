"""Readers: one module per family of formats, each with `read(request) -> Grid`; `opening` chooses one."""
