"""Where compiled kernels are kept, whose code is never loaded, and what is told where none can be kept."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from kernels import NUMBA
from pound_solve.cli.progress import StatusLine
from pound_solve.numerics import jit, kernel_cache
from pound_solve.numerics.digest import digest
from pound_solve.numerics.kernel_cache import MAX_AGE, NOT_KEPT, VARIABLE, CacheFolder

POSIX = pytest.mark.skipif(not hasattr(os, "getuid"), reason="folders have no owners here")
OWN = f"pound-solve-{os.getuid() if hasattr(os, 'getuid') else 0}"
#: compiles one small function, and prints whether that was needed, where it is kept and what is told
TINY = """
from pound_solve.numerics import jit, kernel_cache
def twice(x):
    return 2.0 * x
cold = jit.cold(twice)
assert jit.compiled(twice)(2.0) == 4.0
print(cold, *kernel_cache.cache_folder(), sep="|")
"""


@pytest.fixture
def places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Home and temporary folder within a folder; nothing is named, and nothing known of earlier."""
    for name in (VARIABLE, "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, folder in (("HOME", "home"), ("LOCALAPPDATA", "home"), ("TMPDIR", "tmp")):
        monkeypatch.setenv(name, str(tmp_path / folder))
        (tmp_path / folder).mkdir(exist_ok=True)
    monkeypatch.setattr(kernel_cache.tempfile, "tempdir", str(tmp_path / "tmp"))
    return tmp_path


def cache_folder() -> CacheFolder:
    return kernel_cache.cache_folder.__wrapped__()


def no_home(places: Path) -> None:
    """A file where the home was: no folder can be made in it, not even by root."""
    (places / "home").rmdir()
    (places / "home").write_text("")


def test_kernels_are_kept_in_the_users_cache_folder(places: Path) -> None:
    assert cache_folder() == CacheFolder(kernel_cache.user_cache() / digest())
    assert places / "home" in kernel_cache.user_cache().parents


def test_without_platformdirs_too(places: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "platformdirs", None)
    assert cache_folder().folder == places / "home/.cache/pound-solve" / digest()
    monkeypatch.setenv("XDG_CACHE_HOME", str(places / "xdg"))
    assert cache_folder().folder == places / "xdg/pound-solve" / digest()


def test_a_folder_that_is_named_comes_first(places: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, str(places / "named"))
    assert cache_folder() == CacheFolder(places / "named" / digest())


def test_a_named_folder_that_cannot_be_written_is_told(
    places: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    named = places / "named"
    named.write_text("")
    monkeypatch.setenv(VARIABLE, str(named))
    found = cache_folder()
    assert found.folder == kernel_cache.user_cache() / digest()
    assert f"{VARIABLE}={named}" in found.notice and str(found.folder.parent) in found.notice


@pytest.mark.parametrize("platformdirs", [True, False])
def test_without_a_home_no_folder_of_that_name_appears(
    places: Path, monkeypatch: pytest.MonkeyPatch, platformdirs: bool
) -> None:
    """A container runs as a user that no file knows: `~` stays as it is, or a library complains."""
    monkeypatch.chdir(places)
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    if not platformdirs:
        monkeypatch.setitem(sys.modules, "platformdirs", None)
    assert cache_folder() == CacheFolder(places / "tmp" / OWN / digest())
    assert not (places / "~").exists()


@POSIX
@pytest.mark.parametrize("loose", ["home", "tmp"])
def test_folders_are_closed_to_others(places: Path, loose: str) -> None:
    if loose == "tmp":
        no_home(places)
    first = cache_folder().folder
    assert first is not None and places / loose in first.parents
    for folder in (first, first.parent):
        assert folder.stat().st_mode & 0o777 == 0o700
        folder.chmod(0o777)
    assert cache_folder().folder == first
    assert {f.stat().st_mode & 0o777 for f in (first, first.parent)} == {0o700}


@POSIX
@pytest.mark.parametrize("link", [False, True])
def test_nobody_elses_code_is_loaded(places: Path, monkeypatch: pytest.MonkeyPatch, link: bool) -> None:
    """Another user has made the folder of the predictable name, or a link of that name, first."""
    no_home(places)
    folder, me = places / "tmp" / OWN, os.getuid()
    if link:
        (places / "elsewhere").mkdir()
        folder.symlink_to(places / "elsewhere")
    else:
        folder.mkdir()
    assert cache_folder().folder == folder / digest()
    monkeypatch.setattr(os, "getuid", lambda: me + 1)
    folder.rename(places / "tmp" / f"pound-solve-{me + 1}")
    assert cache_folder() == CacheFolder(None, NOT_KEPT)


def test_versions_that_no_run_uses_any_more_go(places: Path) -> None:
    root = kernel_cache.user_cache()
    before = kernel_cache.time.time() - 1.01 * MAX_AGE
    names = {
        "0123456789abcdef": True,
        "0123456789abcdef-old-7": True,
        "0123456789abcde0": False,
        "mine": True,
    }
    for name, old in names.items():
        (root / name / "folder").mkdir(parents=True)
        if old:
            os.utime(root / name, (before, before))
    assert cache_folder().folder == root / digest()
    assert {f.name for f in root.iterdir()} == {"mine", "0123456789abcde0", digest()}


def test_a_run_keeps_its_version_alive(places: Path) -> None:
    own = cache_folder().folder
    assert own is not None
    before = kernel_cache.time.time() - 2 * MAX_AGE
    os.utime(own, (before, before))
    (own / "kernel").write_text("")
    assert cache_folder().folder == own and (own / "kernel").exists()


def test_two_processes_prune_at_once(places: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both have seen the same old folder; the other one renames it first."""
    root = kernel_cache.user_cache()
    old = root / "0123456789abcdef"
    old.mkdir(parents=True)
    before = kernel_cache.time.time() - 2 * MAX_AGE
    os.utime(old, (before, before))
    rename = Path.rename

    def beaten(self: Path, target: Path) -> Path:
        rename(self, root / "0123456789abcdef-old-other")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", beaten)
    assert cache_folder().folder == root / digest()
    assert (root / "0123456789abcdef-old-other").is_dir()  # the other one deletes it


def tiny(env: dict[str, str], folder: Path) -> list[str]:
    """What a process says that compiles one function, from a file: numba keeps no other code."""
    script = folder / "tiny.py"
    script.write_text(TINY)
    done = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, env={**os.environ, **env}
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip().split("|")


@pytest.mark.full
def test_without_a_home_the_second_process_compiles_nothing(places: Path) -> None:
    pytest.importorskip("numba")
    no_home(places)
    first, second = (tiny({}, places) for _ in range(2))
    assert first == ["True", str(places / "tmp" / OWN / digest()), ""]
    assert second == ["False", *first[1:]]


@NUMBA
def test_one_library_is_built_for_all_checkouts_of_a_source(
    places: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from ahead_of_time import __main__ as ahead

    built: list[Path] = []

    def build(path: Path) -> None:
        built.append(path)
        path.write_bytes(b"library %d" % len(built))

    monkeypatch.setattr(ahead, "build", build)
    monkeypatch.setattr(kernel_cache, "cache_folder", kernel_cache.cache_folder.__wrapped__)
    for checkout in ("one", "other"):
        ahead.take(places / checkout)
        assert (places / checkout).read_bytes() == b"library 1"
    monkeypatch.setattr(ahead, "builder", lambda: "of another compiler")
    ahead.take(places / "third")
    assert (places / "third").read_bytes() == b"library 2"


@pytest.mark.full
def test_where_nothing_can_be_kept_kernels_are_compiled_and_it_is_told(places: Path) -> None:
    pytest.importorskip("numba")
    no_home(places)
    (places / "tmp" / OWN).write_text("")
    assert tiny({}, places) == ["True", "None", NOT_KEPT]
    named = str(places / "named")
    assert tiny({VARIABLE: named}, places) == ["True", str(Path(named, digest())), ""]


def test_on_a_terminal_a_long_line_stays(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A line that is rewritten in place is gone with the next one; a longer one is never blanked."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    line = StatusLine()
    line.tell(NOT_KEPT)
    line.tell(jit.COMPILING)
    line.clear()
    told = capsys.readouterr().err
    assert told.count(f"pound-solve: {NOT_KEPT}\n") == 1
    assert told.endswith("\r") and f"pound-solve: {jit.COMPILING}" not in told
