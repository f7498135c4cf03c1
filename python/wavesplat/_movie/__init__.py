"""Movies: what each frame shows, and the files that frames become."""
