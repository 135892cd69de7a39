"""Quantities of a sweep over a PARAM, as data and as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pound_solve.cli.main import main
from pound_solve.report.sweep import trends
from pound_solve.results.sweep_file import Sweep, Variable, write
from pound_solve.statistics.curves import PARAM, CurveError

GAPS, RECORDS, LEVELS = (0.02, 0.01, 0.04), ("a", "b", "c"), (0.2, 0.4)


def sweep_of(missing: int = -1) -> Sweep:
    """Runs whose force is a known function of gap, record and level; one run stopped."""
    runs = [(g, r, s) for g in GAPS for r in RECORDS for s in LEVELS]
    gap, record, level = (np.array(x) for x in zip(*runs))
    force = np.array([[force_of(*run), 0.0] for run in runs])
    status = np.array(["done"] * len(runs), object)
    if missing >= 0:
        status[missing] = "stopped"
    variables = {
        "run": Variable(np.arange(1, len(runs) + 1)),
        "deck": Variable(np.array(["pair.inp"] * len(runs), object)),
        "gap": Variable(gap, doc=f"{PARAM}gap"),
        "k": Variable(np.full(len(runs), 5.0), doc=f"{PARAM}k"),
        "record": Variable(np.array(record, object)),
        "pga": Variable(level),
        "status": Variable(status),
        "reached": Variable(np.full(len(runs), 3.0)),
        "contact_force": Variable(force, "contact", "kN"),
    }
    return Sweep(variables, {"contact": ("roof", "floor")}, {"units": "kN m s"})


def force_of(gap: float, record: str, level: float) -> float:
    return float(1000.0 * level * (1 + RECORDS.index(record)) / (1.0 + gap))


def test_a_trend_has_the_fractiles_of_its_records_in_the_order_of_the_param() -> None:
    (panel,) = trends.panels(sweep_of())
    assert (panel.quantity, panel.unit) == ("contact_force", "kN")
    assert [trend.title for trend in panel.trends] == ["pga 0.2", "pga 0.4"]
    for trend, level in zip(panel.trends, LEVELS):
        assert trend.x.tolist() == sorted(GAPS) and len(trend.records) == len(RECORDS)
        for (x, y), record in zip(trend.records, RECORDS):
            assert y.tolist() == [force_of(gap, record, level) for gap in x]
        for n, record in enumerate(RECORDS):  # of three records each fractile is one of them
            assert trend.fractiles[n].tolist() == [force_of(gap, record, level) for gap in trend.x]


def test_a_run_that_stopped_has_no_value() -> None:
    (panel,) = trends.panels(sweep_of(missing=0))
    (x, y) = panel.trends[0].records[0]
    assert np.isnan(y[x == 0.02]).all() and np.isfinite(y[x != 0.02]).all()
    assert np.isfinite(panel.trends[0].fractiles).all()


@pytest.mark.parametrize(
    ("over", "quantities", "told"),
    [("k", (), "PARAM k vary in this sweep; there are: gap"), ("", ("fame",), "there is no quantity fame")],
)
def test_what_is_not_there_is_told(over: str, quantities: tuple[str, ...], told: str) -> None:
    with pytest.raises(CurveError, match=told):
        trends.panels(sweep_of(), over, quantities)


def test_the_verb_plot_draws_a_sweep(tmp_path: Path, capsys: Any) -> None:
    pytest.importorskip("matplotlib")
    path = tmp_path / "sweep.h5"
    write(sweep_of(), path)
    for words, told in (
        ([], ""),
        (["contact_force", "--over", "gap"], ""),
        (["--over", "k"], "there are: gap"),
        (["--as", "gif"], "the picture of a sweep is written as svg, png, pdf"),
        (["--time", "0"], "--time does not belong to the picture of a sweep"),
    ):
        assert main(["plot", str(path), *words]) == (2 if told else 0)
        out, err = capsys.readouterr()
        assert out == ("" if told else f"{tmp_path / 'sweep_trends.svg'}\n") and told in err
    sheet = tmp_path / "own.mplstyle"
    sheet.write_text("axes.facecolor: 123456\n")
    assert main(["plot", str(path), "--style", str(sheet), "-o", str(tmp_path / "own")]) == 0
    text = (tmp_path / "own" / "sweep_trends.svg").read_text("utf-8")
    assert (
        "#123456" in text and "pga 0.4, median" in text and "contact force [kN]" in text and ">gap<" in text
    )
