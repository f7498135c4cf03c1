"""`python -m wavesplat` is the command line."""

from wavesplat._cli import main

if __name__ == "__main__":
    main()
