# SPDX-License-Identifier: MIT
"""Sessions of a folder."""

from __future__ import annotations

import os
from pathlib import Path

from .session import BadSession, Session


def find_sessions(*paths: str | os.PathLike[str]) -> list[Path]:
    """The session files (.h5) that the paths name: files as they are, folders searched to any depth; sorted, each
    once. Raises FileNotFoundError for a path that is not there, and where nothing is found."""
    found: dict[Path, Path] = {}
    for path in map(Path, paths):
        if not path.exists():
            raise FileNotFoundError(f"there is no such file or folder: {path}")
        for file in sorted(path.rglob("*.h5")) if path.is_dir() else [path]:
            found.setdefault(file.resolve(), file)
    if not found:
        raise FileNotFoundError(f"there is no session (.h5) in {', '.join(map(str, paths))}")
    return sorted(found.values())


def open_sessions(*paths: str | os.PathLike[str], accept_bad: bool = False) -> list[Session]:
    """What `thermorig train` would take of these paths, in its order: by environment and number, without those
    that were recorded for a calibration. Raises BadSession for one whose verdict is bad, unless accepted, and
    ValueError where two files hold the same recording."""
    sessions = [session for session in map(Session, find_sessions(*paths)) if not session.for_calibration]
    first_of: dict[str, Session] = {}
    for session in sessions:
        if session.verdict == "bad" and not accept_bad:
            raise BadSession(f"{session.path}: the verdict is bad: {'; '.join(session.verdict_reasons)}")
        first = first_of.setdefault(session.data_hash, session)
        if first is not session:
            raise ValueError(f"{session.path}: holds the same recording as {first.path}")
    return sorted(sessions, key=lambda session: (session.environment, session.acquisition, session.data_hash))
