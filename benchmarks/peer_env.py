"""Make the peer's environment: OpenSeesPy in a virtual environment of its own, never a dependency of ours.

    python3.11 benchmarks/peer_env.py             # makes .venv-peer beside pyproject.toml
    python3.11 benchmarks/peer_env.py --apt       # and installs the shared libraries that it needs (root)

OpenSees 3.7.1 wants Python 3.11 on Linux and the Debian packages libblas3, liblapack3 and libgfortran5; the
releases after it want a newer C library than a stable Debian has.
"""

import argparse
import subprocess
import sys
import venv
from pathlib import Path

WHEELS = ("openseespy==3.7.1.2", "openseespylinux==3.7.1.2")
LIBRARIES = ("libblas3", "liblapack3", "libgfortran5")
FOLDER = Path(__file__).resolve().parents[1] / ".venv-peer"


def install_libraries():
    """Install the shared libraries with apt; asked for by a flag, because it changes the machine."""
    subprocess.run(["apt-get", "update", "-qq"], check=True)
    subprocess.run(["apt-get", "install", "-y", "-qq", "--no-install-recommends", *LIBRARIES], check=True)


def make(folder):
    """Create the environment, or complete one that exists, and return its interpreter."""
    venv.create(folder, with_pip=True)
    python = folder / "bin" / "python"
    subprocess.run([python, "-m", "pip", "install", "--quiet", *WHEELS], check=True)
    return python


def version(python):
    """Version of OpenSees that the environment loads; None when it does not, and the loader says why."""
    command = "import openseespy.opensees as ops; print(ops.version())"
    answer = subprocess.run([python, "-c", command], stdout=subprocess.PIPE, text=True)
    return answer.stdout.strip() if answer.returncode == 0 else None


def main():
    """Read the command line, make the environment, try it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--folder", type=Path, default=FOLDER, help="default: .venv-peer")
    parser.add_argument("--apt", action="store_true", help="install the Debian packages too")
    args = parser.parse_args()

    if sys.version_info[:2] != (3, 11) or sys.platform != "linux":
        sys.exit("peer_env: OpenSeesPy 3.7.1.2 runs under Python 3.11 on Linux; start me with python3.11")
    if args.apt:
        install_libraries()
    python = make(args.folder)
    found = version(python)
    if found is None:
        sys.exit(f"peer_env: OpenSees does not load; is one of {', '.join(LIBRARIES)} missing? (--apt)")
    print(f"OpenSees {found}: {python}")


if __name__ == "__main__":
    main()
