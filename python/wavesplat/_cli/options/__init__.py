"""Options of the command line, declared once, and the objects that they make."""
