"""Puts the compiled kernels into a wheel, which is then one of a platform: a hook of hatchling.

HATCH_BUILD_HOOK_ENABLE_CUSTOM=1 in the environment asks for it; else a wheel is of Python alone.
"""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


def platform_tag(python: str, machine: str, oldest: str) -> str:
    """Tag of the platform that code is compiled for.

    Parameters
    ----------
    python : str
        The platform of Python, which on macOS may have several processors.
    machine : str
        The processor.
    oldest : str
        The oldest macOS that the compiler is asked for; empty: that of Python.
    """
    if python.startswith("macosx"):
        release = oldest or python.split("-")[1]
        major, minor = [int(part) for part in f"{release}.0".split(".")[:2]]
        if major > 10 or machine == "arm64":  # the first macOS for arm64 is 11, and tags have no 11.1
            major, minor = max(major, 11), 0
        python = f"macosx-{major}.{minor}-{machine}"
    return python.replace("-", "_").replace(".", "_")


class KernelsHook(BuildHookInterface):  # type: ignore[misc] # not installed where types are checked
    """The hook."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Packages that the compilation needs: it runs the program, numba and a compiler."""
        core = self.metadata.core
        return [*core.dependencies, *core.optional_dependencies["fast"], "setuptools"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile, and add the libraries to the files of the wheel."""
        if version == "editable":
            return
        root = Path(self.root)
        folder = root / "build" / "kernels"
        shutil.rmtree(folder, ignore_errors=True)
        path = os.pathsep.join(str(root / own) for own in ("solver", "parser", "."))
        environment = {**os.environ, "PYTHONPATH": path}
        command = [sys.executable, "-m", "ahead_of_time", str(folder)]
        subprocess.run(command, cwd=root, env=environment, check=True)
        for own in folder.iterdir():
            build_data["force_include"][str(own)] = f"pound_solve/numerics/{own.name}"
        build_data["pure_python"] = False
        oldest = os.environ.get("MACOSX_DEPLOYMENT_TARGET", "")
        tag = platform_tag(sysconfig.get_platform(), platform.machine(), oldest)
        build_data["tag"] = f"py3-none-{tag}"
