"""Readers: one module per family of formats, each with `read(request) -> Grid`; `opening` finds out which is asked."""
