"""Options of the command line, declared once, and what they make."""
