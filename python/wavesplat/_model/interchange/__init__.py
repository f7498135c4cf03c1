"""Objects and files of other libraries and programs."""
