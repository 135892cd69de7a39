"""Steps of records: those of earthquakes are not doubted, ten times as long or as short ones are."""

import pytest

from pound_solve.loading.motions.base import LoadingContext
from pound_solve.loading.motions.doubts import pace, reason_mispaced
from pound_solve.loading.motions.record import samples
from pound_solve.loading.piecewise import Piecewise
from pound_solve.loading.records.known import KNOWN


def record(name, stretched=1.0):
    found = samples({"FILE": name, "TSCALE": stretched}, LoadingContext(9.81))
    return Piecewise.from_samples(found.t, found.values)


@pytest.mark.parametrize("name", sorted(KNOWN))
def test_no_step_of_a_record_is_doubted(name):
    assert not reason_mispaced(record(name))
    period, duration = pace(record(name))
    assert 0.1 < period < 1.5 and 3.0 < duration < 100.0


@pytest.mark.parametrize(
    ("stretched", "told"), [(10.0, "lake beds have 2 s"), (0.1, "hard rock has 0.05 s")]
)
def test_ten_times_the_step_is_told(stretched, told):
    assert told in reason_mispaced(record("ELCENTRO_180", stretched))
    period, duration = pace(record("ELCENTRO_180"))
    assert pace(record("ELCENTRO_180", stretched)) == pytest.approx(
        (stretched * period, stretched * duration)
    )


def test_what_does_not_swing_has_no_pace():
    assert pace(Piecewise.from_samples(range(200), [1.0] * 200)) == (0.0, 0.0)
    assert pace(Piecewise.from_samples([0.0, 1.0], [1.0, -1.0])) == (0.0, 0.0)
