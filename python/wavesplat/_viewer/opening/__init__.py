"""Files that are opened in the viewer: by the command, by pages, from the start page."""
