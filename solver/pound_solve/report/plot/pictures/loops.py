"""Picture `loops`: force against deformation of springs, hinges and contacts."""

from __future__ import annotations

from typing import Any

from pound_solve.report.plot import style
from pound_solve.report.plot.members import chosen_contacts, chosen_springs, refuse
from pound_solve.report.plot.pictures import contacts
from pound_solve.report.plot.schema import Choice, Nothing, Picture
from pound_solve.results import Results

MOST = 16  #: panels
LEAST = 1e-6  #: plastic work of a panel, as a fraction of the largest


def loops(results: Results, choice: Choice) -> Any:
    """Draw the chosen springs, hinges and contacts, or those with the largest plastic work."""
    springs = "spring/force" in results.histories
    if not choice.member:
        if not springs:
            raise Nothing("springs and hinges")
        count = len(results.labels("spring/force"))
        shown, closed = _yielded(results), list[int]()
        more = (
            f": {len(shown)} of {count}, those with the largest plastic work" if len(shown) < count else ""
        )
        title = f"Springs and hinges{more}"
    else:
        shown = chosen_springs(results, choice) if springs else []
        closed = chosen_contacts(results, choice, refused=False)
        refuse(results, choice, ("spring", "contact"))
        title = ""
    each = (3.4, 2.6) if len(shown) + len(closed) > 1 else (6.0, 4.4)
    figure, all_axes = style.panels(len(shown) + len(closed), title, each)
    for axes, k in zip(all_axes, shown):
        panel(axes, results, k, choice)
    for axes, k in zip(all_axes[len(shown) :], closed):
        contacts.panel(axes, results, k, choice)
    return figure


def panel(axes: Any, results: Results, k: int, choice: Choice) -> None:
    """Draw the force of a spring over its deformation."""
    rows = choice.span(results)
    force, deformation = results.history("spring/force"), results.history("spring/deformation")
    deformed = results.history_units("spring/deformation")[k]
    turns = deformed == "rad"
    style.grid(
        axes,
        f"{'rotation' if turns else 'deformation'} [{deformed}]",
        f"{'moment' if turns else 'force'} [{results.history_units('spring/force')[k]}]",
    )
    axes.plot(deformation[rows, k], force[rows, k], color=style.BLUE, linestyle="-", linewidth=0.8)
    axes.margins(0.05)
    axes.set_title(results.labels("spring/force")[k])


def _yielded(results: Results) -> list[int]:
    """Indices of the springs with the largest plastic work; of the first ones where none has any."""
    labels = results.labels("spring/force")
    work = dict.fromkeys(labels, 0.0)
    if "spring_envelope" in results.tables:
        for row in results.table("spring_envelope"):
            work[f"{row['element']} {row['component']}"] = float(row["plastic_work"])
    least = LEAST * max(work.values(), default=0.0)
    chosen = [k for k, label in enumerate(labels) if work[label] > least] or list(range(len(labels)))
    return sorted(sorted(chosen, key=lambda k: -work[labels[k]])[:MOST])


SPEC = Picture(
    name="loops",
    place=150,
    shows="force over deformation of springs and hinges: those that yielded most, or those chosen",
    needs=("time",),
    draw=loops,
    options=("member", "between"),
)
