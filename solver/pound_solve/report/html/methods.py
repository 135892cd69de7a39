"""Pictures of the page that show a study of the methods."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pound_solve.report.html.picture import PlotlyPicture, curve
from pound_solve.report.plot.pictures import study
from pound_solve.results import Results


def errors_of_methods(results: Results) -> Iterator[PlotlyPicture]:
    """Pictures of the largest error of every run over its time and its steps."""
    if not all(map(results.holds, study.SPEC.needs)):
        return
    targets = results.table("study_advice")["target"]
    for cost, axis in study.costs(results).items():
        runs = [run for run in study.errors(results, cost) if len(run[1])]
        traces = [curve(*run) | {"mode": "lines+markers"} for run in runs]
        span = np.array([f(np.concatenate([x for _, x, _ in runs])) for f in (np.min, np.max)])
        gap = [np.nan]
        x = np.concatenate([[*span, *gap] for _ in targets])
        look = {"line": {"color": "#777", "dash": "dash", "width": 1}, "hoverinfo": "skip"}
        traces.append(curve("advised", x, np.repeat(targets, 3)) | look)
        note = "The dashed lines are the errors for which the study advises a method."
        title = f"Largest error over {axis.partition(' [')[0]}"
        yield PlotlyPicture(title, note, axis, "largest error [-]", traces, log=True)
