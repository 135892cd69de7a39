"""Ground motions, forces and initial velocities.

A motion accelerates the whole base (UniformExcitation).  A SINE is the series Trig; others are straight
lines between samples, which stand in a file of times and accelerations beside the script.
"""

from __future__ import annotations

import numpy as np

from pound_solve.loading.forces.base import Force
from pound_solve.loading.motions.base import GroundMotion
from pound_solve.loading.piecewise import Piecewise
from pound_solve.opensees.script import Script, literal
from pound_solve.structure.dofs import DIRECTIONS


def motions(script: Script, shaken: tuple[GroundMotion, ...], stem: str) -> None:
    """Write the motions of the EQUAKE cards; `stem` begins the names of the files of samples."""
    cards = script.model.equake
    refused = False
    for card in cards:
        for item in ("SUPPORTS", "WAVE"):
            if card[item] is not None:
                script.refuse(f"a motion of some supports ({item})", card.place(item))
                refused = True
        if card["DIRECTION"] == "R":
            script.refuse("a rotation of the ground", card.place("DIRECTION"))
            refused = True
    if refused:
        return
    for n, (card, motion) in enumerate(zip(cards, shaken, strict=True), 1):
        series = script.tag()
        if card.spec.name == "SINE":
            _sine(script, series, motion)
        elif motion.acceleration.degree <= 1:
            _samples(script, series, motion.acceleration, f"{stem}_motion{n}.txt")
        else:
            script.refuse(f"the motion {card.spec.name}, which is no straight lines", card.span)
            continue
        script.settled &= float(motion.acceleration.value(0.0)) == 0.0
        direction = "XY".index(motion.direction) + 1
        script.call("motion", "pattern", "UniformExcitation", series, direction, "-accel", series)


def _sine(script: Script, series: int, motion: GroundMotion) -> None:
    """Write a series Trig."""
    info = motion.info
    times = info["start"], motion.acceleration.end, info["period"]
    amplitude = ("-factor", info["amplitude"], "-shift", info["phase"])
    script.call("motion", "timeSeries", "Trig", series, *times, *amplitude)


def _samples(script: Script, series: int, history: Piecewise, name: str) -> None:
    """Write a series Path that reads its samples from a file of the script."""
    t, a = corners(history)
    rows = "".join(f"{x!r} {y!r}\n" for x, y in zip(t.tolist(), a.tolist()))
    script.files[name] = rows
    script.lines["motion"].append(f"times, ordinates = samples({literal(name)})")
    words = f'"Path", {series}, "-time", *times, "-values", *ordinates'
    script.lines["motion"].append(f"ops.timeSeries({words})")


def corners(history: Piecewise) -> tuple[np.ndarray, np.ndarray]:
    """Times and values between which a history is straight, shape (n,) each; at a jump two times differ by
    rounding.
    """
    lines = history.chords()
    t, (start, slope) = lines.breaks, lines.coefs
    end = start + slope * np.diff(t)
    jump = np.abs(end[:-1] - start[1:]) > 1e-9 * np.abs(start).max(initial=1e-300)
    before = np.flatnonzero(jump) + 1
    times = np.insert(np.append(t[:-1], t[-1]), before, np.nextafter(t[before], -np.inf))
    values = np.insert(np.append(start, end[-1]), before, end[before - 1])
    return times, values


def velocities(script: Script) -> None:
    """Write the initial velocities; displacements are refused.

    The constraint handler Plain takes the velocity of the last of several nodes that move as one, so each
    of them is given it.  Transformation takes that of the master.
    """
    nodes = script.model.nodes.values()
    for card in script.model.initial:
        for item in ("UX", "UY", "UR"):
            if card[item]:
                script.refuse("an initial displacement", card.place(item))
        for node in card["NODES"]:
            for direction, item in enumerate(("VX", "VY", "VR"), 1):
                if card[item]:
                    script.settled = False
                    letter = DIRECTIONS[direction - 1]
                    tied = [n.id for n in nodes if n.slaved.get(letter) == node and not script.arms]
                    for each in (node, *tied):
                        script.call("motion", "setNodeVel", each, direction, card[item], "-commit")


def forces(script: Script, acting: tuple[Force, ...], stem: str) -> None:
    """Write the forces that vary along straight lines; `stem` begins the names of their files."""
    for n, (card, force) in enumerate(zip(script.model.forces, acting, strict=True), 1):
        if force.history.degree > 1:
            script.refuse(f"a force that is no straight lines (FORCES {card.spec.name})", card.span)
            continue
        series = script.tag()
        _samples(script, series, force.history, f"{stem}_force{n}.txt")
        script.settled &= float(force.history.value(0.0)) == 0.0
        script.call("motion", "pattern", "Plain", series, series)
        for node in force.nodes:
            script.call("motion", "load", node, *force.push)
