"""Arguments of pictures: operators, sampling, clips; and checks of arguments."""
