"""What a sweep has before it: how many runs, which are skipped, what they will take."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from pound_solve.sweep.entry import DONE, Entry
from pound_solve.sweep.run import Run
from pound_solve.sweep.study import Study

SHOWN: Final = 20  #: runs of one kind that are listed
_WIDEST: Final = 100  #: characters of a reason


@dataclass(frozen=True)
class Agenda:
    """Runs of a study, or of a piece of it, by what is to be done with them.

    Attributes
    ----------
    ahead : tuple of Run
        To be carried out.
    done : tuple of Run
        Have ended with all.
    ended : tuple of Run
        Have stopped or failed, and are not tried again.
    """

    ahead: tuple[Run, ...]
    done: tuple[Run, ...]
    ended: tuple[Run, ...]

    @classmethod
    def of(cls, runs: Sequence[Run], entries: Mapping[str, Entry], retry: bool) -> Agenda:
        """Sort runs by what they have come to; `retry` tries those again that are not done."""
        ends = [entries[r.identity].status if r.identity in entries else "" for r in runs]
        return cls(
            tuple(r for r, end in zip(runs, ends) if not end or (retry and end != DONE)),
            tuple(r for r, end in zip(runs, ends) if end == DONE),
            tuple(r for r, end in zip(runs, ends) if end and end != DONE and not retry),
        )


def piece(runs: Sequence[Run], k: int, count: int) -> tuple[Run, ...]:
    """The k-th of some pieces of about the same length, k from 1."""
    return tuple(r for r in runs if (r.number - 1) % count == k - 1)


def lines(study: Study, agenda: Agenda, entries: Mapping[str, Entry]) -> Iterator[str]:
    """The plan in words."""
    decks = {r.case.deck for r in study.runs}
    cases = {r.case for r in study.runs}
    own = _many(len(decks), "deck"), f"{_many(len(cases), 'case')} of PARAMs", _shakings(study)
    yield f"{len(study.runs)} runs: {', '.join(own)}"
    for run in (study.runs[0], *study.runs[1:2], study.runs[-1]):
        yield f"  {run.number:6}  {run.title}"
    yield f"done before, skipped: {len(agenda.done)}"
    if agenda.ended:
        yield f"ended before without all, skipped (--retry tries them again): {len(agenda.ended)}"
        yield from reasons(agenda.ended, entries)
    yield f"to be run: {len(agenda.ahead)}"


def _many(count: int, word: str) -> str:
    return f"{count} {word}{'s' if count != 1 else ''}"


def _shakings(study: Study) -> str:
    if not study.measure:
        return "motions of the decks"
    own = [r.shaking for r in study.runs if r.shaking is not None]
    what = {"scale": "factor", "pga": "PGA", "sa": "Sa"}[study.measure]
    records, levels = len({s.record for s in own}), len({s.level for s in own})
    return f"{_many(records, 'record')}, {_many(levels, what)}"


def reasons(runs: Sequence[Run], entries: Mapping[str, Entry]) -> Iterator[str]:
    """Some runs that are not done, each with its reason in one line."""
    for run in runs[:SHOWN]:
        entry = entries[run.identity]
        reason = (entry.message.splitlines() or [""])[0].replace(f"{Path(run.case.deck).parent}/", "")
        yield f"  run {run.number} {run.title}: {entry.status}: {reason[:_WIDEST]}"
    if len(runs) > SHOWN:
        yield f"  and {len(runs) - SHOWN} more"


def estimate(trial: Sequence[Entry], left: int, workers: int, size: float) -> Iterator[str]:
    """What the runs that are left will take, from those of a trial.

    Parameters
    ----------
    trial : sequence of Entry
    left : int
    workers : int
    size : float
        Bytes that one run leaves on the disk.
    """
    cpu = sum(e.cpu for e in trial) / len(trial)
    beyond = 1000.0 * sum(e.cpu - e.solve for e in trial) / len(trial)
    yield f"trial: {len(trial)} runs, {cpu:.3g} s of CPU time each, {beyond:.0f} ms beyond the integration"
    seconds, disk = cpu * left / workers, size * left / 1e6
    yield f"the other {left}: about {seconds:.3g} s with {workers} at a time, {disk:.2g} MB"
