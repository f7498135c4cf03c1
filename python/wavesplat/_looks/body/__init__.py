"""Parts of a body that are drawn or left out: the table of a CT, the brain, the largest body."""
