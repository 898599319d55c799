"""Versions and platform that decide on numbers."""

from __future__ import annotations

import importlib.metadata
import platform
import sys
from functools import cache

DISTRIBUTION = "nlcontrol-robot"
"""Name of the distribution, which is not that of the import: another project has that one."""


@cache
def library_versions() -> dict[str, str]:
    """Versions of nlcontrol and of the libraries that decide on numbers."""
    libraries = ("drake", "numpy", "scipy")
    # Its own is that of the files, which an installation made before may not be of.
    own = str(sys.modules[__name__.partition(".")[0]].__version__)
    return {"nlcontrol": own} | {name: importlib.metadata.version(name) for name in libraries}


def installed_versions() -> dict[str, str]:
    """Versions of Python, of nlcontrol and of the libraries that decide on numbers."""
    return {"python": f"{sys.implementation.name} {platform.python_version()}"} | library_versions()


def platform_name() -> str:
    """System, processor and C library, as far as they decide on numbers."""
    return " ".join(filter(None, (platform.system(), platform.machine(), *platform.libc_ver())))
