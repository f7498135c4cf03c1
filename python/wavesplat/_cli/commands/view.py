"""`wavesplat view`, also `--save` without a page."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, get_args

import typer

from wavesplat._cli.options.geometry import opened_geometry
from wavesplat._cli.options.groups import InputOrNone, Quiet, kernel, option, picture_size
from wavesplat._cli.options.groups import given as options_given
from wavesplat._cli.options.scene import SceneOptions, chosen_scene
from wavesplat._cli.options.view import ViewOptions, camera_for, check_view_options
from wavesplat._cli.printing import check_outputs, message, print_lines
from wavesplat._model.arguments.sampling import Quality
from wavesplat._storage.addresses import is_address
from wavesplat._viewer.opening.example_names import EXAMPLES
from wavesplat.errors import ArgumentError, WavesplatError

if TYPE_CHECKING:
    from wavesplat._viewer.session.state import ViewerState

#: Size, pixels, of the window that the first view is framed for, and of a picture without --size.
FIRST_SIZE = (1024, 768)
#: Seconds that an error waits for a page that can show it.
TELLING_S = 5.0


@dataclass(repr=False)
class OpenedOptions:
    """The document that is opened instead of INPUT, and how it is drawn."""

    state: Path | None = option(
        "FILE.json", "What the viewer saved, or a scene, instead of INPUT and its options; - is stdin."
    )
    example: Any = option(help=f"Instead of INPUT one of {', '.join(EXAMPLES)}.", choices=tuple(EXAMPLES))
    quality: Any = option(help="Of the picture at rest.", default="normal", choices=get_args(Quality))
    kernel: Any = kernel()

    @property
    def render(self) -> dict[str, Any]:
        """Options of pictures."""
        return {"quality": self.quality, "kernel": self.kernel}


@dataclass(repr=False)
class SaveOptions:
    """A picture of what the viewer shows, and what is on it."""

    TITLE: ClassVar = "A picture without a page"

    save: Path | None = option("OUT", "Write a picture of what is shown, and end; no page is opened.")
    shown: Any = option(
        help="Of --save: 3d, a slice by the axis across it, z, y or x, or all, two by two.",
        default="3d",
        choices=("3d", "z", "y", "x", "all"),
    )
    size: Any = picture_size("Of --save: pixels; 1024x768 without it.", None)
    marks: bool = option(help="Of --save: draw measures, scale bars, letters, colour bar, legend.", default=True)

    def check(self, input: str | None, *, is_named: bool) -> None:
        """Refuse options that cannot work, before anything is read."""
        if self.save is not None and not is_named:
            raise ArgumentError("INPUT: name one for --save: a volume, --state FILE.json or --example NAME")
        if self.save is not None:
            check_outputs(input or "-", self.save, "pictures", option="--save")
        elif self != SaveOptions():
            raise ArgumentError("--shown, --size and --marks are for the picture of --save; name it, or leave them out")


def view(
    input: InputOrNone = None,
    *,
    own: OpenedOptions,
    port: Annotated[
        int, typer.Option(metavar="N", min=0, max=65535, help="Port of this machine; 0: one that is free.")
    ] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Whether to open the page.")] = True,
    saving: SaveOptions,
    scene: SceneOptions,
    viewing: ViewOptions,
    quiet: Quiet = False,
) -> None:
    """Look at a volume and turn it, in the browser; without INPUT choose one there; Ctrl-C ends."""
    named = _named(input, own, scene, viewing)
    scene.check()
    check_view_options(viewing)
    _check_there(input)
    saving.check(input, is_named=named is not None)
    if saving.save is not None:
        from wavesplat._viewer.page_requests.seen import check_shown, seen

        shown = check_shown(saving.shown)
        picture = seen(
            _opened(input, own, scene, viewing, quiet=quiet), shown, saving.size or FIRST_SIZE, marks=saving.marks
        )
        picture.save(saving.save)
        print_lines(str(saving.save), written=saving.save)
        return
    from wavesplat._viewer.server.server import Server

    _end_as_by_ctrl_c()
    server = Server(port)
    try:
        print_lines(server.link)
        if not quiet:
            _tell_how_to_reach(server.port)
        if browser:
            server.open_in_browser()
        if named is None:
            _serve(server, None, render=own.render)
        server.send_progress(f"Opening {named}")
        try:
            first = _opened(input, own, scene, viewing, quiet=quiet)
        except WavesplatError as error:
            server.fail(str(error))
            # The page, which may not be there yet, gets the message before the server ends.
            if server.has_reported.wait(TELLING_S if browser else 0):
                threading.Event().wait(0.3)
            raise
        _serve(server, first, input)
    except KeyboardInterrupt:
        if not quiet:
            message("the viewer has ended")
    finally:
        server.close()


def _check_there(input: str | None) -> None:
    """Refuse a file that is not there before a page opens."""
    if input is not None and not is_address(input) and not Path(input).expanduser().exists():
        from wavesplat._storage.size_checks import check_readable

        check_readable(Path(input).expanduser())


def _named(input: str | None, own: OpenedOptions, *groups: Any) -> str | None:
    """The name of what is opened, None if the page asks for a file.

    Raises
    ------
    ArgumentError
        For several things to open, and for options about a volume where none is named.
    """
    names = {
        "INPUT": input and (input.rstrip("/").rpartition("/")[2] or input),
        "--state": own.state and own.state.name,
        "--example": own.example,
    }
    given = {what: name for what, name in names.items() if name is not None}
    if len(given) > 1:
        raise ArgumentError(f"{' and '.join(given)}: name one: a volume, --state FILE.json or --example NAME")
    options = options_given(*groups)
    if options and not given:
        raise ArgumentError(
            f"INPUT: name one for {', '.join(options)}: a volume, --state FILE.json or --example NAME; without these "
            "options, and without INPUT, the page asks for a file"
        )
    return next(iter(given.values()), None)


def _serve(
    server: Any, first: ViewerState | None, input: str | None = None, *, render: Mapping[str, str] | None = None
) -> None:
    """Serve a first state, or the start page and what is opened there with the settings `render`, until Ctrl-C."""
    from wavesplat._viewer.opening.opening import Opener
    from wavesplat._viewer.opening.start_page import Recent
    from wavesplat._viewer.session.session import Session

    sessions: list[Session] = []

    def begin(state: ViewerState) -> None:
        settings = [
            {"op": "replace", "path": f"/render/{name}", "value": value} for name, value in (render or {}).items()
        ]
        sessions.append(Session(state.patched(settings)))
        server.show(sessions[0])

    recent = Recent()
    opener = Opener(lambda: sessions[0].state if sessions else None, begin, recent)
    try:
        if first is not None:
            begin(first)
        if input is not None:
            recent.add(input)
        server.offer(opener)
        ended = threading.Event()
        while True:
            # One wait after the other: Ctrl-C gets through between two.
            ended.wait(3600)
    finally:
        opener.close()
        for session in sessions:
            session.close()


def _end_as_by_ctrl_c() -> None:
    """Let a closed terminal, or the system's request to end, do what Ctrl-C does: files that pages sent are removed."""
    if threading.current_thread() is threading.main_thread():
        for name in ("SIGTERM", "SIGHUP"):
            number = getattr(signal, name, None)
            # `nohup` lets a closed terminal be ignored, which stays so.
            if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, signal.default_int_handler)


def _opened(
    input: str | None, own: OpenedOptions, options: SceneOptions, viewing: ViewOptions, *, quiet: bool
) -> ViewerState:
    from wavesplat._viewer.session.state import ViewerState

    if own.state is not None:
        from wavesplat._scene.documents import scene_files, scene_json

        external_files = options.opening.reader.external_files
        if str(own.state) == "-":
            document = scene_json.parse(sys.stdin.read(), Path.cwd(), external_files=external_files)
        else:
            document = scene_files.load(own.state, external_files=external_files)
        shown = {name: value for name, value in document.options.items() if name in ("quality", "kernel", "composite")}
        return ViewerState.of(document.scene, document.camera, shown, document.view)
    if own.example is not None:
        scene, look, operator = _of_example(own.example, options, quiet=quiet)
    else:
        scene, look, operator, _ = chosen_scene(str(input), options, quiet=quiet, all_times=True)
    camera = camera_for([scene], look, viewing, FIRST_SIZE)
    return ViewerState.of(scene, camera, {**own.render, "composite": operator})


def _of_example(name: str, options: SceneOptions, *, quiet: bool) -> tuple[Any, Any, Any]:
    """The scene of an example, its look, and the operator."""
    from wavesplat import examples
    from wavesplat._scene.scene import Scene

    showing = options.showing
    volume = getattr(examples, name)()
    look = showing.look(volume, name, options.colors, quiet=True)
    geometry = opened_geometry(showing, volume.facts.unit, quiet=quiet)
    scene = Scene(volume, look, background=showing.background or look.background or "black", geometry=geometry)
    return scene, look, showing.operator or look.composite


def _tell_how_to_reach(port: int) -> None:
    if os.environ.get("SSH_CONNECTION") and not (os.environ.get("DISPLAY") or sys.platform in ("win32", "darwin")):
        message(f"on the machine before you: ssh -N -L {port}:127.0.0.1:{port} THIS_MACHINE, then open the link there")
    message("Ctrl-C ends the viewer")
