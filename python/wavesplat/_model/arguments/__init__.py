"""What pictures are asked for: operators, sampling, clips; and checks of arguments."""
