"""Made-up layouts of every history, for tests of files, reports and exports."""

from __future__ import annotations

from pound_solve.results.histories import energy, nodes, reactions
from pound_solve.results.histories.buildings import base_layout, storey_layout
from pound_solve.results.schema import HistoryLayout, Layout

NODES = (1, 2, 3, 4, 100, 101, 102, 300, 301, 302)
STOREYS = [("A", 1), ("A", 2)]

LAYOUTS: Layout = {
    "energy": energy.LAYOUT,
    "node/u": nodes.layout(NODES, ""),
    "node/v": nodes.layout(NODES, "/T"),
    "node/a": nodes.layout(NODES, "/T^2"),
    "drift": HistoryLayout((1,), {"labels": ["B1 storey 1"], "unit": "L"}),
    "building/base": base_layout(["A"]),
    "storey/drift": storey_layout("-", STOREYS),
    "storey/shear": storey_layout("F", STOREYS),
    "storey/moment": storey_layout("F*L", STOREYS),
    "storey/acceleration": storey_layout("L/T^2", STOREYS),
    "contact/gap": HistoryLayout((2,), {"labels": ["901", "902"], "unit": "L"}),
    "contact/force": HistoryLayout((2,), {"labels": ["901", "902"], "unit": "F"}),
    "member/force": HistoryLayout(
        (3,),
        {"element": [101, 101, 102], "quantity": ["axial", "moment I", "axial"], "unit": ["F", "F*L", "F"]},
    ),
    "spring/force": HistoryLayout((0,), {"labels": [], "unit": "F"}),
    "spring/deformation": HistoryLayout(
        (2,), {"element": [11, 12], "quantity": ["X", "R"], "unit": ["L", "rad"]}
    ),
    "reaction": reactions.layout((1, 4)),
    "ground": HistoryLayout((1,), {"labels": ["elcentro"], "unit": "L/T^2"}),
    "force": HistoryLayout((1,), {"labels": ["1 SINE"]}),
}
