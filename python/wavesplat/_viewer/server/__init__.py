"""The viewer's server: the page's files, its connections, and its messages as bytes."""
