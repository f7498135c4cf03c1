"""Requests of a page, and their answers: values at a pixel, measures, pictures, files, code."""
