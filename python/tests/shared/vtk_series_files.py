"""ParaView's lists of files, one for each time, as tests write them."""

from __future__ import annotations

import json


def save_pvd(path, files):
    sets = "".join(f'<DataSet timestep="{time}" part="0" file="{name}"/>' for time, name in files)
    path.write_text(f'<VTKFile type="Collection" version="0.1"><Collection>{sets}</Collection></VTKFile>')
    return path


def save_series(path, files):
    path.write_text(json.dumps({"file-series-version": "1.0", "files": [{"name": n, "time": t} for t, n in files]}))
    return path
