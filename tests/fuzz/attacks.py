"""Results files that are not as they were written: bytes flipped and cut, parts swapped and linked."""

from __future__ import annotations

import io
from collections.abc import Callable
from contextlib import suppress
from random import Random

import h5py
import numpy as np


def attacked(whole: bytes, rng: Random) -> bytes:
    """The bytes of a results file after one attack."""
    return rng.choice((_flip, _flip, _flip, _bytes, _bytes, _parts, _parts, _parts))(whole, rng)


def _flip(whole: bytes, rng: Random) -> bytes:
    """One to eight bits."""
    data = bytearray(whole)
    for _ in range(rng.choice((1, 1, 1, 2, 8))):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return bytes(data)


def _bytes(whole: bytes, rng: Random) -> bytes:
    """A stretch cut off, left out, put in, blanked or written over."""
    a = rng.randrange(len(whole))
    n = rng.choice((1, 8, 100, 4096))
    way = rng.randrange(6)
    if way == 0:
        return whole[:a]
    if way == 1:
        return whole[:a] + whole[a + n :]
    if way == 2:
        return whole[:a] + rng.randbytes(n) + whole[a:]
    if way == 3:
        return whole[:a] + bytes(n) + whole[a + n :]
    if way == 4:
        return whole[:a] + b"\xff" * n + whole[a + n :]
    b = rng.randrange(len(whole))
    return whole[:a] + whole[b : b + n] + whole[a + n :]


def _parts(whole: bytes, rng: Random) -> bytes:
    """By HDF5: groups, datasets, links, attributes; the digest of the whole is looked at or not."""
    memory = io.BytesIO(whole)
    with h5py.File(memory, "r+") as file:
        names: list[str] = []
        file.visit(names.append)
        for _ in range(rng.choice((1, 1, 2))):
            with suppress(
                KeyError, ValueError, TypeError, RuntimeError, OSError, AttributeError
            ):  # an attack that HDF5 refuses
                rng.choice(ATTACKS)(file, sorted(names), rng)
        if rng.random() < 0.5:
            file.attrs["status"] = "running"  # a killed run, whose parts are looked at alone
            file.attrs["digest"] = ""
    return memory.getvalue()


def _drop(file: h5py.File, names: list[str], rng: Random) -> None:
    del file[rng.choice(names)]


def _swap(file: h5py.File, names: list[str], rng: Random) -> None:
    a, b = rng.sample(names, 2)
    file.move(a, "aside")
    file.move(b, a)
    file.move("aside", b)


def _link(file: h5py.File, names: list[str], rng: Random) -> None:
    a, b = rng.sample(names, 2)
    del file[a]
    file[a] = rng.choice(
        (h5py.SoftLink("/" + b), h5py.SoftLink("/" + a), h5py.ExternalLink("missing.h5", b), file[b])
    )


def _retype(file: h5py.File, names: list[str], rng: Random) -> None:
    name = rng.choice(names)
    del file[name]
    file[name] = rng.choice(
        (
            np.zeros(3),
            np.float64(1.0),
            "text",
            np.zeros((2, 0)),
            np.zeros((0,)),
            np.zeros(3, "i1"),
            h5py.Empty("f"),
        )
    )


def _grow(file: h5py.File, names: list[str], rng: Random) -> None:
    """More or fewer rows; a length that no memory holds."""
    history = file[rng.choice([n for n in names if n.startswith("history/")] or names)]
    history.resize(rng.choice((0, 1, len(history) + 1, 2**40)), axis=0)


def _attribute(file: h5py.File, names: list[str], rng: Random) -> None:
    item = file[rng.choice(names)] if rng.random() < 0.7 else file
    keys = sorted(item.attrs)
    if not keys:
        return
    key = rng.choice(keys)
    if rng.random() < 0.4:
        del item.attrs[key]
    else:
        item.attrs[key] = rng.choice(
            (
                0,
                -1,
                1e300,
                "",
                "x" * 2000,
                [],
                ["a"],
                [1, 2, 3],
                float("nan"),
                h5py.Empty("f"),
                np.zeros((2, 2)),
            )
        )


def _number(file: h5py.File, names: list[str], rng: Random) -> None:
    """One number of a dataset."""
    item = file[rng.choice(names)]
    if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and item.size:
        flat = item[()].reshape(-1)
        flat[rng.randrange(len(flat))] = rng.choice((np.nan, np.inf, 1e300, 0.0))
        item[...] = flat.reshape(item.shape)


ATTACKS: tuple[Callable[[h5py.File, list[str], Random], None], ...] = (
    _drop,
    _swap,
    _link,
    _retype,
    _grow,
    _attribute,
    _attribute,
    _number,
)
