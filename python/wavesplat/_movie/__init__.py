"""Movies: the scene and the camera of each frame, and the files of frames."""
