# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Files and folders of `morula.batch`: on this machine by paths, elsewhere by URLs through fsspec."""

from __future__ import annotations

import os
import pathlib
import socket
import time
import urllib.parse
from collections.abc import Mapping
from typing import Any, Union

from ._morula import batch_engine as engine

Name = Union[str, pathlib.Path]

#: Where a file takes its name in one step; elsewhere, as in stores of objects, one appears whole by itself.
_RENAMES = {"file", "local", "sftp", "ssh", "smb", "ftp", "hdfs", "webhdfs", "arrow_hdfs"}


class Place:
    """A file or folder, on this machine or on a file system of fsspec."""

    def __init__(self, name: str | os.PathLike[str], storage_options: Mapping[str, Any] | None = None) -> None:
        text = os.fspath(name)
        self.options = dict(storage_options or {})
        self.local: pathlib.Path | None = None
        self._fs: Any = None
        if text.startswith("file://"):
            from urllib.request import url2pathname

            text = url2pathname(urllib.parse.urlsplit(text).path)
        if "://" not in text:
            self.local = pathlib.Path(text)
            self.name: Name = self.local
            return
        try:
            import fsspec  # type: ignore[import-not-found,import-untyped,unused-ignore]
        except ImportError:
            raise ImportError(f"{text}: only files of this machine can be used without fsspec: pip install fsspec") from None
        self._fs, self._path = fsspec.core.url_to_fs(text, **self.options)
        self.name = text if text.endswith("://") else text.rstrip("/")

    def __truediv__(self, name: str) -> Place:
        return Place(self.local / name if self.local is not None else f"{self.name}/{name}", self.options)

    @property
    def suffix(self) -> str:
        return pathlib.PurePosixPath(str(self.name)).suffix.lower()

    def absolute(self) -> str:
        """The absolute place, for workers with another working folder."""
        return str(self.local.absolute()) if self.local is not None else str(self.name)

    def parent(self) -> Place:
        if self.local is not None:
            return Place(self.local.parent)
        above = str(self.name).rpartition("/")[0]
        return Place(above + "/" if above.endswith(":/") else above, self.options)

    def exists(self) -> bool:
        """True if there is a file, a folder or a link, even a broken one."""
        return os.path.lexists(self.local) if self.local is not None else bool(self._fs.exists(self._path))

    def is_folder(self) -> bool:
        return self.local.is_dir() if self.local is not None else bool(self._fs.isdir(self._path))

    def make_folder(self) -> None:
        if self.local is not None:
            self.local.mkdir(parents=True, exist_ok=True)
        else:
            self._fs.makedirs(self._path, exist_ok=True)

    def name_in(self, folder: Place) -> str:
        """This place's path below another one; both on another machine."""
        return str(self._path)[len(str(folder._path).rstrip("/")) + 1 :]

    def files(self) -> list[Name]:
        """All files below a folder on another machine, sorted."""
        return sorted(str(self._fs.unstrip_protocol(path)) for path in self._fs.find(self._path))

    def read(self) -> bytes:
        """The content. OSError if there is no file; a FIFO is not a file."""
        if self.local is not None:
            data = engine.read(self.local)
            if data is None:
                raise OSError(f"{self.local}: is no file that can be read")
            return data
        found: bytes = self._fs.cat_file(self._path)
        return found

    def read_if_there(self) -> bytes | None:
        try:
            return self.read()
        except FileNotFoundError:
            return None
        except OSError:
            if self.local is not None:
                return None
            raise

    def write(self, content: str | bytes) -> None:
        """Writes a file. The write is atomic."""
        data = content.encode() if isinstance(content, str) else content
        mark = f"{socket.gethostname()}.{os.getpid()}.{time.monotonic_ns()}"
        if self.local is not None:
            beside = self.local.with_name(f".{self.local.name}.{mark}")
            beside.write_bytes(data)
            os.replace(beside, self.local)
            return
        self._fs.makedirs(self._path.rpartition("/")[0], exist_ok=True)
        kinds = self._fs.protocol if isinstance(self._fs.protocol, (list, tuple)) else (self._fs.protocol,)
        if _RENAMES.isdisjoint(kinds):
            self._fs.pipe_file(self._path, data)
            return
        folder, _, last = self._path.rpartition("/")
        self._fs.pipe_file(f"{folder}/.{last}.{mark}", data)
        self._fs.mv(f"{folder}/.{last}.{mark}", self._path)

    def remove(self) -> None:
        if self.local is not None:
            self.local.unlink()
        else:
            self._fs.rm_file(self._path)
