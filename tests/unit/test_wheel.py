"""What pip asks of a wheel with compiled kernels: its tag, and a library that old systems can load."""

from __future__ import annotations

import ctypes
import importlib
import math
import platform
import re
import shutil
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
from packaging.tags import mac_platforms


@pytest.fixture
def hook(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The hook without hatchling, which only a build installs."""
    stub = SimpleNamespace(BuildHookInterface=object)
    monkeypatch.setitem(sys.modules, "hatchling.builders.hooks.plugin.interface", stub)
    return importlib.import_module("ahead_of_time.hook")


@pytest.mark.parametrize(
    ("python", "machine", "oldest", "tag"),
    [
        ("macosx-10.13-universal2", "arm64", "", "macosx_11_0_arm64"),
        ("macosx-10.13-universal2", "x86_64", "", "macosx_10_13_x86_64"),
        ("macosx-10.13-universal2", "x86_64", "10.15", "macosx_10_15_x86_64"),
        ("macosx-14.0-arm64", "arm64", "11.0", "macosx_11_0_arm64"),
        ("macosx-11.3-arm64", "arm64", "", "macosx_11_0_arm64"),
        ("macosx-13-x86_64", "x86_64", "", "macosx_13_0_x86_64"),
    ],
)
def test_macos_takes_the_tag(hook: ModuleType, python: str, machine: str, oldest: str, tag: str) -> None:
    assert hook.platform_tag(python, machine, oldest) == tag
    assert tag in mac_platforms((15, 0), machine)


@pytest.mark.parametrize("python", ["linux-x86_64", "linux-aarch64", "win-amd64"])
def test_other_tags_are_those_of_python(hook: ModuleType, python: str) -> None:
    assert hook.platform_tag(python, "any", "") == python.replace("-", "_")


#: every function that has a second version, called by name or by LLVM itself
CALLS = """
declare double @llvm.exp.f64(double)
declare double @llvm.pow.f64(double, double)
declare double @exp2(double)
declare double @log(double)
declare double @log2(double)
declare double @fmod(double, double)
define double @f(double %x) {
%a = call double @llvm.exp.f64(double %x)
%b = call double @llvm.pow.f64(double %a, double 1.3)
%c = call double @exp2(double %b)
%d = call double @log(double %c)
%e = call double @log2(double %d)
%g = call double @fmod(double %e, double 0.7)
ret double %g
}
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="symbols have versions in glibc only")
@pytest.mark.skipif(not shutil.which("cc"), reason="needs a C compiler")
def test_a_library_needs_no_young_system_and_no_folder_of_this_machine(tmp_path: Path) -> None:
    pytest.importorskip("numba")
    from ahead_of_time.link import link
    from ahead_of_time.machine_code import FIRST, machine_code

    path = tmp_path / "f.so"
    link({"f": machine_code("f", CALLS)}, path)
    content = path.read_bytes()
    assert {*re.findall(rb"GLIBC_[\d.]+", content)} == {FIRST[platform.machine()].encode()}
    assert sys.base_prefix.encode() not in content and str(tmp_path).encode() not in content
    f = ctypes.CDLL(str(path)).f
    f.argtypes, f.restype = [ctypes.c_double], ctypes.c_double
    for x in (0.1, 0.7, 1.1):
        assert f(x) == math.fmod(math.log2(math.log(2.0 ** math.exp(x) ** 1.3)), 0.7)
