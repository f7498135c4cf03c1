"""The interactive viewer from Python: in a notebook a widget, else a page of the browser."""

from __future__ import annotations

import json
import sys
import threading
import weakref
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal

from wavesplat import _native
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.clips import Clip
from wavesplat._model.arguments.operators import Operator
from wavesplat._model.arguments.sampling import Kernel, Quality
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.sources import beside, warn_of_elsewhere
from wavesplat._picture.picture import Picture
from wavesplat._public import public
from wavesplat._scene.documents import scene_json
from wavesplat._scene.scene import Scene, as_scene
from wavesplat._storage import json_texts
from wavesplat._storage.paths import expanded
from wavesplat._system.values import described
from wavesplat._viewer.opening.opening import Opener
from wavesplat._viewer.page_requests import export_html
from wavesplat._viewer.page_requests.seen import Shown, check_shown, seen
from wavesplat._viewer.session.session import Session
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from typing import Self

#: Pixels of pictures whose size is not given.
PICTURE_SIZE = (1024, 768)


@public
class Viewer:
    """A viewer that `view` opened; it is shown until it is closed, or Python ends.

    Attributes
    ----------
    url : str or None
        A link that lets one page in; None in a notebook. Each time it is asked for it is another one.

    Examples
    --------
    >>> import wavesplat as ws
    >>> with ws.view(ws.examples.ripples(16), browser=False) as viewer:
    ...     viewer.camera = viewer.camera.turned(azimuth=30)
    ...     viewer.picture((32, 24)).size
    (32, 24)
    """

    def __init__(self, state: ViewerState, *, port: int | None) -> None:
        self._listeners: list[Callable[[Viewer], object]] = []
        self._closed = threading.Event()
        whole = weakref.ref(self)

        def changed(_state: ViewerState, cause: str) -> None:
            viewer = whole()
            if viewer is not None and cause == "page":
                for listener in tuple(viewer._listeners):
                    listener(viewer)

        session = self._session = Session(state, changed)
        self._opener = Opener(lambda: session.state)
        self._server: Any = None
        self._widget: Any = None
        self._finalizer: Any = weakref.finalize(self, _close_all, self._opener, session)
        if port is not None:
            from wavesplat._viewer.server.server import Server

            self._serve(Server(port))

    def _serve(self, server: Any) -> None:
        self._server = server
        server.show(self._session)
        server.offer(self._opener)
        self._finalizer.detach()
        self._finalizer = weakref.finalize(self, _close_all, server, self._opener, self._session)

    def _open_in_browser(self) -> None:
        if self._server is not None:
            self._server.open_in_browser()

    @property
    def url(self) -> str | None:
        """A new link, which lets one page in; None in a notebook."""
        link: str | None = None if self._server is None else self._server.link
        return link

    @property
    def state(self) -> dict[str, Any]:
        """The state as a document (JSON): the document of the scene, with the fields `camera`, `render` and `view`.

        A copy; setting it shows another one, of the same volumes.
        """
        document: dict[str, Any] = json.loads(json.dumps(self._session.state.document))
        return document

    @state.setter
    def state(self, document: Mapping[str, Any]) -> None:
        _native.check_values(document, "state")
        self._session.change(self._session.state.replaced(json.loads(json.dumps(dict(document)))))

    @property
    def scene(self) -> Scene:
        """The scene with the looks that were chosen; setting it shows another scene, of any volumes."""
        return self._session.state.scene

    @scene.setter
    def scene(self, scene: Scene) -> None:
        if not isinstance(scene, Scene):
            raise ArgumentError(f"scene is {described(scene)}; give a wavesplat.Scene")
        before = self._session.state
        self._session.change(before.with_scene(scene))

    @property
    def camera(self) -> Camera:
        """The camera of the picture in space; may be set."""
        return self._session.state.camera

    @camera.setter
    def camera(self, camera: Camera) -> None:
        if not isinstance(camera, Camera):
            raise ArgumentError(f"camera is {described(camera)}; give a wavesplat.Camera")
        self._session.change(self._session.state.with_camera(camera))

    def on_change(self, callback: Callable[[Viewer], object]) -> Callable[[], None]:
        """Call a function, with the viewer, after each change in a page; what is returned ends that.

        It is called in a thread of the viewer, and should be quick.

        Examples
        --------
        >>> import wavesplat as ws
        >>> viewer = ws.view(ws.examples.ripples(16), browser=False)
        >>> stop = viewer.on_change(lambda viewer: print(viewer.camera))
        >>> stop()
        >>> viewer.close()
        """
        self._listeners.append(callback)

        def stop() -> None:
            if callback in self._listeners:
                self._listeners.remove(callback)

        return stop

    @takes_its_types
    def picture(
        self,
        size: tuple[int, int] = PICTURE_SIZE,
        *,
        quality: Quality | None = None,
        shown: Shown = "3d",
        marks: bool | None = None,
    ) -> Picture:
        """The picture of a view, or of all four, drawn anew.

        Parameters
        ----------
        size : (width, height)
            Pixels.
        quality : str, optional
            "draft", "normal", "fine" or "high"; None is the quality of the viewer at rest.
        shown : str
            "3d"; a slice by the axis across it: "z" (axial of a body), "y", "x"; or "all", two by two.
        marks : bool, optional
            Whether measures, scale bars, letters, colour bar and legend are drawn, as far as they are switched on in
            the viewer; None: of slices and "all".

        Raises
        ------
        ArgumentError
            If an argument cannot work.
        """
        state = self._session.state
        if quality is not None:
            state = state.patched([{"op": "replace", "path": "/render/quality", "value": quality}])
        chosen = check_shown(shown)
        return seen(state, chosen, size, marks=chosen != "3d" if marks is None else marks)

    @takes_its_types
    def save(
        self,
        path: str | PathLike[str],
        *,
        size: tuple[int, int] = PICTURE_SIZE,
        shown: Shown = "3d",
        marks: bool | None = None,
    ) -> None:
        """Write the state, or a picture of it, to a file.

        Parameters
        ----------
        path : path
            .json: the state, for `wavesplat view --state`, `Scene.load` and `wavesplat render --from`. .html: a page
            with the picture in it. Else a picture, as `Picture.save` writes it.
        size : (width, height)
            Pixels of the picture.
        shown, marks
            As for `picture`.

        Raises
        ------
        FileError
            If the file cannot be written; nothing is left behind.

        Warns
        -----
        WavesplatWarning
            If a volume does not lie in the folder of the state, so that opening it needs `--external-files`.
        """
        suffix = expanded(path).suffix.lower()
        if suffix == ".json":
            document = beside(self._session.state.file_document(size), expanded(path).absolute().parent)
            json_texts.save(path, scene_json.write(document))
            warn_of_elsewhere(document, path, stacklevel=2)
        elif suffix == ".html":
            json_texts.save(path, export_html.page_of(self._session.state, self.picture(size)))
        else:
            self.picture(size, shown=shown, marks=marks).save(path)

    def wait(self) -> None:
        """Wait until the viewer is closed, or Ctrl-C: for scripts, which else end at once, and the page with them.

        Examples
        --------
        >>> import threading, wavesplat as ws
        >>> viewer = ws.view(ws.examples.ripples(16), browser=False)
        >>> threading.Timer(0.1, viewer.close).start()
        >>> viewer.wait()
        """
        try:
            # The wait is cut into steps, so that Ctrl-C gets through on all systems.
            while not self._closed.wait(1.0):
                pass
        except KeyboardInterrupt:
            self.close()

    def close(self) -> None:
        """Close the viewer, and let go of the volumes."""
        self._finalizer()
        self._listeners.clear()
        self._closed.set()

    def _repr_mimebundle_(self, **options: Any) -> Any:
        """Output of a notebook's cell: the widget, and a picture for where notebooks are only read."""
        from wavesplat._viewer import notebook

        return notebook.bundle_of(self, **options)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        where = "" if self._server is None else f" at http://127.0.0.1:{self._server.port}"
        names = ", ".join(repr(layer.name) for layer in self.scene.layers)
        return f"<Viewer: {names}{where}>"


@public
@takes_its_types
def view(
    what: Any,
    look: Any = None,
    *,
    labels: Labels | None = None,
    shading: Shading | Literal["look"] | None = "look",
    clip: Clip | Sequence[Clip] = (),
    background: str | Sequence[float] | None = None,
    camera: Camera | str | None = None,
    quality: Quality = "normal",
    kernel: Kernel = "linear",
    composite: Operator | None = None,
    state: Mapping[str, Any] | None = None,
    port: int = 0,
    browser: bool | None = None,
) -> Viewer:
    """Open a volume or a scene in the interactive viewer.

    Parameters
    ----------
    what : Volume, Scene, array, Layer, or several in a list
        As for `Scene`.
    look, labels, shading, clip, background
        As for `Scene`.
    camera, quality, kernel, composite
        As for `Scene.render`: how the picture at rest is drawn.
    state : mapping, optional
        The field `view` of a state that was saved, or a whole one, of which looks and all else of the scene are taken.
    port : int, default 0
        Where the page is served, on this machine alone; 0 is any that is free.
    browser : bool, optional
        Whether to open a page in the browser; None: outside of notebooks, in which it is a widget.

    Returns
    -------
    Viewer
        It is shown as long as it is kept; a script that has nothing else to do ends with `viewer.wait()`.

    Raises
    ------
    ArgumentError
        If an argument cannot work.
    LibraryError
        If a notebook needs `anywidget`, which the extra `notebook` brings.

    Examples
    --------
    >>> import wavesplat as ws
    >>> viewer = ws.view(ws.examples.ct_pelvis(), "ct-bone", browser=False)
    >>> viewer.scene.layers[0].look.name
    'ct-bone'
    >>> viewer.close()
    """
    scene = as_scene(what, look, labels=labels, shading=shading, clip=clip, background=background)
    options = {"quality": quality, "kernel": kernel, "composite": composite}
    if not isinstance(state, Mapping | None):
        raise ArgumentError(f"state is {described(state)}; give a state that was saved, or its field view")
    _native.check_values(state, "state")
    is_whole = state is not None and "layers" in state
    first = ViewerState.of(scene, camera, options, state.get("view") if is_whole and state else state)
    if is_whole:
        from wavesplat._viewer.page_requests.questions import state_from_text

        first = state_from_text(first, json.dumps(state)).begun()
    in_notebook = browser is None and is_notebook()
    viewer = Viewer(first, port=None if in_notebook else port)
    if in_notebook:
        from wavesplat._viewer import notebook

        notebook.check()
    elif browser is not False:
        viewer._open_in_browser()
    return viewer


def is_notebook() -> bool:
    """Whether this is a kernel of Jupyter, VS Code or Colab, or a marimo notebook."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    if shell is not None and type(shell).__name__ in ("ZMQInteractiveShell", "Shell"):
        return True
    marimo = sys.modules.get("marimo")
    return marimo is not None and bool(marimo.running_in_notebook())


def _close_all(*parts: Any) -> None:
    for part in parts:
        part.close()
