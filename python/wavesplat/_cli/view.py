"""`wavesplat view`."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer

from wavesplat._cli import parsers
from wavesplat._cli.crop_options import CutOptions, takes_cut_options
from wavesplat._cli.geometry_options import opened_geometry
from wavesplat._cli.layer_options import LayerOptions, takes_layer_options
from wavesplat._cli.light_options import LightOptions, takes_light_options
from wavesplat._cli.option_groups import given as options_given
from wavesplat._cli.printing import message, print_lines
from wavesplat._cli.processing_options import ProcessingOptions, takes_processing_options
from wavesplat._cli.reader_options import InputOrNone, ReaderOptions, takes_reader_options_but_channel
from wavesplat._cli.scene_options import SceneOptions, check_scene_options, chosen_scene, takes_scene_options
from wavesplat._cli.shared_options import Kernel, Quiet
from wavesplat._cli.transfer_function_options import ColorOptions, takes_color_options
from wavesplat._cli.view_options import ViewOptions, camera_for, check_view_options, takes_view_options
from wavesplat._cli.view_saving import SaveOptions, check_save_options, save_seen, takes_save_options
from wavesplat._files.addresses import is_address
from wavesplat._model.options import Quality
from wavesplat._viewer.example_names import EXAMPLES
from wavesplat.errors import ArgumentError, WavesplatError

if TYPE_CHECKING:
    from wavesplat._viewer.state import ViewerState

#: Size, pixels, of the window that the first view is framed for.
FIRST_SIZE = (1024, 768)
#: Seconds that an error waits for a page that can show it.
TELLING_S = 5.0


@takes_cut_options
@takes_light_options
@takes_reader_options_but_channel
@takes_layer_options
@takes_color_options
@takes_processing_options
@takes_scene_options
@takes_view_options
@takes_save_options
def view(
    input: InputOrNone = None,
    *,
    state: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.json", help="What the viewer saved, or a scene, instead of INPUT and its options; - is stdin."
        ),
    ] = None,
    example: Annotated[
        Any,
        typer.Option(
            metavar="NAME",
            parser=parsers.one_of(tuple(EXAMPLES)),
            help=f"Instead of INPUT one of {', '.join(EXAMPLES)}.",
        ),
    ] = None,
    layering: LayerOptions,
    showing: SceneOptions,
    colors: ColorOptions,
    viewing: ViewOptions,
    saving: SaveOptions,
    quality: Annotated[
        Any, typer.Option(metavar="NAME", parser=parsers.one_of(get_args(Quality)), help="Of the picture at rest.")
    ] = "normal",
    kernel: Kernel = "linear",
    cuts: CutOptions,
    lighting: LightOptions,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    port: Annotated[
        int, typer.Option(metavar="N", min=0, max=65535, help="Port of this machine; 0: one that is free.")
    ] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Whether to open the page.")] = True,
    quiet: Quiet = False,
) -> None:
    """Look at a volume and turn it, in the browser; without INPUT choose one there; Ctrl-C ends."""
    given = [
        name for name, value in (("INPUT", input), ("--state", state), ("--example", example)) if value is not None
    ]
    _check_named(given, showing, colors, viewing, layering, cuts, lighting, reader, processing)
    check_scene_options(showing, colors, cuts)
    check_view_options(viewing)
    _check_there(input)
    check_save_options(saving, input, is_named=bool(given))

    def opened() -> ViewerState:
        return _opened(
            input,
            state,
            example,
            external_files=reader.external_files,
            options={"quality": quality, "kernel": kernel},
            showing=showing,
            viewing=viewing,
            colors=colors,
            layering=layering,
            cuts=cuts,
            lighting=lighting,
            reader=reader,
            processing=processing,
            quiet=quiet,
        )

    if saving.save is not None:
        save_seen(saving, opened())
        return
    from wavesplat._viewer.server import Server

    _end_as_by_ctrl_c()
    server = Server(port)
    try:
        print_lines(server.link)
        if not quiet:
            _tell_how_to_reach(server.port)
        if browser:
            server.open_in_browser()
        if not given:
            _serve(server, None, render={"quality": quality, "kernel": kernel})
        server.send_progress(f"Opening {_name(input, state, example)}")
        try:
            first = opened()
        except WavesplatError as error:
            server.fail(str(error))
            # The page, which may not be there yet, gets the message before the server ends.
            if server.has_reported.wait(TELLING_S if browser else 0):
                threading.Event().wait(0.3)
            raise
        _serve(server, first, None if input is None else str(input))
    except KeyboardInterrupt:
        if not quiet:
            message("the viewer has ended")
    finally:
        server.close()


def _check_there(input: str | None) -> None:
    """Refuse a file that is not there before a page opens."""
    if input is not None and not is_address(input) and not Path(input).expanduser().exists():
        from wavesplat._files.size_checks import check_readable

        check_readable(Path(input).expanduser())


def _check_named(given: list[str], *groups: Any) -> None:
    """Refuse several things to open, and options about a volume where the page asks for a file."""
    if len(given) > 1:
        raise ArgumentError(f"{' and '.join(given)}: name one: a volume, --state FILE.json or --example NAME")
    named = [] if given else [name for group in groups for name in options_given(group)]
    if named:
        raise ArgumentError(
            f"INPUT: name one for {', '.join(named)}: a volume, --state FILE.json or --example NAME; without these "
            "options, and without INPUT, the page asks for a file"
        )


def _serve(
    server: Any, first: ViewerState | None, input: str | None = None, *, render: Mapping[str, str] | None = None
) -> None:
    """Serve a first state, or the start page and what is opened there with the settings `render`, until Ctrl-C."""
    from wavesplat._viewer.opening import Opener
    from wavesplat._viewer.recent import Recent
    from wavesplat._viewer.session import Session

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
    input: str | None,
    state: Path | None,
    example: str | None,
    *,
    external_files: bool,
    options: dict[str, Any],
    showing: SceneOptions,
    viewing: ViewOptions,
    colors: ColorOptions,
    **others: Any,
) -> ViewerState:
    from wavesplat._viewer.state import ViewerState

    if state is not None:
        from wavesplat._scene import scene_files, scene_json

        if str(state) == "-":
            document = scene_json.parse(sys.stdin.read(), Path.cwd(), external_files=external_files)
        else:
            document = scene_files.load(state, external_files=external_files)
        shown = {name: value for name, value in document.options.items() if name in ("quality", "kernel", "composite")}
        return ViewerState.of(document.scene, document.camera, shown, document.view)
    if example is not None:
        return _of_example(example, showing, viewing, colors, options, quiet=others["quiet"])
    chosen = chosen_scene(str(input), showing, colors=colors, all_times=True, **others)
    camera = camera_for([chosen.scene], chosen.look, viewing, FIRST_SIZE)
    return ViewerState.of(chosen.scene, camera, {**options, "composite": chosen.operator})


def _of_example(
    name: str,
    showing: SceneOptions,
    viewing: ViewOptions,
    colors: ColorOptions,
    options: dict[str, Any],
    *,
    quiet: bool,
) -> ViewerState:
    from wavesplat import examples
    from wavesplat._scene.scene import Scene
    from wavesplat._viewer.state import ViewerState

    volume = getattr(examples, name)()
    look = showing.look(volume, name, colors, quiet=True)
    geometry = opened_geometry(showing, volume.facts.unit, quiet=quiet)
    scene = Scene(volume, look, background=showing.background or look.background or "black", geometry=geometry)
    camera = camera_for([scene], look, viewing, FIRST_SIZE)
    return ViewerState.of(scene, camera, {**options, "composite": showing.operator or look.composite})


def _name(input: str | None, state: Path | None, example: str | None) -> str:
    if input is not None:
        return input.rstrip("/").rpartition("/")[2] or input
    return state.name if state is not None else str(example)


def _tell_how_to_reach(port: int) -> None:
    if os.environ.get("SSH_CONNECTION") and not (os.environ.get("DISPLAY") or sys.platform in ("win32", "darwin")):
        message(f"on the machine before you: ssh -N -L {port}:127.0.0.1:{port} THIS_MACHINE, then open the link there")
    message("Ctrl-C ends the viewer")
