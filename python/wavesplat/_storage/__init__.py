"""Files and addresses: how they are named, read, checked, cached and written."""
