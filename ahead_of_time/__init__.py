"""Compiles the kernels ahead of time, for the wheel of a platform: ``python -m ahead_of_time FOLDER``.

`calls` sees which kernels runs call and with what arguments; `dispatch` makes functions that choose among
all rules by number; numba turns both into machine code (`machine_code`), which the platform's compiler
links (`link`).  Nothing here is installed; `hook` puts the libraries into a wheel.
"""
