"""A process that has loaded the package and forks for each command: importing took most of the time of short commands.

Each command still has a process of its own, with its own working folder, environment, output and exit code.
A request is a line of JSON on stdin, the answer a line on stdout: the child's process number, then its exit code.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

#: Variables that Python reads when it starts: a command with one of them needs a new interpreter.
READ_AT_START = ("PYTHON", "LC_", "LANG")


class CommandServer:
    """The server as seen by tests."""

    def __init__(self):
        self._process = subprocess.Popen(
            [sys.executable, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            encoding="utf-8",
            env={**os.environ, "PYTHONUTF8": "1"},
        )

    def run(self, arguments, cwd, environment, timeout):
        """Run a command and return it as `subprocess.run` does; `subprocess.TimeoutExpired` after `timeout` seconds."""
        with tempfile.TemporaryFile("w+b") as out, tempfile.TemporaryFile("w+b") as err:
            request = {
                "arguments": arguments,
                "cwd": str(cwd or Path.cwd()),
                "environment": {**os.environ, "PYTHONUTF8": "1", **environment},
                "streams": [f"/proc/{os.getpid()}/fd/{stream.fileno()}" for stream in (out, err)],
                "timeout": timeout,
            }
            print(json.dumps(request), file=self._process.stdin, flush=True)
            code = json.loads(self._process.stdout.readline())
            texts = []
            for stream in (out, err):
                stream.seek(0)
                texts.append(stream.read().decode("utf-8").replace("\r\n", "\n"))
        if code is None:
            raise subprocess.TimeoutExpired(arguments, timeout, *texts)
        return subprocess.CompletedProcess(arguments, code, *texts)

    def close(self):
        """End the server."""
        self._process.stdin.close()
        self._process.wait(timeout=60)
        self._process.stdout.close()


def can_fork(environment):
    """Whether a command with these variables can run in a fork."""
    return Path("/proc/self/fd").is_dir() and not any(name.startswith(READ_AT_START) for name in environment)


def _next_request():
    """Answer requests by children, each of which returns its request from here; None at the end."""
    for line in sys.stdin:
        request = json.loads(line)
        child = os.fork()
        if child == 0:
            return request
        print(json.dumps(_exit_code(child, request["timeout"])), flush=True)
    return None


def _exit_code(child, timeout):
    """Wait for a child: its exit code, as of `subprocess`; None, and the child is killed, after `timeout` seconds."""
    signal.signal(signal.SIGALRM, lambda *_: os.kill(child, signal.SIGKILL))
    signal.setitimer(signal.ITIMER_REAL, timeout)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    over = signal.getitimer(signal.ITIMER_REAL)[0] == 0
    signal.setitimer(signal.ITIMER_REAL, 0)
    return None if over and code == -signal.SIGKILL else code


def _become(request):
    """Take over folder, environment, arguments and streams of a request."""
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    os.environ.clear()
    os.environ.update(request["environment"])
    for number, path in enumerate([os.devnull, *request["streams"]]):
        opened = os.open(path, os.O_RDONLY if number == 0 else os.O_WRONLY)
        os.dup2(opened, number)
        os.close(opened)
    os.chdir(request["cwd"])
    import wavesplat.__main__

    sys.argv = [wavesplat.__main__.__file__, *request["arguments"]]


if __name__ == "__main__":
    # What every command loads; other packages are loaded by the commands that need them, as users' are.
    import wavesplat
    import wavesplat._cli

    for name in wavesplat.__all__:
        getattr(wavesplat, name)
    if (request := _next_request()) is not None:
        _become(request)
        wavesplat._cli.main()
