"""Versions and platform that decide on numbers."""

from __future__ import annotations

import importlib.metadata
import platform
import sys
from functools import cache


@cache
def library_versions() -> dict[str, str]:
    """Versions of nlcontrol and of the libraries that decide on numbers."""
    packages = ("nlcontrol", "drake", "numpy", "scipy")
    return {name: importlib.metadata.version(name) for name in packages}


def installed_versions() -> dict[str, str]:
    """Versions of Python, of nlcontrol and of the libraries that decide on numbers."""
    return {"python": f"{sys.implementation.name} {platform.python_version()}"} | library_versions()


def platform_name() -> str:
    """System, processor and C library, as far as they decide on numbers."""
    return " ".join(filter(None, (platform.system(), platform.machine(), *platform.libc_ver())))
