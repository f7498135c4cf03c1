"""`python -m wavesplat` is the command line."""

from wavesplat.cli import main

if __name__ == "__main__":
    main()
