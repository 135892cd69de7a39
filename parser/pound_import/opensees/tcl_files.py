"""Files of a model in Tcl: those of its folder can be read, and what it writes stays in memory."""

from __future__ import annotations

import io
import os
from pathlib import Path, PurePath
from typing import Final

from pound_deck.files import contents

MOST_BYTES: Final = 50_000_000  #: of one file


class Files:
    """Files as a model sees them.

    Parameters
    ----------
    folder : Path
        The only one whose files it reads.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self.current = self.folder
        self.written: dict[Path, io.StringIO] = {}
        self._channels: dict[str, io.StringIO] = {}

    def path(self, name: str) -> Path:
        """Path of a file of the folder, links followed.

        Raises
        ------
        OSError
            It lies outside of the folder.
        """
        path = Path(os.path.realpath(self.current / name.replace("\\", "/")))
        if path != self.folder and self.folder not in path.parents:
            raise OSError(f"{name} lies outside of the folder of the model")
        return path

    def text(self, name: str) -> str:
        """Text of a file that the model wrote or that lies in the folder.

        Raises
        ------
        OSError
            There is no such file, or it is too large.
        """
        path = self.path(name)
        if path in self.written:
            return self.written[path].getvalue()
        if not path.is_file():
            raise OSError(f"couldn't open {name}: no such file in the folder of the model")
        if path.stat().st_size > MOST_BYTES:
            raise OSError(f"{name} exceeds {MOST_BYTES // 1_000_000} MB")
        data = contents(path)
        try:
            return data.decode("utf-8-sig").replace("\r\n", "\n")
        except UnicodeDecodeError:
            return data.decode("latin-1").replace("\r\n", "\n")

    def of_the_model(self, name: str) -> str | None:
        """Text of a file that the model wrote, else None."""
        stream = self.written.get(self.path(name))
        return stream.getvalue() if stream else None

    def open(self, name: str, access: str = "r", *_: str) -> str:
        """Open a channel and return its name."""
        channel = f"channel{len(self._channels) + 1}"
        if access.startswith("r"):
            stream = io.StringIO(self.text(name))
        else:
            path = self.path(name)
            if path not in self.written or not access.startswith("a"):
                self.written[path] = io.StringIO()
            stream = self.written[path]
            stream.seek(0, io.SEEK_END)
        self._channels[channel] = stream
        return channel

    def close(self, channel: str, *_: str) -> str:
        """Close a channel."""
        self._channels.pop(channel, None)
        return ""

    def puts(self, *words: str) -> str:
        """Write to a channel; what goes to the terminal is dropped."""
        end = "\n"
        if words[:1] == ("-nonewline",):
            end, words = "", words[1:]
        if len(words) > 1 and words[0] in self._channels:
            stream = self._channels[words[0]]
            if stream.tell() > MOST_BYTES:
                raise OSError(f"the model writes more than {MOST_BYTES // 1_000_000} MB")
            stream.write(words[1] + end)
        return ""

    def line(self, channel: str) -> tuple[str, int]:
        """Next line of a channel and its length, -1 at the end."""
        raw = self._stream(channel).readline()
        return (raw.rstrip("\n"), len(raw.rstrip("\n"))) if raw else ("", -1)

    def read(self, *words: str) -> str:
        """Rest of a channel, or as many characters as are asked for."""
        words = tuple(w for w in words if w != "-nonewline")
        return self._stream(words[0]).read(int(words[1]) if len(words) > 1 else -1)

    def eof(self, channel: str) -> bool:
        """Whether a channel is at its end."""
        stream = self._stream(channel)
        here = stream.tell()
        ends = not stream.read(1)
        stream.seek(here)
        return ends

    def _stream(self, channel: str) -> io.StringIO:
        if channel not in self._channels:
            raise OSError(f'can not find channel named "{channel}"')
        return self._channels[channel]

    def cd(self, name: str = ".") -> str:
        """Go to a folder within that of the model; one that is not there is taken to exist."""
        self.current = self.path(name)
        return ""

    def file(self, action: str, *words: str) -> str | bool:
        """Answer Tcl's ``file``; what would change files has no effect."""
        names = [word for word in words if not word.startswith("-")] or [""]
        pure = PurePath(names[0])
        match action:
            case "join":
                return PurePath(*names).as_posix()
            case "dirname":
                return pure.parent.as_posix()
            case "tail":
                return pure.name
            case "extension":
                return pure.suffix
            case "rootname":
                return names[0][: len(names[0]) - len(pure.suffix)] if pure.suffix else names[0]
            case "normalize" | "nativename":
                return names[0]
            case "isdirectory":
                return self.path(names[0]).is_dir()
            case "exists" | "isfile" | "readable":
                path = self.path(names[0])
                return path in self.written or path.is_file() or (action == "exists" and path.is_dir())
        return ""
