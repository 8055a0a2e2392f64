# SPDX-License-Identifier: MIT
"""Sessions of a folder."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import Iterator

from .session import BadSession, Session


def find_sessions(*paths: str | os.PathLike[str]) -> list[Path]:
    """The session files (.h5) that the paths name: files as they are, folders searched to any depth; sorted, each
    once. Raises FileNotFoundError for a path that is not there, and where nothing is found, and PermissionError for a
    folder that may not be searched."""
    found: dict[Path, Path] = {}
    for path in map(Path, paths):
        if not path.exists():
            raise FileNotFoundError(f"there is no such file or folder: {path}")
        for file in sorted(_files_in(path)) if path.is_dir() else [path]:
            found.setdefault(file.resolve(), file)
    if not found:
        raise FileNotFoundError(f"there is no session (.h5) in {', '.join(map(str, paths))}")
    return sorted(found.values())


def _files_in(folder: Path) -> Iterator[Path]:
    """As the program searches: no pipes, no folders that links lead to."""
    def refuse(error: OSError) -> None:
        raise error
    for place, _, names in os.walk(folder, onerror=refuse):
        yield from (file for name in names if name.endswith(".h5") and (file := Path(place, name)).is_file())


def open_sessions(*paths: str | os.PathLike[str], accept_bad: bool = False) -> list[Session]:
    """What `thermorig train` would take of these paths, in its order: by environment and number, without those
    that were recorded for a calibration. Bad ones that lie in a folder are left out with a warning, unless accepted.
    Raises BadSession for one that is named itself, and where no other is left, and ValueError where two files hold
    the same recording."""
    sessions, bad = [], []
    named = {Path(path).resolve() for path in paths}
    for session in map(Session, find_sessions(*paths)):
        if session.for_calibration:
            session.close()
        elif session.verdict != "bad" or accept_bad:
            sessions.append(session)
        else:
            bad.append(f"{session.path}: the verdict is bad: {'; '.join(session.verdict_reasons)}")
            session.close()
            if Path(session.path).resolve() in named:
                raise BadSession(bad[-1])
    if bad and not sessions:
        raise BadSession(bad[0])
    for reason in bad:
        warnings.warn(f"left out: {reason} (accept_bad=True takes it)", stacklevel=2)
    first_of: dict[str, Session] = {}
    for session in sessions:
        first = first_of.setdefault(session.data_hash, session)
        if first is not session:
            raise ValueError(f"{session.path}: holds the same recording as {first.path}")
    return sorted(sessions, key=lambda session: (session.environment, session.acquisition, session.data_hash))
