"""Links object files to a shared library, by the compiler that builds extensions of Python."""

from __future__ import annotations

import os
import platform
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from setuptools._distutils.ccompiler import new_compiler
from setuptools._distutils.sysconfig import customize_compiler

WINDOWS, MACOS = "win32", "darwin"
SUFFIX = {WINDOWS: ".dll", MACOS: ".dylib"}.get(sys.platform, ".so")
#: what code calls: mathematical functions, and on Windows what fills memory and begins a library
LIBRARIES = ["ucrt", "vcruntime", "msvcrt"] if sys.platform == WINDOWS else ["m"]
#: a symbol that nothing defines is found at once
COMPLETE = ["-Wl,-z,defs"] if sys.platform not in (WINDOWS, MACOS) else []


def link(objects: Mapping[str, bytes], path: Path) -> None:
    """Link object files to a library.

    Parameters
    ----------
    objects : mapping
        Contents of the files by the name of the function that each has.
    path : Path
        Of the library.
    """
    if sys.platform == MACOS:  # a Python for several processors would ask for the code of all of them
        os.environ["ARCHFLAGS"] = f"-arch {platform.machine()}"
    compiler = new_compiler()
    customize_compiler(compiler)
    if sys.platform != WINDOWS:  # a folder of this machine, in which others would look for libraries
        compiler.linker_so = [word for word in compiler.linker_so if "rpath" not in word]
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder, f"{name}{compiler.obj_extension}") for name in objects]
        for own, content in zip(paths, objects.values()):
            own.write_bytes(content)
        compiler.link_shared_object(
            [str(own) for own in paths],
            str(path),
            libraries=LIBRARIES,
            export_symbols=list(objects),
            extra_postargs=COMPLETE,
        )
