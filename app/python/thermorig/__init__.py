# SPDX-License-Identifier: MIT
"""Sessions of thermorig: what stands in them, and the windows that its networks learn from.

    import thermorig
    for session in thermorig.open_sessions("recordings"):
        data = thermorig.windows(session, frames=3)
        print(session.name, len(data), data.label_dps.mean())
"""

from .sessions import find_sessions, open_sessions
from .checks import NotASession
from .session import BadSession, Estimate, Session
from .windows import Scaling, Windows, scaling_of, windows

__all__ = [
    "BadSession", "Estimate", "NotASession", "Scaling", "Session", "Windows", "find_sessions", "open_sessions",
    "scaling_of", "windows",
]
__version__ = "0.2.0"
