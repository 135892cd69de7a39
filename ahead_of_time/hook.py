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


def platform_tag() -> str:
    """Tag of the platform that code is compiled for."""
    own = sysconfig.get_platform().replace("universal2", platform.machine())
    return own.replace("-", "_").replace(".", "_")


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
        build_data["tag"] = f"py3-none-{platform_tag()}"
