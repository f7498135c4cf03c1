"""Looks that are chosen by the kind of data: what the samples are, and how they are shown."""
