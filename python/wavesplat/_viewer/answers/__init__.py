"""Answers to the page's questions: what is seen at a pixel, measures, files, code."""
